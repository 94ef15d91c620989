// SPDX-License-Identifier: MIT
#include "core/formats/json_data.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace popcut {
namespace {

std::string place_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column = newline == std::string_view::npos ? byte + 1 : byte - newline;
  return fmt::format("line {}, column {}", line, column);
}

// Depth and count of values by brackets and commas outside of strings: needs no memory.
Result<void> check_limits(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes)
    return fail(ErrorKind::Malformed, "",
                fmt::format("{} bytes of JSON; at most {} are read", text.size(), limits.bytes));
  int depth = 0;
  std::size_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == ']' || c == '}') --depth;
    if (c == '[' || c == '{') {
      ++values;
      if (++depth > limits.depth)
        return fail(ErrorKind::Malformed, place_of(text, i),
                    fmt::format("nested more than {} deep; no such file needs that", limits.depth));
    }
    if (c == ',' && ++values > limits.values)
      return fail(ErrorKind::Malformed, place_of(text, i),
                  fmt::format("more than {} values; split the file", limits.values));
  }
  return {};
}

// The reason out of "[json.exception...] parse error at line 1, column 2: syntax error ...".
std::string reason(std::string_view what) {
  const std::size_t at = what.find("syntax error");
  if (at != std::string_view::npos) what.remove_prefix(at);
  std::string printable;
  for (const char c : what.substr(0, 160))
    printable +=
        static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e ? '?' : c;
  return printable;
}

}  // namespace

Result<nlohmann::json> parse_json_data(std::string_view text, const JsonLimits& limits) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  if (auto within_limits = check_limits(text, limits); !within_limits)
    return tl::unexpected(within_limits.error());
  try {
    return nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    return fail(ErrorKind::Malformed, place_of(text, error.byte == 0 ? 0 : error.byte - 1),
                "not JSON: " + reason(error.what()));
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorKind::Malformed, "", "not JSON: " + reason(error.what()));
  }
}

}  // namespace popcut
