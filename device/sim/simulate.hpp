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

/// Runs a whole program on a simulated cutter: the trace has what it draws and how long it takes.
///
/// @retval OutOfRange  see `SimCutter::make`; or the program draws more than `kMaxDrawnPoints`
/// @retval Malformed   the program is empty, or it draws nothing and most of it is not understood
[[nodiscard]] Result<Trace> simulate(std::span<const std::byte> program, const Machine& machine,
                                     const SimOptions& options = {});

/// The same with the faults of a script, sent by a host that only writes. The host gives up when
/// the cutter is unplugged, stalls, or stops moving; the trace's remarks say so.
///
/// @retval OutOfRange  see `simulate`
[[nodiscard]] Result<Trace> simulate_faults(std::span<const std::byte> program,
                                            const Machine& machine, const SimOptions& options,
                                            std::vector<SimFault> faults);

}  // namespace popcut
