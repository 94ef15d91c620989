// SPDX-License-Identifier: MIT
#include "core/formats/text_sink.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut {

void TextSink::put_rounded(double number) {
  constexpr double kLargest = 1e9;  // beyond it six decimals mean nothing
  if (!(std::abs(number) < kLargest)) return put(number);
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{:.6f}", number);
  std::string_view digits(text.data(), text.size());
  digits.remove_suffix(digits.size() - 1 - digits.find_last_not_of('0'));
  if (digits.back() == '.') digits.remove_suffix(1);
  put(digits == "-0" ? std::string_view("0") : digits);
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      default:
        escaped += (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) ? ' ' : c;
    }
  }
  return escaped;
}

std::string json_quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace popcut
