// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// The one model of how machines move: times of plans and the simulated cutter both use it.

/// Fastest way through a corner so that the path leaves it by at most c = `corner_mm`: v^2 = a c s
/// / (1 - s), s the sine of half the angle between the legs (junction deviation). Infinite straight
/// on, 0 where the way turns back.
///
/// @param turn_cos  cosine of the change of direction: 1 straight on, -1 back
[[nodiscard]] double corner_speed(double turn_cos, const Motion& motion);

/// Seconds over `mm` from speed `entry` to speed `exit`, at most `most`, all in mm/s: speed up,
/// hold, slow down. The two ends must be within reach of each other.
[[nodiscard]] double leg_seconds(double mm, double entry, double exit, double most,
                                 double accel_mm_s2);

/// Seconds that the firmware takes to turn a blade of this offset at a corner: turns beyond 30
/// degrees stop the tool and swing its tip round; 0 below.
[[nodiscard]] double swivel_seconds(double turn_cos, double blade_offset_mm, const Motion& motion);

/// Cosine of the change of direction at q on the way p, q, r; 1 where two of them are one.
[[nodiscard]] double turn_cos(const PagePoint& p, const PagePoint& q, const PagePoint& r);

/// Seconds for a path that starts and ends at rest, at most `speed_mm_s` fast.
///
/// Constant acceleration a; corners at `corner_speed`, at a stop where the firmware turns a blade
/// of `swivel_offset_mm` (0: none). One backward pass v_i = min(corner_i, sqrt(v_(i+1)^2 + 2 a
/// l_i)) and one forward pass make it O(n).
[[nodiscard]] double path_seconds(std::span<const PagePoint> path, double speed_mm_s,
                                  const Motion& motion, double swivel_offset_mm = 0.0);

/// Seconds for a straight move of `mm` with the tool up, from rest to rest.
[[nodiscard]] double travel_seconds(double mm, const Motion& motion);

/// Blades that the firmware turns at corners.
struct FirmwareSwivel {
  double offset_mm{};
  std::uint16_t blade_tools{};  ///< bit n: tool holder n holds a blade
};

/// Seconds for all strokes of `path` with the ways between them, tool down and up each time;
/// without the way from and to home.
[[nodiscard]] double strokes_seconds(const Toolpath& path, const Motion& motion,
                                     const FirmwareSwivel& swivel = {});

}  // namespace popcut
