// SPDX-License-Identifier: MIT
#include "device/sim/ride.hpp"

#include <algorithm>
#include <cmath>

#include "core/machines/motion.hpp"

namespace popcut {

Ride ride_first(std::span<const Leg> ahead, double entry_mm_s, double accel_mm_s2) {
  const Leg& leg = ahead.front();
  if (!(leg.length_mm > 0) || !(leg.speed_mm_s > 0) || !(accel_mm_s2 > 0)) return {0, 0};
  // Backwards from rest at the end of the last known leg: how fast each corner may be left.
  double exit = 0;
  for (std::size_t i = ahead.size() - 1; i > 0; --i) {
    const Leg& later = ahead[i];
    const double reachable = std::sqrt(exit * exit + 2 * accel_mm_s2 * later.length_mm);
    exit = std::min({reachable, later.corner_mm_s, later.speed_mm_s});
  }
  const double v = leg.speed_mm_s;
  const double entry = std::min(entry_mm_s, v);
  exit = std::min({exit, v, std::sqrt(entry * entry + 2 * accel_mm_s2 * leg.length_mm)});
  return {leg_seconds(leg.length_mm, entry, exit, v, accel_mm_s2), exit};
}

}  // namespace popcut
