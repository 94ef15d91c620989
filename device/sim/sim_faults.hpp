// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// A fault on the cable or at the machine. It strikes when the machine has accepted `at_byte` bytes
/// or, if given, when the tool has come down for stroke `at_path` (from 1).
struct SimFault {
  enum class Kind : std::uint8_t {
    Unplug,      ///< nothing is accepted or answered; plugged in again after `seconds` if above 0
    ShortWrite,  ///< one write ends early, although there is room
    Nak,         ///< nothing is accepted for `seconds`
    Silence,     ///< replies are lost for `seconds`
    Garbage,     ///< `text` arrives without a query
    Pause,       ///< the panel's pause button, pressed again after `seconds` if above 0
    Cancel,      ///< the panel's pause button, then cancel after `seconds`
    MediaOut,    ///< the sheet is pulled out, and loaded again after `seconds` if above 0
    Stall,       ///< one write fails, although some of its bytes have arrived
    WrongName,   ///< the machine answers `text` to FG
    NoMarks,     ///< no registration mark can be seen
  };
  std::uint64_t at_byte{};
  Kind kind{};
  double seconds{};
  std::string text{};
  std::optional<std::uint64_t> at_path{};
};

/// "unplug", "short write", ...: the kinds in a fault script.
[[nodiscard]] std::string_view name_of(SimFault::Kind kind);

/// Reads a fault script: `{"popcut": 1, "faults": [{"at_byte": 800, "kind": "nak", "seconds": 3},
/// {"at_path": 12, "kind": "pause"}]}`, or `{"popcut": 1, "random": {"seed": 7, "count": 2,
/// "bytes": 9000}}` for random faults, the same ones for the same seed. At most 1000 faults.
///
/// @retval Malformed   not JSON; place is line and column
/// @retval OutOfRange  an invalid value; place is a JSON pointer
[[nodiscard]] Result<std::vector<SimFault>> parse_faults(std::string_view text);

/// `count` random faults of any kind within the first `bytes` bytes, the same for the same seed.
[[nodiscard]] std::vector<SimFault> random_faults(std::uint32_t seed, std::size_t count,
                                                  std::uint64_t bytes);

}  // namespace popcut
