// SPDX-License-Identifier: MIT
#include "device/schedule.hpp"

#include "device/sim_cutter.hpp"

namespace popcut {

using std::chrono::nanoseconds;

Result<Schedule> schedule(const EncodedProgram& program, const Machine& machine) {
  SimOptions options;
  options.unlimited = true;
  Result<SimCutter> made = SimCutter::make(machine, options);
  if (!made) return tl::unexpected(made.error());
  SimCutter& sim = *made;
  std::vector<SimCutter::Step> steps;
  const auto in_seconds = [](nanoseconds time) {
    return std::chrono::duration<double>(time).count();
  };
  const auto run = [&](ByteRange range) {
    const nanoseconds start = sim.now();
    sim.accept(program.view(range));
    sim.run_dry();
    return in_seconds(sim.now() - start);
  };
  Schedule plan;
  plan.setup_s = run({0, program.geometry.begin});
  sim.record_steps(&steps);
  const nanoseconds zero = sim.now();
  plan.geometry_s = run(program.geometry);
  sim.record_steps(nullptr);
  plan.trailer_s = run(program.trailer);
  // Points inside a command are no place to stop sending: a query may not stand there.
  for (const SimCutter::Step& step : steps)
    if (step.whole_command) plan.geometry.push_back({step.end_byte, in_seconds(step.time - zero)});
  return plan;
}

}  // namespace popcut
