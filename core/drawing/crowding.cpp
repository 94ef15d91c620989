// SPDX-License-Identifier: MIT
// Part of core/drawing/collinear.hpp.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/drawing/collinear.hpp"
#include "core/drawing/linework.hpp"
#include "core/geometry/buckets.hpp"
#include "core/geometry/cell_choice.hpp"
#include "core/geometry/cell_walk.hpp"
#include "core/geometry/line_bins.hpp"

namespace popcut {
namespace {

constexpr std::uint32_t kDirections = 8;  // over half a turn

// The bin of a direction, 14 to 30 degrees wide: the neighbouring bins hold all edges of 0.1 mm or
// more that may overlap. Some overlaps of shorter edges are missed; those are shorter than a blade
// is wide.
std::uint32_t direction_of(const Segment& s) {
  double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y;
  if (dy < 0.0) {
    dx = -dx;
    dy = -dy;
  }
  const double sum = std::abs(dx) + dy;
  if (!(sum > 0.0)) return 0;
  const double turn =
      dx >= 0.0 ? dy / sum : 2.0 - dy / sum;  // 0 to 2 over half a turn of the direction
  return std::min(static_cast<std::uint32_t>(turn * (kDirections / 2)), kDirections - 1);
}

// Whether a part of `s` may lie on `t` or vice versa: a coarse version of `overlap`.
bool may_share(const Segment& s, const Segment& t, double tolerance) {
  const double sx = s.b.x - s.a.x, sy = s.b.y - s.a.y, square = sx * sx + sy * sy;
  const auto along = [&](const PagePoint& p) { return (p.x - s.a.x) * sx + (p.y - s.a.y) * sy; };
  const auto aside = [&](const PagePoint& p) { return (p.y - s.a.y) * sx - (p.x - s.a.x) * sy; };
  double t0 = along(t.a), t1 = along(t.b);
  if (std::max(t0, t1) <= 0.0 || std::min(t0, t1) >= square) return false;
  double h0 = aside(t.a), h1 = aside(t.b);
  const double l = std::sqrt(square);
  // A part of `s` within the tolerance of `t` may be a little farther from `s` if both are short,
  // because they may differ in direction by twice the tolerance per length.
  const double shorter = std::min(l, distance(t.a, t.b));
  const double near = tolerance * (1.0 + std::min(1.0, 4.0 * tolerance / shorter)) * l;
  if (std::min(h0, h1) > near || std::max(h0, h1) < -near) return false;
  if (t0 > t1) {
    std::swap(t0, t1);
    std::swap(h0, h1);
  }
  const double from = std::max(t0, 0.0), to = std::min(t1, square);
  const double least = std::min(tolerance, 0.5 * shorter);
  if (to - from < 0.4 * least * l || !(t1 > t0)) return false;
  const double slope = (h1 - h0) / (t1 - t0);
  return std::abs(h0 + slope * (from - t0)) <= near && std::abs(h0 + slope * (to - t0)) <= near;
}

// The edges of a drawing, and which of them are known to be crowded.
struct Edges {
  std::span<const NodeEdge> edges;
  std::span<const PagePoint> nodes;
  double tolerance;
  std::vector<std::uint8_t> crowded;

  [[nodiscard]] Segment at(std::uint32_t e) const { return {nodes[edges[e].a], nodes[edges[e].b]}; }
  // Marks both edges if they may share a part, and returns whether they do.
  bool meet(std::uint32_t e, const Segment& s, std::uint32_t other) {
    if (other == e || !may_share(s, at(other), tolerance)) return false;
    crowded[e] = crowded[other] = 1;
    return true;
  }
};

// Edges by the cells of the page that they pass, and by direction: `OverlapIndex` for a whole
// drawing that is known before, so that slots are laid out once and read in the order of places.
class ByPlace {
 public:
  ByPlace(const Edges& edges, const std::vector<std::uint32_t>& own, double cell_mm)
      : cell_(cell_mm), count_(std::bit_ceil(2 * own.size() + 16)), slots_(count_, [&](auto&& put) {
          for (const std::uint32_t e : own) {
            const Segment s = edges.at(e);
            const std::uint32_t direction = direction_of(s);
            each_cell(s, 0.0, [&](std::uint64_t place) {
              put(slot(place, direction), e);
              return true;
            });
          }
        }) {}

  // Examines what lies near edge `e` until the edge is crowded.
  void look(Edges& edges, std::uint32_t e) const {
    const Segment s = edges.at(e);
    const std::uint32_t direction = direction_of(s);
    each_cell(s, edges.tolerance, [&](std::uint64_t cell) {
      for (std::uint32_t turn = kDirections - 1; turn <= kDirections + 1; ++turn)
        for (const std::uint32_t other : slots_[slot(cell, (direction + turn) % kDirections)])
          if (edges.meet(e, s, other)) return false;
      return true;
    });
  }

