// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::daemon::http {

/// daemon/http/openapi.json, which is part of the program: what /v1/openapi.json answers.
[[nodiscard]] std::string_view openapi_json();

}  // namespace popcut::daemon::http
