// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Writes a pattern as DXF R12 for cutting and drawing programs: millimetres, one LINE per line, x
/// = v and y = -u. So the sheet lies below the x axis, as seen from the pop-up side and not
/// mirrored. Layers: CUT (colour 7; slits, then the outline), FOLD_M (1), FOLD_V (5), MARK (8; pen
/// lines, none here). Folds come first, the outline last. $INSUNITS 4 and $MEASUREMENT 1 set
/// millimetres. They are newer than R12, but without them each program assumes a different unit.
/// Coordinates are rounded to 1e-6 mm.
void write_pattern_dxf(const Pattern& pattern, std::ostream& out);

}  // namespace popcut
