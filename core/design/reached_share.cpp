// SPDX-License-Identifier: MIT
#include "core/design/reached_share.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/design/shape_fit.hpp"
#include "core/fit/area_samples.hpp"

namespace popcut {
namespace {

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

std::vector<Vec3> area_points(const TriangleMesh& mesh, std::size_t count) {
  return area_samples(TriangleSoup{{mesh.corners.begin(), mesh.corners.end()}}, count);
}

std::vector<ProfileStrip> profile_strips(const Strips& strips, std::span<const double> s_mm) {
  const SpineMap along(strips, s_mm);
  std::vector<ProfileStrip> out;
  for (std::size_t k = 0; k < strips.size(); ++k) {
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

double reached_share(std::span<const Vec3> surface, std::span<const ProfileStrip> strips,
                     double near_mm) {
  std::size_t counted = 0, reached = 0;
  const double on_card = 1e-5 * near_mm;
  for (const Vec3& p : surface) {
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
