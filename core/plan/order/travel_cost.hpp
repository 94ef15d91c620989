// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "core/machines/machine.hpp"

namespace popcut {

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
