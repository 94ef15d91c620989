// SPDX-License-Identifier: MIT
#include "core/plan/knife/blade.hpp"

#include <algorithm>
#include <cmath>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

constexpr double kSamePlace = 1e-9;  // mm
constexpr double kAligned = 1e-3;  // rad; a heading this close to the direction counts as straight
constexpr double kSampleStep = 0.1;  // as a fraction of the offset, while the blade turns

PagePoint ahead(const PagePoint& p, const PagePoint& direction, double by) {
  return {p.x + by * direction.x, p.y + by * direction.y};
}

double angle_between(const PagePoint& u, const PagePoint& w) {
  return std::atan2(u.x * w.y - u.y * w.x, u.x * w.x + u.y * w.y);
}

// Appends the arc of the axis around the tip at `centre` from heading u to heading w as chords,
// without its first point.
void append_swing(const PagePoint& centre, const PagePoint& u, double angle, const Blade& blade,
                  std::vector<PagePoint>& axis) {
  const double ratio = std::min(blade.arc_tolerance_mm / blade.offset_mm, 1.0);
  const double most = std::max(2 * std::acos(1 - ratio), 0.05);
  const int chords = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / most)));
  for (int k = 1; k <= chords; ++k) {
    const double t = angle * k / chords, c = std::cos(t), s = std::sin(t);
    axis.push_back(ahead(centre, {c * u.x - s * u.y, s * u.x + c * u.y}, blade.offset_mm));
  }
}

}  // namespace

std::size_t append_axis_path(std::span<const PagePoint> tip, Blade& blade,
                             std::vector<PagePoint>& axis) {
  std::size_t entry = 0;
  bool begun = false;
  for (std::size_t i = 1; i < tip.size(); ++i) {
    const PagePoint& from = tip[i - 1];
    const double l = distance(from, tip[i]);
    if (l <= kSamePlace) continue;
    const PagePoint u{(tip[i].x - from.x) / l, (tip[i].y - from.y) / l};
    const double turn = angle_between(blade.heading, u);
    if (!begun) {
      const std::size_t first = axis.size();
      axis.push_back(ahead(from, blade.heading, blade.offset_mm));
      if (std::abs(turn) > kAligned) {
        append_swing(from, blade.heading, turn, blade, axis);
        entry = axis.size() - first;
      }
      begun = true;
    } else if (std::abs(turn) > blade.swivel_above_rad) {
      append_swing(from, blade.heading, turn, blade, axis);
    } else if (std::abs(turn) > kAligned) {
      axis.push_back(ahead(from, u, blade.offset_mm));  // part of the arc
    }
    axis.push_back(ahead(tip[i], u, blade.offset_mm));
    blade.heading = u;
  }
  return entry;
}

std::vector<PagePoint> tip_path(std::span<const PagePoint> axis, Blade& blade) {
  std::vector<PagePoint> tip;
  if (axis.empty()) return tip;
  const double d = blade.offset_mm;
  tip.push_back(ahead(axis[0], blade.heading, -d));
  for (std::size_t i = 1; i < axis.size(); ++i) {
    const double l = distance(axis[i - 1], axis[i]);
    if (l <= kSamePlace) continue;
    const PagePoint u{(axis[i].x - axis[i - 1].x) / l, (axis[i].y - axis[i - 1].y) / l};
    const double start = angle_between(u, blade.heading);
    // A heading exactly against the direction would never turn; the smallest deviation turns it.
    const double half = std::tan(std::clamp(start, -3.1, 3.1) / 2);
    const auto heading_at = [&](double s) {
      const double q = 2 * std::atan(half * std::exp(-s / d));
      return PagePoint{std::cos(q) * u.x - std::sin(q) * u.y,
                       std::sin(q) * u.x + std::cos(q) * u.y};
    };
    // Sample until the blade trails straight, which takes d ln(tan(start/2) / tan(aligned/2)).
    const double turning = std::abs(half) > kAligned / 2
                               ? std::min(l, d * std::log(2 * std::abs(half) / kAligned))
                               : 0.0;
    for (double s = kSampleStep * d; s < turning; s += kSampleStep * d)
      tip.push_back(ahead(ahead(axis[i - 1], u, s), heading_at(s), -d));
    if (turning > 0.0 && turning < l)
      tip.push_back(ahead(ahead(axis[i - 1], u, turning), heading_at(turning), -d));
    blade.heading = heading_at(l);
    tip.push_back(ahead(axis[i], blade.heading, -d));
  }
  return tip;
}

}  // namespace popcut
