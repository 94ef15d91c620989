// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// Something that goes wrong on the cable or at the machine, once it has taken `at_byte` bytes, or
/// once the tool has come down for stroke `at_path` (from 1), whichever is given.
struct SimFault {
  enum class Kind : std::uint8_t {
    Unplug,      ///< nothing is accepted or answered any more, plugged in again after `seconds`
    ShortWrite,  ///< this write ends early, though there is room
    Nak,         ///< nothing is accepted for `seconds`
    Silence,     ///< replies are lost for `seconds`
    Garbage,     ///< `text` arrives unasked
    Pause,       ///< the panel's pause button, pressed again after `seconds` if above 0
    Cancel,      ///< pause, and cancel after `seconds`
    MediaOut,    ///< the sheet is pulled out, and loaded again after `seconds` if above 0
    Stall,       ///< this write fails, though some of its bytes have arrived
    WrongName,   ///< the machine answers `text` to FG
    NoMarks,     ///< no registration mark can be seen
  };
  std::uint64_t at_byte{};
  Kind kind{};
  double seconds{};
  std::string text{};
  std::optional<std::uint64_t> at_path{};
};

/// "unplug", "short write", ...: the words of a fault script.
[[nodiscard]] std::string_view name_of(SimFault::Kind kind);

/// Reads a fault script: `{"popcut": 1, "faults": [{"at_byte": 800, "kind": "nak", "seconds": 3},
/// {"at_path": 12, "kind": "pause"}]}`, or `{"popcut": 1, "random": {"seed": 7, "count": 2,
/// "bytes": 9000}}` for faults drawn by chance, the same ones for the same seed. At most 1000
/// faults.
///
/// @retval Malformed   not JSON; place is line and column
/// @retval OutOfRange  a value that is not lawful; place is a JSON pointer
[[nodiscard]] Result<std::vector<SimFault>> parse_faults(std::string_view text);

/// `count` faults of any kind among the first `bytes` bytes. The same for the same seed.
[[nodiscard]] std::vector<SimFault> random_faults(std::uint32_t seed, std::size_t count,
                                                  std::uint64_t bytes);

}  // namespace popcut
