// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangulate.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The rigid faces as triangles: face `f` has the corners `first_corner[f] .. first_corner[f + 1]`
/// and the triangles `first_triangle[f] .. first_triangle[f + 1]`.
struct FaceTriangles {
  std::vector<std::uint32_t> first_corner, first_triangle;
  std::vector<Vec3> corner;        ///< places of the flat sheet, counter-clockwise around each face
  std::vector<Triangle> triangle;  ///< counter-clockwise, indices of corners

  [[nodiscard]] std::size_t faces() const { return first_corner.size() - 1; }
};

/// Cuts every face into triangles (core/geometry/triangulate.hpp): as many as it has corners that
/// turn, less two, joined without cracks.
///
/// @retval OutOfRange  a face is not a simple polygon with an area; `place` is "faces/N"
[[nodiscard]] Result<FaceTriangles> triangulate_faces(const Pattern& pattern);

}  // namespace popcut
