// SPDX-License-Identifier: MIT
#include "device/sim/window.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace popcut {

std::optional<Inside> clip(const Window& window, PagePoint a, PagePoint b) {
  constexpr double kFloatNoiseMm = 1e-9;  // an edge in whole units is not lost to rounding
  Inside inside;
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const std::array slope{-dx, dx, -dy, dy};
  const std::array room{a.x - window.left, window.right - a.x, a.y - window.top,
                        window.bottom - a.y};
  for (std::size_t side = 0; side < 4; ++side) {
    if (slope[side] == 0) {
      if (room[side] < -kFloatNoiseMm) return std::nullopt;
      continue;
    }
    const double t = (room[side] + kFloatNoiseMm) / slope[side];
    if (slope[side] < 0)
      inside.from = std::max(inside.from, t);
    else
      inside.to = std::min(inside.to, t);
  }
  const bool dot = dx == 0 && dy == 0;
  const double least = dot ? 0 : 4 * kFloatNoiseMm / std::hypot(dx, dy);
  if (inside.to - inside.from < least) return std::nullopt;
  return inside;
}

}  // namespace popcut
