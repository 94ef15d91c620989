// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/artwork/colour_image.hpp"
#include "core/geometry/page_point.hpp"
#include "core/result.hpp"

namespace popcut {

/// One page of artwork, in mm from its upper left corner.
struct ArtworkPage {
  std::array<double, 2> size_mm{};
  const ColourImage* image{};  ///< null: none; drawn with its own pixel size from the corner on
  double pixel_mm{};
  PagePoint shift_mm{};            ///< of the image, to the right and down
  std::vector<std::string> svgs;   ///< drawings over the image: documents whose viewBox is in mm
  std::array<double, 2> svg_mm{};  ///< their size
  std::vector<Box> marks{};        ///< filled black
  std::string words{};             ///< beside the bars
  PagePoint bar{};                 ///< where the bars of 100 mm meet: one goes right, one up
  double bar_across_mm{}, bar_down_mm{};  ///< their lengths; 0: none
  std::array<double, 2> stretch{1, 1};    ///< of all of it, for printers that print too small
};

/// Pages as a PDF: pixels packed without loss (Flate), marks and bars as lines, nothing scaled but
/// by `stretch`. The same pages give the same bytes.
///
/// @retval Internal  the libraries cannot draw it; the detail is theirs
[[nodiscard]] Result<std::string> pdf_of_artwork(std::span<const ArtworkPage> pages,
                                                 std::string_view title);

}  // namespace popcut
