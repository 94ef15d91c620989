// SPDX-License-Identifier: MIT
#include "core/text/field_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

using nlohmann::json;
using Kind = ValueRule::Kind;

constexpr std::size_t kMostNameBytes = 1024;

/// A value of a document, with its place below the object that is read.
struct Place {
  FieldReader& fields;
  std::string below;
  const json& value;
};

/// How a kind of values is read and described.
struct KindTraits {
  bool (*takes)(const json& value);  ///< whether the value has its JSON type
  bool (*read)(const ValueRule& rule, const Place& at);
  json (*schema)(const ValueRule& rule);
};
const KindTraits& traits_of(Kind kind);

bool takes_value(const ValueRule& rule, const json& value) {
  if (rule.takes_null && value.is_null()) return true;
  if (rule.is_flat && value.is_array() && !value.empty() && value.front().is_array()) return false;
  return traits_of(rule.kind).takes(value);
}

bool read_value(const ValueRule& rule, const Place& at) {
  if (!rule.is_blamed) return traits_of(rule.kind).read(rule, at);
  const json nothing = json::object();
  FieldReader scratch(nothing);
  if (traits_of(rule.kind).read(rule, {scratch, at.below, at.value})) return true;
  at.fields.refuse(at.below, ErrorKind::Malformed,
                   fmt::format("is {}; must be {}", shown_type(at.value), rule.what));
  return false;
}

json schema_of(const ValueRule& rule) { return traits_of(rule.kind).schema(rule); }

// 1. Reading.

bool store(const ValueRule& rule, const json& value) {
  if (rule.into.set != nullptr) rule.into.set(rule.into.at, value);
  return true;
}

/// Stores a value that follows its rule; nothing is one that does not.
template <typename T>
bool store(const ValueRule& rule, const std::optional<T>& value) {
  return value && store(rule, json(*value));
}

bool read_any(const ValueRule& rule, const Place& at) { return store(rule, at.value); }

bool read_flag(const ValueRule& rule, const Place& at) {
  return store(rule, at.fields.boolean_at(at.below, at.value));
}

bool read_number(const ValueRule& rule, const Place& at) {
  if (rule.takes_null && at.value.is_null()) return store(rule, at.value);
  const auto& [low, high, is_open] = rule.range;
  return store(rule, at.fields.number_at(at.below, at.value, low, high, is_open));
}

bool read_whole(const ValueRule& rule, const Place& at) {
  return store(rule,
               at.fields.integer_at(at.below, at.value, static_cast<std::int64_t>(rule.range.low),
                                    static_cast<std::int64_t>(rule.range.high)));
}

bool read_text(const ValueRule& rule, const Place& at) {
  return store(rule, at.fields.text_at(at.below, at.value, rule.text));
}

bool read_file_name(const ValueRule& rule, const Place& at) {
  const auto name = at.fields.text_at(at.below, at.value, {});
  if (!name ||
      (!name->empty() && name->size() <= kMostNameBytes && name->find('\0') == std::string::npos))
    return store(rule, name);
  at.fields.refuse(at.below, ErrorKind::OutOfRange,
                   fmt::format("is not a file name; must have 1 to {} characters", kMostNameBytes),
                   "length");
  return false;
}

bool read_word(const ValueRule& rule, const Place& at) {
  const auto index = at.fields.word_at(at.below, at.value, rule.words);
  if (index && !rule.into.takes_index) return store(rule, at.value);
  return store(rule, index);
}

bool read_list(const ValueRule& rule, const Place& at) {
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

bool read_object(const ValueRule& rule, const Place& at) {
  FieldReader inner = at.fields.nested(at.value, at.below);
  return at.value.is_object() && read_whole_object(rule.table(), inner);
}

bool read_tagged(const ValueRule& rule, const Place& at) {
  FieldReader inner = at.fields.nested(at.value, at.below);
  if (!at.value.is_object()) return false;
  inner.need("type", fmt::format("must be one of {}", fmt::join(rule.words, ", ")));
  const auto type = inner.optional_word("type", rule.words);
  return type && read_whole_object(rule.parts[*type].table(), inner);
}

bool read_either(const ValueRule& rule, const Place& at) {
  for (const ValueRule& part : rule.parts)
    if (takes_value(part, at.value)) return read_value(part, at);
  at.fields.refuse(at.below, ErrorKind::Malformed,
                   fmt::format("is {}; must be {}", shown_type(at.value), rule.what), "type");
  return false;
}

// 2. The schema.

json any_schema(const ValueRule& rule) { return rule.schema; }
json flag_schema(const ValueRule&) { return {{"type", "boolean"}}; }
json word_schema(const ValueRule& rule) { return {{"enum", rule.words}}; }
json object_schema_of(const ValueRule& rule) { return object_schema(rule.table()); }

json number_schema(const ValueRule& rule) {
  const auto& [low, high, is_open] = rule.range;
  json schema{{"type", "number"}};
  if (rule.takes_null) schema["type"] = {"number", "null"};
  if (std::isfinite(low)) schema[is_open ? "exclusiveMinimum" : "minimum"] = low;
  if (std::isfinite(high)) schema["maximum"] = high;
  return schema;
}

json whole_schema(const ValueRule& rule) {
  const auto low = static_cast<std::int64_t>(rule.range.low);
  const auto high = static_cast<std::int64_t>(rule.range.high);
  if (low == high) return {{"const", low}};
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}};
}

