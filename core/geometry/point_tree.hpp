// SPDX-License-Identifier: MIT
#pragma once

#include <array>
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

  /// Up to `each` (at most `kMostNear`) tags, nearest first, each once with its nearest point.
  class NearList {
   public:
    explicit NearList(std::size_t each) : each_(each) {}
    void clear() { count_ = 0; }
    [[nodiscard]] std::span<const Near> all() const { return {list_.data(), count_}; }
    /// Whether nothing at this distance would be taken in.
    [[nodiscard]] bool closed_to(double squared) const {
      return count_ == each_ && squared >= list_[count_ - 1].squared;
    }
    void add(const Near& one) {
      std::size_t at = 0;
      while (at < count_ && list_[at].tag != one.tag) ++at;
      if (at < count_ ? list_[at].squared <= one.squared : closed_to(one.squared)) return;
      if (at == count_ && count_ < each_) ++count_;
      if (at == count_) --at;
      for (; at > 0 && list_[at - 1].squared > one.squared; --at) list_[at] = list_[at - 1];
      list_[at] = one;
    }

   private:
    std::size_t each_, count_{0};
    std::array<Near, kMostNear> list_;
  };

  PointTree(std::span<const PagePoint> points, std::span<const std::uint32_t> tags);

  /// Sets `found` to the nearest tags to point `i` for which `take(tag)` is true.
  template <typename Take>
  void nearest(std::uint32_t i, NearList& found, Take&& take) const {
    found.clear();
    Search search{sorted_[place_[i]], place_[i], found};
    descend(1, 0, static_cast<std::uint32_t>(sorted_.size()), search, take);
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
    NearList& found;
    [[nodiscard]] bool closed_to(double squared) const { return found.closed_to(squared); }
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
          search.found.add({squared, e.tag});
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
