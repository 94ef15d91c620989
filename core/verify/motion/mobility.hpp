// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Degrees of freedom of the panels on their hinges, to first order, with one panel held.
struct Mobility {
  std::size_t degrees_of_freedom{};
  std::size_t hinges{};  ///< lines about which panels turn
  std::size_t unknowns{};
  double largest_zero{};      ///< largest singular value that counts as zero; 0: none
  double smallest_nonzero{};  ///< smallest singular value that does not; 0: none
  double gap{};               ///< their ratio, with the first one at least `noise`
  double noise{};             ///< singular value that rounding in the file can cause
  bool clear{};               ///< whether the gap is wide enough to be sure
  bool counted{true};         ///< false: there are more degrees of freedom than the search covers
  bool sparse{};              ///< computed by the sparse method
  std::vector<double> smallest;  ///< the smallest singular values, ascending
};

/// The unknowns of the computation. Both forms give the same count.
enum class MobilityForm {
  Loops,   ///< one speed per hinge line, six equations per loop; `Panels` if loops fail
  Panels,  ///< six unknowns per panel, five equations per hinge line
};

/// Counts degrees of freedom by the rank of the closure constraints in a pose.
///
/// The unknowns are the speeds of the fold angles, one per hinge line. Around each vertex inside
/// the sheet, each slit and each hole, the panels must return to where they began: the angular
/// velocities about the crossed hinges sum to zero, and so do their moments about the loop's
/// middle. Moments are scaled by the loop's size, so the singular values are pure numbers. The gap
/// between them gives the rank. A dense SVD serves for a few hinges. Larger sheets use a sparse
/// Cholesky factor of J^T J and inverse iteration on a block of vectors; the singular values are
/// taken from J itself, so that they are not squared.
///
/// If a sheet has no valid loops (`loops_of`), or on request, the unknowns are a twist per panel
/// (angular and linear velocity at the middle of its hinges, scaled by its size). Each hinge then
/// requires that both panels move its middle alike and turn alike across its direction. This has
/// six times as many unknowns.
///
/// @param noise_mm  how far the pose deviates from rigid panels on closed hinges
[[nodiscard]] Mobility mobility(const FoldModel& file, const Sheet& sheet, const PoseMotion& pose,
                                double noise_mm, MobilityForm form = MobilityForm::Loops);

/// How a speed counts in an equation.
struct SpeedInEquation {
  int equation{}, speed{};
  double factor{};
};

/// The same count for any linear equations between speeds.
///
/// @param noise  factors that rounding can cause
[[nodiscard]] Mobility free_speeds(std::span<const SpeedInEquation> entries, int equations,
                                   int speeds, double noise);

}  // namespace popcut::verify
