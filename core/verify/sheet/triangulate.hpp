// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/vec.hpp"

namespace popcut::verify {

/// Corners of a triangle, counter-clockwise, as indices into the points of the sheet.
using Triangle = std::array<std::uint32_t, 3>;

/// Cuts a counter-clockwise polygon into triangles by clipping ears and appends them to
/// `triangles`. Vertices of 180 degrees and zero-width notches are valid. Takes about O(n) for the
/// long comb-like walls of pop-ups, O(n^2) at worst.
///
/// @return false if the triangles do not add up to the polygon's area: then it is not simple
[[nodiscard]] bool triangulate(std::span<const Vec2> points, std::span<const std::uint32_t> polygon,
                               std::vector<Triangle>& triangles);

/// Area in mm^2 that two counter-clockwise triangles share.
[[nodiscard]] double common_area(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

}  // namespace popcut::verify
