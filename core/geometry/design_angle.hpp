// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "core/geometry/angle.hpp"

namespace popcut {

/// The opening angle that a structure is designed for, as oblique coordinates: the point (X, Z) of
/// a section is at `X (1, 0) + Z (cos a, sin a)` in space (docs/geometry.md, section 2).
struct DesignAngle {
  double cosine{0.0}, sine{1.0};

  /// Of an angle in degrees, exact for 90.
  [[nodiscard]] static DesignAngle of_deg(double psi_deg) {
    if (psi_deg == 90.0) return {};
    return of_rad(psi_rad_of(psi_deg));
  }
  /// Of an angle in radians, exact for pi/2.
  [[nodiscard]] static DesignAngle of_rad(double psi_rad) {
    if (std::abs(psi_rad - 0.5 * kPi) < 1e-15) return {};
    return {std::cos(psi_rad), std::sin(psi_rad)};
  }

  [[nodiscard]] bool is_right() const { return cosine == 0.0 && sine == 1.0; }

  /// From (X, Z) to the place (x, z) in space.
  void to_space(double& x, double& z) const { x += z * cosine, z *= sine; }
  /// From the place (x, z) in space to (X, Z).
  void to_oblique(double& x, double& z) const { z /= sine, x -= z * cosine; }
};

}  // namespace popcut
