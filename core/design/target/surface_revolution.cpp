// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/design/spline/monotone_spline.hpp"
#include "core/design/target/expression.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/design_angle.hpp"

namespace popcut {
namespace {

/// The circle about the spine from the ground to the wall: a quarter ellipse's like in oblique
/// coordinates, `n^2 cos^2(a/2) + t^2 sin^2(a/2) = 1` for the angle a. It falls up to 90 degrees.
SliceCurve sector(double r_mm, double angle_rad) {
  const double c = std::cos(0.5 * angle_rad), s = std::sin(0.5 * angle_rad);
  return SliceCurve::sampled(
      r_mm, r_mm, [&](double t) { return 0.5 * r_mm * (std::sqrt(1.0 - s * s * t * t) / c + t); });
}

/// The radius by y, in units of the surface, and where it is known to be.
struct Radius {
  std::function<double(double)> at;
  std::string domain;  ///< "; its points reach from y = 0 to 90"

  double operator()(double y) const { return at(y); }
};

Result<Radius> radius_of(const RevolutionSpec& spec) {
  if (const auto* points = std::get_if<CurvePoints>(&spec.radius)) {
    const MonotoneSpline spline(*points);
    return Radius{spline, fmt::format("; its points reach from y = {:g} to {:g}", spline.first(),
                                      spline.last())};
  }
  std::vector<std::string> variables{"y"};
  if (spec.length) variables.emplace_back("L");
  auto formula = Expression::parse(std::get<std::string>(spec.radius), variables);
  if (!formula) return tl::unexpected(within("/surface/radius", formula.error()));
  // std::function needs a copyable callable, an Expression is not one.
  auto shared = std::make_shared<Expression>(std::move(*formula));
  return Radius{
      [shared, length = spec.length.value_or(0.0)](double y) { return (*shared)(y, length); }, {}};
}

Result<double> radius_at(const Radius& radius, double scale_mm, double s_mm, double y) {
  const double r_mm = scale_mm * radius(y);
  const std::string place = fmt::format("/surface/radius at s = {:.6g} mm", s_mm);
  if (!std::isfinite(r_mm))
    return fail(
        ErrorKind::OutOfRange, place,
        fmt::format("the radius is not a number at y = {:.6g}{}; it must be finite and positive "
                    "there: fewer or narrower slices, or another radius",
                    y, radius.domain),
        std::isnan(r_mm) ? ErrorReason::Misplaced : ErrorReason::None);
  if (r_mm <= 0.0)
    return fail(
        ErrorKind::OutOfRange, place,
        fmt::format("the radius is {:.6g} mm at y = {:.6g}; it must be positive there", r_mm, y),
        ErrorReason::Misplaced);
  return r_mm;
}

/// Places along the spine between which chords stray by `stretch.finest_mm` at most, as far as a
/// thousand places allow, with the ends of the radius' domain among them.
template <typename RadiusMm>
std::vector<double> stations_of(const RadiusMm& radius, const TargetStretch& stretch) {
  constexpr std::size_t kLeast = 64, kMost = 1024;
  const auto is_valid = [&](double s) { return radius(s) >= 0.0 && std::isfinite(radius(s)); };
  const double length = stretch.to_mm - stretch.from_mm;
  std::size_t count = kLeast;
  for (; count < kMost; count *= 2) {
    double most = 0.0;
    const double step = length / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const double s = stretch.from_mm + step * static_cast<double>(k);
      const double off = std::abs(radius(s + 0.5 * step) - 0.5 * (radius(s) + radius(s + step)));
      if (off > most) most = off;  // not where one of them is not a number
    }
    if (most <= stretch.finest_mm) break;
  }
  std::vector<double> out;
  for (std::size_t k = 0; k <= count; ++k) {
    const double s = stretch.from_mm + length * static_cast<double>(k) / static_cast<double>(count);
    if (!out.empty() && is_valid(s) != is_valid(out.back())) {
      double in = is_valid(s) ? s : out.back(), outside = is_valid(s) ? out.back() : s;
      for (int n = 0; n < 50; ++n) {
        const double middle = 0.5 * (in + outside);
        (is_valid(middle) ? in : outside) = middle;
      }
      out.push_back(in);
    }
    out.push_back(s);
  }
  return out;
}

/// Circles of the radius from ground to wall, as bands between the stations, in oblique
/// coordinates. Where there is no radius, nothing.
template <typename RadiusMm>
TriangleSoup circle_bands(const RadiusMm& radius, double angle_rad, const TargetStretch& stretch) {
  constexpr double kLeast = 48.0, kMost = 256.0;
  const double largest = std::max(stretch.reach_x_mm, stretch.reach_z_mm);
  const double angle = std::sqrt(8.0 * stretch.finest_mm / largest);  // sagitta r angle^2 / 8
  const int pieces = static_cast<int>(std::clamp(std::ceil(angle_rad / angle), kLeast, kMost));
  const DesignAngle opening = DesignAngle::of_rad(angle_rad);
  std::vector<double> cosine, sine;
  for (int k = 0; k <= pieces; ++k) {
    cosine.push_back(k == pieces ? opening.cosine : std::cos(angle_rad * k / pieces));
    sine.push_back(std::sin(angle_rad * k / pieces));
    if (!opening.is_right()) opening.to_oblique(cosine.back(), sine.back());
  }
  TriangleSoup out;
  const std::vector<double> stations = stations_of(radius, stretch);
  for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
    const double v0 = stations[k], v1 = stations[k + 1], r0 = radius(v0), r1 = radius(v1);
    if (!(r0 >= 0.0 && r1 >= 0.0) || !std::isfinite(r0 + r1)) continue;
    for (std::size_t i = 0; i + 1 < cosine.size(); ++i)
      out.add({r0 * cosine[i], v0, r0 * sine[i]}, {r0 * cosine[i + 1], v0, r0 * sine[i + 1]},
              {r1 * cosine[i + 1], v1, r1 * sine[i + 1]}, {r1 * cosine[i], v1, r1 * sine[i]});
  }
  return out;
}

}  // namespace

