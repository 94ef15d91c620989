// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/verify/sheet/vec.hpp"

namespace popcut::verify {

/// Corners of a triangle as indices into the points of the sheet, counter-clockwise.
using Triangle = std::array<std::uint32_t, 3>;

/// Cuts a counter-clockwise polygon into triangles by clipping ears and appends them to
/// `triangles`. Vertices of 180 degrees and notches without width are lawful. Ears are found in
/// about O(n) for the long comb-like walls of pop-ups, O(n^2) at worst.
///
/// @return false when the triangles do not make up the polygon's area: it is not simple
[[nodiscard]] bool triangulate(std::span<const Vec2> points, std::span<const std::uint32_t> polygon,
                               std::vector<Triangle>& triangles);

/// Area in mm^2 that two counter-clockwise triangles have in common.
[[nodiscard]] double common_area(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

}  // namespace popcut::verify
