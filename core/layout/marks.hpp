// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include "core/layout/layout.hpp"
#include "core/layout/line_index.hpp"

namespace popcut {

/// Draws marks on both sides of each seam, clear of all lines: ticks that meet when you glue the
/// pieces, and the number of the piece with the seam's letter ("2B"). A warning counts the seams
/// without room. Marks stand on the panels, not on the tabs. `clearance_mm` is the free space
/// around each mark.
void add_marks(Layout& layout, LineIndex& lines, double clearance_mm);

/// Turns the marks into rows of short cuts, for machines without a pen.
void cut_marks(Layout& layout);

/// "A", "B", ... "Z", "AA", "AB", ...
[[nodiscard]] std::string seam_label(std::size_t i);

/// Polylines of capital letters, digits, '-' and '.', `height_mm` high, as single strokes with a
/// bar below. The bar tells N from Z, 6 from 9 and M from W when the paper lies upside down. The
/// origin is the left end of the baseline, y down, mm. Other characters become spaces.
[[nodiscard]] std::vector<std::vector<PagePoint>> single_stroke(std::string_view text,
                                                                double height_mm);

/// Width and height in mm of what `single_stroke` draws, including the bar.
[[nodiscard]] PagePoint single_stroke_size(std::string_view text, double height_mm);

}  // namespace popcut
