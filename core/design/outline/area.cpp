// SPDX-License-Identifier: MIT
#include "core/design/outline/area.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <clipper.hpp>

#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/sweep_triangles.hpp"

namespace popcut {
namespace {

constexpr double kUnseen = 1e-5;  // of the whole size: 1 micron of a shape of 100 mm
constexpr double kSteps = 1e6;    // over the whole size; products stay far below 2^63
constexpr int kMostRounds = 8;    // one is enough but for lines that cross within a step

/// A ring of many points without those that it strays from by at most `far` without them (Douglas
/// and Peucker 1973): curves come with more chords than any card shows.
Ring without_idle_points(const Ring& ring, double far) {
  constexpr std::size_t kMany = 2000;
  const std::size_t n = ring.size();
  if (n < kMany) return ring;
  std::vector<std::uint8_t> kept(n, 0);
  kept[0] = kept[n / 2] = 1;
  std::vector<std::pair<std::size_t, std::size_t>> work{{0, n / 2}, {n / 2, n}};
  while (!work.empty()) {
    const auto [from, to] = work.back();
    work.pop_back();
    const Vec2& a = ring[from];
    const Vec2 way = ring[to % n] - a;
    double most = far;
    std::size_t corner = from;
    for (std::size_t k = from + 1; k < to; ++k) {
      const Vec2 p = ring[k] - a;
      const double t = std::clamp(p.dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
      const double off = (p - t * way).norm();
      if (off > most) most = off, corner = k;
    }
    if (corner == from) continue;
    kept[corner] = 1;
    work.emplace_back(from, corner);
    work.emplace_back(corner, to);
  }
  Ring out;
  for (std::size_t k = 0; k < n; ++k)
    if (kept[k] != 0) out.push_back(ring[k]);
  return out;
}

/// Places on a grid of whole numbers.
struct Grid {
  Vec2 from;
  double step{};

  [[nodiscard]] WholePoint on(const Vec2& p) const {
    const Vec2 at = (p - from) / step;
    return {std::llround(at[0]), std::llround(at[1])};
  }
  [[nodiscard]] Vec2 off(const WholePoint& p) const {
    return from + step * Vec2(static_cast<double>(p.x), static_cast<double>(p.y));
  }
};

/// Closed lines on the grid, one after another, as `sweep_triangles` takes them.
struct GridLines {
  std::vector<WholePoint> points;
  std::vector<std::uint32_t> ends;

  void close() { ends.push_back(static_cast<std::uint32_t>(points.size())); }
};

/// Triangles that meet along their sides as pieces, with the lines around them.
class Pieces {
 public:
  Pieces(const GridLines& lines, const std::vector<Triangle>& triangles, const Grid& grid)
      : lines_(lines), triangles_(triangles), grid_(grid), beside_(3 * triangles.size(), kNone) {
    join_sides();
  }

  std::vector<Area> run() {
    DisjointSets sets(triangles_.size());
    for (std::uint32_t side = 0; side < beside_.size(); ++side)
      if (beside_[side] != kNone) sets.join(side / 3, beside_[side] / 3);
    std::vector<std::uint32_t> piece;
    std::vector<Area> out(sets.number(piece));
    place_.assign(lines_.points.size(), kNone);
    std::vector<std::vector<std::uint32_t>> sides(out.size());
    for (std::uint32_t side = 0; side < beside_.size(); ++side)
      if (beside_[side] == kNone) sides[piece[side / 3]].push_back(side);
    std::vector<std::vector<std::uint32_t>> members(out.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) members[piece[t]].push_back(t);
    for (std::size_t k = 0; k < out.size(); ++k) {
      add_lines(sides[k], out[k]);
      for (const std::uint32_t t : members[k]) {
        const auto& [a, b, c] = triangles_[t];
        out[k].triangles.push_back({place_[a], place_[b], place_[c]});
      }
    }
    return out;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// Side 3 t + c goes from corner c of triangle t to the next one.
  [[nodiscard]] std::uint32_t from(std::uint32_t side) const {
    return triangles_[side / 3][side % 3];
  }
  static std::uint32_t next(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }

  void join_sides() {
    struct Side {
      std::uint32_t low, high, at;
    };
    std::vector<Side> sides;
    sides.reserve(beside_.size());
    for (std::uint32_t at = 0; at < beside_.size(); ++at) {
      const std::uint32_t a = from(at), b = from(next(at));
      sides.push_back({std::min(a, b), std::max(a, b), at});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.at) < std::tie(b.low, b.high, b.at);
    });
    for (std::size_t k = 0; k + 1 < sides.size(); ++k)
      if (sides[k].low == sides[k + 1].low && sides[k].high == sides[k + 1].high)
        beside_[sides[k].at] = sides[k + 1].at, beside_[sides[k + 1].at] = sides[k].at;
  }

  /// The lines around a piece. Where it touches itself, a line goes on along the same triangles.
  void add_lines(const std::vector<std::uint32_t>& sides, Area& out) {
    std::vector<std::vector<std::uint32_t>> lines;
    for (const std::uint32_t first : sides) {
      if (beside_[first] != kNone) continue;  // walked before
      auto& line = lines.emplace_back();
      std::uint32_t side = first;
      do {
        line.push_back(from(side));
        std::uint32_t after = next(side);
        while (beside_[after] != kNone && beside_[after] != kWalked) after = next(beside_[after]);
        beside_[side] = kWalked;
        side = after;
      } while (side != first);
    }
    const auto outer =
        std::find_if(lines.begin(), lines.end(), [&](const auto& line) { return is_left(line); });
    if (outer != lines.end()) std::rotate(lines.begin(), outer, outer + 1);
    std::uint32_t places = 0;
    for (const auto& line : lines) {
      Ring ring;
      for (const std::uint32_t p : line) {
        ring.push_back(grid_.off(lines_.points[p]));
        place_[p] = places++;
      }
      &line == &lines.front() ? void(out.outline = std::move(ring))
                              : out.holes.push_back(std::move(ring));
    }
  }

  [[nodiscard]] bool is_left(const std::vector<std::uint32_t>& line) const {
    std::int64_t twice = 0;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const WholePoint &a = lines_.points[line[k]], &b = lines_.points[line[(k + 1) % line.size()]];
      twice += a.x * b.y - a.y * b.x;
    }
    return twice > 0;
  }

