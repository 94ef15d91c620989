// SPDX-License-Identifier: MIT
#include "core/text/utf8.hpp"

#include <optional>

#include <algorithm>

namespace popcut {
namespace {

bool is_control(std::uint32_t c) { return c < 0x20 || (c >= 0x7F && c < 0xA0); }

bool turns_direction(std::uint32_t c) {
  return (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
}

}  // namespace

CodePoint code_point(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return k < text.size() ? std::uint32_t{static_cast<unsigned char>(text[k])} : 0u;
  };
  const std::uint32_t first = byte(i);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return {};
  std::uint32_t value = first & (0xFFu >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0u) != 0x80u) return {};
    value = value << 6 | (byte(i + k) & 0x3Fu);
  }
  const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
  if (overlong || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return {};
  return {value, length};
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = code_point(text, i).length;
    if (length == 0) return false;
    i += length;
  }
  return true;
}

std::string_view utf8_start(std::string_view text, std::size_t bytes) {
  text = text.substr(0, bytes);
  while (!is_utf8(text)) text.remove_suffix(1);
  return text;
}

void append_utf8(std::string& out, std::uint32_t character) {
  const auto put = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (character < 0x80) return put(character);
  const unsigned tails = character < 0x800 ? 1 : character < 0x10000 ? 2 : 3;
  put((0xFF00U >> (tails + 1) & 0xFFU) | character >> 6 * tails);
  for (unsigned k = tails; k-- > 0;) put(0x80U | (character >> 6 * k & 0x3FU));
}

std::size_t code_points(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;
  }));
}

bool has_controls(std::string_view text, bool lines) {
  for (std::size_t i = 0; i < text.size();) {
    const CodePoint point = code_point(text, i);
    if (point.length == 0) return true;
    const std::uint32_t c = point.value;
    const bool is_line = lines && (c == '\n' || c == '\t');
    if ((is_control(c) && !is_line) || c == 0x2028 || c == 0x2029 || turns_direction(c))
      return true;
    i += point.length;
  }
  return false;
}

bool is_bidi_control(std::string_view text) { return turns_direction(code_point(text, 0).value); }

std::string shown_text(std::string_view text) {
  std::string shown;
  for (std::size_t length = 0; !text.empty(); text.remove_prefix(length)) {
    const CodePoint point = code_point(text, 0);
    length = std::max<std::size_t>(point.length, 1);
    if (point.length > 0 && (is_control(point.value) || turns_direction(point.value)))
      shown += ' ';
    else
      shown += text.substr(0, length);
  }
  return shown;
}

std::string shown_ascii(std::string_view text, std::size_t most) {
  std::string shown(text.substr(0, most));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

namespace {

/// Whether a text is UTF-16 with the high byte first, or the low one; none for other texts.
std::optional<bool> big_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return false;
  if (bytes.starts_with("\xFE\xFF")) return true;
  if (bytes.size() < 4) return std::nullopt;
  const auto is_ascii = [&](char c) { return c != 0 && static_cast<unsigned char>(c) < 0x80; };
  if (is_ascii(bytes[0]) && bytes[1] == 0 && is_ascii(bytes[2]) && bytes[3] == 0) return false;
  if (bytes[0] == 0 && is_ascii(bytes[1]) && bytes[2] == 0 && is_ascii(bytes[3])) return true;
  return std::nullopt;
}

}  // namespace

std::string utf8_of_utf16(std::string_view text, bool big) {
  const auto unit = [&](std::size_t i) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    return static_cast<std::uint32_t>(big ? byte(i) << 8 | byte(i + 1)
                                          : byte(i + 1) << 8 | byte(i));
  };
  std::string out;
  out.reserve(text.size() / 2 + 16);
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xE000) {
      const std::uint32_t low = c < 0xDC00 && i + 3 < text.size() ? unit(i + 2) : 0;
      const bool pair = low >= 0xDC00 && low < 0xE000;
      c = pair ? 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00) : 0xFFFD;
      if (pair) i += 2;
    }
    append_utf8(out, c);
  }
  return out;
}

std::string_view plain_text(std::string_view bytes, std::string& kept) {
  if (bytes.starts_with("\xEF\xBB\xBF")) return bytes.substr(3);
  const auto big = big_utf16(bytes);
  if (!big) return bytes;
  const bool marked = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  kept = utf8_of_utf16(bytes.substr(marked ? 2 : 0), *big);
  return kept;
}

}  // namespace popcut
