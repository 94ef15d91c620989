// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "core/design/target/expression.hpp"
#include "core/design/target/solid_triangles.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {
namespace {

constexpr int kCells = 192;

/// One plane of a solid, in mm of the corner.
class SolidSlice {
 public:
  SolidSlice(const SolidFunction& solid, const PlacementMap& map, double scale_mm, double s_mm)
      : solid_(solid), map_(map), scale_mm_(scale_mm), s_mm_(s_mm) {}

  [[nodiscard]] bool inside(double x, double z) const {
    const auto q = map_.to_surface({x, s_mm_, z});
    return solid_(q[0], q[1], q[2]) < 0.0;  // not a number is outside
  }

  [[nodiscard]] Result<SurfaceSlice> cut(FitMode mode, const char* what) const {
    const std::string place = fmt::format("/surface at s = {:.6g} mm", s_mm_);
    auto reach = find_reach(place, what);
    if (!reach) return tl::unexpected(reach.error());
    const Section section = march((*reach)[0], (*reach)[1]);
    auto fitted = fit_section(section, mode, place, what);
    if (fitted && fitted->fit.unreachable_mm == 0.0) refine(*fitted);
    return fitted;
  }

 private:
  /// The box of the corner that holds the section: from rays about the corner's edge, then widened
  /// until the solid no longer leaves it.
  [[nodiscard]] Result<std::array<double, 2>> find_reach(const std::string& place,
                                                         const char* what) const {
    constexpr int kRays = 48;
    constexpr double kLeast = 1e-3, kMost = 1e4, kGrowth = 1.04;  // in units of the surface
    double most_x = 0.0, most_z = 0.0;
    for (int k = 0; k <= kRays; ++k) {
      const double angle = 0.5 * std::numbers::pi * k / kRays;
      const double cx = k == kRays ? 0.0 : std::cos(angle), cz = k == 0 ? 0.0 : std::sin(angle);
      for (double r = kLeast * scale_mm_; r < kMost * scale_mm_; r *= kGrowth)
        if (inside(r * cx, r * cz))
          most_x = std::max(most_x, r * cx), most_z = std::max(most_z, r * cz);
    }
    if (most_x == 0.0 && most_z == 0.0)
      return fail(ErrorKind::Infeasible, place,
                  fmt::format("no part of the {} is in the corner x > 0, z > 0 there; move it with "
                              "translate_mm, or use fewer or narrower slices",
                              what),
                  ErrorReason::Misplaced);
    std::array<double, 2> reach{1.05 * std::max(most_x, 0.02 * most_z),
                                1.05 * std::max(most_z, 0.02 * most_x)};
    for (int round = 0; round < 60; ++round) {
      const bool leaves_x = leaves(reach, true), leaves_z = leaves(reach, false);
      if (!leaves_x && !leaves_z) return reach;
      if (leaves_x) reach[0] *= 1.2;
      if (leaves_z) reach[1] *= 1.2;
      if (std::max(reach[0], reach[1]) > kMost * scale_mm_) break;
    }
    return fail(ErrorKind::Infeasible, place,
                fmt::format("the {} does not end within {:g} mm of the corner; it must be a solid "
                            "part that wall and ground can hold",
                            what, kMost * scale_mm_));
  }

  [[nodiscard]] double value(double x, double z) const {
    const auto q = map_.to_surface({x, s_mm_, z});
    const double at = solid_(q[0], q[1], q[2]);
    return std::isnan(at) ? std::numeric_limits<double>::infinity() : at;
  }

  [[nodiscard]] bool leaves(const std::array<double, 2>& reach, bool at_x) const {
    return dips_below_zero(
        [&](double along) { return at_x ? value(reach[0], along) : value(along, reach[1]); },
        reach[at_x ? 1 : 0], kCells);
  }

  /// Where the boundary crosses between a point inside and one outside.
  [[nodiscard]] SectionPoint crossing(SectionPoint in, SectionPoint out) const {
    for (int k = 0; k < 44; ++k) {
      const SectionPoint middle{0.5 * (in.x + out.x), 0.5 * (in.z + out.z)};
      (inside(middle.x, middle.z) ? in : out) = middle;
    }
    return {0.5 * (in.x + out.x), 0.5 * (in.z + out.z)};
  }

  /// Marching squares (Lorensen and Cline 1987, in the plane). Of the two ways through a cell with
  /// opposite corners inside, the one that keeps them apart is taken.
  [[nodiscard]] Section march(double reach_x, double reach_z) const {
    Section section;
    const double touch_mm = 1e-9 * (reach_x + reach_z);
    const auto point = [&](int i, int j) {
      return SectionPoint{reach_x * i / kCells, reach_z * j / kCells};
    };
    constexpr int kRow = kCells + 1;
    std::array<bool, kRow> below{}, above{};
    std::array<SectionPoint, kRow> low{}, high{};  // crossings on the horizontal edges
    const auto fill = [&](int j, std::array<bool, kRow>& row,
                          std::array<SectionPoint, kRow>& cross) {
      for (int i = 0; i < kRow; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const SectionPoint p = point(i, j);
        row[at] = inside(p.x, p.z);
        if (i > 0 && row[at] != row[at - 1])
          cross[at - 1] = row[at] ? crossing(p, point(i - 1, j)) : crossing(point(i - 1, j), p);
      }
    };
    fill(0, below, low);
    for (int j = 0; j < kCells; ++j) {
      fill(j + 1, above, high);
      SectionPoint left{};
      for (int i = 0; i < kRow; ++i) {
        const auto at = static_cast<std::size_t>(i);
        SectionPoint right{};
        if (below[at] != above[at])
          right = below[at] ? crossing(point(i, j), point(i, j + 1))
                            : crossing(point(i, j + 1), point(i, j));
        if (i > 0)
          add_cell({below[at - 1], below[at], above[at], above[at - 1]},
                   {low[at - 1], right, high[at - 1], left}, touch_mm, section);
        left = right;
      }
      std::swap(below, above), std::swap(low, high);
    }
    return section;
  }

