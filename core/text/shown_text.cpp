// SPDX-License-Identifier: MIT
#include "core/text/shown_text.hpp"

namespace popcut {

bool is_bidi_control(std::string_view text) {
  if (text.size() < 3 || text[0] != '\xe2') return false;
  const auto last = static_cast<unsigned char>(text[2]);
  return (text[1] == '\x80' && last >= 0xaa && last <= 0xae) ||
         (text[1] == '\x81' && last >= 0xa6 && last <= 0xa9);
}

std::string shown_text(std::string text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  std::size_t end = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool wide =
        byte(at) == 0xc2 && at + 1 < text.size() && byte(at + 1) >= 0x80 && byte(at + 1) < 0xa0;
    const bool turns = is_bidi_control(std::string_view(text).substr(at));
    const bool control = wide || turns || byte(at) < 0x20 || byte(at) == 0x7f;
    if (wide) ++at;
    if (turns) at += 2;
    text[end++] = control ? ' ' : text[at];
  }
  text.resize(end);
  return text;
}

}  // namespace popcut
