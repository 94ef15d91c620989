// SPDX-License-Identifier: MIT
#include "core/drawing/nesting.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/geometry/interval_bins.hpp"

namespace popcut {
namespace {

bool crosses_left_of(const PagePoint& p, const PagePoint& a, const PagePoint& b) {
  return (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
}

// The middle of the longest segment: the point of the line that is least likely to lie on another
// line.
PagePoint probe(std::span<const PagePoint> line) {
  std::size_t longest = 1;
  double most = -1.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double d = distance(line[i - 1], line[i]);
    if (d > most) {
      most = d;
      longest = i;
    }
  }
  return {(line[longest - 1].x + line[longest].x) / 2, (line[longest - 1].y + line[longest].y) / 2};
}

// A closed line that can tell whether it contains a point. Long lines keep their segments by rows.
class Loop {
 public:
  Loop(std::span<const PagePoint> points, std::uint32_t line)
      : points_(points),
        line_(line),
        area_(std::abs(twice_area(points)) / 2),
        box_(bounds(points)) {}
  [[nodiscard]] std::uint32_t line() const { return line_; }
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] double area() const { return area_; }
  // Whether box `b` fits in this loop's box; what sticks out is not inside.
  [[nodiscard]] bool has_room_for(const Box& b) const {
    return b.x0 >= box_.x0 && b.x1 <= box_.x1 && b.y0 >= box_.y0 && b.y1 <= box_.y1;
  }
  // Of two loops, the larger one is outside.
  [[nodiscard]] bool outside(const Loop& other) const {
    return area_ != other.area_ ? area_ > other.area_ : line_ > other.line_;
  }

  [[nodiscard]] bool holds(const PagePoint& p) {
    bool inside = false;
    if (points_.size() <= kShort) {
      for (std::size_t i = 1; i < points_.size(); ++i)
        if (crosses_left_of(p, points_[i - 1], points_[i])) inside = !inside;
      return inside;
    }
    if (rows_.bins().size() == 0) sort_by_rows();
    for (const std::uint32_t i : rows_.at(p.y))
      if (crosses_left_of(p, points_[i - 1], points_[i])) inside = !inside;
    return inside;
  }

 private:
  static constexpr std::size_t kShort = 64;

  void sort_by_rows() {
    std::vector<std::uint32_t> all(points_.size() - 1);
    std::iota(all.begin(), all.end(), 1U);
    rows_ = IntervalBins(box_.y0, box_.y1, all.size() / 4, all, [&](std::uint32_t i) {
      return std::pair<double, double>(std::minmax(points_[i - 1].y, points_[i].y));
    });
  }

  std::span<const PagePoint> points_;
  std::uint32_t line_;
  double area_;
  Box box_;
  IntervalBins rows_;
};

// Loops by the cells that their boxes touch, in the grid whose cells are just larger than the box:
// at most four each. A point is looked up in each grid that has any. (A grid of one cell size would
// hold large loops in all of its cells.)
class LoopGrids {
 public:
  explicit LoopGrids(const std::vector<Loop>& loops) {
    for (const Loop& loop : loops) {
      all_.add({loop.box().x0, loop.box().y0});
      all_.add({loop.box().x1, loop.box().y1});
    }
    side_ = std::max({all_.width(), all_.height(), 1e-9});
    for (std::uint32_t i = 0; i < loops.size(); ++i) {
      const Box& b = loops[i].box();
      const double part = side_ / std::max({b.width(), b.height(), side_ * 1e-6});
      const auto level = static_cast<unsigned>(std::clamp(std::floor(std::log2(part)), 0.0, 19.0));
      used_ |= 1u << level;
      const std::uint64_t x1 = cell(b.x1 - all_.x0, level), y1 = cell(b.y1 - all_.y0, level);
      for (std::uint64_t y = cell(b.y0 - all_.y0, level); y <= y1; ++y)
        for (std::uint64_t x = cell(b.x0 - all_.x0, level); x <= x1; ++x)
          entries_.push_back({key(level, x, y), i});
    }
    std::sort(entries_.begin(), entries_.end());
  }

  template <typename Visit>
  void visit(const PagePoint& p, Visit&& visit) const {
    if (p.x < all_.x0 || p.x > all_.x1 || p.y < all_.y0 || p.y > all_.y1) return;
    for (unsigned levels = used_; levels != 0; levels &= levels - 1) {
      const auto level = static_cast<unsigned>(std::countr_zero(levels));
      const std::uint64_t k = key(level, cell(p.x - all_.x0, level), cell(p.y - all_.y0, level));
      for (auto at = std::lower_bound(entries_.begin(), entries_.end(), Entry{k, 0});
           at != entries_.end() && at->key == k; ++at)
        visit(at->loop);
    }
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t loop;
    auto operator<=>(const Entry&) const = default;
  };
  [[nodiscard]] std::uint64_t cell(double offset, unsigned level) const {
    return static_cast<std::uint64_t>(offset / side_ * static_cast<double>(1u << level));
  }
  static std::uint64_t key(unsigned level, std::uint64_t x, std::uint64_t y) {
    return (std::uint64_t{level} << 58) | (x << 29) | y;
  }

