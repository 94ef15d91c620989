// SPDX-License-Identifier: MIT
#include "daemon/model/warnings.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut::daemon {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestCode = 40;

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string place_json(const WarningPlace& place) {
  if (!place.is_known()) return "null";
  std::string text;
  const auto add = [&](const char* name, const std::string& value) {
    text += fmt::format(R"({}"{}":{})", text.empty() ? "" : ",", name, value);
  };
  if (place.sheet > 0) add("sheet", std::to_string(place.sheet));
  if (place.u_mm) add("u_mm", Json(*place.u_mm).dump());
  if (place.v_mm) add("v_mm", Json(*place.v_mm).dump());
  if (!place.source.empty()) add("source", quoted(place.source));
  return "{" + text + "}";
}

bool is_code(std::string_view text) {
  return !text.empty() && text.size() <= kLongestCode &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

WarningPlace place_from(const Json& json) {
  WarningPlace place;
  if (!json.is_object()) return place;
  const auto number = [&](const char* name) -> std::optional<double> {
    const auto found = json.find(name);
    if (found == json.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
  };
  place.sheet = static_cast<int>(std::clamp(number("sheet").value_or(0), 0.0, 1e6));
  place.u_mm = number("u_mm"), place.v_mm = number("v_mm");
  place.source = text_of(json, "source");
  return place;
}

}  // namespace

std::string warnings_json(const std::vector<Warning>& warnings) {
  std::string text = "[";
  for (const Warning& one : warnings)
    fmt::format_to(std::back_inserter(text),
                   R"({}{{"code":{},"message":{},"place":{},"spoils":{}}})",
                   &one == &warnings.front() ? "" : ",", quoted(one.code), quoted(one.message),
                   place_json(one.place), one.spoils);
  return text + "]";
}

std::vector<Warning> warnings_from_json(std::string_view json) {
  std::vector<Warning> warnings;
  const Json list = Json::parse(json, nullptr, false);
  if (!list.is_array()) return warnings;
  for (const Json& one : list) {
    if (!one.is_object()) continue;
    Warning warning{.code = text_of(one, "code"), .message = text_of(one, "message")};
    if (!is_code(warning.code)) warning.code = "note";
    const auto place = one.find("place"), spoils = one.find("spoils");
    if (place != one.end()) warning.place = place_from(*place);
    warning.spoils = spoils != one.end() && *spoils == true;
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

std::string spoiling_codes(const std::vector<Warning>& warnings) {
  std::vector<std::string> known;
  std::string codes;
  for (const Warning& one : warnings) {
    if (!one.spoils || std::find(known.begin(), known.end(), one.code) != known.end()) continue;
    codes += (codes.empty() ? "" : " ") + one.code;
    known.push_back(one.code);
  }
  return codes;
}

std::vector<std::string> codes_of(std::string_view codes) {
  std::vector<std::string> all;
  while (!codes.empty()) {
    const std::size_t end = std::min(codes.find(' '), codes.size());
    if (end > 0) all.emplace_back(codes.substr(0, end));
    codes.remove_prefix(std::min(end + 1, codes.size()));
  }
  return all;
}

std::string codes_without(std::string_view codes, const std::vector<std::string>& accepted) {
  std::string left;
  for (const std::string& code : codes_of(codes))
    if (std::find(accepted.begin(), accepted.end(), code) == accepted.end())
      left += (left.empty() ? "" : " ") + code;
  return left;
}

}  // namespace popcut::daemon
