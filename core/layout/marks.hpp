// SPDX-License-Identifier: MIT
#pragma once

#include "core/layout/layout.hpp"
#include "core/layout/line_index.hpp"

namespace popcut {

/// Draws on both sides of each seam ticks that meet where the pieces are glued, and the number of
/// the piece with the seam's letter ("2B"), where no line is in their way. What finds no room is
/// told in the warnings. `tabs` lie on one side: letters stand on the panels, ticks too.
void add_marks(Layout& layout, LineIndex& lines, double clearance_mm);

/// Makes the marks rows of short cuts, for machines without a pen.
void cut_marks(Layout& layout);

/// "A", "B", ... "Z", "AA", "AB", ...
[[nodiscard]] std::string seam_label(std::size_t i);

}  // namespace popcut
