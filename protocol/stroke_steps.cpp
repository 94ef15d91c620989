// SPDX-License-Identifier: MIT
#include "protocol/stroke_steps.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kFarthest = 1 << 30;

Result<std::optional<std::int64_t>> steps(double value, const SteppedScale& scale,
                                          std::string_view what, std::string_view unit,
                                          std::size_t index, const Machine& machine) {
  if (!(scale.per_step > 0)) return std::nullopt;
  const double nearest = std::round(value / scale.per_step);
  if (nearest >= scale.min_step && nearest <= scale.max_step)
    return static_cast<std::int64_t>(nearest);
  return fail(ErrorKind::OutOfRange, stroke_place(index),
              fmt::format("a {} of {} {}; {} takes {} to {} {} in steps of {}", what, value, unit,
                          machine.name, scale.min_step * scale.per_step,
                          scale.max_step * scale.per_step, unit, scale.per_step));
}

}  // namespace

std::string stroke_place(std::size_t index) { return fmt::format("/strokes/{}", index); }

Result<StrokeSteps> steps_of(const Stroke& stroke, std::size_t index, const Machine& machine) {
  if (stroke.tool < 1 || stroke.tool > machine.tool_holders)
    return fail(ErrorKind::OutOfRange, stroke_place(index),
                fmt::format("tool holder {}; {} has {}, counted from 1", stroke.tool, machine.name,
                            machine.tool_holders));
  const auto force = steps(stroke.force_gf, machine.force_gf, "force", "gf", index, machine);
  if (!force) return tl::unexpected(force.error());
  const auto speed = steps(stroke.speed_mm_s, machine.speed_mm_s, "speed", "mm/s", index, machine);
  if (!speed) return tl::unexpected(speed.error());
  return StrokeSteps{stroke.tool, *force, *speed};
}

Result<void> put_on_grid(const Toolpath& toolpath, std::size_t index, const PageMap& map,
                         int per_unit, std::vector<GridPoint>& line) {
  line.clear();
  const Stroke& stroke = toolpath.strokes[index];
  const std::uint64_t end = std::uint64_t{stroke.first} + stroke.count;
  if (end > toolpath.points.size())
    return fail(ErrorKind::Internal, stroke_place(index),
                fmt::format("points {} to {} of a toolpath that has {}", stroke.first, end,
                            toolpath.points.size()));
  for (const PagePoint& page : toolpath.points_of(stroke)) {
    const MachinePoint exact = map.to_machine(page);
    const double a = std::round(exact.a * per_unit);
    const double b = std::round(exact.b * per_unit);
    if (!(std::abs(a) <= kFarthest && std::abs(b) <= kFarthest))
      return fail(ErrorKind::OutOfRange, stroke_place(index),
                  fmt::format("a point at ({}, {}) mm; it must lie on the page", page.x, page.y));
    const GridPoint point{static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)};
    if (line.empty() || line.back() != point) line.push_back(point);
  }
  return {};
}

std::vector<ToolKind> holders_of(const Toolpath& toolpath, const JobOptions& options) {
  std::uint8_t highest = 1;
  for (const Stroke& stroke : toolpath.strokes) highest = std::max(highest, stroke.tool);
  std::vector<bool> used(highest + 1U), cuts(highest + 1U);
  for (const Stroke& stroke : toolpath.strokes) {
    used[stroke.tool] = true;
    if (stroke.operation != Operation::Draw) cuts[stroke.tool] = true;
  }
  std::vector<ToolKind> kinds = options.holders;
  for (std::size_t tool = kinds.size() + 1; tool <= highest; ++tool)
    kinds.push_back(used[tool] && !cuts[tool] ? ToolKind::Pen : ToolKind::Blade);
  return kinds;
}

void append_number(std::string& text, std::int64_t value, int per_unit) {
  char digits[24];
  if (value < 0) text += '-';
  const std::int64_t size = value < 0 ? -value : value;
  const auto whole = std::to_chars(std::begin(digits), std::end(digits), size / per_unit);
  text.append(std::begin(digits), whole.ptr);
  const std::int64_t rest = size % per_unit;
  if (rest == 0) return;
  const std::int64_t hundredths = rest * 100 / per_unit;
  text += '.';
  text += static_cast<char>('0' + hundredths / 10);
  text += static_cast<char>('0' + hundredths % 10);
}

}  // namespace popcut
