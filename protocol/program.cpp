// SPDX-License-Identifier: MIT
#include "protocol/program.hpp"

#include <array>
#include <iterator>

#include <fmt/format.h>

namespace popcut {

std::string_view name_of(Verb verb) {
  constexpr std::array<std::string_view, 23> kNames{
      "initialise",   "query",       "move",          "draw",          "speed",     "force",
      "blade offset", "corner lift", "corner extend", "tool",          "mat",       "orientation",
      "window near",  "window far",  "autoblade",     "track enhance", "line type", "home",
      "set origin",   "absolute",    "empty",         "setting",       "unknown"};
  return kNames.at(static_cast<std::size_t>(verb));
}

std::string printable(std::string_view text, std::size_t most) {
  std::string out;
  for (const char c : text.substr(0, most)) {
    if (c >= ' ' && c <= '~')
      out += c;
    else
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace popcut
