// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A drag knife: its tip trails `offset_mm` behind the axis that the machine moves, and turns
/// freely.
///
/// While the axis moves, the tip moves along its own heading only (a tractrix): when the axis moves
/// straight at an angle q to the heading, tan(q/2) falls by exp(-s / offset) over s mm. So the tip
/// stays in place while the axis goes around it on an arc of radius `offset`.
struct Blade {
  double offset_mm{};
  double swivel_above_rad{0.26};   ///< sharper corners get an arc
  double arc_tolerance_mm{0.005};  ///< largest distance between an arc and its chords
  PagePoint heading{1.0, 0.0};     ///< unit vector from tip to axis, as the last stroke left it
};

/// Appends to `axis` the path of the axis for which the tip cuts `tip` (two points or more, mm).
/// Straight parts are shifted ahead by the offset; at corners the axis swings around the tip, which
/// stays in place. The path begins with such a swing from `blade.heading` to the first direction
/// (the entry rotation). Updates `blade.heading` to the last direction.
///
/// @return number of points of the entry rotation; 0 if the blade already points the right way
std::size_t append_axis_path(std::span<const PagePoint> tip, Blade& blade,
                             std::vector<PagePoint>& axis);

/// The path of the tip, to 0.005 mm, while the axis follows `axis` with the tool down: the inverse
/// of `append_axis_path`. Updates `blade.heading`, which carries over from stroke to stroke.
[[nodiscard]] std::vector<PagePoint> tip_path(std::span<const PagePoint> axis, Blade& blade);

}  // namespace popcut
