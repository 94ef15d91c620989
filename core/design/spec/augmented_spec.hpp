// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

namespace popcut {

/// `curvature` of a spec: what the surface through the chains' vertices is to be, for the augmented
/// loss of S4. A list is empty (not asked for), has one value for all, or one an inner vertex:
/// levels 1 .. N - 1 of each slice that has slices on both sides, slice by slice.
struct AugmentedSpec {
  std::vector<double> K_area;                 ///< Gaussian curvature, 1/mm^2
  std::vector<double> H;                      ///< mean curvature, 1/mm, > 0 where convex
  std::vector<std::array<double, 3>> first;   ///< a_ss, a_st, a_tt of (level, slice), mm^2
  std::vector<std::array<double, 3>> second;  ///< b_ss, b_st, b_tt, mm
  double weight_K{}, weight_H{}, weight_first{}, weight_second{};  ///< 0 where not asked for
};

}  // namespace popcut
