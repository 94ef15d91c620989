// SPDX-License-Identifier: MIT
#include "daemon/http/api/json_body.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"

namespace popcut::daemon::http {
namespace {

using nlohmann::json;

constexpr std::size_t kMostOptions = 32;
constexpr std::size_t kLongestOption = 200;
// More than any body needs, and few enough to read quickly.
constexpr std::size_t kMostValues = 4096;

/// JSON bodies: the body itself has the empty pointer, and 5.0 is not a whole number.
class BodyNotation : public Notation {
 public:
  [[nodiscard]] std::string place(const std::string& pointer, bool /*is_key*/) const override {
    return pointer;
  }
  [[nodiscard]] std::string proposed(const std::string& pointer,
                                     const std::string& name) const override {
    return pointer + "/" + name;
  }
  [[nodiscard]] bool takes_whole_fractions() const override { return false; }
};

std::optional<std::string> option_text(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  if (value.is_number()) return fmt::format("{}", value.get<double>());
  if (!value.is_string()) return std::nullopt;
  std::string text = value.get<std::string>();
  if (text.size() > kLongestOption || has_controls(text)) return std::nullopt;
  return text;
}

bool is_option_name(std::string_view name) {
  return !name.empty() && name.size() <= 40 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

}  // namespace

const Notation& body_notation() {
  static const BodyNotation notation;
  return notation;
}

Answer<json> parse_body(std::string_view text, int max_depth) {
  auto value = read_json(text, {.values = kMostValues, .depth = max_depth});
  if (value) return std::move(*value);
  const JsonFault& fault = value.error();
  Problem problem{ProblemKind::MalformedJson, fault.detail};
  if (!fault.pointer.empty()) problem.detail = fmt::format("{} {}", fault.pointer, fault.detail);
  if (fault.is_syntax && fault.last_byte > 0) {
    problem.detail += fmt::format(" (byte {})", fault.last_byte);
    problem.errors.push_back({fmt::format("byte {}", fault.last_byte), "malformed", fault.detail});
  }
  return tl::unexpected<Problem>(std::move(problem));
}

std::map<std::string, std::string> read_options(FieldReader& fields, const std::string& name) {
  std::map<std::string, std::string> out;
  const json* found = fields.value(name);
  if (found == nullptr) return out;
  FieldReader options = fields.nested(*found, name);
  if (!found->is_object()) return out;
  if (found->size() > kMostOptions) {
    fields.refuse(name, ErrorKind::OutOfRange,
                  fmt::format("has {} options; must have at most {}", found->size(), kMostOptions),
                  "length");
    return out;
  }
  for (const auto& [key, value] : found->items()) {
    const std::optional<std::string> text = option_text(value);
    if (is_option_name(key) && text)
      out.emplace(key, *text);
    else
      options.refuse(json_pointer_token(key), ErrorKind::OutOfRange,
                     "must be an option of 'popcut plan' without dashes, with a string, number or "
                     "boolean as its value",
                     "option");
  }
  return out;
}

std::vector<RequestFault> request_faults(const FieldReader& fields) {
  std::vector<RequestFault> faults;
  for (const FieldFault& fault : fields.faults())
    faults.push_back({fault.place, fault.code, fault.detail, fault.got});
  return faults;
}

Problem validation(std::vector<RequestFault> faults) {
  Problem problem{ProblemKind::Validation, {}};
  if (!faults.empty())
    problem.detail =
        fmt::format("{} {}{}", faults.front().pointer.empty() ? "the body" : faults.front().pointer,
                    faults.front().detail, faults.size() > 1 ? ", and more" : "");
  problem.errors = std::move(faults);
  return problem;
}

}  // namespace popcut::daemon::http
