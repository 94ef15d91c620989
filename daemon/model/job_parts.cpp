// SPDX-License-Identifier: MIT
#include "daemon/model/job_parts.hpp"

#include <algorithm>
#include <cstdint>

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

void put(JsonObject& out, std::string_view name, std::int64_t number) { out.number(name, number); }
void take(const JsonLeaf& leaf, std::int64_t& number) {
  constexpr double kMost = 1e15;
  if (leaf.number) number = static_cast<std::int64_t>(std::clamp(*leaf.number, 0.0, kMost));
}

template <typename Part>
JsonObject object_of_part(const Part& part) {
  JsonObject out;
  list_fields(&part, [&](std::string_view name, auto member) { put(out, name, part.*member); });
  return out;
}

template <typename Part>
std::optional<Part> part_from_json(std::string_view json) {
  Part part;
  const bool whole = each_json_leaf(json, [&](const JsonLeaf& leaf) {
    list_fields(&part, [&](std::string_view name, auto member) {
      if (leaf.depth == 1 && leaf.name == name) take(leaf, part.*member);
    });
  });
  return whole && json.starts_with('{') ? std::optional(part) : std::nullopt;
}

}  // namespace

JsonObject json_of(const LoadedSheet& load) { return object_of_part(load); }
JsonObject json_of(const Handwork& work) { return object_of_part(work); }

std::optional<LoadedSheet> loaded_sheet_from_json(std::string_view json) {
  return part_from_json<LoadedSheet>(json);
}
std::optional<Handwork> handwork_from_json(std::string_view json) {
  return part_from_json<Handwork>(json);
}

}  // namespace popcut::daemon
