// SPDX-License-Identifier: MIT
#include "core/text/json_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <fmt/format.h>

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::size_t kMostValues = 2'000'000;
constexpr std::size_t kLongestToken = 64;

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t up = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = up;
    }
  }
  return row[b.size()];
}

// Where the parser is, and the first key that stands twice in its object.
class DoubledKey {
 public:
  bool operator()(json::parse_event_t event, const json& value) {
    switch (event) {
      case json::parse_event_t::object_start:
      case json::parse_event_t::array_start:
        levels_.push_back({.is_list = event == json::parse_event_t::array_start});
        break;
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        levels_.pop_back();
        [[fallthrough]];
      case json::parse_event_t::value:
        if (!levels_.empty()) ++levels_.back().index;
        break;
      case json::parse_event_t::key:
        meet(value.get_ref<const std::string&>());
    }
    return true;
  }
  /// Its JSON pointer; empty if there is none.
  [[nodiscard]] const std::string& pointer() const { return pointer_; }

 private:
  struct Level {
    bool is_list{false};
    std::size_t index{0};
    std::set<std::string> keys{};
    std::set<std::string>::const_iterator key{};
  };
  void meet(const std::string& key) {
    Level& level = levels_.back();
    bool fresh = false;
    std::tie(level.key, fresh) = level.keys.insert(key);
    if (fresh || !pointer_.empty()) return;
    for (const Level& one : levels_)
      pointer_ += "/" + (one.is_list ? std::to_string(one.index) : json_pointer_token(*one.key));
  }
  std::vector<Level> levels_;
  std::string pointer_;
};

}  // namespace

std::string json_pointer_token(std::string_view key) {
  return (json::json_pointer() / std::string(key.substr(0, kLongestToken))).to_string().substr(1);
}

std::string line_and_column(std::string_view text, std::size_t byte) {
  byte = std::min(byte, text.size());
  const auto begin = text.begin();
  const auto lines = std::count(begin, begin + static_cast<std::ptrdiff_t>(byte), '\n');
  const std::size_t newline = byte == 0 ? std::string_view::npos : text.rfind('\n', byte - 1);
  const std::size_t column = newline == std::string_view::npos ? byte : byte - newline - 1;
  return fmt::format("line {}, column {}", lines + 1, std::max<std::size_t>(column, 1));
}

// By brackets and commas outside of strings: needs no memory. The depth is limited before nlohmann
// sees the text, since copying a deep value recurses.
Result<void> check_json_limits(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes)
    return fail(ErrorKind::Malformed, "",
                fmt::format("{} bytes of JSON; at most {} are read", text.size(), limits.bytes));
  int depth = 0;
  std::size_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\0')  // which the parser would take for the end
      return fail(ErrorKind::Malformed, line_and_column(text, i + 1),
                  "a zero byte, which JSON has none of; is it another kind of file?");
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == ']' || c == '}') --depth;
    const bool opens = c == '[' || c == '{';
    if (opens && ++depth > limits.depth)
      return fail(ErrorKind::Malformed, line_and_column(text, i + 1),
                  fmt::format("the JSON is nested more than {} deep; flatten it", limits.depth));
    if ((opens || c == ',') && ++values > limits.values)
      return fail(
          ErrorKind::Malformed, line_and_column(text, i + 1),
          fmt::format("the JSON has more than {} values; nothing popcut reads so needs that",
                      limits.values));
  }
  return {};
}

Result<json> parse_json(std::string_view text, int max_depth) {
  if (const auto sound = check_json_limits(text, {.values = kMostValues, .depth = max_depth});
      !sound)
    return tl::unexpected(sound.error());
  DoubledKey doubled;
  const auto watch = [&](int, json::parse_event_t event, json& value) {
    return doubled(event, value);
  };
  try {
    json value = json::parse(text, watch);
    if (!doubled.pointer().empty())
      return fail(ErrorKind::Malformed, doubled.pointer(), "stands twice in one object; keep one");
    return value;
  } catch (const json::parse_error& e) {
    const bool cut_off = e.byte > text.size();
    return fail(ErrorKind::Malformed, line_and_column(text, e.byte),
                cut_off ? "the JSON ends too early; is the file whole?"
                        : "this is not JSON; look for a missing comma, quote or bracket here");
  } catch (const json::out_of_range& e) {  // the only one of parsing: a number like 1e400
    const std::string_view what = e.what();
    const std::size_t begin = what.find('\''), end = what.rfind('\'');
    const std::string_view number =
        begin < end ? what.substr(begin + 1, end - begin - 1) : std::string_view();
    const std::size_t at = number.empty() ? std::string_view::npos : text.find(number);
    return fail(
        ErrorKind::OutOfRange, at == std::string_view::npos ? "" : line_and_column(text, at + 1),
        fmt::format("the number {} is larger than any that can be used; numbers up to 1e308 "
                    "can be read, and lengths up to 100000 mm",
                    number.substr(0, 40)));
  } catch (const json::exception& e) {
    return fail(ErrorKind::Malformed, "", fmt::format("this is not lawful JSON ({})", e.what()));
  }
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  if (word.size() > 64) return best;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) best_distance = distance, best = candidate;
  }
  return best;
}

