// SPDX-License-Identifier: MIT
#include "daemon/cli/cutter/cut_session.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>

#include "daemon/cli/cutter/stop_signals.hpp"
#include "daemon/cli/view/pause_key.hpp"
#include "daemon/cli/view/progress_bar.hpp"
#include "daemon/devices/cutter_line.hpp"

namespace popcut::cli {
namespace {

/// The line to the device, for one program.
Result<daemon::CutterLine> line_to(const CutTarget& target, const std::string& file) {
  daemon::CutterLine line{target.device, target.machine, 0, target.faults, {}, {}, file};
  if (target.device.kind != DeviceKind::Usb) return line;
  auto bus = UsbBus::open();
  if (!bus) return tl::unexpected(bus.error());
  line.bus = std::make_shared<UsbBus>(std::move(*bus));
  return line;
}

}  // namespace

Result<SentProgram> send_program(const CutTarget& target, const Machine& driven,
                                 const ProgramToSend& what, bool progress, SessionOptions options) {
  auto line = line_to(target, what.file);
  if (!line) return tl::unexpected(line.error());
  auto cable = daemon::OpenLine::open(*line, "", what.area_mm, [] {});
  if (!cable) return tl::unexpected(cable.error());
  ProgressBar bar(progress);
  PauseKey pause;
  options.cancel = &StopSignals::stop_asked;
  options.give_up = &StopSignals::give_up_asked;
  options.pause = &pause.asked();
  options.progress = [&](const SessionProgress& p) {
    pause.look();
    const std::string words =
        p.phase == SessionPhase::Cutting
            ? fmt::format("cutting, stroke {} of {}", p.strokes_done, p.strokes)
        : p.asks
            ? "did the cutter continue after its pause? press p if so, Ctrl-C if it was cancelled"
        : p.phase == SessionPhase::Held ? "paused with the tool up; press p to continue"
                                        : std::string(name_of(p.phase));
    try {
      bar.show(words, 1 - p.seconds_left / std::max(what.seconds, 1.0), p.seconds_left);
    } catch (const std::system_error&) {  // nobody looks: the terminal is gone
      StopSignals::stop_asked = true;
    }
  };
  if (pause.works()) options.ask = [&] { pause.press(); };
  const StopSignals guard;  // at a question, Ctrl-C ends popcut as usual
  const bool at_terminal = isatty(STDERR_FILENO) == 1;
  SentProgram sent{run_session(cable->transport(), driven, what.program, options), {}};
  // A terminal that is gone must not keep files from being written.
  if (at_terminal && isatty(STDERR_FILENO) != 1 &&
      std::freopen("/dev/null", "w", stderr) == nullptr)
    sent.end.remarks.push_back("the terminal is gone");
  sent.stop_asked = StopSignals::stop_asked;
  bar.clear();
  if (progress)
    for (const std::string& remark : sent.end.remarks)
      fmt::print(stderr, "  note     {}\n", remark);
  sent.trace = cable->trace();
  if (!sent.end.error && !sent.end.cancelled)
    if (const auto kept = cable->finish(); !kept) sent.end.error = kept.error();
  return sent;
}

}  // namespace popcut::cli
