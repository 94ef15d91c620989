// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <vector>

namespace popcut {

/// The `count` values of a histogram, by steps, that lie nearest to all of it: the least sum of
/// weights times distances (k-medians in one dimension, by dynamic programming over intervals).
/// Descending; fewer where the histogram has fewer. O(count x steps^2).
[[nodiscard]] std::vector<int> interval_medians(const std::map<int, double>& weight, int count);

}  // namespace popcut
