// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/fit/area_samples.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/fit/triangle_tree.hpp"

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
  double
      overhang{};  ///< behind an outer part of the same section by over 1 % of the size, in x and
                   ///< in z: overhangs, undersides, backs, ends; no falling curve reaches both

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
  std::array<double, 3> share_within{};  ///< of the target's area, within `kWithin` of the size
  OutOfReach out_of_reach;

  /// Root mean square over both surfaces, each with the same weight: one number to rank by.
  [[nodiscard]] double two_sided_rms_mm() const;
};

/// A target that structures are measured against: its tree and samples are made once.
///
/// Distances are those of points in space from the nearest point of the other surface; which side
/// they lie on does not matter. The cost is O(n) for n triangles and O(log n) a sample.
class FitTarget {
 public:
  explicit FitTarget(TriangleSoup target, const SampleDensity& density = {});

  /// No triangle has an area: nothing can be measured.
  [[nodiscard]] bool is_empty() const { return samples_.empty(); }

  /// The figures of a structure. Without a structure, or a target, `samples` are 0 and all
  /// distances too; the shares that are within are 0 then.
  [[nodiscard]] FitFigures measure(const TriangleSoup& structure) const;

 private:
  enum class Place : std::uint8_t { Reachable, Outside, Overhang };

  TriangleTree tree_;
  SampleDensity density_;
  double area_mm2_{}, size_mm_{};
  std::vector<Vec3> samples_;
  std::vector<Place> place_;  ///< one a sample
};

}  // namespace popcut
