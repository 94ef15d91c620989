// SPDX-License-Identifier: MIT
#include "protocol/program.hpp"

#include <iterator>

#include <fmt/format.h>

namespace popcut {

std::string_view name_of(Verb verb) {
  switch (verb) {
    case Verb::Initialise:
      return "initialise";
    case Verb::Query:
      return "query";
    case Verb::Move:
      return "move";
    case Verb::Draw:
      return "draw";
    case Verb::Speed:
      return "speed";
    case Verb::Force:
      return "force";
    case Verb::BladeOffset:
      return "blade offset";
    case Verb::CornerLift:
      return "corner lift";
    case Verb::CornerExtend:
      return "corner extend";
    case Verb::SelectTool:
      return "tool";
    case Verb::Mat:
      return "mat";
    case Verb::Orientation:
      return "orientation";
    case Verb::WindowNear:
      return "window near";
    case Verb::WindowFar:
      return "window far";
    case Verb::Autoblade:
      return "autoblade";
    case Verb::TrackEnhance:
      return "track enhance";
    case Verb::LineType:
      return "line type";
    case Verb::Home:
      return "home";
    case Verb::SetOrigin:
      return "set origin";
    case Verb::Absolute:
      return "absolute";
    case Verb::Empty:
      return "empty";
    case Verb::Other:
      return "setting";
    case Verb::Unknown:
      return "unknown";
  }
  return "";
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
