// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/artwork/artwork.hpp"
#include "core/artwork/printed_sheet.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut {

/// How artwork comes onto the paper of a printer.
struct PrintPageOptions {
  double pixel_mm{25.4 / 300};
  Trapping trapping{};
  bool words{true};  ///< beside the bar; false: no font is looked for, as in a worker
  bool back{false};  ///< the other side too, as a second page
  std::array<double, 2> bars_mm{100, 100};         ///< what the bars of 100 mm measure on a print
  std::optional<std::array<double, 2>> page_mm{};  ///< the printer's paper; none: the sheet's size
};

/// The PDF of one planned sheet: the artwork, its registration marks, and a bar of 100 mm where
/// there is room for it.
///
/// @param lines  lines to draw in place of pixels, an SVG of the pattern's page, or empty
/// @retval Infeasible  the page is smaller than the sheet; artwork is too near to a mark
[[nodiscard]] Result<std::string> artwork_sheet_pdf(const Artwork& artwork,
                                                    const std::string& lines, const Plan& plan,
                                                    std::size_t sheet,
                                                    const PrintPageOptions& options);

/// A page with a bar of 100 mm in either direction, to measure what the printer makes of it.
[[nodiscard]] Result<std::string> scale_page_pdf(const PrintPageOptions& options);

}  // namespace popcut