 private:
  // The directions of a cell are adjacent in memory; their rotation differs for cells of different
  // blocks.
  [[nodiscard]] std::size_t slot(std::uint64_t cell, std::uint32_t direction) const {
    return (cell + ((direction + (cell >> 40)) & (kDirections - 1))) & (count_ - 1);
  }

  template <typename Visit>
  void each_cell(const Segment& s, double reach, Visit&& visit) const {
    walk_cells(s, cell_, reach,
               [&](std::int64_t x, std::int64_t y) { return visit(place_of(x, y)); });
  }
  // The cells of a block of 8 x 8 are adjacent in memory, so that lines drawn nearby are near in
  // memory too.
  static std::uint64_t place_of(std::int64_t x, std::int64_t y) {
    const std::uint64_t block = mixed(static_cast<std::uint64_t>(x >> 3) * 0x9E3779B97F4A7C15ULL ^
                                      static_cast<std::uint64_t>(y >> 3) * 0xC2B2AE3D27D4EB4FULL);
    const auto within = static_cast<std::uint64_t>((x & 7) | (y & 7) << 3);
    return (block << 6 | within) * kDirections;
  }

  double cell_;
  std::size_t count_;  // of slots, a power of two
  Buckets<std::uint32_t> slots_;
};

// Long edges by the lines that they lie on.
class ByLine {
 public:
  ByLine(const Edges& edges, const std::vector<std::uint32_t>& own, const LineBins& bins)
      : bins_(bins), count_(std::bit_ceil(2 * own.size() + 16)), slots_(count_, [&](auto&& put) {
          for (const std::uint32_t e : own) {
            const LongLine line = bins_.line_of(edges.at(e));
            bins_.each_bin(line, [&](std::uint64_t bin) { put(slot(bin), {line, e}); });
          }
        }) {}

  // Examines what lies near each edge until the edge is crowded. Goes slot by slot, because near
  // edges lie in slots that were just read.
  void look_at_all(Edges& edges) const {
    for (std::size_t s = 0; s < slots_.size(); ++s)
      for (const Item& item : slots_[s])
        if (edges.crowded[item.edge] == 0 && slot(bins_.first_bin(item.line)) == s)
          look(edges, item);
  }

 private:
  struct Item {
    LongLine line;
    std::uint32_t edge{};
  };

  void look(Edges& edges, const Item& item) const {
    bool found = false;
    bins_.each_near(item.line, [&](std::uint64_t bin, const LongLine& seen) {
      for (const Item& other : slots_[slot(bin)]) {
        if (found) return;
        found = other.edge != item.edge && bins_.may_share(seen, other.line) &&
                edges.meet(item.edge, edges.at(item.edge), other.edge);
      }
    });
  }
  [[nodiscard]] std::size_t slot(std::uint64_t bin) const { return bin & (count_ - 1); }

  const LineBins& bins_;
  std::size_t count_;  // of slots, a power of two
  Buckets<Item> slots_;
};

}  // namespace

std::vector<std::uint8_t> crowded_edges(std::span<const NodeEdge> list,
                                        std::span<const PagePoint> nodes, double tolerance) {
  Edges edges{list, nodes, tolerance, std::vector<std::uint8_t>(list.size(), 0)};
  std::vector<std::uint32_t> shorts, longs;
  double short_mm = 0.0, long_mm = 0.0;
  Box box;
  for (std::uint32_t e = 0; e < list.size(); ++e) {
    const Segment s = edges.at(e);
    const double l = distance(s.a, s.b);
    const bool is_long = l >= kLongSegment;
    (is_long ? longs : shorts).push_back(e);
    (is_long ? long_mm : short_mm) += l;
    box.add(s.a);
    box.add(s.b);
  }
  if (list.empty()) return {};
  const auto n = static_cast<double>(list.size());
  const auto mean = [](double mm, const std::vector<std::uint32_t>& of) {
    return of.empty() ? kLongSegment : mm / static_cast<double>(of.size());
  };
  {  // On average, long edges pass through at most eight cells of short ones.
    const double coarse =
        std::max({2.0 * mean(short_mm, shorts), (short_mm + long_mm) / (8.0 * n), 0.1});
    const auto at = [&](std::size_t k) { return edges.at(shorts[k]); };
    const ByPlace by_place(edges, shorts, cell_for_density(shorts.size(), at, coarse, 0.1));
    if (!shorts.empty())
      for (std::uint32_t e = 0; e < list.size(); ++e)
        if (edges.crowded[e] == 0) by_place.look(edges, e);
  }
  if (longs.empty()) return std::move(edges.crowded);
  if (!shorts.empty()) {
    const ByPlace by_place(edges, longs, std::max(long_mm / (8.0 * n), kLongSegment));
    for (const std::uint32_t e : shorts)
      if (edges.crowded[e] == 0) by_place.look(edges, e);
  }
  const LineBins bins({(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2},
                      std::hypot(box.width(), box.height()) / 2 + 1.0, mean(long_mm, longs),
                      tolerance);
  ByLine(edges, longs, bins).look_at_all(edges);
  return std::move(edges.crowded);
}

}  // namespace popcut
