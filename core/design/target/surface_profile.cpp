// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "core/design/target/expression.hpp"
#include "core/design/target/solid_triangles.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {
namespace {

std::string at_s(double s_mm) { return fmt::format("/surface/z at s = {:.6g} mm", s_mm); }

constexpr double kMostDepth = 100.0;  ///< a profile deeper than this many heights never lands

/// One plane of a profile: z(x) in mm at a fixed s, and how it reaches the ground.
class ProfileSlice {
 public:
  ProfileSlice(const Expression& z, double scale_mm, double s_mm, double y)
      : z_(z), scale_mm_(scale_mm), s_mm_(s_mm), y_(y) {}

  [[nodiscard]] double operator()(double x_mm) const {
    return scale_mm_ * z_(x_mm / scale_mm_, y_);
  }

  /// Where `curve` ends on the ground, mm; infinite where there is none.
  [[nodiscard]] double end_mm() const {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    const double h = (*this)(0.0);
    if (!std::isfinite(h) || h <= 0.0) return kEndless;
    const Result<double> d = ground_end(h);
    return d && check_falls(h, *d) ? *d : kEndless;
  }

  [[nodiscard]] Result<SliceCurve> curve() const {
    const double h = (*this)(0.0);
    if (!std::isfinite(h) || h <= 0.0)
      return fail(
          ErrorKind::OutOfRange, at_s(s_mm_),
          fmt::format("z(0, y) is {:.6g} mm at y = {:.6g}; the profile must start above the "
                      "ground at the wall",
                      h, y_),
          std::isinf(h) ? ErrorReason::None : ErrorReason::Misplaced);
    const Result<double> d = ground_end(h);
    if (!d) return tl::unexpected(d.error());
    if (auto falls = check_falls(h, *d); !falls) return tl::unexpected(falls.error());
    const auto height = [&, d = *d](double x) {
      const double value = x >= d ? 0.0 : (*this)(x);
      return std::isfinite(value) ? value : 0.0;  // only at the rim of the formula's domain
    };
    return SliceCurve::sampled(h, *d, [&, d = *d](double t) {
      const auto ahead = [&](double x) { return x / d - height(x) / h - t; };
      if (ahead(0.0) >= 0.0) return 0.0;
      if (ahead(d) <= 0.0) return d;
      std::uintmax_t most = 200;
      const auto bracket = boost::math::tools::toms748_solve(
          ahead, 0.0, d, boost::math::tools::eps_tolerance<double>(52), most);
      return 0.5 * (bracket.first + bracket.second);
    });
  }

 private:
  /// Where the profile meets the ground: the end of the first stretch on which z > 0 and falls.
  [[nodiscard]] Result<double> ground_end(double h) const {
    double inside = 0.0, outside = 0.0, before = 0.0;
    for (double x = h / 256.0; x < kMostDepth * h; x = 1.01 * x + h / 256.0) {
      const double here = (*this)(x);
      if (here > (*this)(inside)) {
        if (const std::optional<double> touch = lowest(before, x, h)) return *touch;
      }
      if (!(here > 0.0)) {
        outside = x;
        break;
      }
      before = inside;
      inside = x;
    }
    if (outside == 0.0)
      return fail(
          ErrorKind::Infeasible, at_s(s_mm_),
          fmt::format(
              "the profile stays above the ground up to x = {:.6g} mm; it must fall to "
              "z = 0. If it rises away from the wall, turn it round (write D - x for x, with "
              "the depth D of your shape), or use \"fit\": \"nearest\", which takes the nearest "
              "shape that falls",
              kMostDepth * h));
    for (int k = 0; k < 200 && inside < outside; ++k) {
      const double middle = 0.5 * (inside + outside);
      if (middle <= inside || middle >= outside) break;
      ((*this)(middle) > 0.0 ? inside : outside) = middle;
    }
    const double left = (*this)(inside);
    // A root like (1 - x^8)^(1/8) is still high one rounding before its end, but it does fall
    // there.
    const bool falls_at_rim = left < 0.5 * (*this)(inside * (1.0 - 1e-6));
    if (inside <= 0.0 || (left > 1e-6 * h && !falls_at_rim))
      return fail(
          ErrorKind::Infeasible, at_s(s_mm_),
          fmt::format("the profile breaks off at x = {:.6g} mm, {:.6g} mm above the ground; it "
                      "must fall to z = 0",
                      inside, left));
    return inside;
  }

