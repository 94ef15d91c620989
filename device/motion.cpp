// SPDX-License-Identifier: MIT
#include "device/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace popcut {

double corner_speed(double turn_cos, double accel_mm_s2, double deviation_mm) {
  // The angle between the legs is pi minus the turn, so the sine of its half is the cosine of half
  // the turn.
  const double s = std::sqrt(std::clamp(0.5 * (1.0 + turn_cos), 0.0, 1.0));
  if (s > 0.999999) return std::numeric_limits<double>::infinity();
  return std::sqrt(accel_mm_s2 * deviation_mm * s / (1.0 - s));
}

Ride ride_first(std::span<const Leg> ahead, double entry_mm_s, double accel_mm_s2) {
  const Leg& leg = ahead.front();
  if (!(leg.length_mm > 0) || !(leg.speed_mm_s > 0) || !(accel_mm_s2 > 0)) return {0, 0};
  // 1. Backwards from rest at the end of what is known: how fast each corner may be left.
  double exit = 0;
  for (std::size_t i = ahead.size() - 1; i > 0; --i) {
    const Leg& later = ahead[i];
    const double reachable = std::sqrt(exit * exit + 2 * accel_mm_s2 * later.length_mm);
    exit = std::min({reachable, later.corner_mm_s, later.speed_mm_s});
  }
  const double v = leg.speed_mm_s;
  const double entry = std::min(entry_mm_s, v);
  exit = std::min({exit, v, std::sqrt(entry * entry + 2 * accel_mm_s2 * leg.length_mm)});
  // 2. Speed up, hold, slow down.
  const double peak =
      std::min(v, std::sqrt(accel_mm_s2 * leg.length_mm + 0.5 * (entry * entry + exit * exit)));
  const double ramps_mm = (2 * peak * peak - entry * entry - exit * exit) / (2 * accel_mm_s2);
  const double held_mm = std::max(0.0, leg.length_mm - ramps_mm);
  return {(2 * peak - entry - exit) / accel_mm_s2 + held_mm / peak, exit};
}

}  // namespace popcut
