// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/artwork/colour_image.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads a PNG or JPEG, by its first bytes: eight bits a part, in sRGB as it is written (profiles
/// and gamma are left out), turned as a JPEG's own rows are. What a PNG leaves transparent has less
/// ink. The size is checked before memory is taken.
///
/// @param name  for errors
/// @retval Malformed   neither PNG nor JPEG, or broken; the detail is the library's
/// @retval OutOfRange  more than `most_pixels`, or a JPEG of more scans than any program writes
[[nodiscard]] Result<ColourImage> read_image(const std::string& name, std::string_view bytes,
                                             std::size_t most_pixels = kMaxPixels);

/// Pixels as a PNG with their ink as opacity.
///
/// @retval Internal  libpng failed
[[nodiscard]] Result<std::string> png_of_image(const ColourImage& pixels);

}  // namespace popcut
