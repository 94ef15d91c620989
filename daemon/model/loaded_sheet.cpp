// SPDX-License-Identifier: MIT
#include "daemon/model/loaded_sheet.hpp"

#include "daemon/model/fields.hpp"
#include "daemon/model/json_leaves.hpp"

namespace popcut::daemon {
namespace {

void put(JsonObject& out, std::string_view name, const std::string& text) {
  out.text_or_null(name, text);
}
void put(JsonObject& out, std::string_view name, double number) { out.number(name, number); }

void take(const JsonLeaf& leaf, std::string& text) {
  if (leaf.text) text = *leaf.text;
}
void take(const JsonLeaf& leaf, double& number) {
  if (leaf.number) number = *leaf.number;
}

}  // namespace

JsonObject json_of(const LoadedSheet& load) {
  JsonObject out;
  list_fields(&load, [&](std::string_view name, auto member) { put(out, name, load.*member); });
  return out;
}

std::optional<LoadedSheet> loaded_sheet_from_json(std::string_view json) {
  LoadedSheet load;
  const bool whole = each_json_leaf(json, [&](const JsonLeaf& leaf) {
    list_fields(&load, [&](std::string_view name, auto member) {
      if (leaf.depth == 1 && leaf.name == name) take(leaf, load.*member);
    });
  });
  return whole && json.starts_with('{') ? std::optional(load) : std::nullopt;
}

}  // namespace popcut::daemon
