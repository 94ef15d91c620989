// SPDX-License-Identifier: MIT
#include "core/rigid/motion.hpp"

#include <cmath>

namespace popcut::rigid {
namespace {

/// Three unit columns, square to each other: along the first side, beside it, square to both.
Eigen::Matrix3d frame_of(const std::array<Vec3, 3>& corners) {
  const Vec3 e0 = unit(corners[1] - corners[0]);
  const Vec3 e2 = unit(cross(e0, corners[2] - corners[0]));
  Eigen::Matrix3d frame;
  frame << e0, cross(e2, e0), e2;
  return frame;
}

}  // namespace

Turn toward(const Turn& turn, const Turn& side) {
  return turn.dot(side) < 0 ? Turn(-turn.coeffs()) : turn;
}

Turn slerp(const Turn& a, const Turn& b, double part) {
  const double half = a.angularDistance(b) / 2;
  constexpr double kSmall = 1e-7;  // below it sin(x) is x to a double
  const double wa = half < kSmall ? 1 - part : std::sin((1 - part) * half) / std::sin(half);
  const double wb = half < kSmall ? part : std::sin(part * half) / std::sin(half);
  return Turn(wa * a.coeffs() + wb * toward(b, a).coeffs()).normalized();
}

Motion motion_of(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
  const Eigen::Matrix3d rotation = frame_of(to) * frame_of(from).transpose();
  const Turn turn = Turn(rotation).normalized();
  return {turn, to[0] - turn * from[0]};
}

}  // namespace popcut::rigid
