// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

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

/// How far to cut a closed path past its seam at either end: `wanted_mm`, but at most a quarter of
/// its length `round_mm`.
[[nodiscard]] double overcut_for(double round_mm, double wanted_mm);

/// Whether such a line gets an overcut: closed cuts and outlines do.
[[nodiscard]] bool takes_overcut(Operation operation, std::span<const PagePoint> points);

/// Appends the first or the last `mm` of a line, in the line's direction.
void append_head(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);
void append_tail(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);

/// Appends a closed path that begins `overcut_mm` before its seam and ends as far past it.
void append_with_overcut(std::span<const PagePoint> points, double overcut_mm,
                         std::vector<PagePoint>& out);

/// Length of one round of a closed path that has `passes` rounds, mm.
[[nodiscard]] double round_mm(std::span<const PagePoint> points, int passes);

}  // namespace popcut
