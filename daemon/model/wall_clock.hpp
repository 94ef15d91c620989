// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// The system's clock. Unlike std::chrono::system_clock, whose nanoseconds end in 2262, it is right
/// in any year.
[[nodiscard]] TimeMs wall_clock_ms();

}  // namespace popcut::daemon
