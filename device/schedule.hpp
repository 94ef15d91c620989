// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/plan/machine.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// When each command of a program ends on a machine that is given all of it at once.
struct TimedCommand {
  std::uint64_t end_byte{};
  double seconds{};  ///< since the geometry began
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

}  // namespace popcut
