// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace popcut {

/// Whether `text` begins with one of the characters that turn the direction of what follows (U+202A
/// to U+202E, U+2066 to U+2069; three bytes of UTF-8), so that it reads as what it is not.
[[nodiscard]] bool is_bidi_control(std::string_view text);

/// `text` in one line for a terminal: control characters become blanks, those of UTF-8 too (U+0080
/// to U+009F, which some terminals take for escape sequences; those of `is_bidi_control`). What is
/// no UTF-8 stays as it is.
[[nodiscard]] std::string shown_text(std::string text);

}  // namespace popcut
