// SPDX-License-Identifier: MIT
// Part of core/verify/target/target_surface.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

/// The four Bezier values of one stretch of a spline.
struct Arc {
  double from{}, to{};
  std::array<double, 4> b{};

  [[nodiscard]] double at(double place) const {
    const double t = std::clamp((place - from) / (to - from), 0.0, 1.0);
    std::array<double, 4> c = b;  // de Casteljau
    for (std::size_t left = 3; left > 0; --left)
      for (std::size_t k = 0; k < left; ++k) c[k] += t * (c[k + 1] - c[k]);
    return c[0];
  }
};

/// The spline of docs/geometry.md, section 3, in Bezier form: slopes are weighted harmonic means of
/// the chords' slopes, zero at a turn.
class Spline {
 public:
  explicit Spline(const TargetPoints& points) {
    const std::size_t n = points.size();
    const auto rise = [&](std::size_t k) {
      return (points[k + 1][1] - points[k][1]) / (points[k + 1][0] - points[k][0]);
    };
    const auto run = [&](std::size_t k) { return points[k + 1][0] - points[k][0]; };
    std::vector<double> slope(n, n == 2 ? rise(0) : 0.0);
    for (std::size_t k = 1; k + 1 < n; ++k) {
      const double before = rise(k - 1), after = rise(k);
      if (before * after <= 0.0) continue;
      const double share = (run(k - 1) + 2.0 * run(k)) / (3.0 * (run(k - 1) + run(k)));
      slope[k] = before * after / (share * after + (1.0 - share) * before);
    }
    if (n > 2) {
      slope[0] = at_end(rise(0), rise(1), run(0), run(1));
      slope[n - 1] = at_end(rise(n - 2), rise(n - 3), run(n - 2), run(n - 3));
    }
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const double third = run(k) / 3.0, a = points[k][1], b = points[k + 1][1];
      arcs_.push_back(
          {points[k][0], points[k + 1][0], {a, a + third * slope[k], b - third * slope[k + 1], b}});
    }
  }

  /// NaN outside of the points, but for rounding.
  [[nodiscard]] double operator()(double place) const {
    const double slack = 1e-9 * (arcs_.back().to - arcs_.front().from);
    if (!(place >= arcs_.front().from - slack && place <= arcs_.back().to + slack))
      return std::numeric_limits<double>::quiet_NaN();
    const auto found = std::find_if(arcs_.begin(), arcs_.end() - 1,
                                    [&](const Arc& arc) { return place < arc.to; });
    return found->at(place);
  }
  [[nodiscard]] const std::vector<Arc>& arcs() const { return arcs_; }

 private:
  /// Of the parabola through the last three points, with the sign of the last chord.
  static double at_end(double near, double far, double near_run, double far_run) {
    const double slope = near + (near - far) * near_run / (near_run + far_run);
    if (slope * near <= 0.0) return 0.0;
    return near * far <= 0.0 && std::abs(slope) > std::abs(3.0 * near) ? 3.0 * near : slope;
  }

  std::vector<Arc> arcs_;
};

/// A section: x and z by the length along the chords.
class DrawnCurve {
 public:
  explicit DrawnCurve(const TargetPoints& points)
      : h_(points.front()[1]),
        d_(points.back()[0]),
        x_(by_length(points, 0)),
        z_(by_length(points, 1)) {}

  [[nodiscard]] double h() const { return h_; }
  [[nodiscard]] double d() const { return d_; }
  /// The point at a share of the length, 0 to 1.
  [[nodiscard]] std::array<double, 2> at(double share) const {
    const double place = share * x_.arcs().back().to;
    return {x_(place), z_(place)};
  }

  /// Distance of a point: the nearest of many on each arc, then narrowed.
  [[nodiscard]] double distance(double x, double z) const {
    constexpr int kSamples = 24;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < x_.arcs().size(); ++k) {
      const Arc &ax = x_.arcs()[k], &az = z_.arcs()[k];
      if (box_distance(ax, az, x, z) > nearest) continue;
      const auto away = [&](double place) {
        return std::hypot(ax.at(place) - x, az.at(place) - z);
      };
      const double step = (ax.to - ax.from) / kSamples;
      int best = 0;
      for (int i = 1; i <= kSamples; ++i)
        if (away(ax.from + i * step) < away(ax.from + best * step)) best = i;
      double low = ax.from + std::max(0, best - 1) * step;
      double high = ax.from + std::min(kSamples, best + 1) * step;
      for (int round = 0; round < 80; ++round) {
        const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        away(a) < away(b) ? high = b : low = a;
      }
      nearest = std::min(nearest, away(0.5 * (low + high)));
    }
    return nearest;
  }

  /// The height above `x`: h behind the wall, none beyond d.
  [[nodiscard]] std::optional<double> height(double x) const {
    if (x > d_) return std::nullopt;
    if (x <= 0.0) return h_;
    double low = x_.arcs().front().from, high = x_.arcs().back().to;
    for (int round = 0; round < 100; ++round) {
      const double middle = 0.5 * (low + high);
      (x_(middle) < x ? low : high) = middle;
    }
    return z_(low);
  }

 private:
  static TargetPoints by_length(const TargetPoints& points, std::size_t which) {
    TargetPoints out{{0.0, points.front()[which]}};
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double chord =
          std::hypot(points[k][0] - points[k - 1][0], points[k][1] - points[k - 1][1]);
      out.push_back({out.back()[0] + chord, points[k][which]});
    }
    return out;
  }
  /// From the box between the two ends of an arc, which it does not leave.
  static double box_distance(const Arc& ax, const Arc& az, double x, double z) {
    const auto beyond = [](const Arc& arc, double at) {
      const auto [low, high] = std::minmax(arc.b[0], arc.b[3]);
      return at < low ? low - at : at > high ? at - high : 0.0;
    };
    return std::hypot(beyond(ax, x), beyond(az, z));
  }

  double h_, d_;
  Spline x_, z_;
};

