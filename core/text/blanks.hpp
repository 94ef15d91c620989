// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string_view>

namespace popcut {

/// What CSS and SVG call white space.
inline constexpr std::string_view kBlanks = " \t\n\r\f";

[[nodiscard]] constexpr bool is_blank(char c) { return kBlanks.find(c) != std::string_view::npos; }

/// `text` without the characters of `blanks` before and after it.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text,
                                                 std::string_view blanks = kBlanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

}  // namespace popcut
