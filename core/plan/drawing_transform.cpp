// SPDX-License-Identifier: MIT
#include "core/plan/drawing_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

/// Sine and cosine; exact for whole quarter turns, so that a turned square stays square.
std::pair<double, double> sin_cos(double turn_deg) {
  const double quarters = turn_deg / 90;
  if (quarters == std::round(quarters)) {
    const auto turn = static_cast<std::size_t>((std::llround(quarters) % 4 + 4) % 4);
    constexpr std::array<double, 4> kSin{0, 1, 0, -1}, kCos{1, 0, -1, 0};
    return {kSin[turn], kCos[turn]};
  }
  const double turn_rad = radians(turn_deg);
  return {std::sin(turn_rad), std::cos(turn_rad)};
}

}  // namespace

Placement drawing_transform(const LineWork& drawing, const PlanOptions& options) {
  const auto [sine, cosine] = sin_cos(options.rotate_deg);
  const double flip = options.mirror ? -1 : 1;
  Placement map{cosine * flip, -sine, 0, sine * flip, cosine, 0};
  double scale = options.scale;
  if (options.width_mm) {
    const double width = bounds(placed(drawing, map)).width();
    if (width > 0) scale = *options.width_mm / width;
  }
  for (double* entry : {&map.xx, &map.xy, &map.yx, &map.yy}) *entry *= scale;
  return map;
}

bool is_identity(const Placement& map) {
  return map.xx == 1 && map.xy == 0 && map.x0 == 0 && map.yx == 0 && map.yy == 1 && map.y0 == 0;
}

LineWork transformed(LineWork drawing, const Placement& map) {
  if (is_identity(map)) return drawing;
  const bool mirrored = map.xx * map.yy - map.xy * map.yx < 0;
  LineWork out = placed(std::move(drawing), map);
  out.has_page = false;
  if (!mirrored) return out;
  for (DrawnLine& line : out.lines) {
    if (line.operation == Operation::FoldMountain)
      line.operation = Operation::FoldValley;
    else if (line.operation == Operation::FoldValley)
      line.operation = Operation::FoldMountain;
  }
  return out;
}

Result<std::vector<PagePoint>> copies_at(const LineWork& drawing, int count,
                                         std::array<double, 2> reach_mm, double gap_mm) {
  if (count <= 1) return std::vector<PagePoint>{};
  const Box box = bounds(drawing);
  const double across = box.width() + gap_mm, along = box.height() + gap_mm;
  constexpr double kSlackMm = 1e-6;
  const auto fit = [&](double room, double cell) {
    return static_cast<int>(std::clamp((room + gap_mm + kSlackMm) / cell, 0.0, 100'000.0));
  };
  const int in_row = fit(reach_mm[0], across), rows = fit(reach_mm[1], along);
  const std::int64_t most = std::int64_t{in_row} * rows;
  const std::int64_t turned = std::int64_t{fit(reach_mm[0], along)} * fit(reach_mm[1], across);
  const std::string more =
      turned > most ? fmt::format(" (or {} if you `rotate` it by 90)", turned) : "";
  if (count > most)
    return fail(ErrorKind::Infeasible, "/options/per-sheet",
                fmt::format("is {}, but of {:.1f} x {:.1f} mm with {:g} mm between them {} fit on "
                            "{:g} x {:g} mm; {}",
                            count, box.width(), box.height(), gap_mm,
                            most == 0 ? "none" : std::to_string(most), reach_mm[0], reach_mm[1],
                            most > 1 ? fmt::format("use at most {}{}", most, more)
                                     : fmt::format("leave it out, or use `scale`{}", more)));
  std::vector<PagePoint> places;
  places.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) places.push_back({across * (k % in_row), along * (k / in_row)});
  return places;
}

LineWork copied(LineWork drawing, std::span<const PagePoint> places) {
  if (places.empty()) return drawing;
  LineWork out = drawing.without_lines();
  out.has_page = false;
  out.points.reserve(drawing.points.size() * places.size());
  out.lines.reserve(drawing.lines.size() * places.size());
  std::vector<PagePoint> moved;
  for (const PagePoint& place : places)
    for (const DrawnLine& line : drawing.lines) {
      moved.clear();
      for (const PagePoint& p : drawing.points_of(line))
        moved.push_back({p.x + place.x, p.y + place.y});
      out.append(line.operation, moved);
    }
  return out;
}

LineWork with_weed_box(LineWork drawing, double mm) {
  const Box box = bounds(drawing);
  if (!(mm > 0) || box.empty()) return drawing;
  const double x0 = box.x0 - mm, y0 = box.y0 - mm, x1 = box.x1 + mm, y1 = box.y1 + mm;
  drawing.append(Operation::Outline,
                 std::array<PagePoint, 5>{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}});
  return drawing;
}

double reading_tolerance_mm(const PlanOptions& options) {
  return options.curve_tolerance_mm / std::max(options.scale, 1.0);
}

}  // namespace popcut
