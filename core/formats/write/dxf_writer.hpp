// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Draws a pattern as DXF R12 for cutters' and drawing programs: millimetres, one LINE a line,
/// x = v and y = -u, so that the sheet lies below the x axis as it is seen from the side on which
/// the structure pops up, not mirrored. Layers: CUT (colour 7; slits, then the outline), FOLD_M
/// (1), FOLD_V (5), MARK (8; for what is drawn, none here). Folds come first, the outline last.
/// $INSUNITS 4 and $MEASUREMENT 1 say millimetres: they are newer than R12, but without them each
/// program takes another unit. Places are rounded to 1e-6 mm.
void write_pattern_dxf(const Pattern& pattern, std::ostream& out);

}  // namespace popcut
