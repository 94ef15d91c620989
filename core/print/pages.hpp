// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/pattern/pattern.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut {

/// A page to print: an SVG drawing that fills it except for a margin.
struct PrintedPage {
  std::string svg;
  double width_mm{}, height_mm{};
  double margin_mm{};  ///< around the drawing, which is scaled to fit; 0: true scale
};

inline constexpr double kLargestPageMm = 5080.0;  ///< what PDF allows: 14400 points

/// A name as it can stand on a page: in one line, of at most 120 bytes, with a question mark for
/// each byte that is not UTF-8.
[[nodiscard]] std::string page_name(const std::string& name);

/// What lies below the lines of a page.
enum class PageGround {
  Paper,
  Artwork  ///< a picture: lines have a light rim, and tabs no grey, since they have colours
};

/// The lines of one sheet as they are printed, SVG elements in sheet mm: cuts solid, whole folds
/// dashed, in the looks of `legend_entry`.
///
/// @retval Internal  the sheet has not kept its `lines`
[[nodiscard]] Result<std::string> sheet_lines_svg(const Plan& plan, std::size_t sheet,
                                                  PageGround ground);

/// The pages of a plan. One for each sheet, true to scale: what to cut (solid), whole folds
/// (dashed), tabs in grey, and below it a bar to measure, the legend, the name and number of the
/// sheet, and which side is up. Where there is no room for the legend, it has a page of its own. A
/// drawing that was split ends with a page that shows how the pieces are glued together.
///
/// Each sheet keeps `kPrintSideMm` and `kPrintFooterMm` free around its area; so a page of a
/// machine of the language "hand" is as large as its paper.
///
/// Parts that have names (`Plan::parts`) are named below the drawing, and beside them where there
/// is room. `Plan::glue_marks` are drawn thin and grey.
///
/// @param plan  its sheets have `lines`
/// @retval Infeasible  a page is larger than PDF allows
[[nodiscard]] Result<std::vector<PrintedPage>> sheet_pages(const Plan& plan,
                                                           PageGround ground = PageGround::Paper);

/// The page of one pattern, in the same form: wall on top, seen from the side that pops up.
///
/// @retval Infeasible  the page is larger than PDF allows
[[nodiscard]] Result<std::vector<PrintedPage>> pattern_pages(const Pattern& pattern);

}  // namespace popcut