std::string json_type(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "a list";
    case json::value_t::string:
      return "a text";
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    default:
      return "a number";
  }
}

JsonFields::JsonFields(const json& object, std::string pointer)
    : object_(object), pointer_(std::move(pointer)) {
  if (!object.is_object())
    add_error(ErrorKind::Malformed, pointer_.empty() ? "/" : pointer_,
              fmt::format("is {}; an object is needed", json_type(object)));
}

void JsonFields::add_error(ErrorKind kind, const std::string& place, std::string detail) {
  if (!error_) error_ = Error{kind, place, std::move(detail)};
}

bool JsonFields::has(const std::string& key) {
  return object_.is_object() && object_.contains(key);
}

const json* JsonFields::value(const std::string& key) {
  asked_.push_back(key);
  if (!has(key)) return nullptr;
  return &object_.at(key);
}

const json* JsonFields::require(const std::string& key, bool required, const char* type) {
  const json* found = value(key);
  if (!found && required)
    add_error(ErrorKind::Malformed, pointer(key), fmt::format("is missing; {} is needed", type));
  return found;
}

double JsonFields::number(const std::string& key, std::optional<double> fallback, double low,
                          double high, bool open_low) {
  const double otherwise = fallback.value_or(low);
  const json* found = require(key, !fallback, "a number");
  if (!found) return otherwise;
  if (!found->is_number()) {
    add_error(ErrorKind::Malformed, pointer(key),
              fmt::format("is {}; a number is needed", json_type(*found)));
    return otherwise;
  }
  const double got = found->get<double>();
  if (!std::isfinite(got) || got < low || got > high || (open_low && got == low)) {
    add_error(ErrorKind::OutOfRange, pointer(key),
              fmt::format("is {:g}; a number {} {:g} and at most {:g} is needed", got,
                          open_low ? "above" : "of at least", low, high));
    return otherwise;
  }
  return got;
}

int JsonFields::integer(const std::string& key, std::optional<int> fallback, int low, int high) {
  const int otherwise = fallback.value_or(low);
  const json* found = require(key, !fallback, "a whole number");
  if (!found) return otherwise;
  const double got =
      found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!found->is_number() || got != std::floor(got)) {
    add_error(ErrorKind::Malformed, pointer(key),
              fmt::format("is {}; a whole number is needed",
                          found->is_number() ? fmt::format("{:g}", got) : json_type(*found)));
    return otherwise;
  }
  if (got < low || got > high) {
    add_error(ErrorKind::OutOfRange, pointer(key),
              fmt::format("is {:g}; a whole number from {} to {} is needed", got, low, high));
    return otherwise;
  }
  return static_cast<int>(got);
}

std::string JsonFields::text(const std::string& key, std::optional<std::string> fallback) {
  const json* found = require(key, !fallback, "a text");
  if (!found) return fallback.value_or("");
  if (!found->is_string()) {
    add_error(ErrorKind::Malformed, pointer(key),
              fmt::format("is {}; a text is needed", json_type(*found)));
    return fallback.value_or("");
  }
  return found->get<std::string>();
}

bool JsonFields::boolean(const std::string& key, bool fallback) {
  const json* found = value(key);
  if (!found) return fallback;
  if (!found->is_boolean()) {
    add_error(ErrorKind::Malformed, pointer(key),
              fmt::format("is {}; true or false is needed", json_type(*found)));
    return fallback;
  }
  return found->get<bool>();
}

std::size_t JsonFields::word(const std::string& key, std::size_t fallback,
                             const std::vector<std::string>& words) {
  const std::string got = text(key, words.at(fallback));
  const auto it = std::find(words.begin(), words.end(), got);
  if (it != words.end()) return static_cast<std::size_t>(it - words.begin());
  const std::string near = nearest_word(got, words);
  add_error(ErrorKind::OutOfRange, pointer(key),
            fmt::format("is \"{:.60}{}\"; {}one of {} is needed", got, got.size() > 60 ? "..." : "",
                        near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near),
                        fmt::join(words, ", ")));
  return fallback;
}

Result<void> JsonFields::finish() const {
  if (error_) return tl::unexpected(*error_);
  for (const auto& [key, value] : object_.items()) {
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    const std::string near = nearest_word(key, asked_);
    std::vector<std::string> known = asked_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    return fail(ErrorKind::Malformed, pointer(key),
                near.empty()
                    ? fmt::format("is no field that popcut knows; the fields here are {}",
                                  fmt::join(known, ", "))
                    : fmt::format("is no field that popcut knows; did you mean \"{}\"?", near));
  }
  return {};
}

}  // namespace popcut
