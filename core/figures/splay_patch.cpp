// SPDX-License-Identifier: MIT
#include "core/figures/splay_patch.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

Point3 tip(const SplayPatch& patch, double along, double across, double alpha, double psi_rad) {
  const double theta = splay_angle_rad(alpha, psi_rad);
  return {along + patch.w * std::cos(theta), across, patch.w * std::sin(theta)};
}

}  // namespace

double splay_angle_rad(double alpha, double psi_rad) {
  return 2.0 * std::atan2(alpha * std::cos(psi_rad / 2), 1.0);
}

Point3 SplayPatch::centre(double psi_rad) const { return tip(*this, 0, 0, alpha, psi_rad); }

std::array<Point3, 4> SplayPatch::ring(double psi_rad) const {
  const double across = pitch_across * (on_lattice ? 2.0 * std::sin(psi_rad / 2) : 1.0);
  return {tip(*this, pitch_along, 0, alpha_along, psi_rad),
          tip(*this, 0, across, alpha_across, psi_rad),
          tip(*this, -pitch_along, 0, alpha_along, psi_rad),
          tip(*this, 0, -across, alpha_across, psi_rad)};
}

VertexCurvature curvature_of(const SplayPatch& patch, double psi_rad) {
  return vertex_curvature(patch.centre(psi_rad), patch.ring(psi_rad));
}

Result<double> alpha_across_for_zero(SplayPatch patch, double psi_rad) {
  constexpr double kMost = 100.0;
  const auto K = [&](double alpha_across) {
    patch.alpha_across = alpha_across;
    return curvature_of(patch, psi_rad).K;
  };
  constexpr double kGrowth = 1.01;
  double low = std::max(1.0 / std::cos(psi_rad / 2), patch.alpha);
  while (low < kMost && !(K(low) < -1e-12)) low *= kGrowth;
  double high = low;
  while (high < kMost && !(K(high) > 0)) high *= kGrowth;
  if (!(K(low) < 0) || !(K(high) > 0))
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("no alpha across up to {:g} makes K zero at psi = {:g} rad", kMost, psi_rad));
  constexpr int kHalvings = 200;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (K(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace popcut
