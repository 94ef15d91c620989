// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/result.hpp"
#include "daemon/client/http_client.hpp"

namespace popcut::client {

/// What a request's body was made of, and so what a pointer into it means to a person.
enum class Subject { CommandLine, File };

/// popcutd's problem (application/problem+json) as the one error a person reads: what of the
/// request is wrong and where, or why it may not be now and what may. What came from the command
/// line is named as it is typed there; a pointer into a file stays one.
///
/// @param place  what the request was about ("sphere.json", "job 01J..."); stands before a pointer
/// @param sent   the body that was sent, to say which value was wrong
[[nodiscard]] Error error_from(const HttpResponse& response, const std::string& place,
                               Subject subject = Subject::CommandLine,
                               const nlohmann::json* sent = nullptr);

}  // namespace popcut::client
