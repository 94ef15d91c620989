// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <vector>

#include "core/layout/seam_search.hpp"

namespace popcut {

/// Stepped seams across a column and their cost in mm of glue.
struct SteppedRows {
  std::vector<StepSeam> seams;
  double cost{std::numeric_limits<double>::infinity()};
};

/// Finds the cheapest stepped seams across the column `left`..`right`. A seam has one height in
/// each strip between two lines along y, and changes it only along cuts. Each seam stays in its own
/// band, so that no piece is higher than the limit. Within a band the seam is a shortest path over
/// strips and heights: O(strips x heights).
[[nodiscard]] SteppedRows find_stepped(LineIndex& lines, const SearchLimits& limits,
                                       const ColumnEnds& ends, double left, double right);

}  // namespace popcut
