// SPDX-License-Identifier: MIT
#include "core/text/field_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::size_t kMostNameBytes = 1024;

}  // namespace

/// A value of a document, with its place below the object that is read.
struct ValuePlace {
  FieldReader& fields;
  std::string below;
  const json& value;
};

namespace {

// 1. The JSON types of values.

bool is_anything(const json&) { return true; }
bool is_flag(const json& value) { return value.is_boolean(); }
bool is_number(const json& value) { return value.is_number(); }
bool is_number_or_null(const json& value) { return value.is_number() || value.is_null(); }
bool is_text(const json& value) { return value.is_string(); }
bool is_list(const json& value) { return value.is_array(); }
bool is_flat_list(const json& value) {
  return value.is_array() && (value.empty() || !value.front().is_array());
}
bool is_object(const json& value) { return value.is_object(); }

// 2. Reading.

bool read_value(const ValueRule& rule, const ValuePlace& at) {
  if (!rule.is_blamed) return rule.read(rule, at);
  const json nothing = json::object();
  FieldReader scratch(nothing);
  if (rule.read(rule, {scratch, at.below, at.value})) return true;
  at.fields.refuse(at.below, ErrorKind::Malformed,
                   fmt::format("is {}; must be {}", shown_type(at.value), rule.what));
  return false;
}

bool store(const ValueRule& rule, const json& value) {
  if (rule.into.set != nullptr) rule.into.set(rule.into.at, value);
  return true;
}

/// Stores a value that follows its rule; nothing is one that does not.
template <typename T>
bool store(const ValueRule& rule, const std::optional<T>& value) {
  return value && store(rule, json(*value));
}

bool read_any(const ValueRule& rule, const ValuePlace& at) { return store(rule, at.value); }

bool read_flag(const ValueRule& rule, const ValuePlace& at) {
  return store(rule, at.fields.boolean_at(at.below, at.value));
}

bool read_number(const ValueRule& rule, const ValuePlace& at) {
  if (at.value.is_null() && rule.takes(at.value)) return store(rule, at.value);
  const auto& [low, high, is_open] = rule.range;
  return store(rule, at.fields.number_at(at.below, at.value, low, high, is_open));
}

bool read_whole(const ValueRule& rule, const ValuePlace& at) {
  const auto low = static_cast<std::int64_t>(rule.range.low);
  const auto high = static_cast<std::int64_t>(rule.range.high);
  return store(rule, at.fields.integer_at(at.below, at.value, low, high));
}

bool read_text(const ValueRule& rule, const ValuePlace& at) {
  return store(rule, at.fields.text_at(at.below, at.value, rule.text));
}

bool read_file_name(const ValueRule& rule, const ValuePlace& at) {
  const auto name = at.fields.text_at(at.below, at.value, {});
  if (!name ||
      (!name->empty() && name->size() <= kMostNameBytes && name->find('\0') == std::string::npos))
    return store(rule, name);
  at.fields.refuse(at.below, ErrorKind::OutOfRange,
                   fmt::format("is not a file name; must have 1 to {} characters", kMostNameBytes),
                   "length");
  return false;
}

bool read_word(const ValueRule& rule, const ValuePlace& at) {
  const auto index = at.fields.word_at(at.below, at.value, rule.words);
  if (index && !rule.into.takes_index) return store(rule, at.value);
  return store(rule, index);
}

bool read_list(const ValueRule& rule, const ValuePlace& at) {
  const Count& count = rule.count;
  const std::size_t size = at.value.size();
  if (!at.value.is_array() || size < count.least || size > count.most) {
    at.fields.refuse(at.below, at.value.is_array() ? count.kind : ErrorKind::Malformed,
                     fmt::format("is {}; must be {}", shown_type(at.value), rule.what));
    return false;
  }
  for (std::size_t k = 0; k < size; ++k)
    if (!read_value(rule.parts.front(),
                    {at.fields, fmt::format("{}/{}", at.below, k), at.value[k]}))
      return false;
  return store(rule, at.value);
}

/// Reads the fields of an object that has no others.
bool read_whole_object(const FieldTable& table, FieldReader& fields) {
  const std::size_t before = fields.faults().size();
  const bool is_right = read_fields(table, fields);
  static_cast<void>(fields.finish());
  return is_right && fields.faults().size() == before;
}

bool read_object(const ValueRule& rule, const ValuePlace& at) {
  FieldReader inner = at.fields.nested(at.value, at.below);
  return at.value.is_object() && read_whole_object(rule.table(), inner);
}

bool read_tagged(const ValueRule& rule, const ValuePlace& at) {
  FieldReader inner = at.fields.nested(at.value, at.below);
  if (!at.value.is_object()) return false;
  inner.need("type", fmt::format("must be one of {}", fmt::join(rule.words, ", ")));
  const auto type = inner.optional_word("type", rule.words);
  return type && read_whole_object(rule.parts[*type].table(), inner);
}

bool read_either(const ValueRule& rule, const ValuePlace& at) {
  for (const ValueRule& part : rule.parts)
    if (part.takes(at.value)) return read_value(part, at);
  at.fields.refuse(at.below, ErrorKind::Malformed,
                   fmt::format("is {}; must be {}", shown_type(at.value), rule.what), "type");
  return false;
}

// 3. The schema.

json schema_of(const ValueRule& rule) {
  json schema = rule.schema;
  if (rule.table) schema.update(object_schema(rule.table()));
  for (std::size_t k = 0; k < rule.parts.size(); ++k) {
    json part = schema_of(rule.parts[k]);
    if (rule.read == read_list) {
      schema["items"] = std::move(part);
      continue;
    }
    if (rule.read == read_tagged) {
      part["properties"]["type"]["const"] = rule.words[k];
      part["required"].push_back("type");
    }
    schema["oneOf"].push_back(std::move(part));
  }
  return schema;
}

/// The value of a field that is left out; null: there is none.
json usual_value(const ValueRule& rule) {
  if (!rule.usual.is_null() || rule.is_needed || rule.into.get == nullptr) return rule.usual;
  json usual = rule.into.get(rule.into.at);
  if (rule.into.takes_index && !usual.is_null()) return rule.words.at(usual.get<std::size_t>());
  return usual;
}

}  // namespace

