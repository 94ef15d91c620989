// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace popcut {

/// One Unicode character of a text. A length of 0 means that the text is not UTF-8 there.
struct CodePoint {
  std::uint32_t value{};
  std::size_t length{};  ///< bytes
};

/// The character at byte `i` of `text`: no overlong forms, no surrogates, up to U+10FFFF.
[[nodiscard]] CodePoint code_point(std::string_view text, std::size_t i);

/// Whether all of `text` is UTF-8, as `code_point` defines it.
[[nodiscard]] bool is_utf8(std::string_view text);

/// The number of characters in UTF-8 `text`.
[[nodiscard]] std::size_t code_points(std::string_view text);

/// Whether `text` has a control character (C0, DEL, C1), a character that changes the direction of
/// text, a line separator of Unicode, or is not UTF-8. Tabs and line feeds pass if `lines` is set.
[[nodiscard]] bool has_controls(std::string_view text, bool lines = false);

}  // namespace popcut
