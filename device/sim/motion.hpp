// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/machines/machine.hpp"

namespace popcut {

/// A straight way of the tool, as the motion planner sees it.
struct Leg {
  double length_mm{};
  double speed_mm_s{};   ///< asked for; reached if the leg is long enough
  double corner_mm_s{};  ///< fastest way through the corner with the leg before it; 0: a stop
};

/// How a leg is ridden: a trapezoid of speed.
struct Ride {
  double seconds{};
  double exit_mm_s{};
};

/// Rides the first of `ahead`, entered at `entry_mm_s`, as fast as the legs known so far allow:
/// the last of them must end at rest, and every corner at its own speed. See core/plan/motion.hpp.
[[nodiscard]] Ride ride_first(std::span<const Leg> ahead, double entry_mm_s, double accel_mm_s2);

}  // namespace popcut
