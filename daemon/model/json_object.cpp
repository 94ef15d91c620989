// SPDX-License-Identifier: MIT
#include "daemon/model/json_object.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/model/warnings.hpp"

namespace popcut::daemon {
namespace {

void put(std::string& out, double value) {
  if (std::isfinite(value))
    fmt::format_to(std::back_inserter(out), "{}", value);
  else
    out += "null";
}

void put(std::string& out, std::string_view text) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return c >= ' ' && c < '\x7F' && c != '"' && c != '\\';
  });
  if (is_plain)
    out.append(1, '"').append(text).append(1, '"');
  else
    out += nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

void JsonObject::begin(std::string_view name) {
  if (out_.size() > 1) out_ += ',';
  out_.append(1, '"').append(name).append("\":");
}

JsonObject& JsonObject::text(std::string_view name, std::string_view value) {
  begin(name);
  put(out_, value);
  return *this;
}

JsonObject& JsonObject::text_or_null(std::string_view name, std::string_view value) {
  return value.empty() ? null(name) : text(name, value);
}

JsonObject& JsonObject::texts(std::string_view name, const std::vector<std::string>& values) {
  begin(name);
  out_ += '[';
  for (const std::string& value : values) {
    if (&value != &values.front()) out_ += ',';
    put(out_, value);
  }
  out_ += ']';
  return *this;
}

JsonObject& JsonObject::whole_number(std::string_view name, std::int64_t value) {
  begin(name);
  fmt::format_to(std::back_inserter(out_), "{}", value);
  return *this;
}

JsonObject& JsonObject::number(std::string_view name, double value) {
  begin(name);
  put(out_, value);
  return *this;
}

JsonObject& JsonObject::number(std::string_view name, double value, int decimals) {
  if (!std::isfinite(value)) return null(name);
  return json(name, fmt::format("{:.{}f}", value, decimals));
}

JsonObject& JsonObject::pair(std::string_view name, const std::array<double, 2>& values) {
  begin(name);
  out_ += '[';
  put(out_, values[0]);
  out_ += ',';
  put(out_, values[1]);
  out_ += ']';
  return *this;
}

JsonObject& JsonObject::pair(std::string_view name, const std::array<double, 2>& values,
                             int decimals) {
  return json(name, fmt::format("[{0:.{2}f},{1:.{2}f}]", values[0], values[1], decimals));
}

JsonObject& JsonObject::flag(std::string_view name, bool value) {
  return json(name, value ? "true" : "false");
}

JsonObject& JsonObject::null(std::string_view name) { return json(name, "null"); }

JsonObject& JsonObject::json(std::string_view name, std::string_view value) {
  begin(name);
  out_ += value;
  return *this;
}

JsonObject& JsonObject::object(std::string_view name, const JsonObject& inner) {
  return json(name, inner.whole());
}

JsonObject& JsonObject::objects(std::string_view name, const std::vector<JsonObject>& all) {
  return json(name, json_list_of(all));
}

JsonObject& JsonObject::warnings(std::string_view name, const std::vector<Warning>& all) {
  return json(name, warnings_json(all));
}

JsonObject& JsonObject::members_of(const JsonObject& other) {
  if (other.out_.size() == 1) return *this;
  if (out_.size() > 1) out_ += ',';
  out_.append(other.out_, 1);
  return *this;
}

std::string json_list_of(const std::vector<JsonObject>& all) {
  std::string out = "[";
  for (const JsonObject& one : all) {
    if (&one != &all.front()) out += ',';
    out += one.whole();
  }
  return out + ']';
}

std::string json_text(std::string_view text) {
  std::string out;
  put(out, text);
  return out;
}

}  // namespace popcut::daemon
