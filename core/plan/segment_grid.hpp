// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/overlap.hpp"

namespace popcut {

/// Segments in a uniform grid that is built once: which of them come near a given one?
class SegmentGrid {
 public:
  /// `reach`: how near is near, in mm.
  SegmentGrid(std::span<const Segment> segments, double reach);

  /// Indices of all segments whose cells lie within reach of `segment`, each once.
  void near(const Segment& segment, std::vector<std::uint32_t>& out);

 private:
  template <typename Visit>
  void visit(const Segment& segment, double reach, Visit&& visit) const;

  double reach_;
  double cell_{1.0};
  double x0_{}, y0_{};
  std::int64_t columns_{1}, rows_{1};
  std::vector<std::uint32_t> first_;  ///< cells + 1 offsets into items_
  std::vector<std::uint32_t> items_;
  std::vector<std::uint32_t> seen_;  ///< query that met the segment last
  std::uint32_t query_{};
};

}  // namespace popcut
