// SPDX-License-Identifier: MIT
#include "daemon/config/toml_document.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/text/json_text.hpp"

namespace popcut::daemon {
namespace {

using nlohmann::json;

bool is_index(std::string_view token) {
  return !token.empty() &&
         std::all_of(token.begin(), token.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "/device/0/id" as "device.id".
std::string dotted(std::string_view pointer) {
  std::string path;
  while (!pointer.empty()) {
    pointer.remove_prefix(1);
    const std::string_view token = pointer.substr(0, pointer.find('/'));
    pointer.remove_prefix(token.size());
    if (!is_index(token)) path.append(path.empty() ? "" : ".").append(token);
  }
  return path;
}

}  // namespace

TomlDocument::TomlDocument(const toml::table& table) : root_(json_of(table, "")) {}

json TomlDocument::json_of(const toml::node& node, const std::string& pointer) {
  positions_[pointer].value = node.source().begin;
  if (const toml::table* table = node.as_table()) {
    json object = json::object();
    for (const auto& [key, value] : *table) {
      const std::string name(key.str());
      const std::string at = pointer + "/" + json_pointer_token(name);
      object[name] = json_of(value, at);
      positions_[at].key = key.source().begin;
    }
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    json list = json::array();
    for (const toml::node& item : *array) {
      const std::string at = fmt::format("{}/{}", pointer, list.size());
      list.push_back(json_of(item, at));
      // An item of the wrong type is reported where its list stands.
      if (!item.is_table()) positions_[at].value = node.source().begin;
    }
    return list;
  }
  if (node.is_string()) return node.value<std::string>().value_or("");
  if (node.is_integer()) return node.value<std::int64_t>().value_or(0);
  if (node.is_floating_point()) return node.value<double>().value_or(0.0);
  if (node.is_boolean()) return node.value<bool>().value_or(false);
  return json::binary({});
}

std::string TomlDocument::place(const std::string& pointer, bool is_key) const {
  auto found = positions_.find(pointer);
  if (found == positions_.end()) found = positions_.find(pointer.substr(0, pointer.rfind('/')));
  if (found == positions_.end()) return dotted(pointer);
  const toml::source_position at = is_key ? found->second.key : found->second.value;
  return fmt::format("{}:{}: {}", at.line, at.column, dotted(pointer));
}

std::string TomlDocument::object(const std::string& key) const {
  return key.empty() || is_index(key) ? "a table" : fmt::format("a table, [{}]", key);
}

std::string TomlDocument::objects(const std::string& key) const {
  return fmt::format("tables, each starting with [[{}]]", key);
}

}  // namespace popcut::daemon
