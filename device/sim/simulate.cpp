// SPDX-License-Identifier: MIT
#include "device/sim/simulate.hpp"

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "device/sim/sim_transport.hpp"

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
    if (sim.trace().points.size() > kMaxDrawnPoints)
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("the program draws more than {} points", kMaxDrawnPoints));
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

Result<Trace> simulate_faults(std::span<const std::byte> program, const Machine& machine,
                              const SimOptions& options, std::vector<SimFault> faults) {
  if (program.empty())
    return fail(ErrorKind::Malformed, "", "the program is empty; a GPGL or HPGL program is needed");
  Result<SimCutter> made = SimCutter::make(machine, options);
  if (!made) return tl::unexpected(made.error());
  SimTransport cable(std::move(*made), std::move(faults));
  constexpr std::chrono::seconds kPatience(3600);
  const std::size_t whole = program.size();
  std::string why;
  while (!program.empty() && why.empty()) {
    const auto end = cable.write(program, cable.now() + kPatience);
    program = program.subspan(end.taken);
    if (cable.cutter().trace().points.size() > kMaxDrawnPoints)
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("the program draws more than {} points", kMaxDrawnPoints));
    if (!end.error) break;
    if (end.error->kind != ErrorKind::Timeout) why = end.error->detail;
    // A write that ends early is not the end; one that takes nothing for an hour is.
    else if (end.taken == 0 && cable.cutter().status() != DeviceStatus::Moving)
      why = fmt::format("the cutter takes no data: {}", name_of(cable.cutter().status()));
  }
  if (program.empty()) cable.cutter().finish();
  // By the cable's clock, on which faults still strike and buttons are still pressed.
  do cable.wait(kPatience);
  while (cable.cutter().status() == DeviceStatus::Moving);
  Trace trace = cable.cutter().trace();
  if (!why.empty())
    trace.remarks.push_back(fmt::format("the host gave up after {} of {} bytes: {}",
                                        whole - program.size(), whole, why));
  else if (cable.cutter().status() != DeviceStatus::Ready)
    trace.remarks.push_back(fmt::format("all was sent, but the cutter never came to rest: {}",
                                        name_of(cable.cutter().status())));
  return trace;
}

}  // namespace popcut
