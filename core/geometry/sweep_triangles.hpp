// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/triangulate.hpp"

namespace popcut {

/// A place on a grid of whole numbers, at most 2^29 from 0 each way: turns are exact.
struct WholePoint {
  std::int64_t x{}, y{};
  friend bool operator==(const WholePoint&, const WholePoint&) = default;
};

/// Cuts what closed lines enclose, holes and all, into triangles by a sweep from left to right
/// (Hertel and Mehlhorn, Fast Triangulation of the Plane with Respect to Simple Polygons, 1985).
/// A place is inside if an odd number of lines is around it. Lines may touch each other and
/// themselves, in points and along their sides. O(n log n).
///
/// @param points  of all lines, one line after another
/// @param ends    where each line ends in `points`, one past its last; the last point is joined to
///                the first
/// @return triangles of `points`, counter-clockwise; none if two sides cross each other
[[nodiscard]] std::optional<std::vector<Triangle>> sweep_triangles(
    std::span<const WholePoint> points, std::span<const std::uint32_t> ends);

}  // namespace popcut
