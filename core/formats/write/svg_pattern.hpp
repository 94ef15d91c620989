// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <span>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Draws a pattern to look at: 1 user unit is 1 mm, page x = v and y = u (the wall on top, seen
/// from the side on which the structure pops up), the page is the sheet. Layers as Inkscape writes
/// them: `fold-mountain` (red, dash-dot), `fold-valley` (blue, dashed), `cut` (the slits, black)
/// and `outline` (black). One `path` a line of the pattern, each with `data-assignment` (M, V, C
/// for a slit, B) and `data-foldAngle` of the pi/2 pose in degrees. Places are rounded to 1e-6 mm.
void write_pattern_svg(const Pattern& pattern, std::ostream& out);

/// Draws a pattern to cut: as `write_pattern_svg`, but every fold is its micro-cuts, each a solid
/// path of its own, because cutters' programs drop stroke-dasharray. The layers stand in the order
/// of cutting; `data-popcut="dashes"` tells popcut's reader to cut the folds as they stand.
/// `micro_cuts` are places on the sheet with the role of their fold.
void write_cut_svg(const Pattern& pattern, std::span<const SheetLine> micro_cuts,
                   std::ostream& out);

}  // namespace popcut
