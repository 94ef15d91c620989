// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// What a picture of a sheet shows, and how large its lines and letters are, so that it can be read
/// when it is 600 pixels wide. A drawing that fills less than half of its sheet is shown alone.
struct SheetFrame {
  Box shown;            ///< sheet mm, with a margin
  bool whole{true};     ///< all of the sheet is in it
  double text_mm{3};    ///< size of letters
  double line_mm{0.2};  ///< width of lines
};

/// The frame for lines within `drawn` on a sheet of this width and length.
///
/// @param beside_ems  room for words beside the picture, in sizes of letters; they make it wider
[[nodiscard]] SheetFrame sheet_frame(const Box& drawn, const std::array<double, 2>& sheet_mm,
                                     double beside_ems = 0.0);

/// The sheet as SVG: pale, with a border.
[[nodiscard]] std::string sheet_rect_svg(const SheetFrame& frame,
                                         const std::array<double, 2>& sheet_mm);

/// The whole sheet small, with the shown part in it, as SVG within a square of `size_mm` from
/// `corner` on; empty if the frame shows the whole sheet.
[[nodiscard]] std::string sheet_inset_svg(const SheetFrame& frame, const Box& drawn,
                                          const std::array<double, 2>& sheet_mm,
                                          const PagePoint& corner, double size_mm);

/// "120.0 x 150.0 mm on a sheet of 304.8 x 304.8 mm".
[[nodiscard]] std::string sheet_words(const Box& drawn, const std::array<double, 2>& sheet_mm);

/// The width of lines that can be seen on a page of this size, in mm: from 0.1 to 0.6.
[[nodiscard]] double seen_line_mm(double page_width_mm, double page_height_mm);

}  // namespace popcut