  static constexpr std::uint32_t kWalked = kNone - 1;
  const GridLines& lines_;
  const std::vector<Triangle>& triangles_;
  const Grid& grid_;
  std::vector<std::uint32_t> beside_;  ///< of each side, the one that lies over it; or none
  std::vector<std::uint32_t> place_;   ///< of each point, its number in the piece's lines
};

/// Moves points to the nearest multiples of `step`.
void coarsen(GridLines& lines, std::int64_t step) {
  const auto nearest = [&](std::int64_t value) { return (value + step / 2) / step * step; };
  for (WholePoint& p : lines.points) p = {nearest(p.x), nearest(p.y)};
}

/// Lines that bound the same as `lines` do, without crossings but for those that rounding makes.
/// @return false if they cannot be joined
bool joined(GridLines& lines, ClipperLib::PolyFillType rule) {
  ClipperLib::Clipper clipper;
  std::uint32_t first = 0;
  for (const std::uint32_t end : lines.ends) {
    ClipperLib::Path path;
    for (; first < end; ++first) path.emplace_back(lines.points[first].x, lines.points[first].y);
    clipper.AddPath(path, ClipperLib::ptSubject, true);  // false: it has no area
  }
  ClipperLib::Paths paths;
  if (!clipper.Execute(ClipperLib::ctUnion, paths, rule, rule)) return false;
  lines = {};
  for (const ClipperLib::Path& path : paths) {
    for (const ClipperLib::IntPoint& p : path) lines.points.push_back({p.X, p.Y});
    lines.close();
  }
  return true;
}

constexpr const char* kNoArea = "has no closed line with an area";

/// How much rings hold.
class Extent {
 public:
  void add(const std::vector<Ring>& rings) {
    for (const Ring& ring : rings) {
      points_ += ring.size();
      for (const Vec2& p : ring) {
        finite_ = finite_ && p.allFinite();
        box_.extend(p);
      }
    }
  }

