// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut::daemon::http {

/// daemon/http/api/openapi.json, which is part of the program: the schemas of answers, and what the
/// API is as a whole.
[[nodiscard]] std::string_view openapi_source();

/// What /v1/openapi.json answers. Added to that source are the operations (from `routes`), the
/// schemas of bodies (from the `Body` of each route), of plan options and of pages of lists, and
/// the problems.
[[nodiscard]] std::string_view openapi_json();

}  // namespace popcut::daemon::http
