// SPDX-License-Identifier: MIT
#include "daemon/model/warnings.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/model/json_leaves.hpp"
#include "daemon/model/json_object.hpp"

namespace popcut::daemon {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestCode = 40;

void put_place(JsonObject& out, const WarningPlace& place) {
  if (!place.is_known()) {
    out.null("place");
    return;
  }
  JsonObject known;
  if (place.sheet > 0) known.number("sheet", place.sheet);
  // Numbers as nlohmann writes them: "2.0".
  if (place.u_mm) known.json("u_mm", Json(*place.u_mm).dump());
  if (place.v_mm) known.json("v_mm", Json(*place.v_mm).dump());
  if (!place.source.empty()) known.text("source", place.source);
  out.object("place", known);
}

bool is_code(std::string_view text) {
  return !text.empty() && text.size() <= kLongestCode &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

void take(const JsonLeaf& leaf, Warning& warning) {
  WarningPlace& place = warning.place;
  if (leaf.depth == 2) {
    if (leaf.name == "code" && leaf.text) warning.code = *leaf.text;
    if (leaf.name == "message" && leaf.text) warning.message = *leaf.text;
    if (leaf.name == "spoils") warning.spoils = leaf.is_true;
  } else if (leaf.depth == 3 && leaf.parent == "place") {
    if (leaf.name == "sheet" && leaf.number)
      place.sheet = static_cast<int>(std::clamp(*leaf.number, 0.0, 1e6));
    if (leaf.name == "u_mm") place.u_mm = leaf.number;
    if (leaf.name == "v_mm") place.v_mm = leaf.number;
    if (leaf.name == "source" && leaf.text) place.source = *leaf.text;
  }
}

}  // namespace

std::string warnings_json(const std::vector<Warning>& warnings) {
  std::vector<JsonObject> all;
  for (const Warning& one : warnings) {
    JsonObject& out = all.emplace_back();
    out.text("code", one.code).text("message", one.message);
    put_place(out, one.place);
    out.flag("spoils", one.spoils);
  }
  return json_list_of(all);
}

std::vector<Warning> warnings_from_json(std::string_view json) {
  std::map<std::size_t, Warning> by_item;
  const bool whole = each_json_leaf(json, [&](const JsonLeaf& leaf) {
    if (leaf.depth >= 2) take(leaf, by_item[leaf.item]);
  });
  std::vector<Warning> warnings;
  if (!whole) return warnings;
  for (auto& [item, warning] : by_item) {
    if (!is_code(warning.code)) warning.code = "note";
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

void shorten(std::vector<Warning>& warnings, std::size_t most, std::size_t longest) {
  if (warnings.size() > most) {
    std::stable_partition(warnings.begin(), warnings.end(),
                          [](const Warning& one) { return one.spoils; });
    const std::size_t more = warnings.size() - most;
    warnings.resize(most);
    warnings.push_back({.code = "more", .message = fmt::format("and {} more", more)});
  }
  for (Warning& one : warnings) {
    if (one.message.size() > longest) one.message.resize(longest);
    if (one.place.source.size() > longest) one.place.source.resize(longest);
  }
}

std::vector<std::string> spoiling_codes(const std::vector<Warning>& warnings) {
  std::vector<std::string> codes;
  for (const Warning& one : warnings)
    if (one.spoils && std::find(codes.begin(), codes.end(), one.code) == codes.end())
      codes.push_back(one.code);
  return codes;
}

std::vector<std::string> codes_without(std::vector<std::string> codes,
                                       const std::vector<std::string>& accepted) {
  std::erase_if(codes, [&](const std::string& code) {
    return std::find(accepted.begin(), accepted.end(), code) != accepted.end();
  });
  return codes;
}

}  // namespace popcut::daemon
