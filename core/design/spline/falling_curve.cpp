// SPDX-License-Identifier: MIT
#include "core/design/spline/falling_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

namespace popcut {
namespace {

/// The place between `low` and `high` at which `grows`, which never falls, reaches 0.
template <typename Function>
double zero_between(double low, double high, Function grows) {
  if (!(grows(low) < 0.0)) return low;
  if (!(grows(high) > 0.0)) return high;
  std::uintmax_t most = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      grows, low, high, boost::math::tools::eps_tolerance<double>(52), most);
  return 0.5 * (bracket.first + bracket.second);
}

}  // namespace

std::vector<std::array<double, 2>> FallingCurve::along(
    const std::vector<std::array<double, 2>>& points, int which) {
  std::vector<std::array<double, 2>> out;
  double length = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0)
      length += std::hypot(points[k][0] - points[k - 1][0], points[k][1] - points[k - 1][1]);
    out.push_back({length, points[k][static_cast<std::size_t>(which)]});
  }
  return out;
}

FallingCurve::FallingCurve(const std::vector<std::array<double, 2>>& points)
    : h_(points.front()[1]), d_(points.back()[0]), x_(along(points, 0)), z_(along(points, 1)) {
  for (const auto& [length, x] : along(points, 0)) length_.push_back(length);
  for (const auto& [x, z] : points) t_.push_back(x / d_ - z / h_);
}

std::array<double, 2> FallingCurve::at(double t) const {
  const auto after = std::upper_bound(t_.begin() + 1, t_.end() - 1, t);
  const auto k = static_cast<std::size_t>(after - t_.begin());
  const double length = zero_between(length_[k - 1], length_[k], [&](double at_length) {
    return x_(at_length) / d_ - z_(at_length) / h_ - t;
  });
  return {x_(length), z_(length)};
}

double FallingCurve::height(double x) const {
  if (x < 0.0) return h_;
  if (x > d_) return d_ - x;
  const auto reaches = [&](double at_length) { return x_(at_length) - x; };
  return z_(zero_between(length_.front(), length_.back(), reaches));
}

}  // namespace popcut
