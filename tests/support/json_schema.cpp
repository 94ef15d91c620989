// SPDX-License-Identifier: MIT
#include "tests/support/json_schema.hpp"

#include <algorithm>
#include <regex>
#include <set>

namespace popcut {
namespace {

using nlohmann::json;

bool has_type(const json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return std::string(value.type_name()) == type;
}

const std::set<std::string> kWords{"$ref",          "type",
                                   "enum",          "const",
                                   "pattern",       "minimum",
                                   "maximum",       "minLength",
                                   "maxLength",     "minItems",
                                   "maxItems",      "minProperties",
                                   "items",         "properties",
                                   "required",      "oneOf",
                                   "description",   "format",
                                   "default",       "example",
                                   "maxProperties", "additionalProperties",
                                   "anyOf",         "exclusiveMinimum",
                                   "title",         "$schema"};

}  // namespace

const json& JsonSchema::resolved(const json& schema) const {
  const json* found = &schema;
  while (found->contains("$ref"))
    found = &document_.at(json::json_pointer(found->at("$ref").get<std::string>().substr(1)));
  return *found;
}

std::vector<std::string> JsonSchema::faults(const json& value, const json& schema) const {
  std::vector<std::string> out;
  check(value, schema, "", out);
  return out;
}

void JsonSchema::check(const json& value, const json& reference, const std::string& at,
                       std::vector<std::string>& out) const {
  const json& schema = resolved(reference);
  const auto wrong = [&](const std::string& what) { out.push_back(at + ": " + what); };
  if (schema == false) wrong("must not be there");
  if (schema.is_boolean()) return;
  for (const auto& [word, ignored] : schema.items())
    if (kWords.count(word) == 0) wrong("the schema has the unknown word " + word);
  if (const auto type = schema.find("type"); type != schema.end()) {
    const bool fits = type->is_string()
                          ? has_type(value, *type)
                          : std::any_of(type->begin(), type->end(),
                                        [&](const json& one) { return has_type(value, one); });
    if (!fits) return wrong("is " + value.dump().substr(0, 60) + " and not " + type->dump());
  }
  if (const auto one = schema.find("oneOf"); one != schema.end()) {
    const auto fitting = std::count_if(one->begin(), one->end(), [&](const json& alternative) {
      return faults(value, alternative).empty();
    });
    if (fitting != 1) wrong("fits " + std::to_string(fitting) + " alternatives and not one");
  }
  if (const auto any = schema.find("anyOf"); any != schema.end())
    if (std::none_of(any->begin(), any->end(),
                     [&](const json& alternative) { return faults(value, alternative).empty(); }))
      wrong("fits none of the alternatives");
  if (const auto words = schema.find("enum"); words != schema.end())
    if (std::find(words->begin(), words->end(), value) == words->end())
      wrong(value.dump() + " is none of " + words->dump());
  if (schema.contains("const") && schema.at("const") != value) wrong("is not the constant");
  if (value.is_string()) {
    const std::string text = value;
    if (schema.contains("pattern") &&
        !std::regex_search(text, std::regex(schema.at("pattern").get<std::string>())))
      wrong(text + " does not fit the pattern");
    if (text.size() < schema.value("minLength", std::size_t{0})) wrong("is too short");
    if (text.size() > schema.value("maxLength", std::size_t{1} << 30)) wrong("is too long");
  }
  if (value.is_number()) {
    if (schema.contains("minimum") && value < schema.at("minimum")) wrong("is too small");
    if (schema.contains("exclusiveMinimum") && value <= schema.at("exclusiveMinimum"))
      wrong("is too small");
    if (schema.contains("maximum") && value > schema.at("maximum")) wrong("is too large");
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", std::size_t{0})) wrong("has too few items");
    if (value.size() > schema.value("maxItems", std::size_t{1} << 30)) wrong("has too many items");
    if (schema.contains("items"))
      for (std::size_t i = 0; i < value.size(); ++i)
        check(value[i], schema.at("items"), at + "/" + std::to_string(i), out);
  }
  if (value.is_object()) check_object(value, schema, at, out);
}

void JsonSchema::check_object(const json& value, const json& schema, const std::string& at,
                              std::vector<std::string>& out) const {
  // Looked up and not copied: a copy of all that lies below would be most of the work.
  const auto required = schema.find("required");
  const auto known = schema.find("properties");
  const auto more = schema.find("additionalProperties");
  if (required != schema.end())
    for (const json& name : *required)
      if (!value.contains(name.get<std::string>()))
        out.push_back(at + ": has no " + name.get<std::string>());
  for (const auto& [name, member] : value.items()) {
    if (known != schema.end() && known->contains(name))
      check(member, known->at(name), at + "/" + name, out);
    else if (more != schema.end() && more->is_object())
      check(member, *more, at + "/" + name, out);
    else if (more != schema.end() ? !more->get<bool>() : known != schema.end())
      out.push_back(at + ": has the member " + name + ", which is not documented");
  }
}

}  // namespace popcut
