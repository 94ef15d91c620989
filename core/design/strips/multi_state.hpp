// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/spec/spec.hpp"
#include "core/design/strips/strips.hpp"
#include "core/result.hpp"

namespace popcut {

/// The splays that make one fold vertex's surface take given Gaussian curvatures as the card opens,
/// and the curvature they reach.
struct MultiState {
  SplaySpec splay;            ///< the targets replaced by an alpha for every crease
  std::vector<double> K_rad;  ///< angle defect at each target's psi
};

/// Angle defect K at inner vertex (`level`, `connector`) of a lattice with V-folds at `psi_rad`,
/// over the ring (level + 1, connector), (level, connector + 1), (level - 1, ...), (..., connector
/// - 1). Where a crease has no V-fold its vertex is the point where one of that length would have
/// its tip.
[[nodiscard]] double splayed_curvature(const Strips& strips, const SplaySpec& splay, int level,
                                       int connector, double psi_rad);

/// Finds alphas for the middle vertex of the lattice and its four neighbours (the two along the
/// crease alike, the two across alike) by NLopt's SLSQP from several starts: smallest sum of
/// squares subject to the targets and to what fits the panels (main text, "Multi-state structures";
/// docs/geometry.md, section 7). All other creases stay plain.
///
/// @retval OutOfRange  the lattice has fewer than three inner levels or three connectors
/// @retval Infeasible  no alphas that fit reach the targets; the detail says how near they come
[[nodiscard]] Result<MultiState> solve_multi_state(const Strips& strips, const SplaySpec& splay);

}  // namespace popcut
