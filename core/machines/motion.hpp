// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// How machines move. Plans take their times from this model and the simulated cutter moves by it.

/// Highest speed through a corner at which the path stays within c = `corner_mm` of it (junction
/// deviation): v^2 = a c s / (1 - s), with s the sine of half the angle between the legs. Infinite
/// for a straight line, 0 where the path turns back. In mm/s.
///
/// @param turn_cos  cosine of the change of direction: 1 straight on, -1 back
[[nodiscard]] double corner_speed(double turn_cos, const Motion& motion);

/// Seconds to cover `mm` while going from speed `entry` to speed `exit`, never faster than `most`
/// (all mm/s): accelerate, hold, brake. `exit` must be reachable from `entry` within `mm`.
[[nodiscard]] double leg_seconds(double mm, double entry, double exit, double most,
                                 double accel_mm_s2);

/// Seconds that the firmware takes to turn a blade of this offset at a corner. At turns of more
/// than 30 degrees it stops the tool and swings the blade's tip round; at others this is 0.
[[nodiscard]] double swivel_seconds(double turn_cos, double blade_offset_mm, const Motion& motion);

/// Cosine of the change of direction at q on the path p, q, r; 1 if two of these points coincide.
[[nodiscard]] double turn_cos(const PagePoint& p, const PagePoint& q, const PagePoint& r);

/// Seconds for a path that starts and ends at rest and never exceeds `speed_mm_s`.
///
/// Acceleration a is constant. The path passes corners at `corner_speed` and stops where the
/// firmware turns a blade of `swivel_offset_mm` (0: none). O(n): one backward pass v_i =
/// min(corner_i, sqrt(v_(i+1)^2 + 2 a l_i)), then one forward pass.
[[nodiscard]] double path_seconds(std::span<const PagePoint> path, double speed_mm_s,
                                  const Motion& motion, double swivel_offset_mm = 0.0);

/// Seconds for a straight move of `mm` with the tool up, from rest to rest.
[[nodiscard]] double travel_seconds(double mm, const Motion& motion);

/// The blades that the firmware turns at corners.
struct FirmwareSwivel {
  double offset_mm{};
  std::uint16_t blade_tools{};  ///< bit n: tool holder n holds a blade
};

/// Seconds for all strokes of `path` and the moves between them. Each stroke includes lowering and
/// lifting the tool. The moves from and to home are not included.
[[nodiscard]] double strokes_seconds(const Toolpath& path, const Motion& motion,
                                     const FirmwareSwivel& swivel = {});

}  // namespace popcut
