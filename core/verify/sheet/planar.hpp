// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/result.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::verify {

/// A straight line of a drawing.
struct DrawnEdge {
  Vec2 from, to;
  Assignment kind{};
  double fold_angle_deg{};
};

/// What dashes were joined to.
struct DashEnd {
  double gap_mm{};         ///< usual gap between two dashes, 0 where folds are not dashed
  std::size_t joined{};    ///< gaps closed
  std::size_t extended{};  ///< ends drawn out to the next line
};

/// Joins folds that are drawn as rows of dashes: fills the gaps between dashes in one line that are
/// no wider than usual and that nothing else touches, and draws the rows' ends out to the first
/// line that they meet within such a gap. Drawings whose folds are not rows of
/// dashes stay as they are.
[[nodiscard]] DashEnd join_dashes(std::vector<DrawnEdge>& edges);

/// Makes a sheet of a file that lists no faces: a planar graph of its lines, and faces.
///
/// Rows of dashes are joined; ends and lines that come closer than a tolerance meet (the smallest
/// tolerance, up to 0.3 % of the drawing, with which the fewest folds end nowhere); lines are split
/// where they cross; doubled lines become one (a cut before a fold); what lies free inside a face
/// is tied to it by a flat edge; faces are traced along the lines; areas that cuts go all the way
/// round fall out and become holes. Afterwards indices are not the file's (`drawn`), and `notes`
/// says what was done.
///
/// @retval OutOfRange  more lines cross than can be split
[[nodiscard]] Result<void> planarise(FoldModel& file);

}  // namespace popcut::verify
