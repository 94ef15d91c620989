// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::daemon::http {

/// daemon/http/api/openapi.json, which is part of the program. Its schema "PlanOptions" is empty.
[[nodiscard]] std::string_view openapi_text();

/// What /v1/openapi.json answers: that text with the schema "PlanOptions" made from the table of
/// plan options.
[[nodiscard]] std::string_view openapi_json();

}  // namespace popcut::daemon::http
