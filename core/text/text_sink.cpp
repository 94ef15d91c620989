// SPDX-License-Identifier: MIT
#include "core/text/text_sink.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"

namespace popcut {
namespace {

/// Writes where `kLongestNumber` characters have room. @return the end of what was written
char* write_rounded(char* to, double number) {
  constexpr double kLargest = 1e9;  // beyond it six decimals mean nothing
  if (!(std::abs(number) < kLargest)) return std::to_chars(to, to + kLongestNumber, number).ptr;
  const long long millionths = std::llround(number * 1e6);
  if (millionths < 0) *to++ = '-';
  const auto size = static_cast<unsigned long long>(millionths < 0 ? -millionths : millionths);
  to = std::to_chars(to, to + kLongestNumber, size / 1'000'000).ptr;
  auto rest = static_cast<unsigned>(size % 1'000'000);
  if (rest == 0) return to;
  *to++ = '.';
  for (unsigned place = 100'000; rest > 0; place /= 10) {
    *to++ = static_cast<char>('0' + rest / place);
    rest %= place;
  }
  return to;
}

}  // namespace

void append_rounded(std::string& text, double number) {
  std::array<char, kLongestNumber> digits;
  text.append(digits.data(), write_rounded(digits.data(), number));
}

void TextSink::put_past_block(std::string_view text) {
  flush();
  if (text.size() <= block_.size()) return put(text);
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void TextSink::put_rounded(double number) {
  if (block_.size() - used_ < kLongestNumber) flush();
  char* const first = block_.data() + used_;
  used_ += static_cast<std::size_t>(write_rounded(first, number) - first);
}

namespace {

/// Bytes of the character that `text` begins with where XML 1.0 can hold it: UTF-8 without U+FFFE
/// and U+FFFF. Else 0.
std::size_t xml_character(std::string_view text) {
  const CodePoint first = code_point(text, 0);
  return first.value == 0xfffe || first.value == 0xffff ? 0 : first.length;
}

}  // namespace

std::string xml_escaped(std::string_view text) {
  constexpr std::string_view kSpecial = "&<>\"'";
  constexpr std::array kNames{"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
  std::string escaped;
  escaped.reserve(text.size());
  for (std::size_t length = 1; !text.empty(); text.remove_prefix(length)) {
    const char c = text.front();
    length = xml_character(text);
    if (length != 1) {
      escaped += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(0, length);
      length = std::max<std::size_t>(length, 1);
      continue;
    }
    if (const std::size_t special = kSpecial.find(c); special != std::string_view::npos)
      escaped += kNames.at(special);
    else
      escaped += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return escaped;
}

std::string json_quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace popcut
