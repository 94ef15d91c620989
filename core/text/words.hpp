// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace popcut {

/// What CSS and SVG call white space.
inline constexpr std::string_view kBlanks = " \t\n\r\f";

[[nodiscard]] constexpr bool is_blank(char c) { return kBlanks.find(c) != std::string_view::npos; }

/// `text` without the characters of `blanks` before and after it.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text,
                                                 std::string_view blanks = kBlanks) {
  const auto is_one = [blanks](char c) {  // without a call: this is half of reading a DXF file
    for (const char blank : blanks)  // NOLINT(readability-use-anyofallof): so that it is inlined
      if (c == blank) return true;
    return false;
  };
  while (!text.empty() && is_one(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_one(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes from `rest` what stands before the first of `separators`, and that separator with it.
constexpr std::string_view take_word(std::string_view& rest, std::string_view separators) {
  const std::string_view word = rest.substr(0, rest.find_first_of(separators));
  rest.remove_prefix(std::min(word.size() + 1, rest.size()));
  return word;
}

/// Whether `word` is one of `words`, which stand with blanks between.
[[nodiscard]] constexpr bool has_word(std::string_view words, std::string_view word) {
  while (!words.empty())
    if (const std::string_view one = take_word(words, kBlanks); !one.empty() && one == word)
      return true;
  return false;
}

/// ASCII letters in lower case and in capitals; other characters as they are.
[[nodiscard]] constexpr char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
[[nodiscard]] constexpr char capital(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}
[[nodiscard]] inline std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

/// Whether two words are equal, ignoring the case of ASCII letters.
[[nodiscard]] constexpr bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

/// `text` as a part of a URL: all but letters, digits and "-._~" as %XX.
[[nodiscard]] inline std::string percent_encoded(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF", kPlain = "-._~";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       kPlain.find(c) != std::string_view::npos;
    if (plain)
      out += c;
    else
      out += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return out;
}

/// Reads all of `text` as one number; a plus before it does no harm, a second sign does.
template <typename Number>
[[nodiscard]] bool read_number(std::string_view text, Number& value) {
  if (text.starts_with("+-")) return false;
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc{} && stop == end;
}

}  // namespace popcut
