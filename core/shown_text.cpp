// SPDX-License-Identifier: MIT
#include "core/shown_text.hpp"

namespace popcut {

std::string shown_text(std::string text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  std::size_t end = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool wide =
        byte(at) == 0xc2 && at + 1 < text.size() && byte(at + 1) >= 0x80 && byte(at + 1) < 0xa0;
    const bool control = wide || byte(at) < 0x20 || byte(at) == 0x7f;
    if (wide) ++at;
    text[end++] = control ? ' ' : text[at];
  }
  text.resize(end);
  return text;
}

}  // namespace popcut
