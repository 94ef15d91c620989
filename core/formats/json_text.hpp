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
  std::size_t values{20'000'000};  ///< about the number of commas and brackets
  int depth{64};
};

/// Parses JSON from somebody else. A first pass over the text counts depth and values without
/// taking memory; a byte order mark is skipped.
///
/// @retval Malformed  not JSON, too deep or too large; place is "line L, column C" where it has one
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text,
                                                const JsonLimits& limits = {});

/// What a value is, for messages: "a number", "an array" ...
[[nodiscard]] const char* kind_of(const nlohmann::json& value);

/// `pointer/key` with `~` and `/` of the key escaped as JSON pointers ask.
[[nodiscard]] std::string json_pointer(std::string_view pointer, std::string_view key);

}  // namespace popcut
