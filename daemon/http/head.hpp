// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "daemon/http/api/message.hpp"

namespace popcut::daemon::http {

/// What is wrong with the head of a request, before a library reads it: everything on which two
/// readers could disagree is refused (RFC 9112), so that no request hides in another.
///
/// Refused, among others: no Host or two, any transfer coding but one "chunked" in HTTP/1.1, a
/// length beside it, two lengths, folded lines, bare CR or LF, NUL and other control characters,
/// targets that are not a path, spaces before a colon, versions other than 1.0 and 1.1.
///
/// @param raw from the request line to the empty line, both included
/// @return nothing if it may go on
[[nodiscard]] std::optional<Problem> check_head(std::string_view raw);

/// True for the characters of names and methods (RFC 9110, token).
[[nodiscard]] bool is_token(std::string_view text);

/// Lower case of ASCII letters.
[[nodiscard]] std::string to_lower(std::string_view text);

}  // namespace popcut::daemon::http
