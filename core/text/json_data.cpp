// SPDX-License-Identifier: MIT
#include "core/text/json_data.hpp"

#include <string>

namespace popcut {
namespace {

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
  if (auto within_limits = check_json_limits(text, limits); !within_limits)
    return tl::unexpected(within_limits.error());
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
