// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/design/spline/monotone_spline.hpp"

namespace popcut {

/// A smooth curve through points (x, z) that falls from (0, h) on the wall to (d, 0) on the ground:
/// x never falls along it and z never rises, as in the points. Both are `MonotoneSpline`s of the
/// length along the chords between the points. Where the points turn a corner between a level and
/// an upright chord, so does the curve.
class FallingCurve {
 public:
  /// @param points  at least two, no two neighbours alike; the first has x = 0 and z > 0, the last
  ///                x > 0 and z = 0
  explicit FallingCurve(const std::vector<std::array<double, 2>>& points);

  [[nodiscard]] double h() const { return h_; }
  [[nodiscard]] double d() const { return d_; }
  /// The point at `t = x/d - z/h`, which grows along the curve from -1 to 1.
  [[nodiscard]] std::array<double, 2> at(double t) const;
  /// `t` of the points.
  [[nodiscard]] const std::vector<double>& knots() const { return t_; }
  /// The height at `x`: h before the wall, of an upright stretch its upper end, less than zero
  /// beyond d.
  [[nodiscard]] double height(double x) const;

 private:
  [[nodiscard]] static std::vector<std::array<double, 2>> along(
      const std::vector<std::array<double, 2>>& points, int which);

  double h_, d_;
  std::vector<double> length_, t_;  ///< along the chords, and t, of each point
  MonotoneSpline x_, z_;
};

}  // namespace popcut
