// SPDX-License-Identifier: MIT
#include "device/session/schedule.hpp"

#include "device/port/transport.hpp"
#include "device/sim/sim_cutter.hpp"

namespace popcut {

using std::chrono::nanoseconds;

namespace {

// A stroke whose line was begun has to be sent whole; the move to its start cuts nothing and can be
// sent before. So a line is begun only if its stroke ends within this part of a window; the rest of
// the window allows for the model's errors. A longer one is begun when the machine has less than
// the least part left, in which every recorded query was answered.
constexpr double kStrokeWindow = 0.85;
constexpr double kLeastWindow = 0.25;

void set_stroke_ends(const std::vector<ByteRange>& strokes,
                     std::span<const std::uint64_t> first_lines,
                     std::vector<TimedCommand>& commands) {
  std::size_t first = 0;
  for (std::size_t stroke_at = 0; stroke_at < strokes.size(); ++stroke_at) {
    const ByteRange& stroke = strokes[stroke_at];
    for (; first < commands.size() && commands[first].end_byte <= first_lines[stroke_at]; ++first)
      commands[first].stroke_end_s = commands[first].seconds;
    std::size_t last = first;
    while (last < commands.size() && commands[last].end_byte <= stroke.end) ++last;
    for (std::size_t k = first; k < last; ++k)
      commands[k].stroke_end_s = commands[last - 1].seconds;
    first = last;
  }
  for (; first < commands.size(); ++first) commands[first].stroke_end_s = commands[first].seconds;
}

}  // namespace

Result<Schedule> schedule(const EncodedProgram& program, const Machine& machine,
                          std::span<const std::uint64_t> first_lines) {
  SimOptions options;
  options.unlimited = true;
  Result<SimCutter> made = SimCutter::make(machine, options);
  if (!made) return tl::unexpected(made.error());
  SimCutter& sim = *made;
  std::vector<SimCutter::Step> steps;
  const auto run = [&](ByteRange range) {
    const nanoseconds start = sim.now();
    sim.accept(program.view(range));
    sim.run_dry();
    return to_seconds(sim.now() - start);
  };
  Schedule plan;
  plan.setup_s = run({0, program.geometry.begin});
  sim.record_steps(&steps);
  const nanoseconds zero = sim.now();
  plan.geometry_s = run(program.geometry);
  sim.record_steps(nullptr);
  plan.trailer_s = run(program.trailer);
  plan.feed_out_s = run(program.feed_out);
  // Sending cannot stop at a point inside a command: no query may follow there.
  for (const SimCutter::Step& step : steps)
    if (step.whole_command)
      plan.geometry.push_back({step.end_byte, to_seconds(step.time - zero), 0.0});
  // Bytes after the last command, such as a newline, are sent with it.
  if (plan.geometry.empty() || plan.geometry.back().end_byte < program.geometry.end) {
    const double seconds = plan.geometry_s;
    if (!plan.geometry.empty()) plan.geometry.pop_back();
    if (program.geometry.end > program.geometry.begin)
      plan.geometry.push_back({program.geometry.end, seconds, 0.0});
  }
  set_stroke_ends(program.strokes, first_lines, plan.geometry);
  return plan;
}

std::uint64_t affordable_end(const Schedule& plan, std::size_t next, double sent_s,
                             const Whereabouts& machine, double window_s, std::size_t most_bytes) {
  std::uint64_t end = 0;
  const std::uint64_t begin = next > 0 ? plan.geometry[next - 1].end_byte : 0;
  double ahead_s = sent_s;
  for (; next < plan.geometry.size() && (end == 0 || end < begin + most_bytes); ++next) {
    const TimedCommand& command = plan.geometry[next];
    const bool begun = next > 0 && plan.geometry[next - 1].stroke_end_s == command.stroke_end_s;
    const double until_s = (begun ? command.seconds : command.stroke_end_s) - machine.least_s;
    const double most = begun ? 1.0 : kStrokeWindow, least = begun ? 0.5 : kLeastWindow;
    const bool enough = ahead_s - machine.most_s >= least * window_s * machine.fast;
    if (enough && until_s > most * window_s * machine.slow) break;
    ahead_s = command.seconds;
    end = command.end_byte;
  }
  return end;
}

}  // namespace popcut
