// SPDX-License-Identifier: MIT
#include "core/text/text_width.hpp"

namespace popcut {

double text_width(std::string_view text, double size) {
  double ems = 0.0;
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    if ((byte & 0xC0u) == 0x80u) continue;  // a later byte of a letter
    const bool wide = letter == 'm' || letter == 'w' || (letter >= 'A' && letter <= 'Z');
    ems += byte >= 0xE1 ? 1.1 : wide ? 0.85 : 0.62;
  }
  return ems * size;
}

std::string shortened(std::string_view text, double size, double width) {
  if (text_width(text, size) <= width) return std::string(text);
  std::size_t end = 0;
  for (std::size_t i = 1; i <= text.size(); ++i) {
    if (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0u) == 0x80u) continue;
    if (text_width(text.substr(0, i), size) + text_width("…", size) > width) break;
    end = i;
  }
  return std::string(text.substr(0, end)) + "…";
}

}  // namespace popcut
