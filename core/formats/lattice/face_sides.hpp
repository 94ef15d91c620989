// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/formats/lattice/lattice_blob.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The faces of a pattern as triangles, with what is drawn along their sides.
struct SidedTriangles {
  std::vector<Triangle> corners;    ///< vertices of the pattern, counter-clockwise in (u, v)
  std::vector<std::uint32_t> face;  ///< one a triangle
  std::vector<std::array<SideRole, 3>> sides;  ///< from corner k to corner k + 1
};

/// The role of an edge as a side of its faces: one that is no fold and has a face on either side is
/// inside.
[[nodiscard]] SideRole side_role(const PatternEdge& edge);

/// The roles of the sides of all faces, in the order of `face_vertices`: entry k is the side from
/// that corner to the next one of its face. Sides that no edge of the pattern covers are inside.
[[nodiscard]] std::vector<SideRole> roles_of_sides(const Pattern& pattern);

/// At most as many triangles as `sided_triangles` makes.
[[nodiscard]] std::size_t most_triangles(const Pattern& pattern);

/// Cuts each face into triangles (core/geometry/triangulate.hpp). Corners that do not turn are left
/// out unless the role of the side changes there. A slit without width that ends within a face is
/// no side of any triangle. O(corners) for the faces of pop-ups.
///
/// @retval OutOfRange  a face is not a simple polygon with an area; `place` is "faces/N"
[[nodiscard]] Result<SidedTriangles> sided_triangles(const Pattern& pattern);

}  // namespace popcut