  Box all_;
  double side_{1.0};
  unsigned used_{0};
  std::vector<Entry> entries_;
};

// Steele, Lea and Flood 2014 (splitmix64), here as a hash.
std::uint64_t hash_of(std::uint64_t z) {
  z = (z + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

class Finder {
 public:
  // `inner`: whether loops of strokes that meet themselves count too.
  Finder(const LineWork& work, const std::vector<std::uint8_t>& counts, bool inner)
      : work_(work),
        counts_(counts),
        loop_of_(work.lines.size(), kNone),
        loops_(find(inner)),
        grids_(loops_) {}

  // Calls visit(loop) for each loop around a line.
  template <typename Visit>
  void visit_holders(std::uint32_t line, Visit&& visit) {
    if (loops_.empty() || counts_[line] == 0) return;
    const auto points = work_.points_of(work_.lines[line]);
    const PagePoint p = probe(points);
    const Box box = bounds(points);
    grids_.visit(p, [&](std::uint32_t l) {
      if (loops_[l].line() != line && loops_[l].has_room_for(box) && loops_[l].holds(p)) visit(l);
    });
  }
  [[nodiscard]] bool outside(std::uint32_t loop, std::uint32_t line) const {
    return loop_of_[line] == kNone || loops_[loop].outside(loops_[loop_of_[line]]);
  }
  [[nodiscard]] std::uint32_t line_of(std::uint32_t loop) const { return loops_[loop].line(); }
  [[nodiscard]] bool smaller(std::uint32_t p, std::uint32_t q) const {
    return loops_[q].outside(loops_[p]);
  }

  // All loops around a line, the innermost first.
  std::vector<std::uint32_t> holders(std::uint32_t line) {
    std::vector<std::uint32_t> all;
    visit_holders(line, [&](std::uint32_t l) {
      if (outside(l, line)) all.push_back(l);
    });
    std::sort(all.begin(), all.end(),
              [&](std::uint32_t p, std::uint32_t q) { return smaller(p, q); });
    return all;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<Loop> find(bool inner) {
    std::vector<std::uint32_t> line_of;  // per loop within a stroke
    for (std::uint32_t i = 0; inner && i < work_.lines.size(); ++i) {
      if (counts_[i] != 0) append_stroke_loops(work_.points_of(work_.lines[i]), within_);
      line_of.resize(within_.ends.size(), i);
    }
    std::vector<Loop> loops;
    std::size_t next = 0;
    for (std::uint32_t i = 0; i < work_.lines.size(); ++i) {
      const auto points = work_.points_of(work_.lines[i]);
      if (counts_[i] != 0 && closed(points)) add(loops, points, i);
      for (; next < line_of.size() && line_of[next] == i; ++next) add(loops, within_[next], i);
    }
    return loops;
  }
  // The largest of a line's loops decides what the line lies inside of.
  void add(std::vector<Loop>& loops, std::span<const PagePoint> points, std::uint32_t line) {
    std::uint32_t& own = loop_of_[line];
    const auto number = static_cast<std::uint32_t>(loops.size());
    loops.emplace_back(points, line);
    if (own == kNone || loops[own].area() < loops[number].area()) own = number;
  }

  const LineWork& work_;
  const std::vector<std::uint8_t>& counts_;
  std::vector<std::uint32_t> loop_of_;
  Polylines within_;
  std::vector<Loop> loops_;
  LoopGrids grids_;
};

// The innermost loop around a line, and a hash of all loops around it.
struct Around {
  std::uint32_t innermost{0xffffffffu};
  std::uint64_t hash{0};
};

}  // namespace

std::vector<std::uint32_t> nesting_depth(const LineWork& work,
                                         const std::vector<std::uint8_t>& counts) {
  std::vector<std::uint32_t> depth(work.lines.size(), 0);
  Finder finder(work, counts, false);
  for (std::uint32_t i = 0; i < work.lines.size(); ++i)
    finder.visit_holders(i, [&](std::uint32_t) { ++depth[i]; });
  return depth;
}

Nesting nesting(const LineWork& work, const std::vector<std::uint8_t>& counts) {
  Finder finder(work, counts, true);
  const auto n = static_cast<std::uint32_t>(work.lines.size());
  std::vector<Around> around(n);
  for (std::uint32_t i = 0; i < n; ++i)
    finder.visit_holders(i, [&](std::uint32_t l) {
      if (!finder.outside(l, i)) return;
      around[i].hash ^= hash_of(l);
      if (around[i].innermost == Around{}.innermost || finder.smaller(l, around[i].innermost))
        around[i].innermost = l;
    });
  Nesting out;
  out.first.assign(1, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t l = around[i].innermost;
    if (l != Around{}.innermost) {
      const std::uint32_t line = finder.line_of(l);
      out.holders.push_back(line);
      // The loops around the innermost loop are also around this line, unless lines cross.
      if ((around[line].hash ^ hash_of(l)) != around[i].hash) {
        std::vector<std::uint32_t> known = finder.holders(line), others;
        known.insert(known.begin(), l);
        const std::vector<std::uint32_t> all = finder.holders(i);
        std::set_difference(all.begin(), all.end(), known.begin(), known.end(),
                            std::back_inserter(others),
                            [&](std::uint32_t p, std::uint32_t q) { return finder.smaller(p, q); });
        for (const std::uint32_t h : others) out.holders.push_back(finder.line_of(h));
      }
    }
    out.first.push_back(static_cast<std::uint32_t>(out.holders.size()));
  }
  return out;
}

}  // namespace popcut
