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

/// Which byte of a pair is the low one of UTF-16; none for other texts.
std::optional<std::size_t> low_byte(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return 0;
  if (bytes.starts_with("\xFE\xFF")) return 1;
  if (bytes.size() < 4) return std::nullopt;
  const auto is_ascii = [&](std::size_t k) { return bytes[k] > 0 && bytes[k + 2] > 0; };
  const auto is_zero = [&](std::size_t k) { return bytes[k] == 0 && bytes[k + 2] == 0; };
  if (is_ascii(0) && is_zero(1)) return 0;
  if (is_zero(0) && is_ascii(1)) return 1;
  return std::nullopt;
}

}  // namespace

std::string_view plain_text(std::string_view bytes, std::string& kept) {
  if (bytes.starts_with("\xEF\xBB\xBF")) return bytes.substr(3);
  const auto low = low_byte(bytes);
  if (!low) return bytes;
  const auto unit = [&](std::size_t k) {
    const auto byte = [&](std::size_t i) {
      return std::uint32_t{static_cast<unsigned char>(bytes[i])};
    };
    return byte(k + *low) | byte(k + 1 - *low) << 8;
  };
  constexpr std::uint32_t kHigh = 0xD800, kLow = 0xDC00, kEnd = 0xE000, kUnknown = 0xFFFD;
  kept.clear();
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
    std::uint32_t character = unit(k);
    if (k == 0 && character == 0xFEFF) continue;
    if (character >= kHigh && character < kLow && k + 3 < bytes.size() && unit(k + 2) >= kLow &&
        unit(k + 2) < kEnd) {
      character = 0x10000 + ((character - kHigh) << 10) + (unit(k + 2) - kLow);
      k += 2;
    }
    append_utf8(kept, character >= kHigh && character < kEnd ? kUnknown : character);
  }
  return kept;
}

}  // namespace popcut
