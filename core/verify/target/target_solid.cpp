// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

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

  void add_triangles(const TargetReach& reach, TriangleMesh& out) const override {
    TargetReach box = reach;
    constexpr int kWidenings = 4;
    for (int k = 0; k < kWidenings; ++k) {
      Cells cells(*this, box);
      if (k + 1 < kWidenings && cells.reaches_x()) {
        box.x_mm *= 1.5;
      } else if (k + 1 < kWidenings && cells.reaches_z()) {
        box.z_mm *= 1.5;
      } else {
        cells.add_border(out);
        return;
      }
    }
  }

 private:
  [[nodiscard]] bool inside(double s, double x, double z) const {
    const auto q = frame_.to_surface({x, s, z});
    return f_(q[0], q[1], q[2]) < 0.0;
  }

  /// A grid of signs over the corner, and the border between its two kinds by tetrahedra.
  class Cells {
   public:
    Cells(const Solid& solid, const TargetReach& reach) : solid_(solid), low_s_(reach.begin_mm) {
      constexpr double kAlongTheLongest = 96.0;
      const double length = reach.end_mm - reach.begin_mm;
      step_ = std::max({reach.x_mm, reach.z_mm, length}) / kAlongTheLongest;
      const auto cells = [&](double mm) {
        return std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(mm / step_)));
      };
      count_ = {cells(reach.x_mm) + 1, cells(length) + 1, cells(reach.z_mm) + 1};
      last_s_ = reach.end_mm;
      inside_.resize(count_[0] * count_[1] * count_[2]);
      for (std::size_t k = 0; k < count_[2]; ++k)
        for (std::size_t j = 0; j < count_[1]; ++j)
          for (std::size_t i = 0; i < count_[0]; ++i) {
            const auto p = place({i, j, k});
            inside_[index({i, j, k})] = solid.inside(p[1], p[0], p[2]) ? 1 : 0;
          }
    }

    [[nodiscard]] bool reaches_x() const { return any_inside(0); }
    [[nodiscard]] bool reaches_z() const { return any_inside(2); }

    // Six tetrahedra about a diagonal fill each cell; a plane cuts each in a triangle or two.
    void add_border(TriangleMesh& out) const {
      static constexpr std::array<std::array<std::size_t, 2>, 6> kWays{
          {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};  // corners between 0 and 7
      for (std::size_t k = 0; k + 1 < count_[2]; ++k)
        for (std::size_t j = 0; j + 1 < count_[1]; ++j)
          for (std::size_t i = 0; i + 1 < count_[0]; ++i) {
            std::array<Node, 8> corner;
            std::size_t all = 0;
            for (std::size_t c = 0; c < 8; ++c) {
              corner[c] = {i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)};
              all += inside_[index(corner[c])];
            }
            if (all == 0 || all == 8) continue;
            for (const auto& [a, b] : kWays)
              add_tetrahedron({corner[0], corner[a], corner[b], corner[7]}, out);
          }
    }

   private:
    using Node = std::array<std::size_t, 3>;
    using Place = std::array<double, 3>;

    [[nodiscard]] std::size_t index(const Node& n) const {
      return (n[2] * count_[1] + n[1]) * count_[0] + n[0];
    }
    /// Oblique where the wall is: along the ground and along the wall.
    [[nodiscard]] Place place(const Node& n) const {
      const double along = step_ * static_cast<double>(n[0]);
      const double up = step_ * static_cast<double>(n[2]);
      const double s = std::min(last_s_, low_s_ + step_ * static_cast<double>(n[1]));
      return {along + up * solid_.wall_.cosine, s, up * solid_.wall_.sine};
    }
    /// Whether the solid is still there in the last layer, away from wall and ground.
    [[nodiscard]] bool any_inside(std::size_t axis) const {
      for (std::size_t k = 0; k < count_[2]; ++k)
        for (std::size_t j = 0; j < count_[1]; ++j)
          for (std::size_t i = 0; i < count_[0]; ++i)
            if ((axis == 0 ? i + 1 == count_[0] : k + 1 == count_[2]) &&
                inside_[index({i, j, k})] != 0)
              return true;
      return false;
    }
    [[nodiscard]] Place crossing(const Node& in, const Node& outside) const {
      Place a = place(in), b = place(outside);
      for (int round = 0; round < 24; ++round) {
        const Place middle{0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
        (solid_.inside(middle[1], middle[0], middle[2]) ? a : b) = middle;
      }
      return a;
    }
    void add_tetrahedron(const std::array<Node, 4>& corner, TriangleMesh& out) const {
      std::vector<Node> in, outside;
      for (const Node& n : corner) (inside_[index(n)] != 0 ? in : outside).push_back(n);
      const auto add = [&](const Place& a, const Place& b, const Place& c) {
        for (const Place* p : {&a, &b, &c})
          for (const double value : *p) out.corners.push_back(static_cast<float>(value));
      };
      if (in.size() == 1 || in.size() == 3) {
        const Node apex = in.size() == 1 ? in[0] : outside[0];
        const std::vector<Node>& base = in.size() == 1 ? outside : in;
        std::array<Place, 3> cut;
        for (std::size_t k = 0; k < 3; ++k)
          cut[k] = in.size() == 1 ? crossing(apex, base[k]) : crossing(base[k], apex);
        add(cut[0], cut[1], cut[2]);
      } else if (in.size() == 2) {
        const Place a = crossing(in[0], outside[0]), b = crossing(in[0], outside[1]),
                    c = crossing(in[1], outside[1]), d = crossing(in[1], outside[0]);
        add(a, b, c), add(a, c, d);
      }
    }

    const Solid& solid_;
    double low_s_, last_s_{}, step_{};
    Node count_{};
    std::vector<std::uint8_t> inside_;
  };

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
