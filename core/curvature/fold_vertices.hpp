// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/curvature/vertex_curvature.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The V-fold on a valley crease (docs/geometry.md, section 7): apex O, centre fold OA of length
/// `w_mm` along the crease, in the direction of `sign` along v.
struct CreaseVFold {
  double apex_v_mm{};
  double w_mm{};
  double alpha{};
  double sign{1.0};
};

/// A fold vertex: the middle of a connector's valley fold, or the tip A of the V-fold on it.
struct FoldVertex {
  std::int32_t i{};  ///< level along the strip, 0 for the first one of the lattice
  std::int32_t j{};  ///< connector, counted along the sheet from 0
  /// Of the valley's middle in the designed pose, mm; on a splayed lattice v of a plain crease is
  /// where a tip would lie flat.
  double x{}, v{}, z{};
  std::optional<CreaseVFold> v_fold;
  double u_mm{}, v0_mm{}, v1_mm{};  ///< the whole fold on the flat sheet, from v0 to v1
  std::array<std::int32_t, 4> ring{-1, -1, -1, -1};  ///< (i+1,j) (i,j+1) (i-1,j) (i,j-1), -1: none

  [[nodiscard]] bool inner() const {
    return ring[0] >= 0 && ring[1] >= 0 && ring[2] >= 0 && ring[3] >= 0;
  }
  /// Where the vertex is at the opening angle `psi_rad`, as (x, v, z).
  [[nodiscard]] Point3 posed(double psi_rad) const;
};

/// Finds the fold vertices of a lattice in a FOLD file, from its flat frame and its mountains and
/// valleys alone, without the deployed frames.
///
/// Each strip's folds, sorted along u, alternate and give its staircase: level after a valley,
/// upright after a mountain. A connector is a strip whose mountains run on, some only into the
/// strip to its left, some only into the one to its right (a slice's mountains run on into both);
/// the connectors at both ends of a mountain have the same two panels there, which tells their
/// levels apart and places them on one another. So levels that end at wall or ground, and plain
/// cuts, are no difficulty. Without a card a strip's end counts as the valley that it would have
/// there. Wall and ground are where x and z are least.
///
/// @return the vertices by connector and level
/// @retval Malformed, OutOfRange  the file cannot be read as FOLD, or no frame of it lies flat
/// @retval Infeasible  it has no connectors, or their panels do not close as rectangles must
[[nodiscard]] Result<std::vector<FoldVertex>> fold_vertices_from_fold(std::string_view text);

/// The same from the folds and cuts of a pattern, which lie on its sheet as in its FOLD file.
[[nodiscard]] Result<std::vector<FoldVertex>> fold_vertices(const Pattern& pattern);

}  // namespace popcut