void assign(bool& to, const json& value) { to = value.get<bool>(); }
void assign(int& to, const json& value) { to = value.get<int>(); }
void assign(std::uint64_t& to, const json& value) { to = value.get<std::uint64_t>(); }
void assign(double& to, const json& value) { to = value.get<double>(); }
void assign(std::string& to, const json& value) { to = value.get<std::string>(); }
void assign(json& to, const json& value) { to = value; }
json value_of(bool member) { return member; }
json value_of(int member) { return member; }
json value_of(std::uint64_t member) { return member; }
json value_of(double member) { return member; }
json value_of(const std::string& member) { return member; }
json value_of(const std::array<double, 3>& member) { return member; }
json value_of(const std::vector<double>& member) { return member; }

bool read_fields(const FieldTable& table, FieldReader& fields) {
  const std::size_t before = fields.faults().size();
  const auto& one = table.exactly_one;
  if (one.size() == 2 && fields.has(one[0]) && fields.has(one[1]))
    fields.refuse(one[0], ErrorKind::Malformed,
                  fmt::format("contradicts {}; give one of them", fields.pointer(one[1])));
  bool is_right = true;  // beside the count of faults, which ends at the most that are kept
  for (const Field& row : table.rows) {
    const std::string name(row.name);
    if (row.rule.is_needed) fields.need(name, "must be " + row.rule.what);
    const json* found = fields.value(name);
    is_right &=
        found != nullptr ? read_value(row.rule, {fields, name, *found}) : !row.rule.is_needed;
  }
  is_right &= fields.faults().size() == before;
  if (is_right && !one.empty() && !fields.has(one[1])) {
    for (const Field& row : table.rows)
      if (row.name == one[0]) fields.need(one[0], "must be " + row.rule.what);
  }
  if (is_right && table.complete) table.complete(fields);
  return is_right && fields.faults().size() == before;
}

void describe_fields(const FieldTable& table, json& schema) {
  for (const auto& [name, rule, help] : table.rows) {
    json& field = schema["properties"][std::string(name)] = schema_of(rule);
    field["description"] = rule.unit.empty() ? help : fmt::format("{}, {}", help, rule.unit);
    if (json usual = usual_value(rule); !usual.is_null()) field["default"] = std::move(usual);
    if (rule.is_needed) schema["required"].push_back(name);
  }
  for (const std::string& name : table.exactly_one)
    schema["oneOf"].push_back({{"required", {name}}});
  if (!table.more.is_null()) schema.update(table.more);
}

