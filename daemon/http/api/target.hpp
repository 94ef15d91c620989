// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/model/problem.hpp"

namespace popcut::daemon::http {

/// A target "/a/b?x=1&y" taken apart, everything decoded.
struct Target {
  std::vector<std::string> segments;  ///< "a", "b"; "/" is one empty segment
  std::vector<std::pair<std::string, std::string>> query;
};

/// Decodes `target`. Nothing that a later reader could take for something else is let through:
/// no %5C in a segment, and no %2F but in the id of a device (after /v1/devices/), no control
/// characters, no "." and "..", no invalid UTF-8, no query name twice.
///
/// @retval BadRequest  says which of these
[[nodiscard]] Answer<Target> read_target(std::string_view target);

/// `text` percent-decoded ("+" stays a plus), or a problem if a percent sign is not followed by two
/// hexadecimal digits, or the result is not UTF-8 without control characters.
[[nodiscard]] Answer<std::string> percent_decoded(std::string_view text);

/// What the service gave as the place where a list goes on, in the form that clients see: base64url
/// without padding, to be handed back and not looked into.
[[nodiscard]] std::string encode_cursor(std::string_view place);

/// The other way round, or nothing for what `encode_cursor` never gave.
[[nodiscard]] std::optional<std::string> decode_cursor(std::string_view cursor);

}  // namespace popcut::daemon::http
