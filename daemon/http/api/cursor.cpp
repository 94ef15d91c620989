// SPDX-License-Identifier: MIT
#include "daemon/http/api/cursor.hpp"

#include <algorithm>
#include <cstdint>

#include "daemon/digest/digest.hpp"

namespace popcut::daemon::http {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr char kVersion = '1';
constexpr std::size_t kLongest = 300;

}  // namespace

std::string encode_cursor(std::string_view place) {
  return base64url(kVersion + std::string(place));
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
