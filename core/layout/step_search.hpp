// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <vector>

#include "core/layout/seam_search.hpp"

namespace popcut {

struct SteppedRows {
  std::vector<StepSeam> seams;
  double cost{std::numeric_limits<double>::infinity()};
};

/// The cheapest seams across the column `left`..`right` that may run at another height in each
/// strip between two lines along y, and change it only along cuts. Each keeps to a band of its own,
/// so that no piece is higher than the limit; within it the way is a shortest path over strips and
/// heights, O(strips x heights).
[[nodiscard]] SteppedRows find_stepped(LineIndex& lines, const SearchLimits& limits,
                                       const ColumnEnds& ends, double left, double right);

}  // namespace popcut
