// SPDX-License-Identifier: MIT
#include "core/text/text_width.hpp"

#include <algorithm>
#include <utility>

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

std::vector<std::string> text_rows(std::string_view text, double size, double width) {
  std::vector<std::string> rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    std::string word = shortened(text.substr(at, end - at), size, width);
    at = end + 1;
    if (!rows.empty() && text_width(rows.back() + " " + word, size) <= width)
      rows.back() += " " + word;
    else
      rows.push_back(std::move(word));
  }
  return rows;
}

}  // namespace popcut