/// A surface through drawn curves.
class DrawnSurface {
 public:
  explicit DrawnSurface(std::vector<DrawnStation> stations) : stations_(std::move(stations)) {
    if (stations_.size() == 1) return;
    const std::size_t points = stations_[0].curve.size();
    for (std::size_t k = 0; k < points; ++k) {
      // Steps to point k; for k = 0 the measures at wall and ground.
      TargetPoints right, down;
      for (const DrawnStation& s : stations_) {
        right.push_back({s.y, k == 0 ? s.curve.back()[0] : s.curve[k][0] - s.curve[k - 1][0]});
        down.push_back({s.y, k == 0 ? s.curve.front()[1] : s.curve[k - 1][1] - s.curve[k][1]});
      }
      right_.emplace_back(right), down_.emplace_back(down);
    }
  }

  [[nodiscard]] std::optional<DrawnCurve> section(double y) const {
    if (stations_.size() == 1) return DrawnCurve(stations_[0].curve);
    const double d = right_[0](y), h = down_[0](y);
    if (!std::isfinite(d)) return std::nullopt;
    double sum_x = 0.0, sum_z = 0.0;
    for (std::size_t k = 1; k < right_.size(); ++k) sum_x += right_[k](y), sum_z += down_[k](y);
    TargetPoints points{{0.0, h}};
    double x = 0.0, z = 0.0;
    for (std::size_t k = 1; k < right_.size(); ++k) {
      x += right_[k](y), z += down_[k](y);
      points.push_back({d * (x / sum_x), h * (1.0 - z / sum_z)});
    }
    return DrawnCurve(points);
  }

 private:
  std::vector<DrawnStation> stations_;
  std::vector<Spline> right_, down_;
};

/// The section of the last place that was asked for.
class Sections {
 public:
  explicit Sections(std::vector<DrawnStation> stations) : surface_(std::move(stations)) {}
  [[nodiscard]] const std::optional<DrawnCurve>& at(double y) const {
    if (!y_ || *y_ != y) last_ = surface_.section(y), y_ = y;
    return last_;
  }

 private:
  DrawnSurface surface_;
  mutable std::optional<double> y_;
  mutable std::optional<DrawnCurve> last_;
};

class Lofted : public TargetSurface {
 public:
  Lofted(std::vector<DrawnStation> stations, const TargetPlacement& placement)
      : sections_(std::move(stations)), placement_(placement) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const auto& section = sections_.at(y_of(s_mm));
    const double scale = placement_.scale_mm;
    return section ? scale * section->distance(x_mm / scale, z_mm / scale) : -1.0;
  }
  [[nodiscard]] CurveEnds ends_mm(double s_mm) const override {
    const auto& section = sections_.at(y_of(s_mm));
    if (!section) return {-1.0, -1.0};
    return {placement_.scale_mm * section->h(), placement_.scale_mm * section->d()};
  }
  void add_triangles(const TargetReach& reach, TriangleMesh& out) const override {
    constexpr int kSteps = 96;
    add_sections(
        reach,
        [&](double s_mm) {
          TargetPoints points;
          const auto& section = sections_.at(y_of(s_mm));
          for (int k = 0; section && k <= kSteps; ++k) {
            const auto [x, z] = section->at(static_cast<double>(k) / kSteps);
            points.push_back({placement_.scale_mm * x, placement_.scale_mm * z});
          }
          return points;
        },
        out);
  }

 private:
  [[nodiscard]] double y_of(double s_mm) const {
    return (s_mm - placement_.translate_mm[1]) / placement_.scale_mm;
  }
  Sections sections_;
  TargetPlacement placement_;
};

}  // namespace

TargetFormula formula_through(const TargetPoints& points) {
  return [spline = Spline(points)](double, double y, double) { return spline(y); };
}

std::unique_ptr<TargetSurface> loft_target(std::vector<DrawnStation> stations,
                                           const TargetPlacement& placement) {
  if (placement.upright() && placement.wall.cosine == 0.0)
    return std::make_unique<Lofted>(std::move(stations), placement);
  return solid_target(
      [sections = std::make_shared<Sections>(std::move(stations))](double x, double y, double z) {
        const auto& section = sections->at(y);
        if (!section) return 1.0;
        const auto height = section->height(x);
        return height ? z - *height : x - section->d();
      },
      placement);
}

}  // namespace popcut::verify