Result<Surface> surface_revolution(const RevolutionSpec& spec, const TargetPlacement& placement,
                                   FitMode fit) {
  const auto made = radius_of(spec);
  if (!made) return tl::unexpected(made.error());
  const Radius& radius = *made;
  const Surface solid = surface_of_solid(
      [radius](double x, double y, double z) {
        const double r = radius(y);
        return r > 0.0 ? x * x + z * z - r * r : 1.0;
      },
      placement, fit, "revolution");
  if (!stays_on_spine(placement)) return solid;
  const double angle_deg = placement.design_angle_deg;
  if (angle_deg > 90.0 && fit == FitMode::Exact)
    return fail(ErrorKind::Infeasible, "/design_angle_deg",
                fmt::format("is {:g}; over 90 degrees no falling curve follows a circle about the "
                            "spine. Use at most 90, or \"fit\": \"nearest\"",
                            angle_deg));
  const double angle_rad = psi_rad_of(angle_deg);
  const auto cut = [radius, placement, angle_deg, angle_rad,
                    solid](double s_mm) -> Result<SurfaceSlice> {
    const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
    const auto r_mm = radius_at(radius, placement.scale_mm, s_mm, y);
    if (!r_mm) return tl::unexpected(r_mm.error());
    if (angle_deg > 90.0) return solid.cut(s_mm);
    return SurfaceSlice{angle_deg == 90.0 ? SliceCurve(*r_mm, *r_mm) : sector(*r_mm, angle_rad),
                        {}};
  };
  return Surface(cut, [radius, placement, angle_rad](const TargetStretch& stretch) {
    const auto radius_mm = [&](double s_mm) {
      const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
      return placement.scale_mm * radius(y);
    };
    return circle_bands(radius_mm, angle_rad, stretch);
  });
}

}  // namespace popcut
