// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut::daemon {

/// SHA-256 of bytes that come in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::string_view bytes);
  /// The digest as 64 hexadecimal digits. Nothing may be added after it.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 of `bytes` as 64 hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);
/// SHA-256 of a file.
///
/// @retval Malformed  it cannot be read
[[nodiscard]] Result<std::string> sha256_of_file(const std::string& path);

/// True if both are equal; the time it takes depends on their lengths only.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);
/// `count` bytes from the system's generator.
[[nodiscard]] std::string random_bytes(std::size_t count);
/// RFC 4648 section 5, without padding: 32 bytes are 43 characters.
[[nodiscard]] std::string base64url(std::string_view bytes);

/// 26 characters that sort by the time of their making (ULID): 48 bits of milliseconds, 80 of
/// chance. Within a source each is greater than the one before, also when the clock goes back.
class UlidSource {
 public:
  /// The next one is greater than `last`, which may be empty.
  explicit UlidSource(std::string_view last = {});
  [[nodiscard]] std::string next(std::int64_t now_ms);
  void raise_above(std::string_view last);

 private:
  std::array<std::uint8_t, 16> last_{};
};

/// The smallest id that can have been made at `time_ms`.
[[nodiscard]] std::string first_ulid_of(std::int64_t time_ms);
/// 26 characters of Crockford's alphabet, the first at most 7.
[[nodiscard]] bool is_ulid(std::string_view text);

}  // namespace popcut::daemon
