// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/result.hpp"
#include "daemon/client/http_client.hpp"

namespace popcut::client {

/// What the body of a request was made from; decides how a pointer into it is shown.
enum class Subject { CommandLine, File };

/// A problem of popcutd (application/problem+json) as one error for a person: what is wrong in the
/// request and where, or why it is not possible now and what is. Members that come from the command
/// line are named as they are typed there; a pointer into a file stays a pointer.
///
/// @param place  what the request was about ("sphere.json", "job 01J..."); stands before a pointer
/// @param sent   the body that was sent, to show the wrong value
[[nodiscard]] Error error_from(const HttpResponse& response, const std::string& place,
                               Subject subject = Subject::CommandLine,
                               const nlohmann::json* sent = nullptr);

}  // namespace popcut::client
