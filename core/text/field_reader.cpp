// SPDX-License-Identifier: MIT
#include "core/text/field_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "core/text/json_text.hpp"
#include "core/text/near_names.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::size_t kMostFaults = 32;
constexpr std::size_t kMostShown = 64;

/// What stands at a field, as JSON, where it is short: else empty.
std::string shown(const json& value) {
  if (value.is_structured() || value.is_binary()) return {};
  std::string got = value.dump(-1, ' ', false, json::error_handler_t::replace);
  return got.size() <= kMostShown ? got : std::string();
}

/// A whole number, or nothing. Larger numbers than an integer holds are its largest value.
std::optional<std::int64_t> whole_number(const json& value, bool takes_fractions) {
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  if (value.is_number_unsigned())
    return static_cast<std::int64_t>(
        std::min(value.get<std::uint64_t>(), static_cast<std::uint64_t>(kMost)));
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (!takes_fractions || !value.is_number_float()) return std::nullopt;
  const auto got = value.get<double>();
  if (got != std::floor(got)) return std::nullopt;
  constexpr double kExact = 9e15;
  return static_cast<std::int64_t>(std::clamp(got, -kExact, kExact));
}

/// What is wrong with a text, as code and sentence; empty: nothing.
std::pair<const char*, std::string> text_fault(const std::string& text, const TextRule& rule) {
  const std::size_t length = code_points(text);
  if (length < rule.least || length > rule.most)
    return {"length",
            fmt::format("has {} characters; must have {} to {}", length, rule.least, rule.most)};
  if (rule.controls != TextRule::Controls::Any &&
      has_controls(text, rule.controls == TextRule::Controls::Lines))
    return {"characters", "has a control character; leave it out"};
  return {"", ""};
}

}  // namespace

std::string json_type(const json& value) {
  constexpr std::array kNames{"null",     "an object", "a list",   "a text",         "false",
                              "a number", "a number",  "a number", "a date or time", "a number"};
  if (value.is_boolean() && value.get<bool>()) return "true";
  return kNames.at(static_cast<std::size_t>(value.type()));  // in the order of json::value_t
}

std::string shown_type(const json& value) {
  if (value.is_number()) return value.dump();
  return value.is_array() ? fmt::format("a list of {}", value.size()) : json_type(value);
}

std::string exact_number(double value) {
  std::string text = fmt::format("{:g}", value);
  return std::strtod(text.c_str(), nullptr) == value ? text : fmt::format("{}", value);
}

std::string number_words(double low, double high, bool open_low) {
  const std::string least = exact_number(low), most = exact_number(high);
  if (std::isinf(high)) return fmt::format("a number {} {}", open_low ? "above" : "from", least);
  return open_low ? fmt::format("a number above {} and at most {}", least, most)
                  : fmt::format("a number from {} to {}", least, most);
}

std::string Notation::place(const std::string& pointer, bool /*is_key*/) const {
  return pointer.empty() ? "/" : pointer;
}

std::string Notation::proposed(const std::string& /*pointer*/, const std::string& name) const {
  return name;
}

std::string Notation::object(const std::string& /*key*/) const { return "an object"; }

std::string Notation::objects(const std::string& /*key*/) const { return "a list of objects"; }

const Notation& FieldReader::plain_json() {
  static const Notation plain;
  return plain;
}

FieldReader::FieldReader(const json& object, std::string pointer, const Notation& notation)
    : FieldReader(object, std::move(pointer),
                  std::make_shared<Document>(Document{.notation = notation})) {}

FieldReader::FieldReader(const json& object, std::string pointer,
                         std::shared_ptr<Document> document)
    : object_(&object), pointer_(std::move(pointer)), document_(std::move(document)) {
  if (object.is_object()) return;
  const std::string_view key = std::string_view(pointer_).substr(pointer_.rfind('/') + 1);
  refuse(ErrorKind::Malformed,
         fmt::format("is {}; must be {}", type_of(object), notation().object(std::string(key))),
         "type");
}

FieldReader FieldReader::nested(const json& object, const std::string& below) const {
  return {object, pointer_ + "/" + below, document_};
}

std::string FieldReader::pointer(const std::string& key) const {
  return pointer_ + "/" + json_pointer_token(key);
}

std::string FieldReader::place_of(const std::string& below) const {
  return notation().place(pointer_ + "/" + below, false);
}

std::string FieldReader::type_of(const json& value) const {
  return value.is_object() ? notation().object("") : json_type(value);
}

void FieldReader::add(FieldFault fault) {
  if (document_->faults.size() < kMostFaults) document_->faults.push_back(std::move(fault));
}

void FieldReader::refuse(const std::string& key, ErrorKind kind, std::string detail,
                         std::string code) {
  add({kind, place_of(key), std::move(code), std::move(detail)});
}

