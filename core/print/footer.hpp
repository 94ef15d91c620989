// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A kind of line or area that the legend of a page explains.
struct LegendEntry {
  std::string style;  ///< SVG attributes of the sample line, or of the filled sample
  std::string words;
  bool filled{false};
};

/// The colours of folds on pages.
inline constexpr std::string_view kMountainInk = "#d00000", kValleyInk = "#0000d0";

/// The dashes of a fold on a page, mm: dashes and gaps in turn. A fold always shows two dashes or
/// more, so that it does not look like a cut in grey either: where it is shorter than two of the
/// usual ones and their gap, they are smaller, and below 3.5 mm dots.
[[nodiscard]] std::vector<double> fold_dashes_mm(Operation operation, double length_mm);

/// The entry of an operation, in the look that pages give it: cuts solid black, mountain folds
/// red dash-dot, valley folds blue dashed, scores green dotted, pen lines grey.
[[nodiscard]] LegendEntry legend_entry(Operation operation);
/// The entry of glue tabs.
[[nodiscard]] LegendEntry legend_entry_of_tabs();

/// What stands below the drawing of a page.
struct Footer {
  std::vector<LegendEntry> legend;
  std::vector<std::string> sentences;  ///< the page's name, and which side is up
};

/// Where the footer may stand, mm from the page's upper left corner.
struct FooterPlace {
  double left{}, top{}, width{}, height{};
};

/// Draws a footer as SVG elements: a bar of 100 mm, or the longest of 50, 20, 10 mm that fits, with
/// its length, the legend, and the sentences. Texts are broken between words, and shortened where a
/// word does not fit. Empty if the place has no room for all of it: then there is only the bar in
/// `footer_bar`, and the rest belongs on a page of its own.
[[nodiscard]] std::string footer_svg(const Footer& footer, const FooterPlace& place);
/// The bar alone; empty if not even 10 mm fit.
[[nodiscard]] std::string footer_bar(const FooterPlace& place);
/// The height that the whole footer needs at this width, mm.
[[nodiscard]] double footer_height_mm(const Footer& footer, double width_mm);

}  // namespace popcut
