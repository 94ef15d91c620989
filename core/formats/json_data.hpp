// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// What a JSON text may be before any memory is taken for it.
struct JsonLimits {
  std::size_t bytes{256u << 20};
  std::size_t values{8'000'000};  ///< about the number of commas and brackets
  int depth{64};
};

/// Parses a large JSON file from elsewhere. A first pass over the text counts depth and values, so
/// that no memory is taken for what is refused; a byte order mark is skipped; the last of doubled
/// keys counts.
///
/// @retval Malformed  not JSON, too deep or too large; place is "line L, column C" where it has one
[[nodiscard]] Result<nlohmann::json> parse_json_data(std::string_view text,
                                                     const JsonLimits& limits = {});

}  // namespace popcut
