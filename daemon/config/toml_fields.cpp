// SPDX-License-Identifier: MIT
#include "daemon/config/toml_fields.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/text/near_names.hpp"

namespace popcut::daemon {
namespace {

std::string type_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

}  // namespace

TomlFields::TomlFields(const toml::table& table, std::string path)
    : table_(table), path_(std::move(path)) {}

std::string TomlFields::place(const toml::node& node, const std::string& key) const {
  const toml::source_position at = node.source().begin;
  return fmt::format("{}:{}: {}{}", at.line, at.column, path_, key);
}

const toml::node* TomlFields::ask(const char* key) {
  asked_.emplace_back(key);
  return table_.get(key);
}

void TomlFields::refuse(const char* key, ErrorKind kind, const std::string& detail) {
  if (error_) return;
  const toml::node* const node = table_.get(key);
  error_ = Error{kind, place(node != nullptr ? *node : table_, key), detail};
}

void TomlFields::wrong_type(const char* key, const toml::node& node, const char* wanted) {
  refuse(key, ErrorKind::Malformed, fmt::format("is {}; must be {}", type_of(node), wanted));
}

void TomlFields::number(const char* key, double& value, double low, double high) {
  const toml::node* const node = ask(key);
  if (node == nullptr) return;
  const auto found = node->value<double>();
  if (!found || !node->is_number()) return wrong_type(key, *node, "a number");
  if (!std::isfinite(*found) || *found < low || *found > high)
    return refuse(key, ErrorKind::OutOfRange,
                  fmt::format("is {:g}; must be {:g} to {:g}", *found, low, high));
  value = *found;
}

void TomlFields::whole(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high) {
  const toml::node* const node = ask(key);
  if (node == nullptr) return;
  if (!node->is_integer()) return wrong_type(key, *node, "a whole number");
  const std::int64_t found = node->value<std::int64_t>().value_or(0);
  if (found < low || found > high)
    return refuse(key, ErrorKind::OutOfRange,
                  fmt::format("is {}; must be {} to {}", found, low, high));
  value = found;
}

void TomlFields::text(const char* key, std::string& value) {
  const toml::node* const node = ask(key);
  if (node == nullptr) return;
  if (!node->is_string()) return wrong_type(key, *node, "a string");
  std::string found = node->value<std::string>().value_or("");
  const bool control = std::any_of(found.begin(), found.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  if (control) return refuse(key, ErrorKind::OutOfRange, "contains a control character; remove it");
  value = std::move(found);
}

void TomlFields::boolean(const char* key, bool& value) {
  const toml::node* const node = ask(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) return wrong_type(key, *node, "true or false");
  value = node->value<bool>().value_or(false);
}

void TomlFields::word(const char* key, std::string& value, const std::vector<std::string>& words) {
  std::string found = value;
  text(key, found);
  if (error_) return;
  if (std::find(words.begin(), words.end(), found) == words.end() && table_.contains(key))
    return refuse(key, ErrorKind::OutOfRange,
                  fmt::format("is \"{}\"; {}", found, suggestion(found, words)));
  value = std::move(found);
}

void TomlFields::texts(const char* key, std::vector<std::string>& value) {
  const toml::node* const node = ask(key);
  if (node == nullptr) return;
  const toml::array* const list = node->as_array();
  if (list == nullptr) return wrong_type(key, *node, "a list of strings");
  std::vector<std::string> found;
  for (const toml::node& one : *list) {
    const auto text = one.value<std::string>();
    if (!text || !one.is_string()) return wrong_type(key, one, "a list of strings");
    found.push_back(*text);
  }
  value = std::move(found);
}

void TomlFields::table(const char* key, const std::function<Result<void>(TomlFields&)>& read) {
  const toml::node* const node = ask(key);
  if (node == nullptr || error_) return;
  if (!node->is_table()) return wrong_type(key, *node, fmt::format("a table, [{}]", key).c_str());
  TomlFields fields(*node->as_table(), fmt::format("{}{}.", path_, key));
  if (auto done = read(fields); !done) error_ = done.error();
}

void TomlFields::tables(const char* key, const std::function<Result<void>(TomlFields&)>& read) {
  const toml::node* const node = ask(key);
  if (node == nullptr || error_) return;
  const std::string wanted = fmt::format("tables, each starting with [[{}]]", key);
  if (!node->is_array()) return wrong_type(key, *node, wanted.c_str());
  for (const toml::node& one : *node->as_array()) {
    if (!one.is_table()) return wrong_type(key, one, wanted.c_str());
    TomlFields fields(*one.as_table(), fmt::format("{}{}.", path_, key));
    if (auto done = read(fields); !done) {
      error_ = done.error();
      return;
    }
  }
}

Result<void> TomlFields::finish() const {
  if (error_) return tl::unexpected(*error_);
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(asked_.begin(), asked_.end(), name) != asked_.end()) continue;
    const toml::source_position at = key.source().begin;
    return fail(ErrorKind::Malformed, fmt::format("{}:{}: {}{}", at.line, at.column, path_, name),
                "is an unknown key; " + suggestion(name, asked_));
  }
  return {};
}

}  // namespace popcut::daemon
