// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Freedoms of the panels on their hinges, to first order, with one panel held.
struct Mobility {
  std::size_t degrees_of_freedom{};
  std::size_t hinges{};  ///< lines about which panels turn
  std::size_t unknowns{};
  double largest_zero{};         ///< largest singular value that counts as zero, 0 for none
  double smallest_nonzero{};     ///< smallest one that does not, 0 for none
  double gap{};                  ///< their ratio; the first one is taken as no less than `noise`
  double noise{};                ///< what rounding in the file can give a singular value
  bool clear{};                  ///< the gap leaves no doubt
  bool counted{true};            ///< false: there are more freedoms than were looked for
  bool sparse{};                 ///< how it was computed
  std::vector<double> smallest;  ///< the smallest singular values, ascending
};

/// What the unknowns are. Both forms count the same freedoms.
enum class MobilityForm {
  Loops,   ///< a speed a hinge line, six equations a loop of panels; panels where loops fail
  Panels,  ///< six a panel, five equations a hinge line
};

/// Counts freedoms by the rank of the closure constraints in a pose.
///
/// Unknowns are the speeds of the fold angles, one a hinge line. Around each vertex inside the
/// sheet, each slit and each hole, the panels must come back to where they began: angular
/// velocities about the crossed hinges add up to nothing, and so do their moments about the loop's
/// middle, scaled by the loop's size: the singular values are pure numbers. Their gap tells the
/// rank: dense SVD for a few hinges; else a sparse Cholesky factor of J^T J and inverse iteration
/// on a block of vectors, where the singular values are taken from J itself, so that they are not
/// squared.
///
/// Where a sheet is too unsound for loops (`loops_of`), or on demand, each panel has a twist
/// (angular and linear velocity at the middle of its hinges, scaled by its size) and each hinge
/// asks that both panels move its middle alike and turn alike across its direction: six times as
/// many unknowns.
///
/// @param noise_mm  by how much the pose is off from rigid panels on closed hinges
[[nodiscard]] Mobility mobility(const FoldModel& file, const Sheet& sheet, const PoseMotion& pose,
                                double noise_mm, MobilityForm form = MobilityForm::Loops);

}  // namespace popcut::verify
