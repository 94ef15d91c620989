// SPDX-License-Identifier: MIT
#include "core/design/lattice/section_distance.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

constexpr int kPlaces = 256;
constexpr double kPitch = 2.0 / kPlaces;

}  // namespace

SectionDistance::SectionDistance(const SliceCurve& curve)
    : h_(curve.h()), d_(curve.d()), circle_(curve.is_circle()) {
  if (circle_) return;
  for (int k = 0; k <= kPlaces; ++k) {
    const CurveJet c = curve.at(-1.0 + k * kPitch);
    n_.push_back(c.x / d_ + c.z / h_);
    dn_.push_back(c.dx / d_ + c.dz / h_);
  }
}

SectionDistance::Rise SectionDistance::rise(double t) const {
  if (t <= -1.0) return {n_.front() + dn_.front() * (t + 1.0), dn_.front(), 0.0};
  if (t >= 1.0) return {n_.back() + dn_.back() * (t - 1.0), dn_.back(), 0.0};
  const auto k = std::min<std::size_t>(static_cast<std::size_t>((t + 1.0) / kPitch), kPlaces - 1);
  const double u = (t + 1.0) / kPitch - static_cast<double>(k);
  // Hermite's cubic: n = a + u (b + u (c + u d)).
  const double a = n_[k], b = kPitch * dn_[k], jump = n_[k + 1] - a, end = kPitch * dn_[k + 1];
  const double c = 3.0 * jump - 2.0 * b - end, d = b + end - 2.0 * jump;
  return {a + u * (b + u * (c + u * d)), (b + u * (2.0 * c + u * 3.0 * d)) / kPitch,
          (2.0 * c + 6.0 * u * d) / (kPitch * kPitch)};
}

SectionPoint SectionDistance::at(double t) const {
  const double n = circle_ ? std::sqrt(std::max(0.0, 2.0 - t * t)) : rise(t).n;
  return {0.5 * d_ * (n + t), 0.5 * h_ * (n - t)};
}

SectionDistance::Foot SectionDistance::foot(SectionPoint p) const {
  if (circle_) {
    const double rho = std::hypot(p.x, p.z);
    if (rho < 1e-9 * h_) return {-h_, std::sqrt(0.5), std::sqrt(0.5), 0.0};
    const double x = p.x / rho, z = p.z / rho;
    return {rho - h_, x, z, x - z};
  }
  double t = p.x / d_ - p.z / h_;  // where the curve crosses the chord's normal: near the foot
  double x = 0.0, z = 0.0, dx = 0.0, dz = 0.0;
  for (int step = 0; step < 8; ++step) {
    const Rise r = rise(t);
    x = 0.5 * d_ * (r.n + t) - p.x, z = 0.5 * h_ * (r.n - t) - p.z;
    dx = 0.5 * d_ * (r.dn + 1.0), dz = 0.5 * h_ * (r.dn - 1.0);
    const double slope = x * dx + z * dz, speed2 = dx * dx + dz * dz;
    const double bend = speed2 + 0.5 * r.ddn * (x * d_ + z * h_);
    const double move = -slope / (bend > 0.25 * speed2 ? bend : speed2);
    if (std::abs(move) < 1e-9) break;
    t += std::clamp(move, -0.25, 0.25);
  }
  const double speed = std::hypot(dx, dz);
  const double nx = -dz / speed, nz = dx / speed;  // outward: x grows and z falls along the curve
  return {-(x * nx + z * nz), nx, nz, t};
}

}  // namespace popcut
