// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <numbers>

namespace popcut {

/// The opening angle that a structure is designed for, as oblique coordinates: the point (X, Z) of
/// a section is at `X (1, 0) + Z (cos a, sin a)` in space (docs/geometry.md, section 2).
struct Opening {
  double cosine{0.0}, sine{1.0};

  /// Of an angle in degrees, exact for 90.
  [[nodiscard]] static Opening of_deg(double degrees) {
    if (degrees == 90.0) return {};
    return of_rad(degrees / 180.0 * std::numbers::pi);
  }
  /// Of an angle in radians, exact for pi/2.
  [[nodiscard]] static Opening of_rad(double radians) {
    if (std::abs(radians - 0.5 * std::numbers::pi) < 1e-15) return {};
    return {std::cos(radians), std::sin(radians)};
  }

  [[nodiscard]] bool is_right() const { return cosine == 0.0 && sine == 1.0; }

  /// From (X, Z) to the place (x, z) in space.
  void to_space(double& x, double& z) const { x += z * cosine, z *= sine; }
  /// From the place (x, z) in space to (X, Z).
  void to_oblique(double& x, double& z) const { z /= sine, x -= z * cosine; }
};

}  // namespace popcut
