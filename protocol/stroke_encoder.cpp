// SPDX-License-Identifier: MIT
#include "protocol/stroke_encoder.hpp"

#include <array>
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

StrokeEncoder::StrokeEncoder(const Toolpath& toolpath, const Machine& machine, const PageMap& map,
                             std::optional<double> feed_out_mm, int per_unit,
                             std::size_t bytes_per_point)
    : toolpath_(toolpath),
      machine_(machine),
      map_(map),
      feed_out_mm_(feed_out_mm),
      per_unit_(per_unit),
      bytes_per_point_(bytes_per_point) {}

Result<EncodedProgram> StrokeEncoder::run() {
  const std::string& bytes = program_.bytes;
  program_.dialect = map_.dialect;
  program_.strokes.reserve(toolpath_.strokes.size());
  program_.bytes.reserve(toolpath_.points.size() * bytes_per_point_ + 256);
  if (Result<void> done = check_job(); !done) return tl::unexpected(done.error());
  StrokeSteps first;
  if (!toolpath_.strokes.empty()) {
    const Result<StrokeSteps> steps = steps_of(0);
    if (!steps) return tl::unexpected(steps.error());
    first = *steps;
  }
  write_setup(first);
  const std::uint64_t search = bytes.size();
  write_search();
  if (bytes.size() > search) program_.search = {search, bytes.size()};
  program_.geometry.begin = bytes.size();
  for (std::size_t k = 0; k < toolpath_.strokes.size(); ++k) {
    const std::uint64_t begin = bytes.size();
    if (Result<void> done = write_stroke(k); !done) return tl::unexpected(done.error());
    program_.strokes.push_back({begin, bytes.size()});
  }
  program_.geometry.end = bytes.size();
  write_trailer();
  program_.trailer = {program_.geometry.end, bytes.size()};
  if (feed_out_mm_) {
    const std::int64_t feed =
        farthest_feed_ + std::llround(*feed_out_mm_ / map_.feed_unit_mm * per_unit_);
    write_feed_out(map_.feed_first ? GridPoint{feed, 0} : GridPoint{0, feed});
    program_.feed_out = {program_.trailer.end, bytes.size()};
  }
  return std::move(program_);
}

/// Steps for the stroke's force and speed; errors name what the machine takes.
Result<StrokeSteps> StrokeEncoder::steps_of(std::size_t index) const {
  const Stroke& stroke = toolpath_.strokes[index];
  const Machine& machine = machine_;
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

/// Puts the stroke's points on the grid, in `line_`.
Result<void> StrokeEncoder::put_on_grid(std::size_t index) {
  line_.clear();
  const Stroke& stroke = toolpath_.strokes[index];
  const std::uint64_t end = std::uint64_t{stroke.first} + stroke.count;
  if (end > toolpath_.points.size())
    return fail(ErrorKind::Internal, stroke_place(index),
                fmt::format("points {} to {} of a toolpath that has {}", stroke.first, end,
                            toolpath_.points.size()));
  for (const PagePoint& page : toolpath_.points_of(stroke)) {
    const MachinePoint exact = map_.to_machine(page);
    const double a = std::round(exact.a * per_unit_);
    const double b = std::round(exact.b * per_unit_);
    if (!(std::abs(a) <= kFarthest && std::abs(b) <= kFarthest))
      return fail(ErrorKind::OutOfRange, stroke_place(index),
                  fmt::format("a point at ({}, {}) mm; it must lie on the page", page.x, page.y));
    const GridPoint point{static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)};
    if (line_.empty() || line_.back() != point) line_.push_back(point);
    farthest_feed_ = std::max(farthest_feed_, map_.feed_first ? point.a : point.b);
  }
  return {};
}

Result<void> StrokeEncoder::write_stroke(std::size_t index) {
  const Result<StrokeSteps> steps = steps_of(index);
  if (!steps) return tl::unexpected(steps.error());
  if (Result<void> done = put_on_grid(index); !done) return done;
  if (line_.size() < 2) {
    program_.dots.push_back(static_cast<std::uint32_t>(index));
    return {};
  }
  if (Result<void> done = check_line(index); !done) return done;
  write_changes(*steps);
  write_line();
  return {};
}

void StrokeEncoder::append_point(GridPoint point) {
  append_number(program_.bytes, point.a, per_unit_);
  program_.bytes += ',';
  append_number(program_.bytes, point.b, per_unit_);
}

void append_number(std::string& text, std::int64_t value, int per_unit) {
  std::array<char, 24> digits;
  if (value < 0) text += '-';
  const std::int64_t size = value < 0 ? -value : value;
  const auto whole = std::to_chars(digits.data(), digits.data() + digits.size(), size / per_unit);
  text.append(digits.data(), whole.ptr);
  const std::int64_t rest = size % per_unit;
  if (rest == 0) return;
  const std::int64_t hundredths = rest * 100 / per_unit;
  text += '.';
  text += static_cast<char>('0' + hundredths / 10);
  text += static_cast<char>('0' + hundredths % 10);
}

}  // namespace popcut
