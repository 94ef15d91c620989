// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/artwork/artwork.hpp"
#include "core/artwork/printed_sheet.hpp"
#include "core/plan/plan.hpp"
#include "core/print/pages.hpp"
#include "core/result.hpp"

namespace popcut {

/// How artwork comes onto the paper of a printer.
struct PrintPageOptions {
  double pixel_mm{25.4 / 300};
  Trapping trapping{};
  bool words{true};       ///< beside the bar; false: no font is looked for, as in a worker
  bool back{false};       ///< the other side too, as a second page
  bool cut_lines{false};  ///< cut and fold lines over the artwork; the sheets have `lines`
  std::array<double, 2> bars_mm{100, 100};         ///< what the bars of 100 mm measure on a print
  std::optional<std::array<double, 2>> page_mm{};  ///< the printer's paper; none: the sheet's size
};

/// Whether nothing is printed but names and where tabs go: such an artwork has no pixels.
[[nodiscard]] bool is_blank(const Artwork& artwork);

/// The PDF of one planned sheet: the artwork, its registration marks, and a bar of 100 mm where
/// there is room for it.
///
/// Parts that have names (`Plan::parts`) are named beside them where there is room.
///
/// @param lines  lines to draw in place of pixels, an SVG of the pattern's page, or empty
/// @param lined  the sheet's page with its cut and fold lines and a legend, of `sheet_pages` over
///               artwork: the artwork goes below it, in place of a page of the sheet alone
/// @retval Infeasible  the page is smaller than the sheet; artwork is too near to a mark
[[nodiscard]] Result<std::string> artwork_sheet_pdf(const Artwork& artwork,
                                                    const std::string& lines, const Plan& plan,
                                                    std::size_t sheet,
                                                    const PrintPageOptions& options,
                                                    const PrintedPage* lined = nullptr);

/// A planned sheet with its artwork as `sheet_svg`, for programs that print and cut: the artwork is
/// the layer "print", as pixels (PNG) or as `lines`.
///
/// @retval as `artwork_sheet_pdf`
[[nodiscard]] Result<std::string> artwork_sheet_svg(const Artwork& artwork,
                                                    const std::string& lines, const Plan& plan,
                                                    std::size_t sheet,
                                                    const PrintPageOptions& options);

/// The artwork of a sheet alone, as a PNG, for programs that take a picture and lines apart: as
/// large as the box around the strokes and the bleed beyond it on all sides, so that the middles of
/// both are one place. White where there is no ink: such programs trim what is transparent, and cut
/// around what is not, which must be no line of the card. Of a blank artwork it shows names and
/// where tabs go.
///
/// @retval as `artwork_sheet_pdf`
[[nodiscard]] Result<std::string> artwork_sheet_png(const Artwork& artwork, const Plan& plan,
                                                    std::size_t sheet,
                                                    const PrintPageOptions& options);

/// A page with a bar of 100 mm in either direction, to measure what the printer makes of it.
[[nodiscard]] Result<std::string> scale_page_pdf(const PrintPageOptions& options);

}  // namespace popcut
