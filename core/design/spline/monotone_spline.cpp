// SPDX-License-Identifier: MIT
#include "core/design/spline/monotone_spline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace popcut {
namespace {

/// The slope at a point between the chords' slopes `a`, over a stretch `ha`, and `b` over `hb`.
double inner_slope(double ha, double a, double hb, double b) {
  if (!(a * b > 0.0)) return 0.0;
  const double wa = 2.0 * hb + ha, wb = hb + 2.0 * ha;
  return (wa + wb) / (wa / a + wb / b);
}

/// The slope at an end, from the chord there and the next one.
double end_slope(double ha, double a, double hb, double b) {
  const double slope = ((2.0 * ha + hb) * a - ha * b) / (ha + hb);
  if (!(slope * a > 0.0)) return 0.0;
  if (!(a * b > 0.0) && std::abs(slope) > 3.0 * std::abs(a)) return 3.0 * a;
  return slope;
}

}  // namespace

MonotoneSpline::MonotoneSpline(const std::vector<std::array<double, 2>>& points) {
  for (const auto& [place, value] : points) place_.push_back(place), value_.push_back(value);
  const std::size_t n = points.size();
  std::vector<double> step(n - 1), chord(n - 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    step[k] = place_[k + 1] - place_[k];
    chord[k] = (value_[k + 1] - value_[k]) / step[k];
  }
  slope_.assign(n, chord.front());
  if (n == 2) return;
  slope_.front() = end_slope(step[0], chord[0], step[1], chord[1]);
  for (std::size_t k = 1; k + 1 < n; ++k)
    slope_[k] = inner_slope(step[k - 1], chord[k - 1], step[k], chord[k]);
  slope_.back() = end_slope(step[n - 2], chord[n - 2], step[n - 3], chord[n - 3]);
}

double MonotoneSpline::operator()(double place) const {
  const double slack = 1e-9 * (last() - first());
  if (!(place >= first() - slack && place <= last() + slack))
    return std::numeric_limits<double>::quiet_NaN();
  place = std::clamp(place, first(), last());
  const auto after = std::upper_bound(place_.begin() + 1, place_.end() - 1, place);
  const auto k = static_cast<std::size_t>(after - place_.begin()) - 1;
  const double h = place_[k + 1] - place_[k], t = (place - place_[k]) / h, s = 1.0 - t;
  const double value = s * s * ((1.0 + 2.0 * t) * value_[k] + h * t * slope_[k]) +
                       t * t * ((1.0 + 2.0 * s) * value_[k + 1] - h * s * slope_[k + 1]);
  // Rounding is not to leave the values of the two points either.
  const auto [low, high] = std::minmax(value_[k], value_[k + 1]);
  return std::clamp(value, low, high);
}

}  // namespace popcut
