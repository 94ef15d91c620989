// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/vec.hpp"

namespace popcut {

/// Corners of a triangle as indices of points, counter-clockwise.
using Triangle = std::array<std::uint32_t, 3>;

/// Twice the area of a polygon, negative where it runs clockwise.
[[nodiscard]] double twice_area(std::span<const Vec2> points,
                                std::span<const std::uint32_t> polygon);

/// The corners of a polygon without those that do not turn: along sides, and the tips of notches
/// without width.
[[nodiscard]] std::vector<std::uint32_t> turning_corners(std::span<const Vec2> points,
                                                         std::span<const std::uint32_t> polygon);

/// Cuts a counter-clockwise polygon into triangles by clipping ears and appends them to
/// `triangles`: two fewer than `turning_corners`, which are left out first. No corner ever lies
/// within the side of a triangle unless there is no other way. About O(n) for the long combs that
/// the walls of pop-ups are and for round shapes, O(n^2) at worst.
///
/// @return false when the triangles do not make up the polygon's area: it is not simple
[[nodiscard]] bool triangulate(std::span<const Vec2> points, std::span<const std::uint32_t> polygon,
                               std::vector<Triangle>& triangles);

/// Area in mm^2 that two counter-clockwise triangles have in common.
[[nodiscard]] double common_area(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

}  // namespace popcut
