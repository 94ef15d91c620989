// SPDX-License-Identifier: MIT
#include "core/machines/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

constexpr double kSamePlace = 1e-9;       // mm
constexpr double kSwivelTurnCos = 0.866;  // cos 30 degrees: the firmware stops at sharper turns

// The speeds along a path. The buffer is reused for all strokes, so none of them allocates.
class PathTimer {
 public:
  explicit PathTimer(const Motion& motion) : motion_(motion) {}

  double seconds(std::span<const PagePoint> path, double most, double swivel_offset_mm) {
    points_.clear();
    for (const PagePoint& p : path)
      if (points_.empty() || distance(points_.back(), p) > kSamePlace) points_.push_back(p);
    if (points_.size() < 2) return 0.0;
    const double a = motion_.accel_mm_s2;
    speed_.assign(points_.size(), 0.0);
    double seconds = 0.0;
    for (std::size_t i = points_.size() - 2; i > 0; --i) {
      const double turn = turn_cos(points_[i - 1], points_[i], points_[i + 1]);
      const double swivel = swivel_seconds(turn, swivel_offset_mm, motion_);
      const double corner = swivel > 0.0 ? 0.0 : std::min(most, corner_speed(turn, motion_));
      seconds += swivel;
      const double l = distance(points_[i], points_[i + 1]);
      speed_[i] = std::min(corner, std::sqrt(speed_[i + 1] * speed_[i + 1] + 2 * a * l));
    }
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      const double l = distance(points_[i], points_[i + 1]);
      speed_[i + 1] = std::min(speed_[i + 1], std::sqrt(speed_[i] * speed_[i] + 2 * a * l));
      seconds += leg_seconds(l, speed_[i], speed_[i + 1], most, a);
    }
    return seconds;
  }

 private:
  const Motion& motion_;
  std::vector<PagePoint> points_;
  std::vector<double> speed_;
};

}  // namespace

double corner_speed(double turn_cos, const Motion& motion) {
  // The angle between the legs is pi minus the turn, so the sine of its half is the cosine of half
  // the turn.
  const double s = std::sqrt(std::clamp(0.5 * (1.0 + turn_cos), 0.0, 1.0));
  if (s > 1 - 1e-12) return std::numeric_limits<double>::infinity();
  return std::sqrt(motion.accel_mm_s2 * motion.corner_mm * s / (1 - s));
}

double leg_seconds(double mm, double entry, double exit, double most, double accel_mm_s2) {
  const double a = accel_mm_s2, ends = entry * entry + exit * exit;
  const double peak = std::min(most, std::sqrt(a * mm + ends / 2));
  const double ramps = (2 * peak * peak - ends) / (2 * a);
  return (2 * peak - entry - exit) / a + std::max(0.0, mm - ramps) / peak;
}

double swivel_seconds(double turn_cos, double blade_offset_mm, const Motion& motion) {
  if (!(blade_offset_mm > 0.0) || turn_cos >= kSwivelTurnCos) return 0.0;
  return blade_offset_mm * std::acos(std::clamp(turn_cos, -1.0, 1.0)) / motion.swivel_mm_s;
}

double turn_cos(const PagePoint& p, const PagePoint& q, const PagePoint& r) {
  const double before = distance(p, q), after = distance(q, r);
  if (before == 0.0 || after == 0.0) return 1.0;
  return ((q.x - p.x) * (r.x - q.x) + (q.y - p.y) * (r.y - q.y)) / (before * after);
}

double travel_seconds(double mm, const Motion& motion) {
  return mm > 0.0 ? leg_seconds(mm, 0.0, 0.0, motion.travel_mm_s, motion.accel_mm_s2) : 0.0;
}

double search_seconds(double width_mm, double height_mm, const MarkSearch& marks) {
  return std::min(2 * (width_mm + height_mm) / marks.sensor_mm_s, marks.longest_s);
}

std::vector<StrokeTime> stroke_times(const Toolpath& path, const Motion& motion,
                                     const FirmwareSwivel& swivel) {
  PathTimer timer(motion);
  std::vector<StrokeTime> times;
  times.reserve(path.strokes.size());
  double seconds = 0.0;
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    const Stroke& stroke = path.strokes[i];
    const auto points = path.points_of(stroke);
    if (i > 0)
      seconds += travel_seconds(
          distance(path.points_of(path.strokes[i - 1]).back(), points.front()), motion);
    const bool blade = (swivel.blade_tools >> stroke.tool & 1) != 0;
    times.push_back({.begin_s = seconds});
    seconds += motion.drop_s + motion.lift_s +
               timer.seconds(points, stroke.speed_mm_s, blade ? swivel.offset_mm : 0.0);
    times.back().end_s = seconds;
  }
  return times;
}

double strokes_seconds(const Toolpath& path, const Motion& motion, const FirmwareSwivel& swivel) {
  const std::vector<StrokeTime> times = stroke_times(path, motion, swivel);
  return times.empty() ? 0.0 : times.back().end_s;
}

}  // namespace popcut
