// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/line_bins.hpp"
#include "core/geometry/overlap.hpp"

namespace popcut {

/// Finds which parts of a segment lie on other segments, of any lengths, while segments are
/// inserted.
///
/// Short segments are found by place (`OverlapIndex`). Long ones would fill its cells, so they are
/// found by the line that they lie on (`LineBins`).
class CollinearIndex {
 public:
  using Covered = OverlapIndex::Covered;

  /// @param all  all segments that will be used, to choose cell sizes
  CollinearIndex(std::span<const Segment> all, double tolerance);

  void insert(const Segment& segment, std::uint32_t id);
  /// All parts of `segment` that lie on inserted segments, sorted by `from`; ignores id `not_this`.
  void covered(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);

 private:
  struct Sizes {
    double short_cell{1.0}, long_cell{1.0}, usual_long{kLongSegment};
    std::size_t shorts{}, longs{};
    PagePoint middle;
    double reach{1.0};  ///< half the drawing's diagonal
  };
  static Sizes sizes_of(std::span<const Segment> all);
  [[nodiscard]] std::size_t slot(std::uint64_t bin) const { return bin & (head_.size() - 1); }
  void covered_by_long(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);

  Sizes sizes_;
  double tolerance_;
  LineBins bins_;
  OverlapIndex shorts_;
  OverlapIndex longs_by_place_;
  bool any_short_;
  struct Entry {
    LongLine line;
    std::uint64_t bin{};
    std::uint32_t segment{};  ///< index into segments_
    std::int32_t next{};      ///< next entry of the same slot
  };
  std::vector<std::int32_t> head_;  ///< long segments, by line
  std::vector<Entry> lines_;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> ids_;
};

/// A straight edge between two numbered points.
struct NodeEdge {
  std::uint32_t a{}, b{};
};

/// Tells which edges may share a part with another edge, within `tolerance` mm: 1 for those that
/// do, and for some that only nearly do. In most drawings these are few, and only they need a
/// closer look.
///
/// Short edges are found in cells of the page, by direction; long ones by the line that they lie on
/// (`LineBins`). O(n log n) time and about 30 bytes per edge unless lines pile up; edges that pile
/// up on one line end each other's search early.
[[nodiscard]] std::vector<std::uint8_t> crowded_edges(std::span<const NodeEdge> edges,
                                                      std::span<const PagePoint> nodes,
                                                      double tolerance);

}  // namespace popcut
