// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace popcut::daemon::http {

/// What the service gave as the place where a list goes on, in the form that clients see: base64url
/// without padding, to be handed back and not looked into.
[[nodiscard]] std::string encode_cursor(std::string_view place);

/// The other way round, or nothing for what `encode_cursor` never gave.
[[nodiscard]] std::optional<std::string> decode_cursor(std::string_view cursor);

}  // namespace popcut::daemon::http
