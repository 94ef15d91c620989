// SPDX-License-Identifier: MIT
#include "core/pattern/pattern.hpp"

#include <cmath>
#include <numbers>

namespace popcut {

std::array<double, 3> posed(const PatternVertex& p, double psi_rad) {
  return {p.x + p.z * std::cos(psi_rad), p.v, p.z * std::sin(psi_rad)};
}

double fold_angle_deg(EdgeRole role, double psi_rad) {
  const double bend_deg = (std::numbers::pi - psi_rad) * 180.0 / std::numbers::pi;
  if (role == EdgeRole::Valley) return bend_deg;
  if (role == EdgeRole::Mountain) return -bend_deg;
  return 0.0;
}

}  // namespace popcut
