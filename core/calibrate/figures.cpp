// SPDX-License-Identifier: MIT
#include "core/calibrate/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace popcut::calibrate {
namespace {

constexpr double kTickMm = 4;
constexpr double kSquareMm = 8;

void add(Toolpath& path, const ToolSettings& tool, std::vector<PagePoint> points) {
  Stroke stroke;
  stroke.operation = Operation::Cut;
  stroke.first = static_cast<std::uint32_t>(path.points.size());
  stroke.count = static_cast<std::uint32_t>(points.size());
  stroke.line = static_cast<std::uint32_t>(path.strokes.size());
  stroke.tool = static_cast<std::uint8_t>(tool.tool);
  stroke.force_gf = tool.force_gf;
  stroke.speed_mm_s = tool.speed_mm_s;
  path.points.insert(path.points.end(), points.begin(), points.end());
  path.strokes.push_back(stroke);
}

void add_square(Toolpath& path, const ToolSettings& tool, PagePoint at, double mm) {
  for (int pass = 0; pass < tool.passes; ++pass) {
    ToolSettings deeper = tool;
    deeper.force_gf += pass * tool.force_step_gf;
    // A little further than the start, so that the corner is cut through.
    add(path, deeper,
        {{at.x, at.y},
         {at.x + mm, at.y},
         {at.x + mm, at.y + mm},
         {at.x, at.y + mm},
         {at.x, at.y},
         {at.x + 0.5, at.y}});
  }
}

/// The nearest speed that the machine has.
double stepped(const Machine& machine, double speed_mm_s) {
  const SteppedScale& speed = machine.speed_mm_s;
  if (!(speed.per_step > 0)) return speed_mm_s;
  const double step = std::round(speed_mm_s / speed.per_step);
  return speed.per_step *
         std::clamp(step, static_cast<double>(speed.min_step), static_cast<double>(speed.max_step));
}

}  // namespace

Toolpath Angle::path(const ToolSettings& tool) const {
  Toolpath made;
  const double x = corner.x + right_mm, y = corner.y + down_mm;
  add(made, tool, {corner, {x, corner.y}});
  add(made, tool, {{x, corner.y - kTickMm / 2}, {x, corner.y + kTickMm / 2}});
  add(made, tool, {corner, {corner.x, y}});
  for (const double before : {0.0, kTickMm})
    add(made, tool, {{corner.x - kTickMm / 2, y - before}, {corner.x + kTickMm / 2, y - before}});
  return made;
}

Angle short_angle() { return {.corner = {20, 20}, .right_mm = 40, .down_mm = 25}; }

Result<Angle> long_angle(std::array<double, 2> area_mm) {
  const auto room = [](double mm) { return std::floor(std::min(200.0, mm - 40) / 10) * 10; };
  Angle angle{.corner = {20, 20}, .right_mm = room(area_mm[0]), .down_mm = room(area_mm[1])};
  if (angle.right_mm < 40 || angle.down_mm < 40)
    return fail(ErrorKind::Infeasible, "",
                fmt::format("a sheet of {:g} x {:g} mm is too small to measure on; take one of 80 "
                            "x 80 mm at least",
                            area_mm[0], area_mm[1]));
  return angle;
}

Toolpath corner_square(const ToolSettings& tool) {
  Toolpath path;
  add_square(path, tool, {10, 10}, 20);
  return path;
}

