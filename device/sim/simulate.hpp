// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/sim/sim_cutter.hpp"
#include "device/sim/sim_faults.hpp"

namespace popcut {

/// Runs a whole program on a simulated cutter: what it draws, and how long it takes.
///
/// @retval OutOfRange  see `SimCutter::make`; or the program draws more than `kMaxDrawnPoints`
/// @retval Malformed   there are no bytes, or nothing is drawn and few commands are understood
[[nodiscard]] Result<Trace> simulate(std::span<const std::byte> program, const Machine& machine,
                                     const SimOptions& options = {});

/// The same over a cable on which the faults of a script strike, sent by a host that only writes.
/// It gives up when the cable is cut, the line stalls, or nothing moves any more; the trace says so
/// in its remarks.
///
/// @retval OutOfRange  see `simulate`
[[nodiscard]] Result<Trace> simulate_faults(std::span<const std::byte> program,
                                            const Machine& machine, const SimOptions& options,
                                            std::vector<SimFault> faults);

}  // namespace popcut
