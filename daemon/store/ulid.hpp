// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace popcut::daemon {

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
