// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// For each line with `counts` set, the number of closed lines among these that contain its middle
/// point and whose box contains its box; 0 for all others. Even-odd rule; a line is never inside
/// itself.
[[nodiscard]] std::vector<std::uint32_t> nesting_depth(const LineWork& work,
                                                       const std::vector<std::uint8_t>& counts);

/// The closed lines around each line, without those that follow from the others: `around(i)` holds
/// the innermost one, whose own `around` has the next. It holds more than one only where lines
/// cross.
struct Nesting {
  std::vector<std::uint32_t> first;  ///< per line, and one more: into `holders`
  std::vector<std::uint32_t> holders;
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t line) const {
    return std::span(holders).subspan(first[line], first[line + 1] - first[line]);
  }
};

/// Nesting of the lines with `counts` set, like `nesting_depth`. If two closed lines contain each
/// other's middle, the one with the larger area is outside. A stroke that meets itself, such as a
/// lollipop, contains what lies in its loops. O(n log n) plus the size of the result, for lines
/// that are not nested thousands deep.
[[nodiscard]] Nesting nesting(const LineWork& work, const std::vector<std::uint8_t>& counts);

/// Appends the loops that a stroke makes where it meets itself (like a lollipop). It walks along
/// the stroke. When it reaches a place where it was before (to 0.002 mm), the part between becomes
/// a loop and is left out of later loops. A closed stroke that meets itself nowhere else has no
/// loops. The search for crossings has a budget of about 64 pairs per segment; beyond it, it sees
/// only crossings that are vertices of both parts. O(n log n) time and memory.
void append_stroke_loops(std::span<const PagePoint> stroke, Polylines& out);

}  // namespace popcut
