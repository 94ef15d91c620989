// SPDX-License-Identifier: MIT
#include "device/compare/run_along.hpp"

#include <algorithm>
#include <cmath>

#include "device/sim/window.hpp"

namespace popcut {

std::optional<Along> run_along(const Segment& a, const Segment& b, double reach) {
  const double a_length = distance(a.a, a.b);
  if (!(a_length > 0)) return std::nullopt;
  const double ux = (a.b.x - a.a.x) / a_length;
  const double uy = (a.b.y - a.a.y) / a_length;
  const auto project = [&](PagePoint p) { return (p.x - a.a.x) * ux + (p.y - a.a.y) * uy; };
  const double s0 = project(b.a);
  const double s1 = project(b.b);
  const double from = std::max(0.0, std::min(s0, s1));
  const double to = std::min(a_length, std::max(s0, s1));
  const bool long_enough = to - from > std::sqrt(2.0) * reach || to - from > 0.5 * a_length;
  if (!long_enough || !(to > from)) return std::nullopt;
  // The two must be close at both ends of the common stretch, which excludes a crossing.
  const auto parameter = [&](double s) { return (s - s0) / (s1 - s0); };
  const auto apart = [&](double s) {
    return distance(along(a.a, a.b, s / a_length), along(b.a, b.b, parameter(s)));
  };
  const double aside = reach * (std::abs(ux) + std::abs(uy));
  if (apart(from) > aside || apart(to) > aside) return std::nullopt;
  const double b_length = distance(b.a, b.b);
  const double t0 = parameter(from) * b_length;
  const double t1 = parameter(to) * b_length;
  return Along{{from, to}, {std::min(t0, t1), std::max(t0, t1)}};
}

VertexGrid::VertexGrid(std::vector<PagePoint> points, double reach)
    : points_(std::move(points)), reach_(reach) {
  std::sort(points_.begin(), points_.end(), [&](PagePoint a, PagePoint b) {
    const double ca = column(a.x);
    const double cb = column(b.x);
    return ca != cb ? ca < cb : a.y < b.y;
  });
}

double VertexGrid::column(double x) const { return std::floor(x / (4 * reach_)); }

bool VertexGrid::near(PagePoint p) const {
  const double last = column(p.x + reach_);
  for (double c = column(p.x - reach_); c <= last; ++c) {
    auto it =
        std::lower_bound(points_.begin(), points_.end(), p.y - reach_, [&](PagePoint q, double y) {
          const double cq = column(q.x);
          return cq != c ? cq < c : q.y < y;
        });
    for (; it != points_.end() && column(it->x) == c && it->y <= p.y + reach_; ++it)
      if (std::abs(it->x - p.x) <= reach_) return true;
  }
  return false;
}

}  // namespace popcut
