// SPDX-License-Identifier: MIT
#include "core/plan/drawing_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace popcut {
namespace {

/// Sine and cosine; exact for whole quarter turns, so that a turned square stays square.
std::pair<double, double> sin_cos(double degrees) {
  const double quarters = degrees / 90;
  if (quarters == std::round(quarters)) {
    const int turn = static_cast<int>(std::lround(quarters) % 4 + 4) % 4;
    constexpr double kSin[] = {0, 1, 0, -1};
    constexpr double kCos[] = {1, 0, -1, 0};
    return {kSin[turn], kCos[turn]};
  }
  const double radians = degrees * std::numbers::pi / 180;
  return {std::sin(radians), std::cos(radians)};
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

double reading_tolerance_mm(const PlanOptions& options) {
  return options.curve_tolerance_mm / (options.width_mm ? 10.0 : std::max(options.scale, 1.0));
}

}  // namespace popcut
