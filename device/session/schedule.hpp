// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// When each command of a program ends on a machine that is given all of it at once.
struct TimedCommand {
  std::uint64_t end_byte{};
  double seconds{};       ///< since the geometry began
  double stroke_end_s{};  ///< when the stroke that it is part of ends
};

/// The estimated course of a program.
struct Schedule {
  std::vector<TimedCommand> geometry;  ///< in order of bytes
  double setup_s{}, geometry_s{}, trailer_s{};
};

/// Estimates a program by running it on a simulated cutter.
///
/// @retval OutOfRange  see `SimCutter::make`
[[nodiscard]] Result<Schedule> schedule(const EncodedProgram& program, const Machine& machine);

/// How far may be sent of a machine's geometry when `next` is the first command that is not sent,
/// what was sent lasts until `sent_s` and the machine is at `now_s`: at most a window ahead of it,
/// and no stroke that ends beyond the window, so that the host is obeyed within one; but never so
/// little that the machine runs dry. 0 where nothing may; else the end of a command, less than one
/// command beyond `most_bytes`.
[[nodiscard]] std::uint64_t affordable_end(const Schedule& plan, std::size_t next, double sent_s,
                                           double now_s, double window_s, std::size_t most_bytes);

}  // namespace popcut
