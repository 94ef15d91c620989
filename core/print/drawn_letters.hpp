// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace popcut {

/// A drawing of popcut whose letters are lines, so that no font is needed: `single_stroke` letters
/// in place of each `text` element, in capitals, as wide as `text_width` allows. Characters without
/// a glyph leave a space.
[[nodiscard]] std::string with_drawn_letters(std::string_view svg);

}  // namespace popcut
