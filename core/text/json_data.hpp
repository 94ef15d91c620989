// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include "core/text/json_fields.hpp"
#include "core/result.hpp"

namespace popcut {

/// Parses a large JSON file from elsewhere. A first pass over the text counts depth and values, so
/// that no memory is taken for what is refused; a byte order mark is skipped; the last of doubled
/// keys counts.
///
/// @retval Malformed  not JSON, too deep or too large; place is "line L, column C" where it has one
[[nodiscard]] Result<nlohmann::json> parse_json_data(std::string_view text,
                                                     const JsonLimits& limits = {});

}  // namespace popcut
