// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace popcut::star {

/// A number with its derivatives by `kUnknowns` variables (forward differentiation).
template <std::size_t kUnknowns>
struct Dual {
  double value{};
  std::array<double, kUnknowns> by{};

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a number

  /// The function value `f` with slope `df` by this number.
  [[nodiscard]] Dual mapped(double f, double df) const {
    Dual out(f);
    for (std::size_t k = 0; k < kUnknowns; ++k) out.by[k] = df * by[k];
    return out;
  }
  /// f(a, b) with the partial slopes `fa` and `fb`.
  [[nodiscard]] static Dual of(double f, const Dual& a, double fa, const Dual& b, double fb) {
    Dual out(f);
    for (std::size_t k = 0; k < kUnknowns; ++k) out.by[k] = fa * a.by[k] + fb * b.by[k];
    return out;
  }
  friend Dual operator+(const Dual& a, const Dual& b) { return of(a.value + b.value, a, 1, b, 1); }
  friend Dual operator-(const Dual& a, const Dual& b) { return of(a.value - b.value, a, 1, b, -1); }
  friend Dual operator-(const Dual& a) { return a.mapped(-a.value, -1); }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return of(a.value * b.value, a, b.value, b, a.value);
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double q = a.value / b.value;
    return of(q, a, 1 / b.value, b, -q / b.value);
  }
  friend Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    return a.mapped(root, 0.5 / root);
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double square = y.value * y.value + x.value * x.value;
    return of(std::atan2(y.value, x.value), y, x.value / square, x, -y.value / square);
  }
};

/// A point or direction (x, v, z) over any number type.
template <typename S>
struct Vec {
  S x{}, v{}, z{};

  friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.v + b.v, a.z + b.z}; }
  friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.v - b.v, a.z - b.z}; }
  friend Vec operator*(const S& s, const Vec& a) { return {s * a.x, s * a.v, s * a.z}; }
};

template <typename S>
[[nodiscard]] S dot(const Vec<S>& a, const Vec<S>& b) {
  return a.x * b.x + a.v * b.v + a.z * b.z;
}
template <typename S>
[[nodiscard]] Vec<S> cross(const Vec<S>& a, const Vec<S>& b) {
  return {a.v * b.z - a.z * b.v, a.z * b.x - a.x * b.z, a.x * b.v - a.v * b.x};
}
template <typename S>
[[nodiscard]] S length(const Vec<S>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// Curvature of a vertex with its ring; see `VertexCurvature`.
template <typename S>
struct Curvature {
  S defect{}, mean{}, area{};
  Vec<S> normal{};
};

/// Angle defect, cotangent mean curvature and area (S1) of `centre` amid its closed `ring`.
///
/// The angle at the centre is `atan2(|e x f|, e . f)`: what the law of cosines gives, without its
/// loss of digits where an angle is near 0 or pi.
template <typename S>
[[nodiscard]] Curvature<S> curvature(const Vec<S>& centre, std::span<const Vec<S>> ring) {
  using std::atan2;
  Curvature<S> out;
  S angles = 0.0, twice_area = 0.0;
  Vec<S> laplace{}, normal{};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec<S>& p = ring[k];
    const Vec<S>& q = ring[k + 1 == ring.size() ? 0 : k + 1];
    const Vec<S> e = p - centre, f = q - centre, side = q - p;
    const Vec<S> normal_k = cross(e, f);
    const S area_k = length(normal_k);
    const S cot_p = -dot(e, side) / area_k;  // at p, opposite the edge to q
    const S cot_q = dot(f, side) / area_k;   // at q, opposite the edge to p
    angles = angles + atan2(area_k, dot(e, f));
    twice_area = twice_area + area_k;
    normal = normal + normal_k;
    laplace = laplace - cot_p * f - cot_q * e;
  }
  out.normal = (S(1.0) / length(normal)) * normal;
  out.area = twice_area / S(6.0);
  out.defect = S(2 * std::numbers::pi) - angles;
  out.mean = S(0.25) * dot(out.normal, laplace) / out.area;
  return out;
}

/// First and second fundamental forms by the parameters s and t; see `FundamentalForms`.
template <typename S>
struct Forms {
  S a_ss{}, a_st{}, a_tt{};
  S b_ss{}, b_st{}, b_tt{};
};

/// Forms of a star with the ring (s + 1, t + 1, s - 1, t - 1). `mixed` is r_st, zero where the
/// diagonal neighbours are not known.
template <typename S>
[[nodiscard]] Forms<S> forms(const Vec<S>& centre, std::span<const Vec<S>, 4> ring,
                             const Vec<S>& normal, const Vec<S>& mixed) {
  const Vec<S> e0 = ring[0] - centre, e1 = ring[1] - centre;
  const Vec<S> e2 = ring[2] - centre, e3 = ring[3] - centre;
  Forms<S> out;
  out.a_ss = S(0.5) * (dot(e0, e0) + dot(e2, e2));
  out.a_tt = S(0.5) * (dot(e1, e1) + dot(e3, e3));
  out.a_st = S(0.25) * dot(e0 - e2, e1 - e3);
  out.b_ss = -dot(normal, e0 + e2);
  out.b_tt = -dot(normal, e1 + e3);
  out.b_st = -dot(normal, mixed);
  return out;
}

}  // namespace popcut::star
