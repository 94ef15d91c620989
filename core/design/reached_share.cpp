// SPDX-License-Identifier: MIT
#include "core/design/reached_share.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

using Vec = std::array<double, 3>;

Vec corner_of(const TriangleMesh& mesh, std::size_t triangle, std::size_t corner) {
  const float* const p = mesh.corners.data() + 9 * triangle + 3 * corner;
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

double area_of(const Vec& a, const Vec& b, const Vec& c) {
  const Vec p = minus(b, a), q = minus(c, a);
  return 0.5 * std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                          p[0] * q[1] - p[1] * q[0]);
}

double fraction(double value) { return value - std::floor(value); }

/// Squared distance of a point of the section from a piece of a profile.
double square_distance(SectionPoint p, SectionPoint a, SectionPoint b) {
  const double ux = b.x - a.x, uz = b.z - a.z;
  const double length = ux * ux + uz * uz;
  const double share =
      length > 0.0 ? std::clamp(((p.x - a.x) * ux + (p.z - a.z) * uz) / length, 0.0, 1.0) : 0.0;
  const double dx = p.x - a.x - share * ux, dz = p.z - a.z - share * uz;
  return dx * dx + dz * dz;
}

/// Whether a profile comes within `near_mm` of a point. A falling profile is sorted by x - z, which
/// changes by at most sqrt(2) times the distance, so that only a window of it is looked at.
bool comes_near(const std::vector<SectionPoint>& profile, SectionPoint p, double near_mm) {
  const double t = p.x - p.z, window = std::sqrt(2.0) * near_mm;
  const auto first =
      std::partition_point(profile.begin(), profile.end(),
                           [&](const SectionPoint& q) { return q.x - q.z < t - window; });
  auto k = static_cast<std::size_t>(first - profile.begin());
  for (k = k > 0 ? k - 1 : 0; k + 1 < profile.size(); ++k) {
    if (profile[k].x - profile[k].z > t + window) return false;
    if (square_distance(p, profile[k], profile[k + 1]) <= near_mm * near_mm) return true;
  }
  return false;
}

}  // namespace

AreaPoints area_points(const TriangleMesh& mesh, std::size_t count) {
  std::vector<double> sum(mesh.size() + 1, 0.0);
  for (std::size_t t = 0; t < mesh.size(); ++t)
    sum[t + 1] =
        sum[t] + area_of(corner_of(mesh, t, 0), corner_of(mesh, t, 1), corner_of(mesh, t, 2));
  AreaPoints out;
  if (!(sum.back() > 0.0)) return out;
  constexpr double kFirst = 0.8191725133961645, kSecond = 0.6710436067037893,
                   kThird = 0.5497004779019703;  // powers of the root of x^4 = x + 1
  out.reserve(count);
  std::size_t t = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double n = static_cast<double>(k);
    const double at = sum.back() * (n + fraction(0.5 + n * kFirst)) / static_cast<double>(count);
    while (t + 1 < mesh.size() && sum[t + 1] <= at) ++t;
    double u = fraction(0.5 + n * kSecond), v = fraction(0.5 + n * kThird);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec a = corner_of(mesh, t, 0), b = minus(corner_of(mesh, t, 1), a),
              c = minus(corner_of(mesh, t, 2), a);
    out.push_back(
        {a[0] + u * b[0] + v * c[0], a[1] + u * b[1] + v * c[1], a[2] + u * b[2] + v * c[2]});
  }
  return out;
}

std::vector<ProfileStrip> profile_strips(const Strips& strips, std::span<const double> s_mm) {
  // A slice alone lies in two halves: its centre line is between them.
  std::vector<double> v(s_mm.size(), 0.0), halves(s_mm.size(), 0.0);
  for (std::size_t k = 0; k < strips.size(); ++k) {
    if (strips.kind[k] != StripKind::Slice && strips.kind[k] != StripKind::Box) continue;
    const auto j = static_cast<std::size_t>(strips.slice[k]);
    v[j] += 0.5 * (strips.v_begin[k] + strips.v_begin[k + 1]);
    halves[j] += 1.0;
  }
  for (std::size_t j = 0; j < v.size(); ++j) v[j] /= std::max(1.0, halves[j]);
  const auto along = [&](double at) {
    const auto after =
        static_cast<std::size_t>(std::upper_bound(v.begin(), v.end(), at) - v.begin());
    if (after == 0) return s_mm.front() + (at - v.front());
    if (after == v.size()) return s_mm.back() + (at - v.back());
    const double share = (at - v[after - 1]) / (v[after] - v[after - 1]);
    return s_mm[after - 1] + share * (s_mm[after] - s_mm[after - 1]);
  };
  std::vector<ProfileStrip> out;
  for (std::size_t k = 0; k < strips.size() && !s_mm.empty(); ++k) {
    if (strips.kind[k] == StripKind::Margin) continue;
    ProfileStrip strip{along(strips.v_begin[k]), along(strips.v_begin[k + 1]), {}};
    for (std::uint32_t p = strips.first_panel[k]; p < strips.first_panel[k + 1]; ++p) {
      if (strips.plane[p] == kWallPlane || strips.plane[p] == kGroundPlane) continue;
      const std::size_t q = p + k;
      if (strip.profile.empty()) strip.profile.push_back({strips.x[q], strips.z[q]});
      strip.profile.push_back({strips.x[q + 1], strips.z[q + 1]});
    }
    out.push_back(std::move(strip));
  }
  return out;
}

double reached_share(const AreaPoints& surface, std::span<const ProfileStrip> strips,
                     double near_mm) {
  std::size_t counted = 0, reached = 0;
  const double on_card = 1e-5 * near_mm;
  for (const Vec& p : surface) {
    if (std::abs(p[0]) <= on_card || std::abs(p[2]) <= on_card) continue;
    ++counted;
    auto strip = std::partition_point(strips.begin(), strips.end(), [&](const ProfileStrip& s) {
      return s.end_mm < p[1] - near_mm;
    });
    for (; strip != strips.end() && strip->begin_mm <= p[1] + near_mm; ++strip) {
      const double beside = std::max({0.0, strip->begin_mm - p[1], p[1] - strip->end_mm});
      const double left = std::sqrt(std::max(0.0, near_mm * near_mm - beside * beside));
      if (!comes_near(strip->profile, {p[0], p[2]}, left)) continue;
      ++reached;
      break;
    }
  }
  return counted > 0 ? static_cast<double>(reached) / static_cast<double>(counted) : 0.0;
}

}  // namespace popcut