  /// Corners and edge crossings counter-clockwise from the lower left corner and the lower edge.
  static void add_cell(const std::array<bool, 4>& corner, const std::array<SectionPoint, 4>& edge,
                       double touch_mm, Section& section) {
    const int count = corner[0] + corner[1] + corner[2] + corner[3];
    if (count == 0 || count == 4) return;
    if (count == 2 && corner[0] == corner[2]) {
      const std::size_t odd = corner[0] ? 0 : 1;  // a corner that is inside, and its opposite
      add_clipped(section, edge[odd == 0 ? 3 : 0], edge[odd], touch_mm);
      add_clipped(section, edge[odd + 1], edge[odd + 2], touch_mm);
      return;
    }
    std::array<SectionPoint, 2> ends;
    std::size_t found = 0;
    for (std::size_t k = 0; k < 4 && found < 2; ++k)
      if (corner[k] != corner[(k + 1) % 4]) ends[found++] = edge[k];
    add_clipped(section, ends[0], ends[1], touch_mm);
  }

  /// The same curve from the solid itself: along each line of constant t the crossing nearest to
  /// the curve that marching found.
  void refine(SurfaceSlice& slice) const {
    const SliceCurve rough = slice.curve;
    const double h = end_on_wall(rough.h(), true), d = end_on_wall(rough.d(), false);
    bool found = h > 0.0 && d > 0.0;
    const auto x_at = [&](double t) {
      const auto on = [&](double n) { return SectionPoint{0.5 * d * (n + t), 0.5 * h * (n - t)}; };
      const CurveJet c = rough.at(std::clamp(t, -1.0, 1.0));
      const double near = c.x / d + c.z / h;
      double step = 1e-5;
      const auto is_inside = [&](double n) {
        const SectionPoint p = on(n);
        return inside(std::max(0.0, p.x), std::max(0.0, p.z));
      };
      double in = near - step, out = near + step;
      for (int k = 0; k < 8 && (!is_inside(in) || is_inside(out)); ++k) {
        step *= 2.0;
        in = std::max(near - step, std::abs(t)), out = near + step;
      }
      if (!is_inside(in) || is_inside(out)) {
        found = found && 1.0 - std::abs(t) < 1e-4;  // at the very ends rounding decides
        return std::clamp(0.5 * d * (near + t), 0.0, d);
      }
      for (int k = 0; k < 52; ++k) {
        const double middle = 0.5 * (in + out);
        (is_inside(middle) ? in : out) = middle;
      }
      return std::clamp(0.5 * d * (0.5 * (in + out) + t), 0.0, d);
    };
    if (!found) return;
    SliceCurve fine = SliceCurve::sampled(h, d, x_at, 1e-12, 7);
    for (int k = 1; k < 200; ++k) {  // a formula that is rough at every scale keeps the rough curve
      const CurveJet a = fine.at(-1.0 + 0.01 * k), b = rough.at(-1.0 + 0.01 * k);
      found = found && std::abs(a.x - b.x) < 1e-3 * d && std::abs(a.z - b.z) < 1e-3 * h;
    }
    if (!found) return;
    slice.fit.rms_mm = slice.fit.max_mm = 0.0;
    slice.curve = std::move(fine);
  }

  /// The end on the wall (or ground) to all digits, from one that is nearly right; 0 for none.
  [[nodiscard]] double end_on_wall(double near, bool wall) const {
    const auto on = [&](double a) { return wall ? SectionPoint{0.0, a} : SectionPoint{a, 0.0}; };
    const SectionPoint in = on(near * (1.0 - 1e-4)), out = on(near * (1.0 + 1e-4));
    if (!inside(in.x, in.z) || inside(out.x, out.z)) return 0.0;
    const SectionPoint p = crossing(in, out);
    return wall ? p.z : p.x;
  }

  const SolidFunction& solid_;
  const PlacementMap& map_;
  double scale_mm_, s_mm_;
};

}  // namespace

Surface surface_of_solid(SolidFunction solid, const TargetPlacement& placement, FitMode fit,
                         const char* what) {
  const PlacementMap map(placement);
  const auto shared = std::make_shared<const SolidFunction>(std::move(solid));
  const auto cut = [shared, map, scale = placement.scale_mm, fit, what](double s_mm) {
    return SolidSlice(*shared, map, scale, s_mm).cut(fit, what);
  };
  return Surface(cut, [shared, map](const TargetStretch& stretch) {
    return solid_triangles(
        [&](const Vec3& p) {
          const auto q = map.to_surface({p[0], p[1], p[2]});
          return (*shared)(q[0], q[1], q[2]);
        },
        stretch);
  });
}

Result<Surface> surface_implicit(const ImplicitSpec& spec, const TargetPlacement& placement,
                                 FitMode fit) {
  auto f = Expression::parse(spec.f, {"x", "y", "z"});
  if (!f) return tl::unexpected(within("/surface/f", f.error()));
  auto shared = std::make_shared<Expression>(std::move(*f));
  return surface_of_solid([shared](double x, double y, double z) { return (*shared)(x, y, z); },
                          placement, fit, "solid");
}

}  // namespace popcut
