// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// When a command of a program ends, on a machine that receives all of it at once.
struct TimedCommand {
  std::uint64_t end_byte{};
  double seconds{};       ///< since the geometry began
  double stroke_end_s{};  ///< when its stroke ends
};

/// When each command of a program ends, by estimate.
struct Schedule {
  std::vector<TimedCommand> geometry;  ///< in order of bytes
  double setup_s{}, geometry_s{}, trailer_s{};
};

/// Estimates a program by running it on a simulated cutter.
///
/// @retval OutOfRange  see `SimCutter::make`
[[nodiscard]] Result<Schedule> schedule(const EncodedProgram& program, const Machine& machine);

/// Up to which byte of the geometry you may send now. `next` is the first command that was not
/// sent, the commands sent last until `sent_s`, and the machine is at `now_s`.
///
/// Sends at most a window ahead and no stroke that ends beyond the window, so that a stop takes
/// effect within one window; but never so little that the machine runs dry.
///
/// @return the end of a command, less than one command beyond `most_bytes`; 0 if nothing may be
/// sent
[[nodiscard]] std::uint64_t affordable_end(const Schedule& plan, std::size_t next, double sent_s,
                                           double now_s, double window_s, std::size_t most_bytes);

}  // namespace popcut
