// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <compare>
#include <span>

namespace popcut {

/// A point of a page in mm: x to the right (the carriage), y down (the feed), origin top left.
struct PagePoint {
  double x{};
  double y{};
  friend constexpr auto operator<=>(const PagePoint&, const PagePoint&) = default;
};

/// An axis-parallel box in page mm; `empty()` until a point was added.
struct Box {
  double x0{1e300}, y0{1e300}, x1{-1e300}, y1{-1e300};
  [[nodiscard]] bool empty() const { return x0 > x1; }
  [[nodiscard]] double width() const { return x1 - x0; }
  [[nodiscard]] double height() const { return y1 - y0; }
  void add(const PagePoint& p);
};

/// Distance of two points, mm.
[[nodiscard]] inline double distance(const PagePoint& a, const PagePoint& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);  // coordinates are bounded, so this cannot overflow
}
/// The point at share `t` of the way from a to b.
[[nodiscard]] constexpr PagePoint lerp(const PagePoint& a, const PagePoint& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}
/// The same within the way: from 0 down a itself, from 1 on b itself.
[[nodiscard]] constexpr PagePoint between(const PagePoint& a, const PagePoint& b, double t) {
  return t <= 0.0 ? a : t >= 1.0 ? b : lerp(a, b, t);
}
/// Twice the area that a closed polyline goes round: positive if it goes clockwise on a page, whose
/// y points down.
[[nodiscard]] double twice_area(std::span<const PagePoint> ring);
/// The bounding box of points.
[[nodiscard]] Box bounds(std::span<const PagePoint> points);
/// Length of an open polyline, mm.
[[nodiscard]] double length(std::span<const PagePoint> line);
/// Whether its last point equals its first.
[[nodiscard]] bool closed(std::span<const PagePoint> line);

}  // namespace popcut
