// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

inline constexpr double kPdfMarginMm = 15.0;  ///< white around the sheet; the bar stands in it

/// Draws a pattern at true scale on one PDF page, the sheet's size and `kPdfMarginMm` around it, as
/// `write_pattern_svg` does (page x = v, y = u downward; mountain red dash-dot, valley blue dashed,
/// slits and outline black), with its name above and a bar of 100 mm below (50 or 10 mm where the
/// sheet is narrower): measure it on the print before paper is lost.
///
/// @return the bytes of the file, the same for the same pattern
/// @retval Infeasible  the page would be larger than a PDF page can be (5080 mm)
/// @retval Internal    the PDF library failed; the detail has its code
[[nodiscard]] Result<std::string> pattern_pdf(const Pattern& pattern);

}  // namespace popcut
