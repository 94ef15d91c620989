// SPDX-License-Identifier: MIT
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

#include <fmt/format.h>

#include "daemon/cli/cutter/simulate_pty.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "device/sim/sim_pty.hpp"

namespace popcut::cli {
namespace {

std::atomic<bool> pty_end_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
extern "C" void ask_pty_to_end(int) { pty_end_asked = true; }

Result<SimTransport> make_cable(const PtyOptions& options) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machine =
      find_driven_machine(options.machine.empty() ? "cameo3" : options.machine, tables->texts);
  if (!machine) return tl::unexpected(tables->with_file(machine.error(), "--machine"));
  auto faults = read_faults(options.faults);
  if (!faults) return tl::unexpected(faults.error());
  auto sim = SimCutter::make(*machine);
  if (!sim) return tl::unexpected(sim.error());
  return SimTransport(std::move(*sim), std::move(*faults));
}

/// The keys of the panel: one line each, because the terminal delivers lines.
void press(SimCutter& cutter, bool& input) {
  pollfd keys{STDIN_FILENO, POLLIN, 0};
  while (input && poll(&keys, 1, 0) == 1) {
    char key = 0;
    if (read(STDIN_FILENO, &key, 1) != 1) {
      input = false;
      return;
    }
    switch (key) {
      case 'p':
        cutter.status() == DeviceStatus::Paused ? cutter.resume() : cutter.pause();
        break;
      case 'c':
        cutter.cancel();
        break;
      case 'm':
        cutter.status() == DeviceStatus::NoMedia ? cutter.load_media() : cutter.unload_media();
        break;
      default:
        continue;
    }
    fmt::print(stderr, "{}\n", name_of(cutter.status()));
    std::fflush(stderr);
  }
}

}  // namespace

Result<void> serve_pty(const PtyOptions& options, const Globals& globals) {
  auto cable = make_cable(options);
  if (!cable) return tl::unexpected(cable.error());
  auto pty = SimPty::open(std::move(*cable), options.speedup);
  if (!pty) return tl::unexpected(pty.error());
  // Before anyone reads how to end it.
  pty_end_asked = false;
  auto* const interrupt = std::signal(SIGINT, ask_pty_to_end);
  auto* const terminate = std::signal(SIGTERM, ask_pty_to_end);
  fmt::print("{}\n", pty->path());
  std::fflush(stdout);
  if (!globals.quiet)
    fmt::print(
        stderr,
        "a simulated {} is at {}; type p (pause or continue), c (cancel) or m (take the sheet "
        "out or put it in), then Enter; Ctrl-C ends\n",
        pty->cable().cutter().trace().machine, pty->path());
  std::fflush(stderr);
  bool input = true;
  while (!pty_end_asked && pty->serve(std::chrono::milliseconds(50)))
    press(pty->cable().cutter(), input);
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, terminate);
  if (options.folder.empty()) return {};
  const Trace& trace = pty->cable().cutter().trace();
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = folder->add("cut.svg", trace_svg(trace)); !done) return done;
  if (auto done = folder->add("trace.json", trace_json(trace)); !done) return done;
  return folder->commit("popcut simulate " POPCUT_VERSION);
}

}  // namespace popcut::cli
