// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/fit/triangle_soup.hpp"
#include "core/geometry/vec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Closed lines in a plane, mm; the last point of each is joined to the first.
using FlatRings = std::vector<std::vector<Vec2>>;

/// The two coordinates that a plane across an axis leaves: (y, z), (x, z) or (x, y).
[[nodiscard]] Vec2 in_plane(const Vec3& p, int axis);

/// What planes cut out of a mesh.
struct PlaneSections {
  std::vector<FlatRings> planes;  ///< one a plane
  std::size_t gaps{};             ///< of the mesh, which straight lines close
  double gaps_mm{};               ///< their length together
};

/// The lines in which planes meet a closed mesh, one set a plane. All of a plane's lines run the
/// same way around the inside, so that what winds around is inside. A corner that lies in a plane
/// counts as above it, which leaves no special cases. Points are within rounding of the mesh.
/// O(triangles log planes + n log n) for n crossed triangles.
///
/// Where the mesh is open, the nearest ends are joined by straight lines.
///
/// @param axis       0, 1 or 2: planes are those where this coordinate is `at_mm`
/// @param at_mm      ascending
/// @param most_open  share of the lines' length that may be such straight lines
/// @retval Infeasible  the mesh has no inside: more of it is open
[[nodiscard]] Result<PlaneSections> plane_sections(const TriangleSoup& mesh, int axis,
                                                   std::span<const double> at_mm, double most_open);

}  // namespace popcut
