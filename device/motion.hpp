// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/plan/machine.hpp"

namespace popcut {

/// A straight way of the tool, as the motion planner sees it.
struct Leg {
  double length_mm{};
  double speed_mm_s{};   ///< asked for; reached if the leg is long enough
  double corner_mm_s{};  ///< fastest way through the corner with the leg before it; 0: a stop
};

/// Fastest way through a corner so that the path leaves it by at most `deviation_mm` at
/// `accel_mm_s2`: v^2 = a d s / (1 - s), s the sine of half the angle between the two legs.
///
/// @param turn_cos  cosine of the change of direction: 1 straight on, -1 back
[[nodiscard]] double corner_speed(double turn_cos, double accel_mm_s2, double deviation_mm);

/// How a leg is ridden: a trapezoid of speed.
struct Ride {
  double seconds{};
  double exit_mm_s{};
};

/// Rides the first of `ahead`, entered at `entry_mm_s`, as fast as the legs known so far allow:
/// the last of them must end at rest, and every corner at its own speed.
[[nodiscard]] Ride ride_first(std::span<const Leg> ahead, double entry_mm_s, double accel_mm_s2);

}  // namespace popcut
