// SPDX-License-Identifier: MIT
#include "core/plan/motion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/plan/linework.hpp"

namespace popcut {
namespace {

// Seconds over `l` mm from speed v0 to v1, never faster than `most`.
double piece_seconds(double l, double v0, double v1, double most, double a) {
  const double peak = std::min(most, std::sqrt(a * l + (v0 * v0 + v1 * v1) / 2));
  const double turning = (2 * peak * peak - v0 * v0 - v1 * v1) / (2 * a);
  return (2 * peak - v0 - v1) / a + std::max(0.0, l - turning) / peak;
}

double corner_speed(const PagePoint& p, const PagePoint& q, const PagePoint& r, double most,
                    const Motion& motion) {
  const double cosine =
      ((q.x - p.x) * (r.x - q.x) + (q.y - p.y) * (r.y - q.y)) / (distance(p, q) * distance(q, r));
  const double s = std::sqrt(std::clamp((1 + cosine) / 2, 0.0, 1.0));
  if (s > 1 - 1e-12) return most;
  return std::min(most, std::sqrt(motion.accel_mm_s2 * motion.corner_mm * s / (1 - s)));
}

}  // namespace

double path_seconds(std::span<const PagePoint> path, double speed_mm_s, const Motion& motion) {
  std::vector<PagePoint> points;
  points.reserve(path.size());
  for (const PagePoint& p : path)
    if (points.empty() || distance(points.back(), p) > 1e-9) points.push_back(p);
  if (points.size() < 2) return 0.0;
  const double a = motion.accel_mm_s2;
  std::vector<double> speed(points.size(), 0.0);
  for (std::size_t i = points.size() - 2; i > 0; --i) {
    const double corner = corner_speed(points[i - 1], points[i], points[i + 1], speed_mm_s, motion);
    const double l = distance(points[i], points[i + 1]);
    speed[i] = std::min(corner, std::sqrt(speed[i + 1] * speed[i + 1] + 2 * a * l));
  }
  double seconds = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double l = distance(points[i], points[i + 1]);
    speed[i + 1] = std::min(speed[i + 1], std::sqrt(speed[i] * speed[i] + 2 * a * l));
    seconds += piece_seconds(l, speed[i], speed[i + 1], speed_mm_s, a);
  }
  return seconds;
}

double travel_seconds(double mm, const Motion& motion) {
  return mm > 0.0 ? piece_seconds(mm, 0.0, 0.0, motion.travel_mm_s, motion.accel_mm_s2) : 0.0;
}

double strokes_seconds(const Toolpath& path, const Motion& motion) {
  double seconds = 0.0;
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    const Stroke& stroke = path.strokes[i];
    const auto points = path.points_of(stroke);
    if (i > 0)
      seconds += travel_seconds(
          distance(path.points_of(path.strokes[i - 1]).back(), points.front()), motion);
    seconds += motion.drop_s + motion.lift_s + path_seconds(points, stroke.speed_mm_s, motion);
  }
  return seconds;
}

}  // namespace popcut
