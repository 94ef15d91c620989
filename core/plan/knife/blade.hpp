// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A drag knife: its tip trails the axis that the machine moves by `offset_mm`, and turns freely.
///
/// While the axis moves, the tip moves along its own heading only (a tractrix): along a straight
/// way at an angle q to the heading, tan(q/2) falls by exp(-s / offset) after s mm. So the tip
/// stays where it is while the axis goes round it on an arc of radius `offset`.
struct Blade {
  double offset_mm{};
  double swivel_above_rad{0.26};   ///< corners above this angle are turned on an arc
  double arc_tolerance_mm{0.005};  ///< between an arc and its chords
  PagePoint heading{1.0, 0.0};     ///< from tip to axis, a unit vector; what the last stroke left
};

/// The way of the axis whose tip cuts `tip` (two points or more): each straight part is shifted
/// ahead by the offset, and at corners the axis swings about the standing tip. It begins with such
/// a swing from `blade.heading` to the first direction (the entry rotation), and leaves the last
/// direction in `blade.heading`. Appended to `axis`. Returns how many points the entry rotation
/// has; 0 where the blade stood right already.
std::size_t append_axis_path(std::span<const PagePoint> tip, Blade& blade,
                             std::vector<PagePoint>& axis);

/// What the tip does while the axis goes along `axis` with the tool down, to 0.005 mm; the inverse
/// of `append_axis_path`. `blade.heading` goes on from stroke to stroke.
[[nodiscard]] std::vector<PagePoint> tip_path(std::span<const PagePoint> axis, Blade& blade);

}  // namespace popcut
