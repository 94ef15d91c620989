// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// An SVG drawing as a PNG on white, its larger side `largest_px` long (librsvg, cairo and libpng).
/// The same drawing gives the same bytes, as long as the libraries and the fonts of its words are
/// the same. Nothing outside of the drawing is read.
///
/// @param svg  as popcut writes it: with a viewBox
/// @retval Internal  they cannot draw it; the detail is theirs
[[nodiscard]] Result<std::string> png_of_svg(std::string_view svg, int largest_px);

/// Pixels as a PNG: `rgb` has three bytes for each, row by row from above.
///
/// @retval Internal  libpng cannot write it; the detail is its own
[[nodiscard]] Result<std::string> png_of_pixels(std::span<const std::uint8_t> rgb, int width,
                                                int height);

}  // namespace popcut
