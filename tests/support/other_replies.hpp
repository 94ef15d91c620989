// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "protocol/replies.hpp"

namespace popcut {

/// Replies to queries that popcut does not send.

/// Two numbers: the reply to `[`, `U`, FA, TB71 and TC.
struct NumberPair {
  double first{};
  double second{};
};

[[nodiscard]] inline Result<NumberPair> parse_pair(std::string_view reply) {
  return parse_numbers(reply, 2, 2).map([](const std::vector<double>& values) {
    return NumberPair{values[0], values[1]};
  });
}

/// The reply to G: where the tool is, in units of the feed and the carriage.
[[nodiscard]] inline Result<NumberPair> parse_position(std::string_view reply) {
  return parse_numbers(reply, 3, 3).map([](const std::vector<double>& values) {
    return NumberPair{values[0], values[1]};
  });
}

/// The reply to ESC NAK, one code per holder: 0 empty, 1 ratchet blade, 2 autoblade, 3 deep cut, 4
/// kraft blade, 5 rotary blade, 7 pen, 255 error.
[[nodiscard]] inline Result<std::vector<int>> parse_tools(std::string_view reply) {
  return parse_numbers(reply, 1, 8)
      .and_then([](const std::vector<double>& values) -> Result<std::vector<int>> {
        std::vector<int> codes;
        for (const double value : values) {
          if (!(value >= 0 && value <= 255) || value != static_cast<int>(value))
            return fail(ErrorKind::Malformed, "", "tool codes of 0 to 255 were expected");
          codes.push_back(static_cast<int>(value));
        }
        return codes;
      });
}

/// "empty", "ratchet blade", ...; "unknown tool" for codes without a known meaning.
[[nodiscard]] inline std::string_view tool_name(int code) {
  constexpr std::string_view kNames[]{
      "empty",       "ratchet blade", "autoblade",    "deep-cut blade",
      "kraft blade", "rotary blade",  "unknown tool", "pen"};
  return code == 255 ? "error" : code >= 0 && code < 8 ? kNames[code] : "unknown tool";
}

}  // namespace popcut
