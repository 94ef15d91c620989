// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

inline constexpr double kPdfMarginMm = 15.0;  ///< white margin around the sheet; holds the bar

/// Draws a pattern at true scale on one PDF page: the sheet with `kPdfMarginMm` around it, in the
/// style of `write_pattern_svg` (page x = v, y = u downward; mountain red dash-dot, valley blue
/// dashed, slits and outline black). Its name stands above, and below it a bar of 100 mm (50 or 10
/// mm if the sheet is narrower). Measure the bar on the print before you cut.
///
/// @return the bytes of the file; the same pattern gives the same bytes
/// @retval Infeasible  the page would be larger than PDF allows (5080 mm)
/// @retval Internal    the PDF library failed; the detail has its code
[[nodiscard]] Result<std::string> pattern_pdf(const Pattern& pattern);

}  // namespace popcut
