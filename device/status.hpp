// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace popcut {

/// What a GPGL machine answers to ESC ENQ.
enum class Status : std::uint8_t {
  Ready,      ///< 0: idle, media loaded
  Moving,     ///< 1: anything is queued or moves
  NoMedia,    ///< 2
  Paused,     ///< 3: by the panel
  Cancelled,  ///< 4: on the panel, out of a pause (seen on the Cameo 3)
};

/// The digit on the wire.
[[nodiscard]] constexpr char digit(Status status) {
  return static_cast<char>('0' + static_cast<int>(status));
}

}  // namespace popcut
