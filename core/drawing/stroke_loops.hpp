// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// Closed loops one after the other; the last point of each repeats its first.
struct StrokeLoops {
  std::vector<PagePoint> points;
  std::vector<std::uint32_t> ends;  ///< per loop: one past its last point

  [[nodiscard]] std::span<const PagePoint> loop(std::size_t i) const {
    const std::size_t first = i == 0 ? 0 : ends[i - 1];
    return std::span(points).subspan(first, ends[i] - first);
  }
};

/// Appends the loops that a stroke makes where it meets itself (like a lollipop). It walks along
/// the stroke. When it reaches a place where it was before (to 0.002 mm), the part between becomes
/// a loop and is left out of later loops. A closed stroke that meets itself nowhere else has no
/// loops. The search for crossings has a budget of about 64 pairs per segment; beyond it, it sees
/// only crossings that are vertices of both parts. O(n log n) time and memory.
void append_stroke_loops(std::span<const PagePoint> stroke, StrokeLoops& out);

}  // namespace popcut
