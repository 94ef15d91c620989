// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <utility>

#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

constexpr double kMost = 1e4;  ///< largest size of a solid, in units of the surface

/// The border of a solid, found by the sign of its function.
class Solid : public TargetSurface {
 public:
  Solid(TargetFormula f, const TargetPlacement& placement)
      : f_(std::move(f)), frame_(placement), wall_(placement.wall), scale_(placement.scale_mm) {}

  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const Plane plane{*this, s_mm, x_mm, z_mm, inside(s_mm, x_mm, z_mm)};
    constexpr int kAngles = 32;
    constexpr double kGrowth = 1.3;
    const double start = 1e-13 * std::hypot(x_mm, z_mm) + 1e-15 * scale_;
    for (double r = start; r < kMost * scale_; r *= kGrowth) {
      double best = -1.0, best_angle = 0.0;
      for (int k = 0; k < kAngles; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / kAngles;
        if (!plane.differs(angle, r)) continue;
        const double found = plane.crossing(angle, r);
        if (best < 0.0 || found < best) best = found, best_angle = angle;
      }
      if (best >= 0.0) return plane.narrowed(best_angle, best, std::numbers::pi / kAngles);
    }
    return -1.0;
  }

  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    return {end(s_mm, true), end(s_mm, false)};
  }

 private:
  [[nodiscard]] bool inside(double s, double x, double z) const {
    const auto q = frame_.to_surface({x, s, z});
    return f_(q[0], q[1], q[2]) < 0.0;
  }

  /// One plane, seen from a point.
  struct Plane {
    const Solid& solid;
    double s, x, z;
    bool here;

    /// Whether the point in this direction is in the corner and on the other side of the border.
    [[nodiscard]] bool differs(double angle, double r) const {
      const double px = x + r * std::cos(angle), pz = z + r * std::sin(angle);
      return solid.wall_.ahead(px, pz) >= 0.0 && pz >= 0.0 && solid.inside(s, px, pz) != here;
    }
    [[nodiscard]] double crossing(double angle, double r) const {
      double near = 0.0, far = r;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (near + far);
        (differs(angle, middle) ? far : near) = middle;
      }
      return far;
    }
    /// Turns towards the nearest point of the border.
    [[nodiscard]] double narrowed(double angle, double best, double step) const {
      for (int k = 0; k < 26; ++k) {
        bool better = false;
        for (const double turned : {angle - step, angle + step}) {
          if (!differs(turned, best)) continue;
          best = crossing(turned, best), angle = turned, better = true;
          break;
        }
        if (!better) step *= 0.5;
      }
      return best;
    }
  };

  /// The farthest point of the solid on the wall or on the ground.
  [[nodiscard]] double end(double s, bool wall) const {
    const auto within = [&](double a) {
      return wall ? inside(s, a * wall_.cosine, a * wall_.sine) : inside(s, a, 0.0);
    };
    double in = -1.0, out = -1.0;
    double last = 0.0;
    for (double a = 1e-3 * scale_; a < kMost * scale_; a *= 1.01) {
      if (within(a)) {
        in = a;
      } else if (in == last && in > 0.0) {
        out = a;
      }
      last = a;
    }
    if (in < 0.0 || out < in) return -1.0;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (in + out);
      (within(middle) ? in : out) = middle;
    }
    return in;
  }

  TargetFormula f_;
  PlacedFrame frame_;
  TargetWall wall_;
  double scale_;
};

}  // namespace

std::unique_ptr<TargetSurface> solid_target(TargetFormula f, const TargetPlacement& placement) {
  return std::make_unique<Solid>(std::move(f), placement);
}

}  // namespace popcut::verify
