// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/deploy/rigid.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The rigid faces as triangles: face `f` has the corners `first_corner[f] .. first_corner[f + 1]`
/// and the triangles `first_triangle[f] .. first_triangle[f + 1]`.
struct FaceTriangles {
  std::vector<std::uint32_t> first_corner, first_triangle;
  std::vector<Vec3> corner;  ///< places of the flat sheet, counter-clockwise around each face
  std::vector<std::array<std::uint32_t, 3>> triangle;  ///< counter-clockwise, indices of corners

  [[nodiscard]] std::size_t faces() const { return first_corner.size() - 1; }
};

/// Cuts every face into triangles by clipping ears, one fewer than corners less one each. Corners
/// of 180 degrees and notches without width are left out first. No corner ever lies within the side
/// of a triangle, so that the triangles of a face are joined without cracks. About O(n) for the
/// long combs that the walls of pop-ups are, O(n^2) at worst.
///
/// @retval OutOfRange  a face is not a simple polygon with an area; `place` is "faces/N"
[[nodiscard]] Result<FaceTriangles> triangulate_faces(const Pattern& pattern);

}  // namespace popcut
