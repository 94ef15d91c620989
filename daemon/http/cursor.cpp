// SPDX-License-Identifier: MIT
#include "daemon/http/cursor.hpp"

#include <algorithm>
#include <cstdint>

namespace popcut::daemon::http {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr char kVersion = '1';
constexpr std::size_t kLongest = 300;

}  // namespace

std::string encode_cursor(std::string_view place) {
  const std::string plain = kVersion + std::string(place);
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : plain) {
    bits = bits << 8 | static_cast<unsigned char>(c);
    for (count += 8; count >= 6; count -= 6) out += kDigits[bits >> (count - 6) & 63u];
    bits &= (1u << count) - 1;
  }
  if (count > 0) out += kDigits[bits << (6 - count) & 63u];
  return out;
}

std::optional<std::string> decode_cursor(std::string_view cursor) {
  if (cursor.empty() || cursor.size() > kLongest) return std::nullopt;
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : cursor) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>(bits >> count & 0xFFu);
    bits &= (1u << count) - 1;
  }
  const bool is_plain =
      std::all_of(out.begin(), out.end(), [](char c) { return c > ' ' && c < '\x7F'; });
  if (out.size() < 2 || out.front() != kVersion || !is_plain) return std::nullopt;
  out.erase(0, 1);
  if (encode_cursor(out) != cursor) return std::nullopt;  // one spelling only
  return out;
}

}  // namespace popcut::daemon::http