  /// @retval OutOfRange  too many points, or one that is not finite
  /// @retval Infeasible  no area
  [[nodiscard]] Result<Grid> grid() const {
    if (!finite_)
      return fail(ErrorKind::OutOfRange, "", "has a coordinate that is not a finite number");
    if (points_ > kMostRingPoints)
      return tl::unexpected(too_much(
          fmt::format("it has {} points; must have at most {}", points_, kMostRingPoints)));
    if (points_ == 0 || !(box_.sizes().minCoeff() > 0.0))
      return fail(ErrorKind::Infeasible, "", kNoArea);
    return Grid{box_.min(), box_.sizes().maxCoeff() / kSteps};
  }

 private:
  std::size_t points_{};
  bool finite_{true};
  Eigen::AlignedBox2d box_;
};

}  // namespace

Result<std::vector<Area>> areas_within(const std::vector<Ring>& rings, FillRule fill) {
  Extent extent;
  extent.add(rings);
  const auto found = extent.grid();
  if (!found) return tl::unexpected(found.error());
  const Grid grid = *found;
  GridLines lines;
  for (const Ring& ring : rings) {
    for (const Vec2& p : without_idle_points(ring, kUnseen * kSteps * grid.step))
      lines.points.push_back(grid.on(p));
    lines.close();
  }
  // Lines that do not cross need no joining, which takes time as the square of their number.
  if (fill == FillRule::NonZero && !joined(lines, ClipperLib::pftNonZero))
    return fail(ErrorKind::Malformed, "", "its lines cannot be joined to areas");
  auto triangles = sweep_triangles(lines.points, lines.ends);
  // Crossings are rounded to the grid, which can make new ones; on a coarser grid lines that are so
  // close become one.
  for (int round = 0; !triangles && round < kMostRounds; ++round) {
    if (round > 1) coarsen(lines, std::int64_t{1} << (round - 1));
    if (!joined(lines, ClipperLib::pftEvenOdd))
      return fail(ErrorKind::Malformed, "", "its lines cannot be joined to areas");
    triangles = sweep_triangles(lines.points, lines.ends);
  }
  if (triangles && triangles->empty()) return fail(ErrorKind::Infeasible, "", kNoArea);
  if (triangles) return Pieces(lines, *triangles, grid).run();
  return fail(ErrorKind::Infeasible, "",
              "has lines that cross each other at more places than can be told apart; simplify it "
              "where lines lie close together");
}

Result<std::vector<Area>> areas_painted(std::vector<Coat> coats) {
  coats.erase(coats.begin(), std::find_if(coats.begin(), coats.end(),
                                          [](const Coat& coat) { return !coat.takes_away; }));
  if (coats.empty()) return fail(ErrorKind::Infeasible, "", kNoArea);
  if (coats.size() == 1) return areas_within(coats.front().rings, FillRule::EvenOdd);
  if (coats.size() > kMostCoats)
    return tl::unexpected(too_much(
        fmt::format("white and other shapes lie over each other {} times; at most {} can be read; "
                    "join the shapes in the editor",
                    coats.size(), kMostCoats)));
  Extent extent;
  for (const Coat& coat : coats) extent.add(coat.rings);
  const auto grid = extent.grid();
  if (!grid) return tl::unexpected(grid.error());
  ClipperLib::Paths left;
  for (const Coat& coat : coats) {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(left, ClipperLib::ptSubject, true);
    for (const Ring& ring : coat.rings) {
      ClipperLib::Path path;
      for (const Vec2& p : without_idle_points(ring, kUnseen * kSteps * grid->step)) {
        const WholePoint at = grid->on(p);
        path.emplace_back(at.x, at.y);
      }
      clipper.AddPath(path, ClipperLib::ptClip, true);
    }
    if (!clipper.Execute(coat.takes_away ? ClipperLib::ctDifference : ClipperLib::ctUnion, left,
                         ClipperLib::pftEvenOdd, ClipperLib::pftEvenOdd))
      return fail(ErrorKind::Malformed, "", "its lines cannot be joined to areas");
  }
  std::vector<Ring> rings;
  for (const ClipperLib::Path& path : left) {
    Ring& ring = rings.emplace_back();
    for (const ClipperLib::IntPoint& p : path) ring.push_back(grid->off({p.X, p.Y}));
  }
  return areas_within(rings, FillRule::EvenOdd);
}

}  // namespace popcut
