// SPDX-License-Identifier: MIT
#include "core/geometry/tent_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace popcut {
namespace {

constexpr double kOpen_rad = 0.5 * std::numbers::pi;
constexpr int kOpenings = 180;  ///< each half degree
constexpr int kPlaces = 60;     ///< of a strut that are tried

}  // namespace

double TentSection::roof_rad(double psi_rad) const {
  // From A to B, and the turn from there to Q by the law of cosines.
  const double x = strut_foot_mm * std::cos(psi_rad) - foot_mm,
               y = strut_foot_mm * std::sin(psi_rad), far = std::hypot(x, y);
  const double cosine =
      (strut_at_mm * strut_at_mm + far * far - strut_mm * strut_mm) / (2.0 * strut_at_mm * far);
  constexpr double kRounding = 1e-12;
  if (!(std::abs(cosine) <= 1.0 + kRounding)) return std::numeric_limits<double>::quiet_NaN();
  return std::atan2(y, x) - std::acos(std::clamp(cosine, -1.0, 1.0));
}

double TentSection::play_mm(double off_mm) const {
  const double s = std::sin(slope_rad), c = std::cos(slope_rad);
  const double strut_rad = std::atan2(strut_foot_mm - strut_at_mm * s, foot_mm - strut_at_mm * c);
  const double rise = std::sin(strut_rad), level = std::cos(strut_rad);
  // A fold that is off leaves a gap in the direction of tab and panel together; what of it lies
  // along the strut moves Q across the roof.
  const double at_eave = c * level - (1.0 - s) * rise, at_roof = 1.0 - (c * level + s * rise),
               at_foot = 1.0 - rise;
  return off_mm * std::hypot(at_eave, at_roof, at_foot) * roof_mm /
         (strut_at_mm * std::sin(slope_rad - strut_rad));
}

double TentSection::clearance_mm() const {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= kOpenings; ++k) {
    const double psi = kOpen_rad * k / kOpenings, roof = roof_rad(psi);
    if (std::isnan(roof)) return roof;
    least = std::min(least, foot_mm - roof_mm * std::sin(roof - psi) / std::sin(psi));
  }
  return least;
}

TentSection tent_at(double foot_mm, double roof_mm, double slope_rad, double strut_at_mm) {
  TentSection out{foot_mm, roof_mm, slope_rad, strut_at_mm, 0.0, 0.0};
  out.strut_foot_mm = foot_mm * strut_at_mm * (1.0 + std::cos(slope_rad)) /
                      (foot_mm + strut_at_mm * (1.0 - std::sin(slope_rad)));
  out.strut_mm = foot_mm + strut_at_mm - out.strut_foot_mm;
  return out;
}

std::optional<TentSection> firmest_tent(double foot_mm, double roof_mm, double slope_rad) {
  // `tent_at` with its foot at the height of the ridge, solved for strut_at.
  const double s = std::sin(slope_rad), c = std::cos(slope_rad);
  const double rest = foot_mm * (1.0 + c) - roof_mm * s * (1.0 - s);
  const double most = rest > 0.0 ? std::min(roof_mm, roof_mm * s * foot_mm / rest) : roof_mm;
  std::optional<TentSection> best;
  for (int k = 1; k <= kPlaces; ++k) {
    const TentSection tent = tent_at(foot_mm, roof_mm, slope_rad, most * k / kPlaces);
    if (!(tent.play_mm(1.0) > 0.0) || (best && tent.play_mm(1.0) >= best->play_mm(1.0))) continue;
    if (tent.clearance_mm() > 0.0) best = tent;
  }
  return best;
}

}  // namespace popcut