void FieldReader::refuse(ErrorKind kind, std::string detail, std::string code) {
  add({kind, notation().place(pointer_, false), std::move(code), std::move(detail)});
}

void FieldReader::refuse(const Error& error) {
  add({error.kind, error.place, "value", error.detail});
}

void FieldReader::need(const std::string& key, const std::string& what) {
  if (object_->is_object() && !has(key))
    refuse(json_pointer_token(key), ErrorKind::Malformed, "is missing; " + what, "missing");
}

bool FieldReader::has(const std::string& key) const {
  return object_->is_object() && object_->contains(key);
}

const json* FieldReader::value(const std::string& key) {
  asked_.push_back(key);
  return has(key) ? &object_->at(key) : nullptr;
}

const json* FieldReader::require(const std::string& key, const std::string& what) {
  need(key, "must be " + what);
  return value(key);
}

void FieldReader::wrong_type(const std::string& below, const json& found, const std::string& what) {
  add({ErrorKind::Malformed, place_of(below), "type",
       fmt::format("is {}; must be {}", type_of(found), what), shown(found)});
}

std::optional<double> FieldReader::number_at(const std::string& below, const json& value,
                                             double low, double high, bool open_low) {
  if (!value.is_number()) {
    wrong_type(below, value, "a number");
    return std::nullopt;
  }
  const auto got = value.get<double>();
  if (std::isfinite(got) && got >= low && got <= high && !(open_low && got == low)) return got;
  add({ErrorKind::OutOfRange, place_of(below), "range",
       fmt::format("is {}; must be {}", exact_number(got), number_words(low, high, open_low)),
       shown(value)});
  return std::nullopt;
}

double FieldReader::number(const std::string& key, std::optional<double> fallback, double low,
                           double high, bool open_low) {
  if (!fallback) need(key, "must be " + number_words(low, high, open_low));
  const json* found = value(key);
  const auto got = found != nullptr
                       ? number_at(json_pointer_token(key), *found, low, high, open_low)
                       : std::nullopt;
  return got.value_or(fallback.value_or(low));
}

std::optional<std::int64_t> FieldReader::integer_at(const std::string& below, const json& value,
                                                    std::int64_t low, std::int64_t high) {
  const auto got = whole_number(value, notation().takes_whole_fractions());
  if (got && *got >= low && *got <= high) return got;
  const std::string is = value.is_number() ? value.dump() : type_of(value);
  add({got ? ErrorKind::OutOfRange : ErrorKind::Malformed, place_of(below), got ? "range" : "type",
       fmt::format("is {}; must be a whole number from {} to {}", is, low, high), shown(value)});
  return std::nullopt;
}

std::optional<std::int64_t> FieldReader::optional_integer(const std::string& key, std::int64_t low,
                                                          std::int64_t high) {
  const json* found = value(key);
  return found != nullptr ? integer_at(json_pointer_token(key), *found, low, high) : std::nullopt;
}

int FieldReader::integer(const std::string& key, std::optional<int> fallback, int low, int high) {
  if (!fallback) need(key, fmt::format("must be a whole number from {} to {}", low, high));
  const int otherwise = fallback.value_or(low);
  return static_cast<int>(optional_integer(key, low, high).value_or(otherwise));
}

std::optional<std::string> FieldReader::text_at(const std::string& below, const json& value,
                                                const TextRule& rule) {
  if (!value.is_string()) {  // what stands here may be a secret, so it is not quoted
    refuse(below, ErrorKind::Malformed, fmt::format("is {}; must be a text", type_of(value)),
           "type");
    return std::nullopt;
  }
  std::string text = value.get<std::string>();
  auto [code, detail] = text_fault(text, rule);
  if (detail.empty()) return text;
  refuse(below, ErrorKind::OutOfRange, std::move(detail), code);
  return std::nullopt;
}

std::optional<std::string> FieldReader::optional_text(const std::string& key,
                                                      const TextRule& rule) {
  const json* found = value(key);
  return found != nullptr ? text_at(json_pointer_token(key), *found, rule) : std::nullopt;
}

std::string FieldReader::text(const std::string& key, std::optional<std::string> fallback,
                              const TextRule& rule) {
  if (!fallback) need(key, "must be a text");
  return optional_text(key, rule).value_or(fallback.value_or(""));
}

std::optional<bool> FieldReader::boolean_at(const std::string& below, const json& value) {
  if (value.is_boolean()) return value.get<bool>();
  wrong_type(below, value, "true or false");
  return std::nullopt;
}

std::optional<bool> FieldReader::optional_boolean(const std::string& key) {
  const json* found = value(key);
  return found != nullptr ? boolean_at(json_pointer_token(key), *found) : std::nullopt;
}

bool FieldReader::boolean(const std::string& key, bool fallback) {
  return optional_boolean(key).value_or(fallback);
}

