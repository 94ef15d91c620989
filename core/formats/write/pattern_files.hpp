// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>
#include <span>
#include <string>

#include "core/drawing/linework.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

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

/// Writes a pattern as DXF R12 for cutting and drawing programs: millimetres, one LINE per line, x
/// = v and y = -u. So the sheet lies below the x axis, as seen from the pop-up side and not
/// mirrored. Layers: CUT (colour 7; slits, then the outline), FOLD_M (1), FOLD_V (5), MARK (8; pen
/// lines, none here). Folds come first, the outline last. $INSUNITS 4 and $MEASUREMENT 1 set
/// millimetres. They are newer than R12, but without them each program assumes a different unit.
/// Coordinates are rounded to 1e-6 mm.
void write_pattern_dxf(const Pattern& pattern, std::ostream& out);

/// Writes what is cut on one sheet as DXF R12 for programs that drive a cutter, such as Silhouette
/// Studio: millimetres at true size, x to the right and y up from the lower left corner of the
/// page. Lines stay in their order, which is that of cutting. A line of two points is a LINE, a
/// longer one a POLYLINE. Layers: DRAW (colour 3), SCORE (4), FOLD (1), CUT (7). In a dashed
/// drawing each dash of a fold is a line of its own.
void write_sheet_dxf(const LineWork& drawing, const std::array<double, 2>& page_mm,
                     std::ostream& out);

}  // namespace popcut
