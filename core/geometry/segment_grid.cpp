// SPDX-License-Identifier: MIT
#include "core/geometry/segment_grid.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/page_point.hpp"

namespace popcut {

SegmentGrid::SegmentGrid(std::span<const Segment> segments, double reach, bool fine)
    : reach_(reach) {
  Box box;
  double total = 0.0;
  for (const Segment& s : segments) {
    box.add(s.a);
    box.add(s.b);
    total += distance(s.a, s.b);
  }
  if (segments.empty()) box = {0.0, 0.0, 0.0, 0.0};
  // As many cells as segments, but large enough that a line takes at most 8 cells on average. A
  // fine grid has up to a million cells and 16 million entries.
  const double n = static_cast<double>(segments.size()) + 1.0;
  const double cells = fine ? std::max(n, 1e6) : n, entries = fine ? std::max(8 * n, 16e6) : 8 * n;
  cell_ = std::max({std::sqrt(box.width() * box.height() / cells), total / entries, 2.0 * reach,
                    (box.width() + box.height()) / (4.0 * cells)});
  x0_ = box.x0;
  y0_ = box.y0;
  columns_ = static_cast<std::int64_t>(box.width() / cell_) + 1;
  rows_ = static_cast<std::int64_t>(box.height() / cell_) + 1;
  cells_ = Buckets<std::uint32_t>(static_cast<std::size_t>(columns_ * rows_), [&](auto&& put) {
    for (std::uint32_t i = 0; i < segments.size(); ++i)
      visit(segments[i], 0.0, [&](std::size_t cell) { put(cell, i); });
  });
  seen_.assign(segments.size(), 0);
}

void SegmentGrid::near(const Segment& segment, std::vector<std::uint32_t>& out) {
  out.clear();
  ++query_;
  visit(segment, reach_, [&](std::size_t cell) {
    for (const std::uint32_t i : cells_[cell])
      if (seen_[i] != query_) {
        seen_[i] = query_;
        out.push_back(i);
      }
  });
}

}  // namespace popcut
