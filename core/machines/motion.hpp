// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <span>
#include <vector>

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

/// Seconds for a straight move of `mm` with the tool up, from rest to rest.
[[nodiscard]] double travel_seconds(double mm, const Motion& motion);

/// Seconds for one search for marks around a rectangle, along the carriage and the feed.
[[nodiscard]] double search_seconds(double width_mm, double height_mm, const MarkSearch& marks);

/// The blades that the firmware turns at corners.
struct FirmwareSwivel {
  double offset_mm{};
  std::uint16_t blade_tools{};  ///< bit n: tool holder n holds a blade
};

/// When a stroke begins, with the tool still up at its first point, and when the tool is up again
/// at its last; s since the first one began.
struct StrokeTime {
  double begin_s{}, end_s{};
};
/// The times of all strokes, as `strokes_seconds` counts them.
[[nodiscard]] std::vector<StrokeTime> stroke_times(const Toolpath& path, const Motion& motion,
                                                   const FirmwareSwivel& swivel = {});

/// Seconds for all strokes of `path` and the moves between them. Each stroke includes lowering and
/// lifting the tool. The moves from and to home are not included.
///
/// A stroke starts and ends at rest. Acceleration a is constant. The tool passes corners at
/// `corner_speed` and stops where the firmware turns a blade. O(n): one backward pass v_i =
/// min(corner_i, sqrt(v_(i+1)^2 + 2 a l_i)), then one forward pass.
[[nodiscard]] double strokes_seconds(const Toolpath& path, const Motion& motion,
                                     const FirmwareSwivel& swivel = {});

/// Cost of a move of the lifted tool: seconds on the machine, or millimetres.
///
/// From rest to rest with acceleration a and top speed v: 2 sqrt(d/a) up to d = v^2/a, beyond it
/// d/v + v/a. This is concave: many short moves cost more than one move of the same length. Lifting
/// and lowering cost the same for each stroke and do not affect the order.
struct TravelCost {
  double knee_mm{0.0};        ///< v^2/a
  double root_s{0.0};         ///< 2/sqrt(a)
  double per_mm{1.0};         ///< 1/v, or 1 for millimetres
  double beyond_knee_s{0.0};  ///< v/a

  [[nodiscard]] static TravelCost millimetres() { return {}; }
  [[nodiscard]] static TravelCost seconds(const Motion& motion) {
    const double a = motion.accel_mm_s2, v = motion.travel_mm_s;
    return {v * v / a, 2.0 / std::sqrt(a), 1.0 / v, v / a};
  }
  [[nodiscard]] double operator()(double mm) const {
    return mm < knee_mm ? root_s * std::sqrt(mm) : mm * per_mm + beyond_knee_s;
  }
};

}  // namespace popcut
