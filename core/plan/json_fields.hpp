// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// Reads the fields of one JSON object, each required unless it says otherwise. The first fault is
/// kept in `fault`, after which nothing is read: so a reader is a plain list of its fields.
class JsonFields {
 public:
  JsonFields(const nlohmann::json& value, std::string pointer, std::optional<Error>& fault);

  void text(const char* key, std::string& out);
  void flag(const char* key, bool& out);
  void number(const char* key, double& out, double lowest, double highest);
  void whole(const char* key, long& out, long lowest, long highest);
  template <typename Int>
  void whole(const char* key, Int& out, long lowest, long highest) {
    long value = 0;
    whole(key, value, lowest, highest);
    if (!fault_) out = static_cast<Int>(value);
  }
  /// The value at `key` of the given kind, or null after a fault.
  const nlohmann::json* object(const char* key);
  const nlohmann::json* array(const char* key);
  /// Known, but of no meaning here ("source", "like").
  void also(const char* key);
  /// Everything that was not asked for is a fault.
  void nothing_else();

  [[nodiscard]] std::string at(const char* key) const;
  void reject(ErrorKind kind, std::string place, std::string detail);

 private:
  const nlohmann::json* get(const char* key);

  const nlohmann::json& value_;
  std::string pointer_;
  std::optional<Error>& fault_;
  std::vector<std::string> known_;
};

}  // namespace popcut
