// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

namespace popcut {

/// A curve through points, value by place, that turns only where they do: between two of them it
/// stays between their values, and it rises and falls as they do (docs/geometry.md, section 3).
///
/// Cubic Hermite pieces with one slope a point (C1). Inside the slope is the weighted harmonic mean
/// of the chords' slopes beside it, or zero where these have different signs (Fritsch and Butland,
/// A method for constructing local monotone piecewise cubic interpolants, 1984); at the ends it is
/// that of the parabola through three points, kept to the sign of the first chord and to three
/// times its slope.
class MonotoneSpline {
 public:
  /// @param points  at least two pairs of place and value, by growing place
  explicit MonotoneSpline(const std::vector<std::array<double, 2>>& points);

  /// The value at a place; NaN before the first point and beyond the last one by more than a
  /// billionth of the whole, which is left to rounding.
  [[nodiscard]] double operator()(double place) const;

  [[nodiscard]] double first() const { return place_.front(); }
  [[nodiscard]] double last() const { return place_.back(); }

 private:
  std::vector<double> place_, value_, slope_;
};

}  // namespace popcut
