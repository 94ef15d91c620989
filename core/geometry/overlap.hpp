// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/cell_walk.hpp"
#include "core/geometry/page_point.hpp"

namespace popcut {

/// The part of `s` (of length `l`) that lies on `other` to `tolerance`, mm along it; false if none.
[[nodiscard]] bool overlap(const Segment& s, double l, const Segment& other, double tolerance,
                           double& from, double& to);

/// Finds which parts of a segment lie on others: a hash of grid cells and directions, filled as one
/// goes: neither the drawing's extent nor its number of lines need be known (`SegmentGrid` wants
/// both), and only lines of nearly the same direction are looked at. Two segments overlap where
/// one's projection falls on the other and both ends of that part lie within `tolerance` of it; so
/// lines that cross never do.
class OverlapIndex {
 public:
  /// @param cell  size of a grid cell in mm; see `cell_for`
  OverlapIndex(double cell, double tolerance, std::size_t expected);

  /// A cell size with which `segments` take O(n) cells in total.
  [[nodiscard]] static double cell_for(std::span<const Segment> segments);

  void insert(const Segment& segment, std::uint32_t id);

  struct Covered {
    double from{}, to{};  ///< mm along the queried segment
    std::uint32_t by{};   ///< id of the segment that covers it
  };
  /// All parts of `segment` that lie on inserted segments, sorted by `from`; ignores id `not_this`.
  void covered(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);
  /// The same, appended to `out` and not sorted.
  void find(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out);

  /// Pairs of segments that were compared so far: many where many meet in one place.
  [[nodiscard]] std::size_t compared() const { return compared_; }

 private:
  [[nodiscard]] std::size_t slot(std::int64_t cx, std::int64_t cy, int direction) const;

  double cell_;
  double tolerance_;
  std::vector<std::int32_t> head_;
  std::vector<std::pair<std::uint32_t, std::int32_t>>
      entries_;  ///< index into segments_, and the next entry
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint32_t> seen_;  ///< last query that looked at each segment
  std::uint32_t query_{};
  std::size_t compared_{};
};

}  // namespace popcut
