// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
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

/// The first characters of UTF-8 `text`, at most so many bytes of them.
[[nodiscard]] std::string_view utf8_start(std::string_view text, std::size_t bytes);

/// UTF-16 as UTF-8; half a surrogate pair becomes U+FFFD.
///
/// @param big  the high byte of a pair comes first
[[nodiscard]] std::string utf8_of_utf16(std::string_view text, bool big);

/// The text of a file without its byte order mark. UTF-16 becomes UTF-8; without a mark it is known
/// by its first two characters, if these are ASCII.
///
/// @param kept  holds a text that was changed; the result may point into it, else into `bytes`
[[nodiscard]] std::string_view plain_text(std::string_view bytes, std::string& kept);

/// Appends a character as UTF-8.
void append_utf8(std::string& out, std::uint32_t character);

/// The number of characters in UTF-8 `text`.
[[nodiscard]] std::size_t code_points(std::string_view text);

/// Whether `text` has a control character (C0, DEL, C1), a character that changes the direction of
/// text, a line separator of Unicode, or is not UTF-8. Tabs and line feeds pass if `lines` is set.
[[nodiscard]] bool has_controls(std::string_view text, bool lines = false);

/// Whether `text` begins with one of the characters that turn the direction of what follows (U+202A
/// to U+202E, U+2066 to U+2069; three bytes of UTF-8), so that it reads as what it is not.
[[nodiscard]] bool is_bidi_control(std::string_view text);

/// `text` in one line for a terminal: control characters become blanks, those of UTF-8 too (U+0080
/// to U+009F, which some terminals take for escape sequences; those of `is_bidi_control`). What is
/// no UTF-8 stays as it is.
[[nodiscard]] std::string shown_text(std::string_view text);

/// The first `most` bytes of `text` in printable ASCII; every other byte becomes a question mark.
[[nodiscard]] std::string shown_ascii(std::string_view text, std::size_t most);

}  // namespace popcut
