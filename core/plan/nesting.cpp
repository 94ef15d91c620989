// SPDX-License-Identifier: MIT
#include "core/plan/nesting.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

struct Loop {
  std::uint32_t line{};
  Box box;
};

bool holds(std::span<const PagePoint> loop, const PagePoint& p) {
  bool inside = false;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const PagePoint& a = loop[i - 1];
    const PagePoint& b = loop[i];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y))
      inside = !inside;
  }
  return inside;
}

// Boxes of loops by the cells of a coarse grid that they touch.
class LoopGrid {
 public:
  explicit LoopGrid(const std::vector<Loop>& loops) : loops_(loops) {
    for (const Loop& loop : loops) {
      all_.add({loop.box.x0, loop.box.y0});
      all_.add({loop.box.x1, loop.box.y1});
    }
    side_ = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::sqrt(loops.size())), 1, 64);
    cells_.resize(static_cast<std::size_t>(side_ * side_));
    for (std::uint32_t i = 0; i < loops.size(); ++i) {
      const Box& b = loops[i].box;
      for (std::int64_t y = row(b.y0); y <= row(b.y1); ++y)
        for (std::int64_t x = column(b.x0); x <= column(b.x1); ++x)
          cells_[static_cast<std::size_t>(y * side_ + x)].push_back(i);
    }
  }
  [[nodiscard]] const std::vector<std::uint32_t>& at(const PagePoint& p) const {
    return cells_[static_cast<std::size_t>(row(p.y) * side_ + column(p.x))];
  }

 private:
  [[nodiscard]] std::int64_t cell(double value, double from, double span) const {
    const double f = span > 0.0 ? (value - from) / span * static_cast<double>(side_) : 0.0;
    return static_cast<std::int64_t>(
        std::clamp(std::floor(f), 0.0, static_cast<double>(side_ - 1)));
  }
  [[nodiscard]] std::int64_t column(double x) const { return cell(x, all_.x0, all_.width()); }
  [[nodiscard]] std::int64_t row(double y) const { return cell(y, all_.y0, all_.height()); }

  const std::vector<Loop>& loops_;
  Box all_;
  std::int64_t side_{1};
  std::vector<std::vector<std::uint32_t>> cells_;
};

// The middle of the longest piece: a point of the line that is least likely to lie on another one.
PagePoint probe(std::span<const PagePoint> line) {
  std::size_t longest = 1;
  for (std::size_t i = 2; i < line.size(); ++i)
    if (distance(line[i - 1], line[i]) > distance(line[longest - 1], line[longest])) longest = i;
  return {(line[longest - 1].x + line[longest].x) / 2, (line[longest - 1].y + line[longest].y) / 2};
}

}  // namespace

std::vector<std::uint32_t> nesting_depth(const LineWork& work,
                                         const std::vector<std::uint8_t>& counts) {
  std::vector<std::uint32_t> depth(work.lines.size(), 0);
  std::vector<Loop> loops;
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    const auto points = work.points_of(work.lines[i]);
    if (counts[i] == 0 || !closed(points)) continue;
    Loop loop{i, {}};
    for (const PagePoint& p : points) loop.box.add(p);
    loops.push_back(loop);
  }
  if (loops.empty()) return depth;
  const LoopGrid grid(loops);
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    if (counts[i] == 0) continue;
    const PagePoint p = probe(work.points_of(work.lines[i]));
    for (const std::uint32_t l : grid.at(p)) {
      const Box& box = loops[l].box;
      if (loops[l].line == i || p.x < box.x0 || p.x > box.x1 || p.y < box.y0 || p.y > box.y1)
        continue;
      if (holds(work.points_of(work.lines[loops[l].line]), p)) ++depth[i];
    }
  }
  return depth;
}

}  // namespace popcut
