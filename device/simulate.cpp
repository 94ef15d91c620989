// SPDX-License-Identifier: MIT
#include "device/simulate.hpp"

#include <fmt/format.h>

namespace popcut {

Result<Trace> simulate(std::span<const std::byte> program, const Machine& machine,
                       const SimOptions& options) {
  if (program.empty())
    return fail(ErrorKind::Malformed, "", "the program is empty; a GPGL or HPGL program is needed");
  Result<SimCutter> made = SimCutter::make(machine, options);
  if (!made) return tl::unexpected(made.error());
  SimCutter& sim = *made;
  while (!program.empty()) {
    const std::size_t taken = sim.accept(program);
    program = program.subspan(taken);
    static_cast<void>(sim.take_replies());  // a program in a file talks to nobody
    if (taken > 0) continue;
    const std::optional<SimCutter::Time> next = sim.next_event();
    if (!next) return fail(ErrorKind::Internal, "", "the simulated cutter stands still");
    sim.run_until(*next);
  }
  sim.finish();
  sim.run_dry();
  const Trace& trace = sim.trace();
  if (trace.strokes.empty() && trace.unknown_count > trace.settings.size())
    return fail(ErrorKind::Malformed, "",
                fmt::format("nothing is drawn and {} commands are not understood, the first is "
                            "\"{}\"; a {} program is needed",
                            trace.unknown_count, trace.unknown.front(),
                            machine.language == "hpgl" ? "HPGL" : "GPGL"));
  return trace;
}

}  // namespace popcut
