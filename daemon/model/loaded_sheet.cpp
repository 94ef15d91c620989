// SPDX-License-Identifier: MIT
#include "daemon/model/loaded_sheet.hpp"

#include <nlohmann/json.hpp>

#include "daemon/model/fields.hpp"

namespace popcut::daemon {
namespace {

void put(JsonObject& out, std::string_view name, const std::string& text) {
  out.text_or_null(name, text);
}
void put(JsonObject& out, std::string_view name, double number) { out.number(name, number); }

void take(const nlohmann::json& value, std::string& text) {
  if (value.is_string()) text = value.get<std::string>();
}
void take(const nlohmann::json& value, double& number) {
  if (value.is_number()) number = value.get<double>();
}

}  // namespace

JsonObject json_of(const LoadedSheet& load) {
  JsonObject out;
  list_fields(&load, [&](std::string_view name, auto member) { put(out, name, load.*member); });
  return out;
}

std::optional<LoadedSheet> loaded_sheet_from_json(std::string_view json) {
  const auto object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  LoadedSheet load;
  list_fields(&load, [&](std::string_view name, auto member) {
    if (const auto found = object.find(name); found != object.end()) take(*found, load.*member);
  });
  return load;
}

}  // namespace popcut::daemon
