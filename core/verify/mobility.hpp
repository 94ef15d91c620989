// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/verify/fold_model.hpp"
#include "core/verify/motion.hpp"
#include "core/verify/sheet.hpp"

namespace popcut::verify {

/// Freedoms of the panels on their hinges, to first order, with one panel held.
struct Mobility {
  std::size_t degrees_of_freedom{};
  std::size_t hinges{};          ///< lines about which panels turn
  std::size_t unknowns{};        ///< six a panel, less the one that is held
  double largest_zero{};         ///< largest singular value that counts as zero, 0 for none
  double smallest_nonzero{};     ///< smallest one that does not, 0 for none
  double gap{};                  ///< their ratio; the first one is taken as no less than `noise`
  double noise{};                ///< what rounding in the file can give a singular value
  bool clear{};                  ///< the gap leaves no doubt
  bool counted{true};            ///< false: there are more freedoms than were looked for
  bool sparse{};                 ///< how it was computed
  std::vector<double> smallest;  ///< the smallest singular values, ascending
};

/// Counts freedoms by the rank of the hinge constraints in a pose (ecosystem: shared-edge form).
///
/// Each panel has a twist (angular and linear velocity at the middle of its hinges); each hinge
/// asks that both panels move its middle alike and turn alike across its direction: five equations.
/// Angular velocities are scaled by the panel's own size, so the singular values are pure numbers
/// of order one, whatever the sizes of panels. Their gap tells the rank: dense SVD for a few
/// panels; else a sparse Cholesky factor of J^T J and inverse iteration on a block of vectors,
/// where the singular values are taken from J itself, so that they are not squared.
///
/// @param noise_mm  by how much the pose is off from rigid panels on closed hinges
[[nodiscard]] Mobility mobility(const FoldFile& file, const Sheet& sheet, const PoseMotion& pose,
                                double noise_mm);

}  // namespace popcut::verify
