// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr double kMostChords = 20'000;  // of one curve

int chords(double second_derivative, double tolerance) {
  const double n = std::ceil(std::sqrt(second_derivative / (8 * tolerance)));
  if (!(n < kMostChords)) return static_cast<int>(kMostChords);  // NaN too
  return std::max(static_cast<int>(n), 1);
}

double second_difference(const PagePoint& a, const PagePoint& b, const PagePoint& c) {
  return std::hypot(a.x - 2 * b.x + c.x, a.y - 2 * b.y + c.y);
}

}  // namespace

void SvgPen::finish() {
  if (!down_) return;
  if (closes_ && at_ != start_) lines_.points.push_back(start_);
  lines_.ends.push_back(static_cast<std::uint32_t>(lines_.points.size()));
  down_ = false;
}

void SvgPen::move(const PagePoint& to) {
  finish();
  at_ = start_ = to;
}

void SvgPen::add(const PagePoint& to) {
  if (!down_) lines_.points.push_back(at_);
  down_ = true;
  lines_.points.push_back(to);
  at_ = to;
}

void SvgPen::line(const PagePoint& to) { add(to); }

void SvgPen::quadratic(const PagePoint& q, const PagePoint& to) {
  const PagePoint p = at_;
  const int n = chords(2 * second_difference(p, q, to), tolerance_);
  for (int i = 1; i < n; ++i) {
    const double t = static_cast<double>(i) / n, s = 1 - t;
    add({s * s * p.x + 2 * s * t * q.x + t * t * to.x,
         s * s * p.y + 2 * s * t * q.y + t * t * to.y});
  }
  add(to);
}

void SvgPen::cubic(const PagePoint& q, const PagePoint& r, const PagePoint& to) {
  const PagePoint p = at_;
  const double d = std::max(second_difference(p, q, r), second_difference(q, r, to));
  const int n = chords(6 * d, tolerance_);
  for (int i = 1; i < n; ++i) {
    const double t = static_cast<double>(i) / n, s = 1 - t;
    const double b0 = s * s * s, b1 = 3 * s * s * t, b2 = 3 * s * t * t, b3 = t * t * t;
    add({b0 * p.x + b1 * q.x + b2 * r.x + b3 * to.x, b0 * p.y + b1 * q.y + b2 * r.y + b3 * to.y});
  }
  add(to);
}

// From end points to centre: SVG 1.1, appendix F.6.5 and F.6.6.
void SvgPen::arc(double rx, double ry, double turn_deg, bool large, bool sweep,
                 const PagePoint& to) {
  rx = std::abs(rx);
  ry = std::abs(ry);
  if (at_ == to) return;
  if (rx == 0.0 || ry == 0.0) return add(to);
  const double turn = radians(turn_deg);
  const double c = std::cos(turn), s = std::sin(turn);
  const double hx = (at_.x - to.x) / 2, hy = (at_.y - to.y) / 2;
  const double x = c * hx + s * hy, y = -s * hx + c * hy;
  const double stretch = x * x / (rx * rx) + y * y / (ry * ry);
  if (stretch > 1) {
    rx *= std::sqrt(stretch);
    ry *= std::sqrt(stretch);
  }
  const double below = rx * rx * y * y + ry * ry * x * x;
  double factor = std::sqrt(std::max(0.0, (rx * rx * ry * ry - below) / below));
  if (large == sweep) factor = -factor;
  const double ox = factor * rx * y / ry, oy = -factor * ry * x / rx;
  const double cx = c * ox - s * oy + (at_.x + to.x) / 2, cy = s * ox + c * oy + (at_.y + to.y) / 2;
  const double from = std::atan2((y - oy) / ry, (x - ox) / rx);
  double span = std::atan2((-y - oy) / ry, (-x - ox) / rx) - from;
  if (sweep && span < 0) span += 2 * std::numbers::pi;
  if (!sweep && span > 0) span -= 2 * std::numbers::pi;
  const double give = std::min(tolerance_ / std::max(rx, ry), 1.0);
  const double n =
      std::clamp(std::ceil(std::abs(span) / (2 * std::acos(1 - give))), 1.0, kMostChords);
  if (!std::isfinite(n) || !std::isfinite(cx) || !std::isfinite(cy)) return add(to);
  for (int i = 1; i < static_cast<int>(n); ++i) {
    const double angle = from + span * i / n;
    const double ex = rx * std::cos(angle), ey = ry * std::sin(angle);
    add({c * ex - s * ey + cx, s * ex + c * ey + cy});
  }
  add(to);
}

void SvgPen::close() {
  if (down_ && at_ != start_) add(start_);
  finish();
  at_ = start_;
}

}  // namespace popcut
