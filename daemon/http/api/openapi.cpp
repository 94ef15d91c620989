// SPDX-License-Identifier: MIT
#include "daemon/http/api/openapi.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/plan/plan_options.hpp"

namespace popcut::daemon::http {
namespace {

using Json = nlohmann::ordered_json;
using Kind = PlanOption::Kind;

Json types(const char* type) { return Json::array({type, "string"}); }

/// The numbers that an option may have, and its default if it has one.
void add_range(const PlanOption& option, Json& schema) {
  const auto number = [&](double value) -> Json {
    if (option.kind == Kind::Whole) return static_cast<std::int64_t>(value);
    return value;
  };
  schema["type"] = types(option.kind == Kind::Whole ? "integer" : "number");
  schema["minimum"] = number(option.least);
  schema["maximum"] = number(option.most);
  const std::vector<double> usual = option.numbers(PlanOptions{});
  if (!usual.empty()) schema["default"] = number(usual.front());
  if (!option.unit.empty())
    schema["description"] = fmt::format("{} ({})", option.help, option.unit);
}

/// What a request may give for an option. Numbers and flags may be texts too.
Json schema_of(const PlanOption& option) {
  Json schema{{"type", "string"}, {"description", option.help}};
  switch (option.kind) {
    case Kind::Flag:
      schema["type"] = types("boolean");
      schema["default"] = false;
      break;
    case Kind::Number:
    case Kind::Whole:
      add_range(option, schema);
      break;
    case Kind::Lengths:
      schema["type"] = types("number");
      break;
    case Kind::Word:
      schema["enum"] = option.words;
      if (std::find(option.words.begin(), option.words.end(), option.usual) != option.words.end())
        schema["default"] = option.usual;
      break;
    case Kind::Text:
      if (!option.usual.empty()) schema["default"] = option.usual;
      break;
    case Kind::Place:
      break;
  }
  return schema;
}

std::string plan_options_schema() {
  Json properties = Json::object();
  for (const PlanOption& option : plan_option_table()) {
    if (option.of_request) continue;
    properties[std::string(option.name)] = schema_of(option);
    if (option.opposite.empty()) continue;
    properties[std::string(option.opposite)] = {
        {"type", types("boolean")},
        {"description", fmt::format("The opposite of {}", option.name)},
        {"default", true}};
  }
  return Json{{"type", "object"},
              {"description",
               "The options of 'popcut plan', without their dashes. A list is a text with commas."},
              {"maxProperties", 32},
              {"properties", properties},
              {"additionalProperties", false}}
      .dump();
}

}  // namespace

std::string_view openapi_json() {
  static const std::string kText = [] {
    constexpr std::string_view kPlace = "\"PlanOptions\": {}";
    std::string text(openapi_text());
    text.replace(text.find(kPlace), kPlace.size(), "\"PlanOptions\": " + plan_options_schema());
    return text;
  }();
  return kText;
}

}  // namespace popcut::daemon::http