json object_schema(const FieldTable& table) {
  json schema{{"type", "object"}, {"additionalProperties", false}};
  describe_fields(table, schema);
  return schema;
}

namespace rule {

ValueRule number(Member into, Range range, std::string unit) {
  const auto& [low, high, is_open] = range;
  json schema{{"type", "number"}};
  if (std::isfinite(low)) schema[is_open ? "exclusiveMinimum" : "minimum"] = low;
  if (std::isfinite(high)) schema["maximum"] = high;
  return {.read = read_number,
          .takes = is_number,
          .into = into,
          .what = number_words(low, high, is_open),
          .schema = std::move(schema),
          .unit = std::move(unit),
          .range = range};
}

ValueRule number_or_null(Member into, Range range) {
  ValueRule rule = number(into, range);
  rule.takes = is_number_or_null;
  rule.schema["type"] = {"number", "null"};
  return rule;
}

ValueRule whole(Member into, int low, int high) {
  json schema{{"type", "integer"}, {"minimum", low}, {"maximum", high}};
  if (low == high) schema = {{"const", low}};
  return {.read = read_whole,
          .takes = is_number,
          .into = into,
          .what = fmt::format("a whole number from {} to {}", low, high),
          .schema = std::move(schema),
          .range = from(low, high)};
}

ValueRule text(Member into, const TextRule& limits) {
  json schema{{"type", "string"}};
  if (limits.least > 0) schema["minLength"] = limits.least;
  if (limits.most != TextRule{}.most) schema["maxLength"] = limits.most;
  return {.read = read_text,
          .takes = is_text,
          .into = into,
          .what = "a text",
          .schema = std::move(schema),
          .text = limits};
}

ValueRule file_name(Member into) {
  ValueRule rule = text(into, {1, kMostNameBytes});
  rule.read = read_file_name;
  return rule;
}

ValueRule flag(Member into) {
  return {.read = read_flag,
          .takes = is_flag,
          .into = into,
          .what = "true or false",
          .schema = {{"type", "boolean"}}};
}

ValueRule word(Member into, std::vector<std::string> words) {
  return {.read = read_word,
          .takes = is_text,
          .into = into,
          .what = fmt::format("one of {}", fmt::join(words, ", ")),
          .schema = {{"enum", words}},
          .words = std::move(words)};
}

ValueRule any(Member into, json schema, std::string what) {
  return {.read = read_any,
          .takes = is_anything,
          .into = into,
          .what = std::move(what),
          .schema = std::move(schema)};
}

ValueRule list(Member into, ValueRule item, Count count, std::string what) {
  return {.read = read_list,
          .takes = is_list,
          .into = into,
          .what = std::move(what),
          .schema = {{"type", "array"}, {"minItems", count.least}, {"maxItems", count.most}},
          .unit = item.unit,
          .count = count,
          .parts = {std::move(item)}};
}

ValueRule triple(Member into, Range range, std::string what) {
  ValueRule rule = list(into, number({}, range), {3, 3, ErrorKind::Malformed}, std::move(what));
  rule.takes = is_flat_list;
  return rule;
}

ValueRule object(std::function<FieldTable()> table, std::string what) {
  return {.read = read_object,
          .takes = is_object,
          .what = std::move(what),
          .schema = json::object(),
          .table = std::move(table)};
}

ValueRule tagged(const std::vector<Field>& kinds) {
  ValueRule rule{.read = read_tagged, .takes = is_object, .what = "an object"};
  for (const auto& [name, part, help] : kinds) {
    rule.words.emplace_back(name);
    rule.parts.push_back(part);
    rule.parts.back().schema["description"] = help;
  }
  return rule;
}

ValueRule either(std::vector<ValueRule> alternatives) {
  std::string what;
  for (const ValueRule& one : alternatives) what += (what.empty() ? "" : ", or ") + one.what;
  return {.read = read_either,
          .takes = is_anything,
          .what = std::move(what),
          .unit = alternatives.front().unit,
          .parts = std::move(alternatives)};
}

ValueRule needed(ValueRule rule) {
  rule.is_needed = true;
  return rule;
}

ValueRule blamed(ValueRule rule) {
  rule.is_blamed = true;
  return rule;
}

}  // namespace rule
}  // namespace popcut
