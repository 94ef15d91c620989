// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace popcut {

/// Holds values against the JSON schemas of one document. Knows what openapi.json and the schema of
/// a design spec use: $ref, type (one or several), enum, const, pattern, minimum, exclusiveMinimum,
/// maximum, minLength, maxLength, minItems, maxItems, minProperties, items, properties, required,
/// oneOf, anyOf, additionalProperties, true and false. A schema with any other word is refused, so
/// that nothing is left unchecked in silence.
class JsonSchema {
 public:
  explicit JsonSchema(const nlohmann::json& document) : document_(document) {}
  /// What is wrong with `value`, each with its JSON pointer; empty: nothing. Members that the
  /// schema does not name are wrong unless it says that there may be more.
  [[nodiscard]] std::vector<std::string> faults(const nlohmann::json& value,
                                                const nlohmann::json& schema) const;
  /// The schema, or what its $ref stands for.
  [[nodiscard]] const nlohmann::json& resolved(const nlohmann::json& schema) const;

 private:
  void check(const nlohmann::json& value, const nlohmann::json& schema, const std::string& at,
             std::vector<std::string>& out) const;
  void check_object(const nlohmann::json& value, const nlohmann::json& schema,
                    const std::string& at, std::vector<std::string>& out) const;
  const nlohmann::json& document_;
};

}  // namespace popcut
