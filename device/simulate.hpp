// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "core/plan/machine.hpp"
#include "core/result.hpp"
#include "device/sim_cutter.hpp"

namespace popcut {

/// Runs a whole program on a simulated cutter: what it draws, and how long it takes.
///
/// @retval OutOfRange  see `SimCutter::make`
/// @retval Malformed   there are no bytes, or nothing is drawn and few commands are understood
[[nodiscard]] Result<Trace> simulate(std::span<const std::byte> program, const Machine& machine,
                                     const SimOptions& options = {});

}  // namespace popcut