json text_schema(const ValueRule& rule) {
  json schema{{"type", "string"}};
  if (rule.text.least > 0) schema["minLength"] = rule.text.least;
  if (rule.text.most != TextRule{}.most) schema["maxLength"] = rule.text.most;
  return schema;
}

json list_schema(const ValueRule& rule) {
  return {{"type", "array"},
          {"minItems", rule.count.least},
          {"maxItems", rule.count.most},
          {"items", schema_of(rule.parts.front())}};
}

json tagged_schema(const ValueRule& rule) {
  json schema;
  for (std::size_t k = 0; k < rule.parts.size(); ++k) {
    json one = schema_of(rule.parts[k]);
    one.update(rule.parts[k].schema);
    one["properties"]["type"]["const"] = rule.words[k];
    one["required"].push_back("type");
    schema["oneOf"].push_back(std::move(one));
  }
  return schema;
}

json either_schema(const ValueRule& rule) {
  json schema;
  for (const ValueRule& part : rule.parts) schema["oneOf"].push_back(schema_of(part));
  return schema;
}

/// The value of a field that is left out; null: there is none.
json usual_value(const ValueRule& rule) {
  const bool is_plain = rule.kind != Kind::Any && rule.kind < Kind::List;
  if (!rule.usual.is_null() || rule.is_needed || !is_plain || rule.into.get == nullptr)
    return rule.usual;
  json usual = rule.into.get(rule.into.at);
  if (rule.into.takes_index && !usual.is_null()) return rule.words.at(usual.get<std::size_t>());
  return usual;
}

// 3. The kinds.

bool is_anything(const json&) { return true; }
bool is_flag(const json& value) { return value.is_boolean(); }
bool is_number(const json& value) { return value.is_number(); }
bool is_text(const json& value) { return value.is_string(); }
bool is_list(const json& value) { return value.is_array(); }
bool is_object(const json& value) { return value.is_object(); }

const KindTraits& traits_of(Kind kind) {
  static constexpr KindTraits kTraits[] = {
      {is_anything, read_any, any_schema},         // Any
      {is_flag, read_flag, flag_schema},           // Flag
      {is_number, read_number, number_schema},     // Number
      {is_number, read_whole, whole_schema},       // Whole
      {is_text, read_text, text_schema},           // Text
      {is_text, read_file_name, text_schema},      // FileName
      {is_text, read_word, word_schema},           // Word
      {is_list, read_list, list_schema},           // List
      {is_object, read_object, object_schema_of},  // Object
      {is_object, read_tagged, tagged_schema},     // Tagged
      {is_anything, read_either, either_schema},   // Either
  };
  return kTraits[static_cast<std::size_t>(kind)];
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
  bool is_right = true;  // beside the count of faults, which ends at the most that are kept
  if (table.check_presence) table.check_presence(fields);
  for (const Field& row : table.rows) {
    const std::string name(row.name);
    if (row.rule.is_needed) fields.need(name, "must be " + row.rule.what);
    const json* found = fields.value(name);
    is_right &= found ? read_value(row.rule, {fields, name, *found}) : !row.rule.is_needed;
  }
  is_right &= fields.faults().size() == before;
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
  if (!table.more.is_null()) schema.update(table.more);
}

json object_schema(const FieldTable& table) {
  json schema{{"type", "object"}, {"additionalProperties", false}};
  describe_fields(table, schema);
  return schema;
}

namespace rule {

ValueRule number(Member into, Range range, std::string unit) {
  return {.kind = Kind::Number,
          .into = into,
          .what = number_words(range.low, range.high, range.is_open),
          .range = range,
          .unit = std::move(unit)};
}

ValueRule number_or_null(Member into, Range range) {
  ValueRule rule = number(into, range);
  rule.takes_null = true;
  return rule;
}

ValueRule whole(Member into, std::int64_t low, std::int64_t high) {
  return {.kind = Kind::Whole,
          .into = into,
          .what = fmt::format("a whole number from {} to {}", low, high),
          .range = from(static_cast<double>(low), static_cast<double>(high))};
}

ValueRule text(Member into, const TextRule& limits) {
  return {.kind = Kind::Text, .into = into, .what = "a text", .text = limits};
}

ValueRule file_name(Member into) {
  return {.kind = Kind::FileName, .into = into, .what = "a text", .text = {1, kMostNameBytes}};
}

ValueRule flag(Member into) { return {.kind = Kind::Flag, .into = into, .what = "true or false"}; }

ValueRule word(Member into, std::vector<std::string> words) {
  std::string what = fmt::format("one of {}", fmt::join(words, ", "));
  return {.kind = Kind::Word, .into = into, .what = std::move(what), .words = std::move(words)};
}

ValueRule any(Member into, json schema, std::string what) {
  return {.into = into, .what = std::move(what), .schema = std::move(schema)};
}

ValueRule list(Member into, ValueRule item, Count count, std::string what) {
  return {.kind = Kind::List,
          .into = into,
          .what = std::move(what),
          .unit = item.unit,
          .count = count,
          .parts = {std::move(item)}};
}

ValueRule triple(Member into, Range range, std::string what) {
  ValueRule rule = list(into, number({}, range), {3, 3, ErrorKind::Malformed}, std::move(what));
  if (into.get != nullptr) rule.usual = into.get(into.at);
  return rule;
}

ValueRule object(std::function<FieldTable()> table, std::string what) {
  return {.kind = Kind::Object, .what = std::move(what), .table = std::move(table)};
}

ValueRule tagged(const std::vector<Field>& kinds) {
  ValueRule rule{.kind = Kind::Tagged, .what = "an object"};
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
  return {.kind = Kind::Either,
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
