// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlopt.h>

#include "core/calibrate/measured.hpp"
#include "core/machines/motion.hpp"

// Part of core/calibrate/measured.hpp.

namespace popcut::calibrate {
namespace {

/// What is fitted: factors of the present values, as logarithms.
struct Fit {
  const Machine& machine;
  std::span<const Timing> timings;
  double blade_offset_mm;
  std::vector<double* (*)(Machine&)> fields{};

  [[nodiscard]] Machine machine_at(const double* logs) const {
    Machine made = machine;
    for (std::size_t k = 0; k < fields.size(); ++k) *fields[k](made) *= std::exp(logs[k]);
    // Which part of it is the lowering, no time tells.
    made.motion.lift_s *= made.motion.drop_s / machine.motion.drop_s;
    return made;
  }
  [[nodiscard]] double error(const Machine& made, const Timing& timing) const;
};

/// The run as the machine moves it: its steps of speed are of another size.
TimedRun at_steps_of(const TimedRun& run, double factor) {
  TimedRun made = run;
  for (Stroke& stroke : made.path.strokes) stroke.speed_mm_s *= factor;
  return made;
}

double Fit::error(const Machine& made, const Timing& timing) const {
  const double factor = machine.speed_mm_s.per_step > 0
                            ? made.speed_mm_s.per_step / machine.speed_mm_s.per_step
                            : 1.0;
  return std::log(run_seconds(at_steps_of(*timing.run, factor), made, blade_offset_mm) /
                  timing.seconds);
}

double squares(unsigned, const double* logs, double*, void* data) {
  const Fit& fit = *static_cast<const Fit*>(data);
  const Machine made = fit.machine_at(logs);
  double sum = 0;
  for (const Timing& timing : fit.timings) {
    const double e = fit.error(made, timing);
    sum += e * e;
  }
  // What no run tells stays as it was.
  for (std::size_t k = 0; k < fit.fields.size(); ++k) sum += 1e-7 * logs[k] * logs[k];
  return sum;
}

}  // namespace

double run_seconds(const TimedRun& run, const Machine& machine, double blade_offset_mm) {
  const Toolpath& path = run.path;
  if (path.strokes.empty()) return 0;
  const FirmwareSwivel swivel{blade_offset_mm,
                              blade_offset_mm > 0 ? std::uint16_t{0xFFFF} : std::uint16_t{0}};
  return strokes_seconds(path, machine.motion, swivel) +
         travel_seconds(distance({}, path.points_of(path.strokes.front()).front()),
                        machine.motion) -
         machine.motion.lift_s;
}

double parking_seconds(const TimedRun& run, double trailer_s, const Machine& machine) {
  const PagePoint last = run.path.points_of(run.path.strokes.back()).back();
  const double way_s = travel_seconds(distance({}, last), machine.motion);
  return std::max(0.0, trailer_s - machine.motion.lift_s - way_s);
}

Result<MotionFit> fit_motion(const Machine& machine, const std::vector<Timing>& timings,
                             double blade_offset_mm) {
  if (timings.size() < 7)
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("{} timed runs; all 7 are needed", timings.size()));
  for (const Timing& timing : timings)
    if (!(timing.seconds > 0.5 && timing.seconds < 7200))
      return fail(ErrorKind::OutOfRange, timing.run->name,
                  fmt::format("took {:g} s; give the seconds from its first move until it stood "
                              "still",
                              timing.seconds));
  Machine start = machine;
  Motion& motion = start.motion;
  motion.drop_s = std::max(motion.drop_s, 0.01);
  motion.lift_s = std::max(motion.lift_s, 0.01);
  motion.corner_mm = std::max(motion.corner_mm, 0.001);
  Fit fit{start, std::span(timings).first(timings.size() - 1), blade_offset_mm};
  fit.fields = {[](Machine& m) { return &m.motion.accel_mm_s2; },
                [](Machine& m) { return &m.motion.travel_mm_s; },
                [](Machine& m) { return &m.motion.drop_s; },
                [](Machine& m) { return &m.motion.corner_mm; }};
  if (blade_offset_mm > 0) fit.fields.push_back([](Machine& m) { return &m.motion.swivel_mm_s; });
  if (machine.speed_mm_s.per_step > 0)
    fit.fields.push_back([](Machine& m) { return &m.speed_mm_s.per_step; });
  const auto count = static_cast<unsigned>(fit.fields.size());
  std::array<double, 6> logs{}, best{};
  double least = HUGE_VAL;
  // The speed of a step and the acceleration explain each other in part: more than one start.
  for (const double begin : {0.0, 0.5, -0.5}) {
    logs.fill(0);
    logs[0] = begin;
    nlopt_opt opt = nlopt_create(NLOPT_LN_SBPLX, count);
    nlopt_set_lower_bounds1(opt, std::log(0.02));
    nlopt_set_upper_bounds1(opt, std::log(50));
    nlopt_set_min_objective(opt, squares, &fit);
    nlopt_set_initial_step1(opt, 0.3);
    nlopt_set_xtol_rel(opt, 1e-7);
    nlopt_set_maxeval(opt, 6000);
    double value = HUGE_VAL;
    (void)nlopt_optimize(opt, logs.data(), &value);  // the errors below decide, not its code
    nlopt_destroy(opt);
    if (value < least) least = value, best = logs;
  }
  MotionFit found{fit.machine_at(best.data()), 0, 0};
  const auto relative = [&](const Timing& timing) {
    return std::abs(std::expm1(fit.error(found.machine, timing)));
  };
  const Timing* worst = nullptr;
  for (const Timing& timing : fit.timings)
    if (worst == nullptr || relative(timing) > found.worst) {
      worst = &timing;
      found.worst = relative(timing);
    }
  found.checked = relative(timings.back());
  if (found.checked > found.worst) worst = &timings.back();
  const double error = std::max(found.worst, found.checked);
  if (error > 0.2)
    return fail(ErrorKind::Infeasible, worst->run->name,
                fmt::format("took {:g} s, {:.0f} % off what the other runs say; time it again",
                            worst->seconds, 100 * error));
  found.machine.motion.spread = std::clamp(2 * error, 0.05, 0.9);
  return found;
}

}  // namespace popcut::calibrate
