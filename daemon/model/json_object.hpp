// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/warning.hpp"

namespace popcut::daemon {

/// The text of a JSON object, written member by member in their order: lists have thousands of
/// jobs, and a text needs no memory to be destroyed. Invalid UTF-8 becomes U+FFFD.
class JsonObject {
 public:
  JsonObject& text(std::string_view name, std::string_view value);
  /// Null for an empty text.
  JsonObject& text_or_null(std::string_view name, std::string_view value);
  JsonObject& texts(std::string_view name, const std::vector<std::string>& values);
  template <std::integral Whole>
  JsonObject& number(std::string_view name, Whole value) {
    return whole_number(name, static_cast<std::int64_t>(value));
  }
  /// As short as it reads back the same; null for infinity and NaN.
  JsonObject& number(std::string_view name, double value);
  /// Rounded to so many decimals; null for infinity and NaN.
  JsonObject& number(std::string_view name, double value, int decimals);
  JsonObject& pair(std::string_view name, const std::array<double, 2>& values);
  JsonObject& pair(std::string_view name, const std::array<double, 2>& values, int decimals);
  JsonObject& flag(std::string_view name, bool value);
  JsonObject& null(std::string_view name);
  JsonObject& object(std::string_view name, const JsonObject& inner);
  JsonObject& objects(std::string_view name, const std::vector<JsonObject>& all);
  JsonObject& warnings(std::string_view name, const std::vector<Warning>& all);
  /// A value that is JSON already.
  JsonObject& json(std::string_view name, std::string_view value);
  /// Adds the members of another object.
  JsonObject& members_of(const JsonObject& other);

  /// "{...}"
  [[nodiscard]] std::string whole() const { return out_ + '}'; }

 private:
  JsonObject& whole_number(std::string_view name, std::int64_t value);
  void begin(std::string_view name);
  std::string out_{"{"};
};

/// "[{...},{...}]"
[[nodiscard]] std::string json_list_of(const std::vector<JsonObject>& all);

/// `text` as a JSON string, with its quotes.
[[nodiscard]] std::string json_text(std::string_view text);

}  // namespace popcut::daemon
