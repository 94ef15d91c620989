// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// The places where lines of a drawing meet: a point that is asked for becomes a node, or the node
/// that is there already. Nodes never move, so nothing is moved twice. It grows point by point,
/// each asked for before it is added: Boost.Geometry's rtree takes 22 times as long for that
/// (tests/bench/spatial_bench), and the other indexes here are built at once.
class NodeIndex {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// @param reach  the largest distance at which two points may be the same, mm
  NodeIndex(double reach, std::size_t expected);

  /// The nearest node within `within` (at most `reach`) of `p` for which `take(node)` is true; or
  /// kNone.
  template <typename Take>
  [[nodiscard]] std::uint32_t find(const PagePoint& p, double within, Take&& take) const;
  [[nodiscard]] std::uint32_t find(const PagePoint& p, double within) const {
    return find(p, within, [](std::uint32_t) { return true; });
  }
  std::uint32_t add(const PagePoint& p);
  std::uint32_t find_or_add(const PagePoint& p, double within) {
    const std::uint32_t found = find(p, within);
    return found != kNone ? found : add(p);
  }
  [[nodiscard]] const PagePoint& point(std::uint32_t node) const { return points_[node]; }
  [[nodiscard]] const std::vector<PagePoint>& points() const { return points_; }
  [[nodiscard]] std::vector<PagePoint> take_points() && { return std::move(points_); }
  [[nodiscard]] std::size_t size() const { return points_.size(); }

 private:
  [[nodiscard]] std::int64_t cell(double value) const;
  [[nodiscard]] std::size_t slot(std::int64_t cx, std::int64_t cy) const;

  double cell_;
  std::vector<std::uint32_t> head_;
  std::vector<std::uint32_t> next_;
  std::vector<PagePoint> points_;
};

template <typename Take>
std::uint32_t NodeIndex::find(const PagePoint& p, double within, Take&& take) const {
  std::uint32_t best = kNone;
  double best_squared = within * within;
  const std::int64_t right = cell(p.x + within), bottom = cell(p.y + within);
  for (std::int64_t cx = cell(p.x - within); cx <= right; ++cx)
    for (std::int64_t cy = cell(p.y - within); cy <= bottom; ++cy)
      for (std::uint32_t n = head_[slot(cx, cy)]; n != kNone; n = next_[n]) {
        const double dx = points_[n].x - p.x, dy = points_[n].y - p.y;
        const double squared = dx * dx + dy * dy;
        const bool nearer = squared < best_squared || (squared == best_squared && n < best);
        if (nearer && take(n)) {
          best = n;
          best_squared = squared;
        }
      }
  return best;
}

}  // namespace popcut
