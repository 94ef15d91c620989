// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <span>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Draws a pattern for viewing: 1 user unit is 1 mm, page x = v and y = u (wall on top, seen from
/// the pop-up side), and the page is the sheet. Inkscape layers: `fold-mountain` (red, dash-dot),
/// `fold-valley` (blue, dashed), `cut` (the slits, black) and `outline` (black). One `path` per
/// line of the pattern, each with `data-assignment` (M, V, C for a slit, B) and `data-foldAngle` of
/// the pi/2 pose in degrees. Coordinates are rounded to 1e-6 mm.
void write_pattern_svg(const Pattern& pattern, std::ostream& out);

/// Draws a pattern for cutting: like `write_pattern_svg`, but every fold is drawn as micro-cuts,
/// each a separate solid path, because cutting programs drop stroke-dasharray. Layers are in
/// cutting order. `data-popcut="dashes"` tells popcut's reader to cut the folds as they are.
/// `micro_cuts` are lines on the sheet with the role of their fold.
void write_cut_svg(const Pattern& pattern, std::span<const SheetLine> micro_cuts,
                   std::ostream& out);

}  // namespace popcut
