// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>

namespace popcut {

/// A place or direction in space as (x, v, z), mm: right-handed, x away from the wall, v along the
/// spine, z up (design reference, section 2).
using Vec3 = std::array<double, 3>;

[[nodiscard]] inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard]] inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline Vec3 operator*(double s, const Vec3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
[[nodiscard]] inline double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// A rotation as a unit quaternion (x, y, z, w), in the order that glTF has.
using Turn = std::array<double, 4>;
inline constexpr Turn kNoTurn{0, 0, 0, 1};

/// The turn by `angle_rad` about `axis` (unit length), counter-clockwise seen against it.
[[nodiscard]] Turn turn_about(const Vec3& axis, double angle_rad);
/// First `b`, then `a`.
[[nodiscard]] Turn operator*(const Turn& a, const Turn& b);
[[nodiscard]] Turn inverse(const Turn& turn);
[[nodiscard]] Vec3 turned(const Turn& turn, const Vec3& p);
/// The turn that lies `part` of the way from `a` to `b` on the shorter arc.
[[nodiscard]] Turn slerp(const Turn& a, Turn b, double part);
/// The angle between two turns, 0..pi.
[[nodiscard]] double angle_between(const Turn& a, const Turn& b);

/// Where a rigid body has gone: first the turn about the origin, then the shift.
struct Motion3 {
  Turn turn{kNoTurn};
  Vec3 shift{};
};

[[nodiscard]] inline Vec3 moved(const Motion3& motion, const Vec3& p) {
  return turned(motion.turn, p) + motion.shift;
}

/// The motion that carries the triangle `from` to the congruent triangle `to`.
[[nodiscard]] Motion3 motion_of(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to);

}  // namespace popcut