std::optional<std::size_t> FieldReader::word_at(const std::string& below, const json& value,
                                                const std::vector<std::string>& words) {
  if (!value.is_string()) {
    wrong_type(below, value, fmt::format("one of {}", fmt::join(words, ", ")));
    return std::nullopt;
  }
  const std::string got = value.get<std::string>();
  const auto it = std::find(words.begin(), words.end(), got);
  if (it != words.end()) return static_cast<std::size_t>(it - words.begin());
  const std::string near = nearest_word(got, words);
  constexpr std::size_t kMostEchoed = 60;
  add({ErrorKind::OutOfRange, place_of(below), "word",
       fmt::format("is \"{}{}\"; must be one of {}{}", utf8_start(got, kMostEchoed),
                   got.size() > kMostEchoed ? "..." : "", fmt::join(words, ", "),
                   near.empty() ? "" : fmt::format("; did you mean {}?", near)),
       shown(value)});
  return std::nullopt;
}

std::optional<std::size_t> FieldReader::optional_word(const std::string& key,
                                                      const std::vector<std::string>& words) {
  const json* found = value(key);
  return found != nullptr ? word_at(json_pointer_token(key), *found, words) : std::nullopt;
}

std::size_t FieldReader::word(const std::string& key, std::optional<std::size_t> fallback,
                              const std::vector<std::string>& words) {
  if (!fallback) need(key, fmt::format("must be one of {}", fmt::join(words, ", ")));
  return optional_word(key, words).value_or(fallback.value_or(0));
}

std::optional<std::vector<std::string>> FieldReader::optional_texts(const std::string& key,
                                                                    std::size_t most,
                                                                    const TextRule& rule) {
  constexpr std::size_t kNoLimit = TextRule{}.most;
  const json* found = value(key);
  if (found == nullptr) return std::nullopt;
  if (!found->is_array()) {
    wrong_type(
        key, *found,
        most == kNoLimit ? "a list of texts" : fmt::format("a list of at most {} texts", most));
    return std::nullopt;
  }
  const std::string token = json_pointer_token(key);
  if (found->size() > most) {
    refuse(token, ErrorKind::OutOfRange,
           fmt::format("has {} texts; must have at most {}", found->size(), most), "length");
    return std::nullopt;
  }
  std::vector<std::string> texts;
  for (const json& item : *found) {
    const std::string wrong = item.is_string()
                                  ? text_fault(item.get<std::string>(), rule).second
                                  : fmt::format("is {}; must be a text", type_of(item));
    if (!wrong.empty()) {
      refuse(token, item.is_string() ? ErrorKind::OutOfRange : ErrorKind::Malformed,
             fmt::format("item {} {}", texts.size() + 1, wrong), "item");
      return std::nullopt;
    }
    texts.push_back(item.get<std::string>());
  }
  return texts;
}

std::vector<double> FieldReader::numbers(const std::string& key, std::size_t count) {
  const std::string what = fmt::format("a list of {} numbers", count);
  const json* found = require(key, what);
  std::vector<double> numbers(count);
  if (found == nullptr) return numbers;
  const bool all =
      found->is_array() && found->size() == count &&
      std::all_of(found->begin(), found->end(), [](const json& item) { return item.is_number(); });
  if (all)
    numbers = found->get<std::vector<double>>();
  else
    wrong_type(json_pointer_token(key), *found, what);
  return numbers;
}

const json* FieldReader::list_of_objects(const std::string& key, std::size_t most) {
  const json* found = value(key);
  if (found == nullptr) return nullptr;
  if (!found->is_array()) {
    wrong_type(json_pointer_token(key), *found, notation().objects(key));
    return nullptr;
  }
  if (found->size() <= most) return found;
  refuse(json_pointer_token(key), ErrorKind::Malformed,
         fmt::format("has {} items; must have at most {}", found->size(), most), "length");
  return nullptr;
}

Result<void> FieldReader::finish() {
  if (object_->is_object()) {
    std::vector<std::string> known = asked_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    constexpr std::size_t kMostNamed = 100;
    std::size_t named = 0;
    for (const auto& [key, value] : object_->items()) {
      if (std::binary_search(known.begin(), known.end(), key)) continue;
      if (++named > kMostNamed) break;
      const std::string near = nearest_word(key, known);
      add({ErrorKind::Malformed, notation().place(pointer(key), true), "unknown_member",
           !near.empty()
               ? fmt::format("is not known; did you mean {}?", notation().proposed(pointer_, near))
           : known.empty()
               ? "is not known; there are no fields here"
               : fmt::format("is not known; the fields here are {}", fmt::join(known, ", "))});
      asked_.push_back(key);
    }
  }
  const std::vector<FieldFault>& all = faults();
  if (all.empty()) return {};
  return fail(all.front().kind, all.front().place, all.front().detail);
}

}  // namespace popcut
