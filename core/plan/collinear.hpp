// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/overlap.hpp"

namespace popcut {

/// Finds which parts of a segment lie on others, for segments of any lengths, filled as one goes.
///
/// Short ones are found by place (`OverlapIndex`). Long ones would fill its cells: they are found
/// by the line that they lie on, its angle and its distance from the middle of the drawing, in bins
/// of 0.01 rad and 1 % of the drawing. Two segments of more than 5 mm that share less than 2 mm at
/// an angle of more than half a degree are not found.
class CollinearIndex {
 public:
  using Covered = OverlapIndex::Covered;

  /// `all`: every segment that may come, for the sizes of cells.
  CollinearIndex(std::span<const Segment> all, double tolerance);

  void insert(const Segment& segment, std::uint32_t id);
  /// All parts of `segment` on inserted segments, sorted by `from`; id `not_this` is passed over.
  void covered(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);

 private:
  struct Sizes {
    double short_cell{1.0}, long_cell{1.0};
    std::size_t shorts{}, longs{};
    PagePoint middle;
    double reach{1.0};  ///< half the drawing's diagonal
  };
  static Sizes sizes_of(std::span<const Segment> all);
  struct Line {
    std::int64_t angle{};  ///< its bin
    double radians{}, offset{};
  };
  [[nodiscard]] Line line_of(const Segment& segment) const;
  [[nodiscard]] std::size_t slot(std::int64_t angle, std::int64_t offset) const;
  void covered_by_long(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);

  Sizes sizes_;
  double tolerance_;
  double offset_bin_;
  OverlapIndex shorts_;
  OverlapIndex longs_by_place_;
  bool any_short_;
  struct LongLine {
    float radians{}, offset{};
    std::int32_t bin{};
    std::int32_t next{};
  };
  std::vector<std::int32_t> head_;  ///< of long segments, by line
  std::vector<LongLine> lines_;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace popcut