Result<std::vector<TimedRun>> timed_runs(const Machine& machine, const ToolSettings& tool,
                                         std::array<double, 2> area_mm) {
  if (area_mm[0] < 100 || area_mm[1] < 170)
    return fail(ErrorKind::Infeasible, "",
                fmt::format("a sheet of {:g} x {:g} mm is too small for the timed runs; take one "
                            "of 100 x 170 mm at least",
                            area_mm[0], area_mm[1]));
  const double wide = std::min(180.0, area_mm[0] - 20);
  ToolSettings usual = tool, slow = tool, fast = tool;
  const double most = machine.speed_mm_s.per_step > 0
                          ? machine.speed_mm_s.per_step * machine.speed_mm_s.max_step
                          : 4 * tool.speed_mm_s;
  usual.speed_mm_s = stepped(machine, tool.speed_mm_s);
  slow.speed_mm_s = stepped(machine, std::min(20.0, most));
  fast.speed_mm_s = stepped(machine, std::min({most, 4 * tool.speed_mm_s, 200.0}));
  std::vector<TimedRun> runs;
  const auto begin = [&](const char* name) -> Toolpath& {
    runs.push_back({name, {}});
    return runs.back().path;
  };
  {
    Toolpath& path = begin("long moves");
    for (int k = 0; k < 9; ++k) {
      const double y = 10 + 4 * k;
      add(path, usual, {{10, y}, {12, y}});
      add(path, usual, {{8 + wide, y + 1}, {10 + wide, y + 1}});
    }
  }
  {
    Toolpath& path = begin("short moves");
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 20; ++k) {
        const double x = 10 + 4 * (row % 2 == 0 ? k : 19 - k), y = 55 + 4 * row;
        add(path, usual, {{x, y}, {x + 1, y}});
      }
  }
  {
    Toolpath& path = begin("slow lines");
    for (int k = 0; k < 4; ++k) {
      const double y = 80 + 3 * k;
      add(path, slow, {{k % 2 == 0 ? 10.0 : 90.0, y}, {k % 2 == 0 ? 90.0 : 10.0, y}});
    }
  }
  {
    Toolpath& path = begin("fast lines");
    for (int k = 0; k < 16; ++k) {
      const double y = 95 + k;
      add(path, fast, {{k % 2 == 0 ? 10.0 : 90.0, y}, {k % 2 == 0 ? 90.0 : 10.0, y}});
    }
  }
  {
    Toolpath& path = begin("corners");
    for (int row = 0; row < 3; ++row) {
      std::vector<PagePoint> zigzag;
      for (int k = 0; k <= 26; ++k)
        zigzag.push_back({10 + 3.0 * k, 118 + 6.0 * row + (k % 2 == 0 ? 0.0 : 3.0)});
      add(path, usual, zigzag);
    }
  }
  {
    Toolpath& path = begin("curves");
    for (int row = 0; row < 4; ++row) {
      std::vector<PagePoint> wave;
      // Chords so long that rounding to the machine's units does not turn them.
      for (int k = 0; k <= 80; ++k) {
        const double x = k;
        wave.push_back({10 + x, 138 + 3.0 * row + 1.5 * std::sin(2 * std::numbers::pi * x / 16)});
      }
      add(path, fast, wave);
    }
  }
  {
    Toolpath& path = begin("a mix of all, to check");
    for (int k = 0; k < 12; ++k) {
      const PagePoint at{12 + 6.0 * k, k % 2 == 0 ? 152.0 : 160.0};
      std::vector<PagePoint> ring;
      for (int i = 0; i <= 24; ++i) {
        const double angle = 2 * std::numbers::pi * i / 24;
        ring.push_back({at.x + 2 * std::cos(angle), at.y + 2 * std::sin(angle)});
      }
      add(path, usual, ring);
      add(path, fast, {{at.x - 3, 164}, {at.x + 3, 164}, {at.x + 3, 167}});
    }
  }
  return runs;
}

Result<ForceSteps> force_steps(const Machine& machine, const ToolSettings& tool) {
  const SteppedScale& scale = machine.force_gf;
  if (!(scale.per_step > 0))
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("the force of {} is set on the machine; set it there", machine.title));
  const auto step_of = [&](double gf) {
    return std::clamp(static_cast<int>(std::round(gf / scale.per_step)), scale.min_step,
                      scale.max_step);
  };
  constexpr int kSquares = 8;
  ForceSteps steps;
  int step = step_of(0.5 * tool.force_gf);
  for (int k = 0; k < kSquares; ++k) {
    const int wanted = step_of(tool.force_gf * (0.5 + 1.1 * k / (kSquares - 1)));
    step = k == 0 ? wanted : std::max(wanted, step + 1);
    if (step > scale.max_step) break;
    ToolSettings pressed = tool;
    pressed.force_gf = step * scale.per_step;
    add_square(steps.path, pressed, {10 + 11.0 * k, 10}, kSquareMm);
    steps.force_gf.push_back(pressed.force_gf);
  }
  return steps;
}

Toolpath depth_square(const ToolSettings& tool, int index) {
  Toolpath path;
  add_square(path, tool, {10 + 11.0 * index, 25}, kSquareMm);
  return path;
}

}  // namespace popcut::calibrate
