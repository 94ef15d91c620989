// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/cutter/cut_session.hpp"
#include "daemon/files/output_folder.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/decode.hpp"

namespace popcut::cli {
namespace send_command {
namespace {

struct Options {
  std::string file, device, machine, treat_as;
  bool yes{false};
};

constexpr std::uintmax_t kLimitBytes = 1u << 28;

/// What the program would do, by the simulator. It is sent only if all of it stays on the machine.
Result<Trace> rehearse(const EncodedProgram& program, const Machine& machine) {
  SimOptions sheet;
  sheet.page_width_mm = machine.width_mm;
  sheet.page_length_mm = machine.length_mm;
  auto trace = simulate(program.view(), machine, sheet);
  if (!trace) return trace;
  if (trace->clipped_mm > 0.1)
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("{:.1f} mm of its lines lie beyond the {:g} x {:g} mm that {} reaches, or "
                    "beyond a window that it sets",
                    trace->clipped_mm, machine.width_mm, machine.length_mm, machine.title));
  return trace;
}

Box box_of(const Trace& trace) {
  Box box;
  for (const PagePoint& p : trace.points) box.add(p);
  return box;
}

Result<void> ask(const Options& options, const CutTarget& target, double seconds) {
  if (options.yes || target.device.kind == DeviceKind::File) return {};
  if (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1)
    return fail(ErrorKind::Refused, "",
                "cannot ask whether to start, because this is not a terminal; with a simulated "
                "device add --yes");
  fmt::print(
      stderr, "Load a sheet into {}, about {:.0f} min. Start cutting? [y/N] ",
      target.simulated() ? target.device.text : target.machine.title + " at " + target.device.text,
      std::ceil(seconds / 60));
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "y" || answer == "Y" || answer == "yes") return {};
  return fail(ErrorKind::Refused, "", "was not started; nothing was cut");
}

Result<void> run_send(const Options& options, const Globals& globals) {
  const bool simulated = options.device.empty() || options.device.starts_with("sim:");
  if (options.yes && !simulated)
    return fail(ErrorKind::Usage, "--yes",
                fmt::format("works only with simulated devices, and {} is real; leave --yes out, "
                            "so that you are asked",
                            options.device));
  auto target = choose_target({options.device, options.machine, options.treat_as});
  if (!target) return tl::unexpected(target.error());
  auto bytes = read_file(options.file, kLimitBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->empty())
    return fail(ErrorKind::Malformed, options.file, "is empty; give a program for a cutter");
  const Machine& machine = target->machine;
  if (const std::string foreign = foreign_program(std::as_bytes(std::span(*bytes)));
      !foreign.empty())
    return fail(ErrorKind::Malformed, options.file, foreign);
  const Dialect dialect = machine.language == "hpgl" ? Dialect::Hpgl : Dialect::Gpgl;
  if (guess_dialect(std::as_bytes(std::span(*bytes))) != dialect)
    return fail(
        ErrorKind::Refused, options.file,
        fmt::format("is written in {}, and {} speaks {}; name another --device or --machine",
                    dialect == Dialect::Hpgl ? "GPGL" : "HPGL", machine.title,
                    dialect == Dialect::Hpgl ? "HPGL" : "GPGL"));
  auto program = read_foreign(dialect, std::move(*bytes));
  if (!program) return tl::unexpected(within(options.file, program.error()));
  program->ask_blade = machine.reports_tools();
  const auto rehearsed = rehearse(*program, machine);
  if (!rehearsed) return tl::unexpected(within(options.file, rehearsed.error()));
  const Box box = box_of(*rehearsed);
  if (!globals.quiet)
    fmt::print(stderr,
               "{}: {} strokes, {:.0f} mm, from {:.1f}, {:.1f} to {:.1f}, {:.1f} mm, about {:.1f} "
               "min on {}\n",
               shown_text(options.file), rehearsed->lifts, rehearsed->cut_mm, box.x0, box.y0,
               box.x1, box.y1, rehearsed->seconds / 60, machine.title);
  if (const auto yes = ask(options, *target, rehearsed->seconds); !yes)
    return tl::unexpected(within(options.file, yes.error()));
  const auto sent = send_program(
      *target, machine,
      {*program, target->device.name, {machine.width_mm, machine.length_mm}, rehearsed->seconds},
      !globals.quiet);
  if (!sent) return tl::unexpected(sent.error());
  const auto count = [&](StrokeFate fate) {
    return std::count(sent->end.fates.begin(), sent->end.fates.end(), fate);
  };
  const std::string ledger = fmt::format("{} strokes are cut, {} are in doubt, {} were not sent",
                                         count(StrokeFate::Certain), count(StrokeFate::InDoubt),
                                         count(StrokeFate::NotSent));
  if (globals.json) {
    const nlohmann::ordered_json json{{"device", target->device.text},
                                      {"machine", machine.name},
                                      {"done", !sent->end.error && !sent->end.cancelled},
                                      {"strokes",
                                       {{"certain", count(StrokeFate::Certain)},
                                        {"in_doubt", count(StrokeFate::InDoubt)},
                                        {"not_sent", count(StrokeFate::NotSent)}}},
                                      {"seconds", sent->end.seconds}};
    print_json(json);
  }
  if (sent->end.error) {
    Error error = within(options.file, *sent->end.error);
    error.detail += "; " + ledger;
    if (sent->end.likely_stroke)
      error.detail +=
          fmt::format("; the knife was most likely in stroke {}", *sent->end.likely_stroke + 1);
    return tl::unexpected(error);
  }
  if (sent->end.cancelled)
    return fail(ErrorKind::Refused, options.file,
                "stopped as you asked, with the tool up and parked; " + ledger);
  if (!globals.quiet)
    fmt::print(stderr, "{}: {}, on {} in {:.0f} s{}\n", shown_text(options.file), ledger,
               target->device.text, sent->end.seconds, sent->trace ? " (simulated)" : "");
  return {};
}

constexpr const char* kHelp =
    "Send a program file, from popcut or another program, to a cutter.\n\n"
    "  popcut send sheets/sheet-01.gpgl --device usb:51053P\n"
    "  popcut send old-job.plt --device serial:/dev/ttyUSB0 --machine hpgl-generic\n\n"
    "popcut first reads and simulates it: it sends nothing that it cannot read, and nothing that\n"
    "leaves the area of the machine. Then it asks, and sends the program as 'popcut cut --direct'\n"
    "does: Ctrl-C stops at the end of a stroke, p pauses, and at the end you know which strokes\n"
    "are cut.";

}  // namespace
}  // namespace send_command

void register_send(const Command& app, const Globals& globals, Run& run) {
  using namespace send_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("send", kHelp);
  command.add_option("PROGRAM", options->file, "The program: GPGL or HPGL")
      .required()
      .value_text("FILE");
  command.add_option("--device", options->device, "Where to cut; 'popcut devices' lists them")
      .value_text("ID [sim:cameo3]");
  command.add_option("--machine", options->machine, "The machine on a port").value_text("NAME");
  command
      .add_option("--treat-as", options->treat_as,
                  "Drive an unknown cutter as if it were this machine, such as cameo4")
      .value_text("NAME");
  command.add_flag("--yes", options->yes, "Do not ask; only with simulated devices");
  when_chosen(command, run, [options, &globals] { return run_send(*options, globals); });
}

}  // namespace popcut::cli
