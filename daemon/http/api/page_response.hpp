// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "daemon/http/api/message.hpp"
#include "daemon/http/api/page_files.hpp"

namespace popcut::daemon::http {

/// A file of the page with all that a browser must know of it: what the page may do (CSP with
/// trusted types), how long it may be kept, and which of its two codings this is.
///
/// @param accept_encoding  the header of the request (RFC 9110, 12.5.3); without it the file goes
/// as
///                         it is, which every client reads
[[nodiscard]] Response page_response(const PageFile& file, std::string_view accept_encoding);

}  // namespace popcut::daemon::http
