// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/fit/triangle_soup.hpp"
#include "core/geometry/vec.hpp"
#include "core/picture/slabs.hpp"

namespace popcut {

/// A flat piece of a target's outside.
struct GhostPolygon {
  std::vector<Vec3> corners;  ///< (x, v, z), mm
  double light{};             ///< cosine of the angle between its normal and the lamp, from 0
};

/// What of a target lies in a slab: within its staircase, which hides it from an eye that does not
/// look through the slab's open side, and before it.
struct GhostSlab {
  std::vector<GhostPolygon> inside, outside;
};

/// The side of a target that `eye` sees, where it lies in the corner x >= 0, z >= 0, cut at the
/// slabs' borders and at their staircases: painted within each slab between holes and panels
/// (`inside`) and after them (`outside`), it is hidden just where paper is before it.
///
/// @param target  its triangles at their places along the sheet; coarsened to at most about
///                `most_triangles`
/// @param eye     the direction to the eye, `lamp` to the lamp, unit length
/// @return one a slab, and before them what lies before the first slab, after them what lies beyond
///         the last
[[nodiscard]] std::vector<GhostSlab> ghost_slabs(const TriangleSoup& target,
                                                 std::span<const Slab> slabs, const Vec3& eye,
                                                 const Vec3& lamp, std::size_t most_triangles);

/// A target of few triangles: corners that fall in one cell of a grid become one (Rossignac and
/// Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993), the finest grid
/// that leaves at most `most_triangles`. Normals are those of the target itself, averaged over each
/// cell's triangles, so that it is shaded as smoothly as before.
struct CoarseTarget {
  std::vector<std::array<Vec3, 3>> corners;
  std::vector<Vec3> normal;  ///< outward, unit length
};
[[nodiscard]] CoarseTarget coarse_target(const TriangleSoup& target, std::size_t most_triangles);

}  // namespace popcut
