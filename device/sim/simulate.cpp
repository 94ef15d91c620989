// SPDX-License-Identifier: MIT
#include "device/sim/simulate.hpp"

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "device/sim/sim_transport.hpp"

namespace popcut {
namespace {

Result<SimCutter> cutter_for(std::span<const std::byte> program, const Machine& machine,
                             const SimOptions& options) {
  if (program.empty())
    return fail(ErrorKind::Malformed, "", "the program is empty; give a GPGL or HPGL program");
  return SimCutter::make(machine, options);
}

Result<void> check_size(const Trace& trace) {
  if (trace.points.size() <= kMaxDrawnPoints) return {};
  return fail(ErrorKind::OutOfRange, "",
              fmt::format("the program draws more than {} points", kMaxDrawnPoints));
}

}  // namespace

Result<Trace> simulate(std::span<const std::byte> program, const Machine& machine,
                       const SimOptions& options) {
  Result<SimCutter> made = cutter_for(program, machine, options);
  if (!made) return tl::unexpected(made.error());
  SimCutter& sim = *made;
  while (!program.empty()) {
    const std::size_t taken = sim.accept(program);
    program = program.subspan(taken);
    if (auto small = check_size(sim.trace()); !small) return tl::unexpected(small.error());
    static_cast<void>(sim.take_replies());  // nobody reads the replies to a file
    if (taken > 0) continue;
    const std::optional<SimCutter::Time> next = sim.next_event();
    if (!next) return fail(ErrorKind::Internal, "", "the simulated cutter does not move");
    sim.run_until(*next);
  }
  sim.finish();
  sim.run_dry();
  const Trace& trace = sim.trace();
  if (trace.strokes.empty() && trace.unknown_count > trace.settings.size())
    return fail(ErrorKind::Malformed, "",
                fmt::format("the program draws nothing and {} commands are not understood, first "
                            "\"{}\"; give a {} program",
                            trace.unknown_count, trace.unknown.front(),
                            machine.language == "hpgl" ? "HPGL" : "GPGL"));
  return trace;
}

Result<Trace> simulate_faults(std::span<const std::byte> program, const Machine& machine,
                              const SimOptions& options, std::vector<SimFault> faults) {
  Result<SimCutter> made = cutter_for(program, machine, options);
  if (!made) return tl::unexpected(made.error());
  SimTransport cable(std::move(*made), std::move(faults));
  constexpr std::chrono::seconds kPatience(3600);
  const std::size_t whole = program.size();
  std::string why;
  while (!program.empty() && why.empty()) {
    const auto end = cable.write(program, cable.now() + kPatience);
    program = program.subspan(end.taken);
    if (auto small = check_size(cable.cutter().trace()); !small)
      return tl::unexpected(small.error());
    if (!end.error) break;
    if (end.error->kind != ErrorKind::Timeout) why = end.error->detail;
    // A write that ends early is not the end; one that gets nothing across in an hour is.
    else if (end.taken == 0 && cable.cutter().status() != DeviceStatus::Moving)
      why = fmt::format("the cutter takes no data: {}", name_of(cable.cutter().status()));
  }
  if (program.empty()) cable.cutter().finish();
  // On the cable's clock, so that faults still strike and buttons are still pressed.
  do cable.wait(kPatience);
  while (cable.cutter().status() == DeviceStatus::Moving);
  Trace trace = cable.cutter().trace();
  if (!why.empty())
    trace.remarks.push_back(fmt::format("the host gave up after {} of {} bytes: {}",
                                        whole - program.size(), whole, why));
  else if (cable.cutter().status() != DeviceStatus::Ready)
    trace.remarks.push_back(
        fmt::format("everything was sent, but the cutter did not become ready: {}",
                    name_of(cable.cutter().status())));
  return trace;
}

}  // namespace popcut
