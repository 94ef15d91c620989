// SPDX-License-Identifier: MIT
#include "daemon/store/ulid.hpp"

#include <algorithm>

#include "daemon/digest/digest.hpp"

namespace popcut::daemon {
namespace {

constexpr std::string_view kCrockford = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";

// 128 bits as 26 characters of 5 bits, most significant first; the first holds 3.
std::string ulid_text(const std::array<std::uint8_t, 16>& bytes) {
  std::string text(26, '0');
  for (std::size_t place = 0; place < 26; ++place) {
    unsigned value = 0;
    for (std::size_t bit = 0; bit < 5; ++bit) {
      const std::size_t at = place * 5 + bit;  // of 130 bits, the first two are zero
      const unsigned one = at < 2 ? 0U : (bytes[(at - 2) / 8] >> (7 - (at - 2) % 8)) & 1U;
      value = value << 1 | one;
    }
    text[place] = kCrockford[value];
  }
  return text;
}

std::array<std::uint8_t, 16> ulid_bytes(std::string_view text) {
  std::array<std::uint8_t, 16> bytes{};
  for (std::size_t place = 0; place < 26; ++place) {
    const std::size_t value = kCrockford.find(text[place]);
    for (std::size_t bit = 0; bit < 5; ++bit) {
      const std::size_t at = place * 5 + bit;
      if (at < 2 || (value >> (4 - bit) & 1U) == 0) continue;
      bytes[(at - 2) / 8] =
          static_cast<std::uint8_t>(bytes[(at - 2) / 8] | 1U << (7 - (at - 2) % 8));
    }
  }
  return bytes;
}

void put_time(std::array<std::uint8_t, 16>& bytes, std::int64_t ms) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ms));
  for (std::size_t i = 0; i < 6; ++i)
    bytes[i] = static_cast<std::uint8_t>(time >> (8 * (5 - i)) & 0xFF);
}

}  // namespace

UlidSource::UlidSource(std::string_view last) { raise_above(last); }

void UlidSource::raise_above(std::string_view last) {
  if (is_ulid(last)) last_ = std::max(last_, ulid_bytes(last));
}

std::string UlidSource::next(std::int64_t now_ms) {
  std::array<std::uint8_t, 16> fresh{};
  put_time(fresh, now_ms);
  const std::string chance = random_bytes(10);
  for (std::size_t i = 0; i < 10; ++i) fresh[6 + i] = static_cast<std::uint8_t>(chance[i]);
  if (std::equal(fresh.begin(), fresh.begin() + 6, last_.begin()) || fresh < last_) {
    fresh = last_;
    for (std::size_t i = 16; i-- > 0;)
      if (++fresh[i] != 0) break;
  }
  last_ = fresh;
  return ulid_text(fresh);
}

std::string first_ulid_of(std::int64_t time_ms) {
  std::array<std::uint8_t, 16> bytes{};
  put_time(bytes, time_ms);
  return ulid_text(bytes);
}

bool is_ulid(std::string_view text) {
  return text.size() == 26 && text[0] <= '7' &&
         text.find_first_not_of(kCrockford) == std::string_view::npos;
}

}  // namespace popcut::daemon
