// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace popcut {

/// Distances of one surface's points from another surface, each point standing for the same area.
struct DistanceFigures {
  double mean_mm{};
  double rms_mm{};
  double p95_mm{};  ///< 95 % of the area are not farther than this
  double max_mm{};  ///< the largest that was found: samples, then uphill from the farthest of them
  std::size_t samples{};
};

/// Why parts of a target are out of reach, each as a share of its whole area (0 to 1).
struct OutOfReach {
  double outside_of_the_corner{};  ///< behind the wall or under the ground
  double beyond_the_slices{};      ///< before or after the structure along the spine
  /// Behind an outer part of the same section by over 1 % of the size, in x and in z: overhangs,
  /// undersides, backs, ends. No falling curve reaches both.
  double overhang{};

  [[nodiscard]] double share() const {
    return outside_of_the_corner + beyond_the_slices + overhang;
  }
};

/// How far a structure and its target are from each other.
struct FitFigures {
  DistanceFigures to_target;     ///< of the structure's points from the target
  DistanceFigures to_structure;  ///< of the target's points from the structure, all of its area
  double size_mm{};              ///< diagonal of the box around the target
  double target_mm2{}, structure_mm2{};
  static constexpr std::array<double, 3> kWithin{0.01, 0.02, 0.05};
  std::array<double, 3> share_within{};      ///< of the target's area, within `kWithin` of the size
  std::array<double, 3> structure_within{};  ///< the same of the structure's area
  OutOfReach out_of_reach;

  /// Root mean square over both surfaces, each with the same weight: one number to rank by.
  [[nodiscard]] double two_sided_rms_mm() const;
};

}  // namespace popcut
