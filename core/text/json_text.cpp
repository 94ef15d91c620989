// SPDX-License-Identifier: MIT
#include "core/text/json_text.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/text/utf8.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestToken = 64;

/// Follows the parser and keeps the first key that stands twice in its object.
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

/// The reason in "[json.exception...] parse error at line 1, column 2: syntax error ...".
std::string reason(std::string_view what) {
  const std::size_t at = what.find("syntax error");
  if (at != std::string_view::npos) what.remove_prefix(at);
  return shown_ascii(what, 160);
}

}  // namespace

std::string json_file(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

std::string json_file(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string json_pointer_token(std::string_view key) {
  return (json::json_pointer() / std::string(key.substr(0, kLongestToken))).to_string().substr(1);
}

namespace {

/// "line L, column C" of the byte with this number, counted from 1.
std::string line_and_column(std::string_view text, std::size_t byte) {
  byte = std::min(byte, text.size());
  const auto begin = text.begin();
  const auto lines = std::count(begin, begin + static_cast<std::ptrdiff_t>(byte), '\n');
  const std::size_t newline = byte == 0 ? std::string_view::npos : text.rfind('\n', byte - 1);
  const std::size_t column = newline == std::string_view::npos ? byte : byte - newline - 1;
  return fmt::format("line {}, column {}", lines + 1, std::max<std::size_t>(column, 1));
}

/// By brackets and commas outside of strings. The depth is limited before nlohmann sees the text,
/// since copying a deep value recurses.
std::optional<JsonFault> limit_fault(std::string_view text, const JsonLimits& limits) {
  const auto at = [](std::size_t i, std::string detail) {
    return JsonFault{ErrorKind::Malformed, std::move(detail), i + 1, i + 1};
  };
  if (text.size() > limits.bytes)
    return JsonFault{ErrorKind::Malformed, fmt::format("has {} bytes of JSON; at most {} are read",
                                                       text.size(), limits.bytes)};
  int depth = 0;
  std::size_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\0') {  // which the parser would take for the end
      JsonFault zero = at(i,
                          "there is a zero byte, which JSON never has; is this another kind of "
                          "file?");
      zero.is_syntax = true;
      return zero;
    }
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == ']' || c == '}') --depth;
    const bool opens = c == '[' || c == '{';
    if (opens && ++depth > limits.depth)
      return at(i, fmt::format("the JSON is nested more than {} deep; flatten it", limits.depth));
    if ((opens || c == ',') && ++values > limits.values)
      return at(i, fmt::format("the JSON has more than {} values; give fewer", limits.values));
  }
  return std::nullopt;
}

JsonFault syntax_fault(std::string_view text, std::size_t byte) {
  JsonFault fault{ErrorKind::Malformed,
                  byte > text.size()
                      ? "the JSON ends too early; is the file complete?"
                      : "this is not JSON; look for a missing comma, quote or bracket here",
                  byte, byte};
  fault.is_syntax = true;
  return fault;
}

/// nlohmann's only `out_of_range` while parsing: "number overflow parsing '1e400'".
JsonFault number_fault(std::string_view text, std::string_view what) {
  const std::size_t begin = what.find('\''), end = what.rfind('\'');
  const std::string_view number =
      begin < end ? what.substr(begin + 1, end - begin - 1) : std::string_view();
  const std::size_t at = number.empty() ? std::string_view::npos : text.find(number);
  JsonFault fault{ErrorKind::OutOfRange,
                  fmt::format("the number {} is too large; use numbers up to 1e308, and lengths "
                              "up to 100000 mm",
                              number.substr(0, 40))};
  if (at != std::string_view::npos) fault.byte = at + 1, fault.last_byte = at + number.size();
  fault.is_syntax = true;
  return fault;
}

Error error_of(std::string_view text, JsonFault fault) {
  std::string place = fault.pointer;
  if (fault.byte > 0) place = line_and_column(text, fault.byte);
  return {fault.kind, std::move(place), std::move(fault.detail)};
}

}  // namespace

tl::expected<json, JsonFault> read_json(std::string_view text, const JsonLimits& limits) {
  if (auto fault = limit_fault(text, limits)) return tl::unexpected(std::move(*fault));
  DoubledKey doubled;
  const auto watch = [&](int, json::parse_event_t event, json& value) {
    return doubled(event, value);
  };
  try {
    json value = json::parse(text, watch);
    if (doubled.pointer().empty()) return value;
    JsonFault fault{ErrorKind::Malformed, "is in one object twice; keep one"};
    fault.pointer = doubled.pointer();
    return tl::unexpected(std::move(fault));
  } catch (const json::parse_error& e) {
    return tl::unexpected(syntax_fault(text, e.byte));
  } catch (const json::out_of_range& e) {
    return tl::unexpected(number_fault(text, e.what()));
  } catch (const json::exception& e) {
    return tl::unexpected(
        JsonFault{ErrorKind::Malformed, fmt::format("this is not valid JSON ({})", e.what())});
  }
}

Result<json> parse_json(std::string_view text, int max_depth) {
  constexpr std::size_t kMostValues = 2'000'000;
  auto value = read_json(text, {.values = kMostValues, .depth = max_depth});
  if (!value) return tl::unexpected(error_of(text, std::move(value.error())));
  return std::move(*value);
}

Result<nlohmann::json> parse_json_data(std::string_view text, const JsonLimits& limits) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  if (auto fault = limit_fault(text, limits))
    return tl::unexpected(error_of(text, std::move(*fault)));
  try {
    return nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    return fail(ErrorKind::Malformed, line_and_column(text, error.byte),
                "not JSON: " + reason(error.what()));
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorKind::Malformed, "", "not JSON: " + reason(error.what()));
  }
}

}  // namespace popcut