  /// Where the profile touches the ground without going through it, as a concave arc does.
  [[nodiscard]] std::optional<double> lowest(double from, double to, double h) const {
    const auto [x, z] = boost::math::tools::brent_find_minima(*this, from, to, 52);
    if (!(z < 1e-9 * h)) return std::nullopt;
    // A minimum's place is known to half the digits only; the root of a five-point slope to all.
    const double step = 1e-3 * h;
    const auto slope = [&](double p) {
      return 8.0 * ((*this)(p + step) - (*this)(p - step)) -
             ((*this)(p + 2.0 * step) - (*this)(p - 2.0 * step));
    };
    const double near = 1e-5 * h;
    if (!(slope(x - near) < 0.0) || !(slope(x + near) > 0.0)) return x;
    std::uintmax_t most = 100;
    const auto bracket = boost::math::tools::toms748_solve(
        slope, x - near, x + near, boost::math::tools::eps_tolerance<double>(50), most);
    return 0.5 * (bracket.first + bracket.second);
  }

  [[nodiscard]] Result<void> check_falls(double h, double d) const {
    constexpr int kSamples = 512;
    double last = h;
    for (int k = 1; k < kSamples; ++k) {
      const double x = d * k / kSamples;
      const double here = (*this)(x);
      if (!std::isfinite(here))
        return fail(
            ErrorKind::OutOfRange, at_s(s_mm_),
            fmt::format("z is not a number at x = {:.6g} mm; it must be finite from the wall to "
                        "the ground",
                        x));
      if (here > last + 1e-9 * h)
        return fail(
            ErrorKind::Infeasible, at_s(s_mm_),
            fmt::format(
                "the profile rises near x = {:.6g} mm (from {:.6g} to {:.6g} mm); it "
                "must fall all the way from the wall to the ground, or \"fit\": \"nearest\" "
                "takes the nearest that does",
                x, last, here));
      last = here;
    }
    return {};
  }

  const Expression& z_;
  double scale_mm_, s_mm_, y_;
};

/// Where the curves of a profile end on the ground, over a stretch of the spine.
class GroundEnds {
 public:
  GroundEnds(const Expression& z, const TargetPlacement& placement, const TargetStretch& stretch)
      : from_mm_(stretch.from_mm), step_mm_((stretch.to_mm - stretch.from_mm) / kSteps) {
    for (std::size_t k = 0; k < end_mm_.size(); ++k) {
      const double s_mm = from_mm_ + step_mm_ * static_cast<double>(k);
      const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
      end_mm_[k] = ProfileSlice(z, placement.scale_mm, s_mm, y).end_mm();
    }
  }

  /// How far forward the profile surely has ended, mm.
  [[nodiscard]] double before_mm(double s_mm) const {
    const double at = step_mm_ > 0.0 ? (s_mm - from_mm_) / step_mm_ : 0.0;
    const auto k = static_cast<std::size_t>(std::clamp(at, 0.0, kSteps - 1.0));
    const auto [low, high] = std::minmax(end_mm_[k], end_mm_[k + 1]);
    return std::isinf(high) ? high : high + (high - low);
  }

 private:
  static constexpr int kSteps = 128;
  double from_mm_, step_mm_;
  std::array<double, kSteps + 1> end_mm_{};
};

}  // namespace

Result<Surface> surface_profile(const ProfileSpec& spec, const TargetPlacement& placement,
                                FitMode fit) {
  if (const auto* points = std::get_if<CurvePoints>(&spec.z))
    return surface_loft({{{0.0, *points}}}, placement, fit);
  auto z = Expression::parse(std::get<std::string>(spec.z), {"x", "y"});
  if (!z) return tl::unexpected(within("/surface/z", z.error()));
  auto shared = std::make_shared<Expression>(std::move(*z));
  const auto below = [shared](double x, double y, double height) {
    return height - (*shared)(x, y);
  };
  Surface solid = surface_of_solid(below, placement, fit, "profile");
  if (!stays_upright(placement)) return solid;
  const auto cut = [shared, placement, fit, solid](double s_mm) -> Result<SurfaceSlice> {
    const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
    auto curve = ProfileSlice(*shared, placement.scale_mm, s_mm, y).curve();
    if (curve) return SurfaceSlice{std::move(*curve), {}};
    if (fit == FitMode::Exact || curve.error().kind != ErrorKind::Infeasible)
      return tl::unexpected(curve.error());
    return solid.cut(s_mm);
  };
  return Surface(cut, [shared, placement, below](const TargetStretch& stretch) {
    const PlacementMap map(placement);
    const GroundEnds ends(*shared, placement, stretch);
    return solid_triangles(
        [&](const Vec3& p) {
          const auto q = map.to_surface({p[0], p[1], p[2]});
          const double value = below(q[0], q[1], q[2]);
          // A profile that rises once more where it has met the ground is not its curves' shape.
          const double end_mm = value < 0.0 ? ends.before_mm(p[1]) : p[0];
          return p[0] > end_mm ? p[0] - end_mm : value;
        },
        stretch);
  });
}

}  // namespace popcut
