// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>

namespace popcut {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegrees = 180.0 / kPi;  ///< degrees of one radian

// Files hold angles with all their digits, so the order of the operations is kept: another one
// changes the last digit of some angles.

[[nodiscard]] constexpr double degrees(double angle_rad) { return angle_rad * 180.0 / kPi; }

[[nodiscard]] constexpr double radians(double angle_deg) { return angle_deg * kPi / 180.0; }

/// The opening angle psi, rad, of one in degrees. In the last digit it can differ from `radians`.
[[nodiscard]] constexpr double psi_rad_of(double psi_deg) { return psi_deg / 180.0 * kPi; }

}  // namespace popcut
