// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/artwork/artwork.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/result.hpp"

namespace popcut {

/// What is printed on one planned sheet, in mm from its upper left corner: with the same placement
/// as the strokes of the sheet's program.
struct PrintedSheet {
  PixelFrame frame;
  ColourImage image;
};

/// What is printed on a sheet. Each piece has its part of the artwork and `bleed_mm` around it; so
/// beyond a seam, and on a glue tab, is what its partner has there.
///
/// @param quiet_mm  around registration marks nothing is printed; what the knife keeps must not
///                  come that near
/// @retval Infeasible  a piece comes too near to a mark; the detail says how near and where
/// @retval OutOfRange  more than `kMaxPixels`
[[nodiscard]] Result<PrintedSheet> printed_sheet(const Artwork& artwork, const Plan& plan,
                                                 std::size_t sheet, double pixel_mm,
                                                 const Trapping& how, double quiet_mm = 1.0);

/// Its mirror image, left and right exchanged: for the other side of the sheet.
[[nodiscard]] ColourImage mirrored(const ColourImage& image);

}  // namespace popcut
