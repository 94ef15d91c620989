// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// When a command of a program ends, on a machine that receives all of it at once.
struct TimedCommand {
  std::uint64_t end_byte{};
  double seconds{};       ///< since the geometry began
  double stroke_end_s{};  ///< when its stroke ends; its own end if it comes before the first line
};

/// When each command of a program ends, by estimate.
struct Schedule {
  std::vector<TimedCommand> geometry;  ///< in order of bytes
  double setup_s{}, geometry_s{}, trailer_s{}, feed_out_s{};
};

/// Estimates a program by running it on a simulated cutter.
///
/// @param first_lines  of the program's strokes
/// @retval OutOfRange  see `SimCutter::make`
[[nodiscard]] Result<Schedule> schedule(const EncodedProgram& program, const Machine& machine,
                                        std::span<const std::uint64_t> first_lines);

/// Where the machine is: it is past `least_s` and has not reached more than `most_s`, seconds of
/// the schedule. It does `slow` to `fast` seconds of the schedule in a second.
struct Whereabouts {
  double least_s{}, most_s{};
  double slow{1}, fast{1};
};

/// Up to which byte of the geometry you may send now. `next` is the first command that was not
/// sent; the commands sent last until `sent_s`.
///
/// Sends at most a window ahead and no stroke that ends beyond the window, so that a stop takes
/// effect within one window however slow the machine is; but never so little that it runs dry
/// however fast it is.
///
/// @param window_s  in seconds of the machine
/// @return the end of a command, less than one command beyond `most_bytes`; 0 if nothing may be
/// sent
[[nodiscard]] std::uint64_t affordable_end(const Schedule& plan, std::size_t next, double sent_s,
                                           const Whereabouts& machine, double window_s,
                                           std::size_t most_bytes);

}  // namespace popcut
