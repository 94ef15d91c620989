// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/design/spline/falling_curve.hpp"

namespace popcut {

/// A falling curve at a place along the spine, as points (x, z) from the wall to the ground.
struct LoftStation {
  double y{};
  std::vector<std::array<double, 2>> curve;
};

/// A surface through the curves of stations: point k of each is joined to point k of the next. Its
/// sections fall as the stations do, and it meets wall and ground between the two stations'
/// measures (docs/geometry.md, section 3).
///
/// Along y everything is a `MonotoneSpline` through the stations: the height h, the depth d, and
/// the steps from point to point, which stay non-negative; the steps of a section are then
/// stretched to its h and d. A single station reaches along the whole spine.
class Loft {
 public:
  /// @param stations  at least one, by growing y; curves as `FallingCurve` takes them, all with the
  ///                  same number of points
  explicit Loft(std::vector<LoftStation> stations);

  /// The section at `y`; none before the first station and beyond the last one.
  [[nodiscard]] std::optional<FallingCurve> at(double y) const;

 private:
  std::vector<LoftStation> stations_;
  std::vector<MonotoneSpline> step_x_, step_z_;  ///< one a step; none for a single station
  std::vector<MonotoneSpline> end_;              ///< h and d
};

}  // namespace popcut
