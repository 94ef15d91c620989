// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// Points in a balanced k-d tree: near neighbours in O(log n) however the points lie, also when
/// many of them, or all, are the same. Each point carries a tag; several may carry the same one.
/// No cell size suits the nearest ones of any distance, so no grid serves here, and
/// Boost.Geometry's rtree takes 1.6 times as long (tests/bench/spatial_bench).
class PointTree {
 public:
  static constexpr std::size_t kMostNear = 16;

  struct Near {
    double squared;  ///< square of the distance
    std::uint32_t tag;
  };

  PointTree(std::span<const PagePoint> points, std::span<const std::uint32_t> tags);

  /// Finds the nearest tags to point `i` for which `take(tag)` is true, nearest first, as many as
  /// fit in `out` (at most `kMostNear`). Each tag occurs once, with its nearest point.
  /// @return number of tags found
  template <typename Take>
  std::size_t nearest(std::uint32_t i, std::span<Near> out, Take&& take) const {
    Search search{sorted_[place_[i]], place_[i], out, 0};
    descend(1, 0, static_cast<std::uint32_t>(sorted_.size()), search, take);
    return search.count;
  }

 private:
  static constexpr std::uint32_t kLeaf = 6;
  struct Entry {
    double x, y;
    std::uint32_t tag;
    std::uint32_t number;
  };
  struct Split {  // halves a range of entries; numbered like a heap, with the root 1
    double at{};
    bool by_y{};
  };
  struct Search {
    Entry from;
    std::uint32_t place;
    std::span<Near> best;
    std::size_t count;

    [[nodiscard]] bool closed_to(double squared) const {
      return count == best.size() && squared >= best[count - 1].squared;
    }
    void add(double squared, std::uint32_t tag) {
      std::size_t at = 0;
      while (at < count && best[at].tag != tag) ++at;
      if (at < count && best[at].squared <= squared) return;
      if (at == count && count < best.size()) ++count;
      if (at == count) --at;
      for (; at > 0 && best[at - 1].squared > squared; --at) best[at] = best[at - 1];
      best[at] = {squared, tag};
    }
  };

  void halve(std::size_t node, std::uint32_t low, std::uint32_t high);

  // The range [low, high) is a leaf, or two halves; the half that contains the point comes first.
  template <typename Take>
  void descend(std::size_t node, std::uint32_t low, std::uint32_t high, Search& search,
               Take& take) const {
    if (high - low <= kLeaf) {
      for (std::uint32_t i = low; i < high; ++i) {
        const Entry& e = sorted_[i];
        const double dx = e.x - search.from.x, dy = e.y - search.from.y;
        const double squared = dx * dx + dy * dy;
        if (i != search.place && !search.closed_to(squared) && take(e.tag))
          search.add(squared, e.tag);
      }
      return;
    }
    const std::uint32_t middle = low + (high - low) / 2;
    const Split& split = splits_[node];
    const double over = (split.by_y ? search.from.y : search.from.x) - split.at;
    // Points on the splitting coordinate may be on either side; the query point's own index
    // decides.
    const bool own = search.place >= low && search.place < high;
    const bool left = own ? search.place < middle : over < 0.0;
    const std::size_t near = 2 * node + (left ? 0 : 1), far = near ^ 1u;
    descend(near, left ? low : middle, left ? middle : high, search, take);
    if (!search.closed_to(over * over))
      descend(far, left ? middle : low, left ? high : middle, search, take);
  }

  std::vector<Entry> sorted_;
  std::vector<Split> splits_;
  std::vector<std::uint32_t> place_;
};

}  // namespace popcut
