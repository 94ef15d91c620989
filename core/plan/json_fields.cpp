// SPDX-License-Identifier: MIT
#include "core/plan/json_fields.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/formats/json_text.hpp"
#include "core/plan/near_names.hpp"

namespace popcut {

JsonFields::JsonFields(const nlohmann::json& value, std::string pointer,
                       std::optional<Error>& fault)
    : value_(value), pointer_(std::move(pointer)), fault_(fault) {
  if (!fault_ && !value_.is_object())
    reject(ErrorKind::Malformed, pointer_,
           fmt::format("{} where an object is due", kind_of(value_)));
}

std::string JsonFields::at(const char* key) const { return json_pointer(pointer_, key); }

void JsonFields::reject(ErrorKind kind, std::string place, std::string detail) {
  if (!fault_) fault_ = Error{kind, std::move(place), std::move(detail)};
}

const nlohmann::json* JsonFields::get(const char* key) {
  known_.emplace_back(key);
  if (fault_) return nullptr;
  const auto found = value_.find(key);
  if (found != value_.end()) return &*found;
  reject(ErrorKind::Malformed, pointer_, fmt::format("has no \"{}\"; it is required", key));
  return nullptr;
}

void JsonFields::text(const char* key, std::string& out) {
  const auto* value = get(key);
  if (value == nullptr) return;
  if (!value->is_string())
    return reject(ErrorKind::Malformed, at(key),
                  fmt::format("{} where a text is due", kind_of(*value)));
  out = value->get<std::string>();
}

void JsonFields::flag(const char* key, bool& out) {
  const auto* value = get(key);
  if (value == nullptr) return;
  if (!value->is_boolean())
    return reject(ErrorKind::Malformed, at(key),
                  fmt::format("{} where true or false is due", kind_of(*value)));
  out = value->get<bool>();
}

void JsonFields::number(const char* key, double& out, double lowest, double highest) {
  const auto* value = get(key);
  if (value == nullptr) return;
  if (!value->is_number())
    return reject(ErrorKind::Malformed, at(key),
                  fmt::format("{} where a number is due", kind_of(*value)));
  out = value->get<double>();
  if (!(out >= lowest && out <= highest))
    reject(ErrorKind::OutOfRange, at(key),
           fmt::format("is {}; from {} to {}", out, lowest, highest));
}

void JsonFields::whole(const char* key, long& out, long lowest, long highest) {
  double value = 0.0;
  number(key, value, static_cast<double>(lowest), static_cast<double>(highest));
  if (fault_) return;
  out = static_cast<long>(value);
  if (static_cast<double>(out) != value)
    reject(ErrorKind::OutOfRange, at(key), fmt::format("is {}; a whole number is due", value));
}

const nlohmann::json* JsonFields::object(const char* key) {
  const auto* value = get(key);
  if (value == nullptr || value->is_object()) return value;
  reject(ErrorKind::Malformed, at(key), fmt::format("{} where an object is due", kind_of(*value)));
  return nullptr;
}

const nlohmann::json* JsonFields::array(const char* key) {
  const auto* value = get(key);
  if (value == nullptr || value->is_array()) return value;
  reject(ErrorKind::Malformed, at(key), fmt::format("{} where an array is due", kind_of(*value)));
  return nullptr;
}

void JsonFields::also(const char* key) { known_.emplace_back(key); }

void JsonFields::nothing_else() {
  if (fault_) return;
  for (const auto& field : value_.items())
    if (std::find(known_.begin(), known_.end(), field.key()) == known_.end())
      return reject(ErrorKind::Malformed, json_pointer(pointer_, field.key()),
                    fmt::format("is not known here; {}", suggestion(field.key(), known_)));
}

}  // namespace popcut
