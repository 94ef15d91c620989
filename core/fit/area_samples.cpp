// SPDX-License-Identifier: MIT
#include "core/fit/area_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace popcut {
namespace {

double area_of_triangle(const TriangleSoup& soup, std::size_t t) {
  const double* c = soup.corners.data() + 9 * t;
  const std::array a{c[3] - c[0], c[4] - c[1], c[5] - c[2]};
  const std::array b{c[6] - c[0], c[7] - c[1], c[8] - c[2]};
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
               z = a[0] * b[1] - a[1] * b[0];
  return 0.5 * std::sqrt(x * x + y * y + z * z);
}

/// The fraction that n times an irrational number has.
double recurrence(std::size_t n, double irrational) {
  const double value = 0.5 + irrational * static_cast<double>(n);
  return value - std::floor(value);
}

}  // namespace

double area_of(const TriangleSoup& soup) {
  double area = 0.0;
  for (std::size_t t = 0; t < soup.size(); ++t) area += area_of_triangle(soup, t);
  return area;
}

std::size_t samples_of(double area_mm2, const SampleDensity& density) {
  const double wanted = std::ceil(area_mm2 * density.per_mm2);
  return static_cast<std::size_t>(
      std::clamp(wanted, static_cast<double>(density.least), static_cast<double>(density.most)));
}

std::vector<Vec3> area_samples(const TriangleSoup& soup, std::size_t count) {
  constexpr double kPhi = 0.61803398874989484820;  // 1 / golden ratio
  constexpr double kFirst = 0.75487766624669276;   // powers of 1 / (the root of x^3 = x + 1)
  constexpr double kSecond = 0.56984029099805327;
  std::vector<Vec3> out;
  const double area = area_of(soup);
  if (!(area > 0.0) || !std::isfinite(area)) return out;
  out.reserve(count);
  const double stretch = area / static_cast<double>(count);
  std::size_t t = 0;
  double before = 0.0, here = area_of_triangle(soup, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const double at = (static_cast<double>(k) + recurrence(k, kPhi)) * stretch;
    while (t + 1 < soup.size() && (at >= before + here || here <= 0.0)) {
      before += here;
      here = area_of_triangle(soup, ++t);
    }
    double u = recurrence(k, kFirst), v = recurrence(k, kSecond);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 a = soup.corner(t, 0), b = soup.corner(t, 1), c = soup.corner(t, 2);
    out.push_back(a + u * (b - a) + v * (c - a));
  }
  return out;
}

}  // namespace popcut
