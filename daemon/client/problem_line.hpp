// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"
#include "daemon/client/http_client.hpp"

namespace popcut::client {

/// popcutd's problem (application/problem+json) as the one error a person reads: what of the
/// request is wrong and where, or why it may not be now and what may.
///
/// @param place  what the request was about ("sphere.json", "job 01J..."); stands before a pointer
[[nodiscard]] Error error_from(const HttpResponse& response, const std::string& place);

}  // namespace popcut::client
