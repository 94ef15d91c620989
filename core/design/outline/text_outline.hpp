// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/design/outline/area.hpp"
#include "core/result.hpp"

namespace popcut {

inline constexpr std::size_t kMostLetters = 200;

/// The font of text that names none: DejaVu Sans Bold, which is part of the program.
[[nodiscard]] std::string_view usual_font();

/// One line of text as shapes, y up: its capitals are `height` high, its leftmost point is at x = 0
/// and its lowest at y = 0. Letters are shaped as the script asks (HarfBuzz), from left to right or
/// from right to left. Curves stray by at most 1/500 of the height.
///
/// @param text  UTF-8
/// @param font  contents of a TrueType or OpenType file
/// @retval Malformed   the font cannot be read; place is "font"
/// @retval OutOfRange  no letters, more than `kMostLetters`, a control character, both writing
///                     directions, or a letter that the font does not have; place is "text"
[[nodiscard]] Result<std::vector<Area>> text_areas(const std::string& text, std::string_view font,
                                                   double height);

}  // namespace popcut
