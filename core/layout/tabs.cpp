// SPDX-License-Identifier: MIT
#include "core/layout/tabs.hpp"

#include <algorithm>
#include <cmath>

#include "core/layout/line_index.hpp"

namespace popcut {
namespace {

constexpr double kLeastTop = 1.0;  // mm; a tab with a narrower top becomes a triangle

// Whether a line perpendicular to an edge of `a` separates `a` from `b` by at least `gap`.
bool parted(const Tab& a, const Tab& b, double gap) {
  for (std::size_t i = 0; i < 4; ++i) {
    const PagePoint& p = a.corners[i];
    const PagePoint& q = a.corners[(i + 1) % 4];
    const double nx = q.y - p.y, ny = p.x - q.x, l = std::hypot(nx, ny);
    if (l == 0.0) continue;
    double a0 = 1e300, a1 = -1e300, b0 = 1e300, b1 = -1e300;
    for (std::size_t k = 0; k < 4; ++k) {
      const double u = (nx * a.corners[k].x + ny * a.corners[k].y) / l;
      const double w = (nx * b.corners[k].x + ny * b.corners[k].y) / l;
      a0 = std::min(a0, u);
      a1 = std::max(a1, u);
      b0 = std::min(b0, w);
      b1 = std::max(b1, w);
    }
    if (b0 >= a1 + gap || a0 >= b1 + gap) return true;
  }
  return false;
}

}  // namespace

bool TabFitter::fit_one(const AxisLine& line, double from, double to, int side, Tab& tab) {
  const double a = from + shape_.clearance_mm, b = to - shape_.clearance_mm;
  const double root = b - a;
  if (root < shape_.min_root_mm) return false;
  const double slope = std::tan(shape_.side_rad);
  const double room = lines_.free_depth(line, a, b, side, shape_.depth_mm + shape_.clearance_mm) -
                      shape_.clearance_mm;
  double depth = std::min(shape_.depth_mm, room);
  if (depth < shape_.min_depth_mm) return false;
  double inset = depth / slope;
  if (root < 2 * inset + kLeastTop) {
    const double lower = (root - kLeastTop) / 2 * slope;
    if (lower >= shape_.min_depth_mm) {
      depth = lower;
      inset = depth / slope;
    } else {
      inset = root / 2;
      depth = std::min(depth, std::max(inset * slope, shape_.min_depth_mm));
    }
  }
  tab.corners = {line.point(a, 0), line.point(a + inset, side * depth),
                 line.point(b - inset, side * depth), line.point(b, 0)};
  tab.depth_mm = depth;
  return true;
}

double TabFitter::fit(const AxisLine& line, const SeamStretch& stretch, int side,
                      std::vector<Tab>& out) {
  const std::size_t before = out.size();
  const double length = stretch.to - stretch.from;
  const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(length / shape_.pitch_mm)));
  double least = shape_.depth_mm;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](std::size_t k) {
      return stretch.from + length * static_cast<double>(k) / static_cast<double>(count);
    };
    Tab tab;
    if (!fit_one(line, at(i), at(i + 1), side, tab)) {
      out.resize(before);
      return 0.0;
    }
    least = std::min(least, tab.depth_mm);
    out.push_back(tab);
  }
  return least;
}

bool tabs_meet(const Tab& a, const Tab& b, double clearance_mm) {
  return !parted(a, b, clearance_mm) && !parted(b, a, clearance_mm);
}

}  // namespace popcut
