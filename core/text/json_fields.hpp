// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// What a JSON text may be before any memory is taken for it.
struct JsonLimits {
  std::size_t bytes{256u << 20};
  std::size_t values{8'000'000};  ///< about the number of commas and brackets
  int depth{64};
};

/// "line L, column C" of the byte with this number, counted from 1.
[[nodiscard]] std::string line_and_column(std::string_view text, std::size_t byte);

/// A key as a part of a JSON pointer (RFC 6901): "/" and "~" escaped, at most 64 bytes of it.
[[nodiscard]] std::string json_pointer_token(std::string_view key);

/// Holds a text against the limits, before it is parsed.
///
/// @retval Malformed  too large, too deep or too many values
[[nodiscard]] Result<void> check_json_limits(std::string_view text, const JsonLimits& limits);

/// Parses JSON text from outside: at most `max_depth` deep, no key twice in one object.
///
/// @retval Malformed  not JSON (place is line and column), too deep, more than two million values,
///                    or a doubled key (place is its JSON pointer)
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, int max_depth = 64);

/// The candidate nearest to `word` when it is near enough to be what was meant, else empty.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& candidates);

/// Reads the fields of one JSON object, each error with its JSON pointer. The first error wins and
/// is kept; the values read after it are the fallbacks. `finish` reports it, or a field that nobody
/// asked for.
class JsonFields {
 public:
  JsonFields(const nlohmann::json& object, std::string pointer);

  [[nodiscard]] bool has(const std::string& key);
  /// A number from `low` to `high` (both lawful); `open_low` leaves `low` itself out.
  double number(const std::string& key, std::optional<double> fallback, double low, double high,
                bool open_low = false);
  int integer(const std::string& key, std::optional<int> fallback, int low, int high);
  std::string text(const std::string& key, std::optional<std::string> fallback);
  bool boolean(const std::string& key, bool fallback);
  /// One of `words`; returns its index.
  std::size_t word(const std::string& key, std::size_t fallback,
                   const std::vector<std::string>& words);
  /// Any value, or nullptr.
  const nlohmann::json* value(const std::string& key);
  [[nodiscard]] std::string pointer(const std::string& key) const {
    return pointer_ + "/" + json_pointer_token(key);
  }
  /// Keeps `error` unless there is one already.
  void add_error(ErrorKind kind, const std::string& place, std::string detail);
  [[nodiscard]] Result<void> finish() const;

 private:
  const nlohmann::json* require(const std::string& key, bool required, const char* type);
  const nlohmann::json& object_;
  std::string pointer_;
  std::vector<std::string> asked_;
  std::optional<Error> error_;
};

/// "a number", "a list", ... for an error message.
[[nodiscard]] std::string json_type(const nlohmann::json& value);

}  // namespace popcut
