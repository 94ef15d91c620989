// SPDX-License-Identifier: MIT
#include "core/text/field_table.hpp"

#include <cmath>

namespace popcut::shape {

Shape<double> number(const Range& range, const std::string& unit) {
  json schema{{"type", "number"}};
  if (std::isfinite(range.low)) schema[range.is_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) schema["maximum"] = range.high;
  return {std::move(schema),
          number_words(range.low, range.high, range.is_open),
          [](const json& value) { return value.is_number(); },
          [range](FieldReader& fields, const std::string& below, const json& value) {
            return fields.number_at(below, value, range.low, range.high, range.is_open);
          },
          [](const double& value) { return json(value); },
          unit};
}

Shape<int> whole(int low, int high) {
  json schema{{"type", "integer"}, {"minimum", low}, {"maximum", high}};
  if (low == high) schema = {{"const", low}};
  return {std::move(schema), fmt::format("a whole number from {} to {}", low, high),
          [](const json& value) { return value.is_number(); },
          [low, high](FieldReader& fields, const std::string& below,
                      const json& value) -> std::optional<int> {
            const auto got = fields.integer_at(below, value, low, high);
            if (!got) return std::nullopt;
            return static_cast<int>(*got);
          },
          [](const int& value) { return json(value); }};
}

Shape<std::string> text(const TextRule& rule) {
  json schema{{"type", "string"}};
  if (rule.least > 0) schema["minLength"] = rule.least;
  if (rule.most != TextRule{}.most) schema["maxLength"] = rule.most;
  return {std::move(schema), "a text", [](const json& value) { return value.is_string(); },
          [rule](FieldReader& fields, const std::string& below, const json& value) {
            return fields.text_at(below, value, rule);
          },
          [](const std::string& value) { return json(value); }};
}

Shape<bool> boolean() {
  return {{{"type", "boolean"}},
          "true or false",
          [](const json& value) { return value.is_boolean(); },
          [](FieldReader& fields, const std::string& below, const json& value) {
            return fields.boolean_at(below, value);
          },
          [](const bool& value) { return json(value); }};
}

Shape<json> any(json schema, std::string what) {
  return {std::move(schema), std::move(what), [](const json&) { return true; },
          [](FieldReader&, const std::string&, const json& value) {
            return std::optional<json>(value);
          }};
}

Shape<std::array<double, 3>> triple(const Range& range, const std::string& what) {
  auto numbers = list(number(range), {3, 3, ErrorKind::Malformed}, what);
  auto shape = as<std::array<double, 3>>(numbers, [](const std::vector<double>& v) {
    return std::array<double, 3>{v[0], v[1], v[2]};
  });
  shape.written = [](const std::array<double, 3>& value) { return json(value); };
  return shape;
}

}  // namespace popcut::shape
