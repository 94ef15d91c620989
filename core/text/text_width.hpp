// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// An upper bound of the width of a text in a sans-serif font of this size, in the size's unit. Few
/// letters are wider than 0.62 of the size; capitals, m and w are, and from Hangul on letters are
/// as wide as they are high.
[[nodiscard]] double text_width(std::string_view text, double size);

/// `text`, or its beginning with an ellipsis if it is wider than `width`.
[[nodiscard]] std::string shortened(std::string_view text, double size, double width);

/// `text` in rows of at most `width`, broken between words; a word that is wider is shortened.
[[nodiscard]] std::vector<std::string> text_rows(std::string_view text, double size, double width);

}  // namespace popcut
