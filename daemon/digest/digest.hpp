// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut::daemon {

/// SHA-256 (FIPS 180-4) of bytes that come in pieces, by libcrypto.
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

/// Bytes as hexadecimal digits, small letters.
[[nodiscard]] std::string hex_of(std::string_view bytes);
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
/// RFC 4648 section 4, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);
/// RFC 4648 section 5, without padding: 32 bytes are 43 characters.
[[nodiscard]] std::string base64url(std::string_view bytes);
/// What PostgreSQL keeps of a password in place of it: SCRAM-SHA-256 (RFC 5802, RFC 7677), with
/// 4096 rounds. `salt` has 16 bytes.
[[nodiscard]] std::string scram_verifier(std::string_view password, std::string_view salt);

}  // namespace popcut::daemon
