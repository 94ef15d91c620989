// SPDX-License-Identifier: MIT
#include "core/geometry/line_bins.hpp"

#include <numbers>

namespace popcut {

LineBins::LineBins(const PagePoint& middle, double reach, double usual_mm, double tolerance)
    : middle_(middle),
      bin_mm_(tolerance + kRadians * reach),
      along_mm_(std::max(2.0 * usual_mm, 0.02 * reach)),
      near_(static_cast<float>(tolerance + 0.001 + 2e-6 * reach)),
      slack_(static_cast<float>(0.01 + 2e-5 * reach)),
      drift_(static_cast<float>(kRadians * reach) + slack_) {}

LongLine LineBins::line_of(const Segment& s) const {
  double angle = std::atan2(s.b.y - s.a.y, s.b.x - s.a.x);
  if (angle < 0.0) angle += std::numbers::pi;
  if (angle >= std::numbers::pi) angle -= std::numbers::pi;
  const double ux = std::cos(angle), uy = std::sin(angle);
  const auto along = [&](const PagePoint& p) {
    return (p.x - middle_.x) * ux + (p.y - middle_.y) * uy;
  };
  const PagePoint half{(s.a.x + s.b.x) / 2 - middle_.x, (s.a.y + s.b.y) / 2 - middle_.y};
  const auto [from, to] = std::minmax({along(s.a), along(s.b)});
  return {static_cast<float>(angle), static_cast<float>(ux * half.y - uy * half.x),
          static_cast<float>(from), static_cast<float>(to)};
}

}  // namespace popcut
