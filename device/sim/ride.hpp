// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/machines/machine.hpp"

namespace popcut {

/// A straight move of the tool, as the motion planner sees it.
struct Leg {
  double length_mm{};
  double speed_mm_s{};   ///< requested; reached if the leg is long enough
  double corner_mm_s{};  ///< highest speed through the corner with the leg before it; 0: a stop
};

/// How long a leg takes, with a trapezoid of speed.
struct Ride {
  double seconds{};
  double exit_mm_s{};
};

/// Rides the first leg of `ahead`, entered at `entry_mm_s`, as fast as the known legs allow: the
/// last one must end at rest, and no corner is faster than its limit. See core/machines/motion.hpp.
[[nodiscard]] Ride ride_first(std::span<const Leg> ahead, double entry_mm_s, double accel_mm_s2);

}  // namespace popcut
