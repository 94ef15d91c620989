// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace popcut::verify {

/// A point or direction on the flat sheet, in mm.
struct Vec2 {
  double u{};
  double v{};
};

[[nodiscard]] constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x() + b.x(), a.y() + b.y()}; }
[[nodiscard]] constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x() - b.x(), a.y() - b.y()}; }
[[nodiscard]] constexpr Vec2 operator*(double s, Vec2 a) { return {s * a.x(), s * a.y()}; }
[[nodiscard]] constexpr double dot(Vec2 a, Vec2 b) { return a.x() * b.x() + a.y() * b.y(); }
[[nodiscard]] constexpr double cross(Vec2 a, Vec2 b) { return a.x() * b.y() - a.y() * b.x(); }
[[nodiscard]] inline double norm(Vec2 a) { return std::hypot(a.x(), a.y()); }

/// A point or direction of a pose, in mm.
struct Vec3 {
  double x{};
  double y{};
  double z{};
};

[[nodiscard]] constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x() + b.x(), a.y() + b.y(), a.z() + b.z()};
}
[[nodiscard]] constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z()};
}
[[nodiscard]] constexpr Vec3 operator*(double s, Vec3 a) {
  return {s * a.x(), s * a.y(), s * a.z()};
}
[[nodiscard]] constexpr double dot(Vec3 a, Vec3 b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}
[[nodiscard]] constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}
[[nodiscard]] inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }
/// `a` scaled to length 1; the zero vector stays zero.
[[nodiscard]] inline Vec3 unit(Vec3 a) {
  const double length = norm(a);
  return length > 0.0 ? (1.0 / length) * a : Vec3{};
}

}  // namespace popcut::verify
