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

}  // namespace popcut
