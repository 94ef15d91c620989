// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// Loops of one after the other, each closed: the last point is the first.
struct StrokeLoops {
  std::vector<PagePoint> points;
  std::vector<std::uint32_t> ends;  ///< of each loop: one behind its last point

  [[nodiscard]] std::span<const PagePoint> loop(std::size_t i) const {
    const std::size_t first = i == 0 ? 0 : ends[i - 1];
    return std::span(points).subspan(first, ends[i] - first);
  }
};

/// Adds the loops that a stroke makes where it meets itself, as a lollipop does: walking along it,
/// whenever it comes to a place where it was (to 0.002 mm), what lies between is a loop, and is
/// left out of the loops that come later. A closed stroke that meets itself nowhere else has none.
/// Crossings are looked for with a budget of about 64 pairs a segment; beyond it only those that
/// are vertices of both parts are seen. O(n log n), also in memory.
void append_stroke_loops(std::span<const PagePoint> stroke, StrokeLoops& out);

}  // namespace popcut
