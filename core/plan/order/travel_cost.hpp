// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "core/machines/machine.hpp"

namespace popcut {

/// What a move of the lifted tool costs: seconds of the machine, or millimetres.
///
/// From rest to rest with acceleration a, at most v fast: 2 sqrt(d/a) up to d = v^2/a, beyond it
/// d/v + v/a. Concave, so that a sum of short moves is dearer than its length says. Lift and drop
/// are the same for each stroke: they do not matter for the order.
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
