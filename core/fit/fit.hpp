// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/fit/area_samples.hpp"
#include "core/fit/fit_figures.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/fit/triangle_tree.hpp"
#include "core/geometry/design_angle.hpp"

namespace popcut {

/// A target that structures are measured against: its tree and samples are made once.
///
/// Distances are those of points in space from the nearest point of the other surface; which side
/// they lie on does not matter. The cost is O(n) for n triangles and O(log n) a sample.
class FitTarget {
 public:
  /// @param opening  of the corner that the target stands in: what is outside of it, and what is
  ///                 behind something else in it, is out of reach
  explicit FitTarget(TriangleSoup target, const SampleDensity& density = {},
                     const DesignAngle& opening = {});

  /// No triangle has an area: nothing can be measured.
  [[nodiscard]] bool is_empty() const { return samples_.empty(); }

  /// The figures of a structure. Without a structure, or a target, `samples` are 0 and all
  /// distances too; the shares that are within are 0 then.
  [[nodiscard]] FitFigures measure(const TriangleSoup& structure) const;

  /// The same for comparing structures, without what takes longest: `max_mm` is that of the
  /// samples, and the shares that are within and `out_of_reach` stay 0.
  [[nodiscard]] FitFigures measure_roughly(const TriangleSoup& structure) const;

 private:
  struct Sampled;
  [[nodiscard]] Sampled sample(const TriangleSoup& structure) const;
  void add_out_of_reach(const TriangleSoup& structure, OutOfReach& out) const;

  TriangleTree tree_;
  DesignAngle opening_;
  std::optional<TriangleTree> section_tree_;  ///< along ground and wall, where they are not square
  SampleDensity density_;
  double area_mm2_{}, size_mm_{};
  std::vector<Vec3> samples_;
};

}  // namespace popcut
