// SPDX-License-Identifier: MIT
#include "core/pattern/pattern.hpp"

#include <cmath>

#include "core/geometry/angle.hpp"

namespace popcut {

std::array<double, 3> posed(const PatternVertex& p, double psi_rad) {
  return {p.x + p.z * std::cos(psi_rad), p.v, p.z * std::sin(psi_rad)};
}

std::array<double, 3> posed(const Kite& kite, const PatternVertex& p, double psi_rad) {
  const KitePoint at = kite.section.posed(p.x, p.z, psi_rad);
  return {at.x, p.v, at.z};
}

double fold_angle_deg(EdgeRole role, double psi_rad) {
  const double bend_deg = degrees(kPi - psi_rad);
  if (role == EdgeRole::Valley) return bend_deg;
  if (role == EdgeRole::Mountain) return -bend_deg;
  return 0.0;
}

double splay_rad(double alpha, double psi_rad) {
  return 2.0 * std::atan(alpha * std::cos(0.5 * psi_rad));
}

std::vector<std::array<double, 3>> posed_vertices(const Pattern& pattern, double psi_rad) {
  std::vector<std::array<double, 3>> out;
  out.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) out.push_back(posed(p, psi_rad));
  for (const VFold& fold : pattern.v_folds) {
    // From the apex along the crease, and up along the bisector of the two panels.
    const double theta = splay_rad(fold.alpha, psi_rad);
    const double up = fold.length_mm * std::sin(theta);
    const auto& o = out[fold.apex];
    out[fold.tip] = {o[0] + up * std::cos(0.5 * psi_rad), o[1] + fold.length_mm * std::cos(theta),
                     o[2] + up * std::sin(0.5 * psi_rad)};
  }
  for (const Kite& kite : pattern.kites)
    for (const std::uint32_t i : kite.vertices) out[i] = posed(kite, pattern.vertices[i], psi_rad);
  return out;
}

std::vector<double> fold_angles_deg(const Pattern& pattern, double psi_rad) {
  std::vector<double> out;
  out.reserve(pattern.edges.size());
  for (const PatternEdge& e : pattern.edges) out.push_back(fold_angle_deg(e.role, psi_rad));
  for (const VFold& fold : pattern.v_folds) {
    const double half =
        std::atan2(std::sqrt(1.0 + fold.alpha * fold.alpha) * std::cos(0.5 * psi_rad),
                   std::sin(0.5 * psi_rad));
    out[fold.edge_b] = out[fold.edge_c] = degrees(2.0 * half);
  }
  for (const Kite& kite : pattern.kites) {
    const double bend_deg = degrees(kite.section.bend_rad(psi_rad));
    for (const std::uint32_t e : kite.edges)
      out[e] = pattern.edges[e].role == EdgeRole::Valley ? bend_deg : -bend_deg;
  }
  return out;
}

}  // namespace popcut
