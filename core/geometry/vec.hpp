// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#ifndef EIGEN_INITIALIZE_MATRICES_BY_ZERO
#error "link popcut_core_geometry, so that a fresh Vec2 is zero in all of the program"
#endif

namespace popcut {

/// A point or direction in the plane, mm. Unlike Eigen's default, `Vec2 p;` is zero: the build sets
/// EIGEN_INITIALIZE_MATRICES_BY_ZERO for all of popcut.
///
/// `auto` on an expression (`const auto c = a - b;`) keeps references to its operands: name the
/// type. `PagePoint` (core/geometry/page_point.hpp) is the plain value of drawings and pages.
using Vec2 = Eigen::Vector2d;
/// A point or direction in space, mm.
using Vec3 = Eigen::Vector3d;

/// Three plain numbers, as headers that many include have them, as a vector.
[[nodiscard]] inline Vec3 vec3(const std::array<double, 3>& p) { return Vec3(p.data()); }

/// a . b, summed from the first coordinate to the last. Eigen's own `dot` pairs the terms as the
/// processor likes it, which moves the last bit of results that files and tests hold.
template <typename A, typename B>
[[nodiscard]] double dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  const typename A::PlainObject p = a;
  const typename B::PlainObject q = b;
  double sum = p[0] * q[0];
  for (int k = 1; k < p.size(); ++k) sum += p[k] * q[k];
  return sum;
}

/// The vector square to both in space; in the plane twice the area of the triangle 0, a, b, with
/// the sign of the turn from a to b (counter-clockwise positive).
template <typename A, typename B>
[[nodiscard]] auto cross(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  const typename A::PlainObject p = a;
  const typename B::PlainObject q = b;
  if constexpr (A::SizeAtCompileTime == 2) {
    return p[0] * q[1] - p[1] * q[0];
  } else {
    return Vec3{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
  }
}

/// |a|
template <typename A>
[[nodiscard]] double norm(const Eigen::MatrixBase<A>& a) {
  const typename A::PlainObject p = a;
  if constexpr (A::SizeAtCompileTime == 2) return std::hypot(p[0], p[1]);
  return std::sqrt(dot(p, p));
}

/// `a` at length 1; the zero vector stays zero.
template <typename A>
[[nodiscard]] typename A::PlainObject unit(const Eigen::MatrixBase<A>& a) {
  const typename A::PlainObject p = a;
  const double length = norm(p);
  if (!(length > 0.0)) return A::PlainObject::Zero();
  return (1.0 / length) * p;
}

}  // namespace popcut
