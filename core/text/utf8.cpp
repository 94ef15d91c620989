// SPDX-License-Identifier: MIT
#include "core/text/utf8.hpp"

#include <algorithm>

namespace popcut {

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
    if ((c < 0x20 && !is_line) || (c >= 0x7F && c < 0xA0)) return true;
    if (c == 0x2028 || c == 0x2029 || (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069))
      return true;
    i += point.length;
  }
  return false;
}

}  // namespace popcut
