// SPDX-License-Identifier: MIT
#include "core/deploy/rigid.hpp"

#include <algorithm>

namespace popcut {
namespace {

using Frame = std::array<Vec3, 3>;  // three unit columns, square to each other

Frame frame_of(const std::array<Vec3, 3>& corners) {
  const Vec3 along = corners[1] - corners[0];
  const Vec3 e0 = (1 / norm(along)) * along;
  const Vec3 across = cross(e0, corners[2] - corners[0]);
  const Vec3 e2 = (1 / norm(across)) * across;
  return {e0, cross(e2, e0), e2};
}

/// The quaternion of a rotation matrix, from its largest component (Shepperd 1978).
Turn turn_of(const std::array<Vec3, 3>& row) {
  const double trace = row[0][0] + row[1][1] + row[2][2];
  Turn q{};
  if (trace > 0) {
    q = {row[2][1] - row[1][2], row[0][2] - row[2][0], row[1][0] - row[0][1], 1 + trace};
  } else {
    const std::size_t i = row[0][0] >= row[1][1] && row[0][0] >= row[2][2] ? 0
                          : row[1][1] >= row[2][2]                         ? 1
                                                                           : 2;
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1 + row[i][i] - row[j][j] - row[k][k];
    q[j] = row[j][i] + row[i][j];
    q[k] = row[k][i] + row[i][k];
    q[3] = row[k][j] - row[j][k];
  }
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& part : q) part /= size;
  return q;
}

double dot4(const Turn& a, const Turn& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

}  // namespace

Turn turn_about(const Vec3& axis, double angle_rad) {
  const double s = std::sin(angle_rad / 2);
  return {s * axis[0], s * axis[1], s * axis[2], std::cos(angle_rad / 2)};
}

Turn operator*(const Turn& a, const Turn& b) {
  const Vec3 p{a[0], a[1], a[2]}, q{b[0], b[1], b[2]};
  const Vec3 v = a[3] * q + b[3] * p + cross(p, q);
  return {v[0], v[1], v[2], a[3] * b[3] - dot(p, q)};
}

Turn inverse(const Turn& turn) { return {-turn[0], -turn[1], -turn[2], turn[3]}; }

Vec3 turned(const Turn& turn, const Vec3& p) {
  const Vec3 q{turn[0], turn[1], turn[2]};
  const Vec3 t = 2.0 * cross(q, p);
  return p + turn[3] * t + cross(q, t);
}

double angle_between(const Turn& a, const Turn& b) {
  const Turn way = inverse(a) * b;
  return 2 * std::atan2(norm({way[0], way[1], way[2]}), std::abs(way[3]));
}

Turn slerp(const Turn& a, Turn b, double part) {
  if (dot4(a, b) < 0) b = {-b[0], -b[1], -b[2], -b[3]};
  const double half = angle_between(a, b) / 2;
  constexpr double kSmall = 1e-7;  // below it sin(x) is x to a double
  const double wa = half < kSmall ? 1 - part : std::sin((1 - part) * half) / std::sin(half);
  const double wb = half < kSmall ? part : std::sin(part * half) / std::sin(half);
  Turn out{};
  for (std::size_t i = 0; i < 4; ++i) out[i] = wa * a[i] + wb * b[i];
  const double size = std::sqrt(dot4(out, out));
  for (double& value : out) value /= size;
  return out;
}

Motion3 motion_of(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
  const Frame f = frame_of(from), t = frame_of(to);
  std::array<Vec3, 3> rows{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      rows[r][c] = t[0][r] * f[0][c] + t[1][r] * f[1][c] + t[2][r] * f[2][c];
  const Turn turn = turn_of(rows);
  return {turn, to[0] - turned(turn, from[0])};
}

}  // namespace popcut
