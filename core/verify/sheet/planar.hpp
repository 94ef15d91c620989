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

/// What joining dashes did.
struct JoinedDashes {
  double gap_mm{};         ///< usual gap between two dashes; 0: folds are not dashed
  std::size_t joined{};    ///< number of gaps closed
  std::size_t extended{};  ///< number of ends extended to the next line
};

/// Joins folds that are drawn as rows of dashes. Fills the gaps between dashes in one line that are
/// no wider than usual and that nothing else touches. Extends the ends of the rows to the first
/// line that they meet within such a gap. Does not change drawings whose folds are not dashed.
[[nodiscard]] JoinedDashes join_dashes(std::vector<DrawnEdge>& edges);

/// Makes a sheet from a file without faces: a planar graph of its lines, and faces.
///
/// 1. Joins rows of dashes. 2. Joins ends and lines that come closer than a tolerance (the smallest
/// one, up to 0.3 % of the drawing, that leaves the fewest loose folds). 3. Splits lines where they
/// cross. 4. Merges doubled lines (a cut wins over a fold). 5. Connects what lies inside a face to
/// it by a flat edge. 6. Traces faces along the lines. 7. Turns areas surrounded by cuts into
/// holes. Afterwards indices differ from the file's (`drawn`), and `notes` says what was done.
///
/// @retval OutOfRange  too many lines cross
[[nodiscard]] Result<void> planarise(FoldModel& file);

}  // namespace popcut::verify
