// SPDX-License-Identifier: MIT
#include "core/geometry/kite.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

KitePoint in_space(double x, double z, double psi_rad) {
  return {x + z * std::cos(psi_rad), z * std::sin(psi_rad)};
}

}  // namespace

double KiteSection::slope_rad() const {
  const double theta = 2.0 * std::atan2(q_mm(), p_mm());
  return overhangs() ? theta - 0.5 * kPi : theta;
}

bool KiteSection::has(double x, double z) const {
  constexpr double kSame_mm = 1e-9;
  const double from_q = (x - z) - (q.x - q.z), whole = p_mm() + q_mm();
  return from_q > kSame_mm && from_q < whole - kSame_mm;
}

KitePoint KiteSection::posed(double x, double z, double psi_rad) const {
  const KitePoint at = in_space(x, z, psi_rad);
  if (!has(x, z)) return at;
  // Along QE, in lengths that do not cancel where it opens or shuts.
  const double dx = p_mm() - q_mm() * std::cos(psi_rad), dz = -q_mm() * std::sin(psi_rad);
  const double squared = dx * dx + dz * dz;
  const KitePoint from = in_space(q.x, q.z, psi_rad);
  const double ax = at.x - from.x, az = at.z - from.z;
  const double along = 2.0 * (ax * dx + az * dz) / squared;
  return {from.x + along * dx - ax, from.z + along * dz - az};
}

KitePoint KiteSection::r() const { return posed(q.x, e.z, 0.5 * kPi); }

double KiteSection::depth_mm(double across_mm) const {
  const std::array corners{q, r(), e};
  double depth = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < 2; ++k) {
    const KitePoint &a = corners[k], &b = corners[k + 1];
    const double from = a.x - a.z, to = b.x - b.z;
    const double part = (across_mm - from) / (to - from);
    if (!(part >= 0.0 && part <= 1.0)) continue;
    const double here = (1.0 - part) * (a.x + a.z) + part * (b.x + b.z);
    if (!(here <= depth)) depth = here;
  }
  return depth;
}

double KiteSection::bend_rad(double psi_rad) const {
  const double shorter = std::min(p_mm(), q_mm()), longer = std::max(p_mm(), q_mm());
  return kPi - psi_rad -
         2.0 * std::atan2(shorter * std::sin(psi_rad), longer - shorter * std::cos(psi_rad));
}

double KiteSection::clearance_mm() const {
  const double apart = std::abs(p_mm() - q_mm());
  return apart > 0.0 ? 2.0 * p_mm() * q_mm() / apart : std::numeric_limits<double>::infinity();
}

KiteSection kite_at_eave(const KitePoint& eave, double slope_rad, double length_mm) {
  return {{eave.x - length_mm, eave.z + length_mm * std::tan(0.5 * slope_rad)}, eave};
}

KiteSection kite_at_ridge(const KitePoint& ridge, double slope_rad, double length_mm) {
  return {ridge,
          {ridge.x + length_mm / std::tan(0.25 * kPi + 0.5 * slope_rad), ridge.z - length_mm}};
}

double longest_at_eave_mm(double eave_x_mm, double slope_rad) {
  return eave_x_mm * std::tan(0.25 * kPi - 0.5 * slope_rad);
}

double longest_at_ridge_mm(double ridge_z_mm, double slope_rad) {
  // E lies as far below the ridge as the roof is long, and hangs 2 l / (t - 1) above the ground.
  const double t = std::tan(0.25 * kPi + 0.5 * slope_rad);
  return ridge_z_mm * (t - 1.0) / (t + 1.0);
}

}  // namespace popcut
