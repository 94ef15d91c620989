// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
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

/// Why a text is not JSON that popcut reads.
struct JsonFault {
  ErrorKind kind{ErrorKind::Malformed};
  std::string detail;
  std::size_t byte{};       ///< of the first byte that is wrong, counted from 1; 0: not known
  std::size_t last_byte{};  ///< of the last one
  std::string pointer{};    ///< of a key that stands twice in one object, else empty
  bool is_syntax{};         ///< the grammar of JSON is broken, not one of popcut's limits
};

/// The list of what `item` makes of each of `items`.
[[nodiscard]] auto json_list(const auto& items, const auto& item) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& one : items) list.push_back(item(one));
  return list;
}

/// The text of a JSON file, indented by two blanks; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string json_file(const nlohmann::json& json);
[[nodiscard]] std::string json_file(const nlohmann::ordered_json& json);

/// A key as a part of a JSON pointer (RFC 6901): "/" and "~" escaped, at most 64 bytes of it.
[[nodiscard]] std::string json_pointer_token(std::string_view key);

/// Parses JSON from outside: no key may stand twice in one object, no number may be too large for a
/// double.
[[nodiscard]] tl::expected<nlohmann::json, JsonFault> read_json(std::string_view text,
                                                                const JsonLimits& limits);

/// Parses JSON text from outside as `read_json`: at most `max_depth` deep and two million values.
///
/// @retval Malformed   not JSON (place is line and column), too deep, too many values, or a doubled
///                     key (place is its JSON pointer)
/// @retval OutOfRange  a number that is too large for a double
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, int max_depth = 64);

/// Parses a large JSON file from elsewhere. A byte order mark is skipped; the last of doubled keys
/// counts.
///
/// @retval Malformed  not JSON, too deep or too large; place is "line L, column C" where it has one
[[nodiscard]] Result<nlohmann::json> parse_json_data(std::string_view text,
                                                     const JsonLimits& limits = {});

}  // namespace popcut
