// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/motion.hpp"

namespace popcut {

/// Strokes as a tour sees them. Stop 0 is home, where the tour begins and ends. Every other stop
/// has two ends: node 2 s and node 2 s + 1. A stop with doors is a closed stroke; both of its nodes
/// are at the door that is currently its seam.
struct TourStops {
  std::vector<PagePoint> node;
  std::vector<std::uint32_t> first_door;  ///< per stop, and one more: into `doors`; may be empty
  std::vector<PagePoint> doors;
  std::vector<std::uint32_t> seam;  ///< per stop: into `doors`; may be empty
  /// Per stop, and one more: into `later`, the stops that must come after it; may be empty.
  std::vector<std::uint32_t> first_later;
  std::vector<std::uint32_t> later;
  std::vector<std::uint32_t> first_earlier;  ///< the stops that must come before it
  std::vector<std::uint32_t> earlier;
  bool free_start{false},
      free_end{false};  ///< the tour may start, end anywhere: that move costs nothing
  TravelCost cost;

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(node.size() / 2); }
  [[nodiscard]] bool has_doors(std::uint32_t stop) const {
    return !first_door.empty() && first_door[stop + 1] > first_door[stop];
  }
  [[nodiscard]] std::span<const std::uint32_t> later_than(std::uint32_t stop) const {
    return std::span(later).subspan(first_later[stop], first_later[stop + 1] - first_later[stop]);
  }
  [[nodiscard]] std::span<const std::uint32_t> earlier_than(std::uint32_t stop) const {
    return std::span(earlier).subspan(first_earlier[stop],
                                      first_earlier[stop + 1] - first_earlier[stop]);
  }
  /// Node 1 is where the tour leaves home, node 0 where it returns.
  [[nodiscard]] bool is_free(std::uint32_t n) const {
    return n < 2 && (n == 1 ? free_start : free_end);
  }
  [[nodiscard]] double between(std::uint32_t n, const PagePoint& p) const {
    if (is_free(n)) return 0.0;
    const double dx = node[n].x - p.x, dy = node[n].y - p.y;
    return cost(std::sqrt(dx * dx + dy * dy));
  }
  [[nodiscard]] double between(std::uint32_t n, std::uint32_t m) const {
    return is_free(m) ? 0.0 : between(n, node[m]);
  }
  void choose_seam(std::uint32_t stop, std::uint32_t door) {
    seam[stop] = door;
    node[2 * stop] = node[2 * stop + 1] = doors[door];
  }
};

/// An order of all stops, home first, and whether the tour enters each at its second end.
struct TourOrder {
  std::vector<std::uint32_t> sequence;
  std::vector<std::uint8_t> flipped;  ///< per stop
};

/// The cost of `order`, from home to home.
[[nodiscard]] double tour_cost(const TourStops& stops, const TourOrder& order);

/// The nodes near each node, nearest first: `near(n)`. Shorter lists end with `kNone`.
struct NearNodes {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t each{0};
  std::vector<std::uint32_t> nodes;
  std::vector<float> mm;  ///< their distances in mm, from door to door
  [[nodiscard]] std::span<const std::uint32_t> near(std::uint32_t n) const {
    return std::span(nodes).subspan(std::size_t{n} * each, each);
  }
};

/// The `each` (at most 12) nearest nodes of each node, without those of its own stop. O(n log n).
[[nodiscard]] NearNodes near_nodes(const TourStops& stops, std::uint32_t each);

/// A tour made greedily: repeatedly adds the shortest link that joins loose ends of different
/// pieces, first among near nodes, then among the remaining ends. O(n log n).
[[nodiscard]] TourOrder greedy_tour(const TourStops& stops, const NearNodes& near);

/// The order with delays: a stop that comes too early waits until all stops that must precede it
/// are done, and then follows at once. O(n).
[[nodiscard]] TourOrder with_precedence(const TourStops& stops, const TourOrder& order);

}  // namespace popcut
