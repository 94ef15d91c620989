// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/plan/machine.hpp"
#include "core/toolpath.hpp"

namespace popcut {

/// Seconds for a path that starts and ends at rest, at most `speed_mm_s` fast.
///
/// Constant acceleration a. At a corner between unit directions u and w the speed is at most
/// sqrt(a c s / (1 - s)) with s = sqrt((1 + u.w) / 2) (junction deviation c: straight on is free, a
/// reversal stops). One backward pass v_i = min(corner_i, sqrt(v_(i+1)^2 + 2 a l_i)) and one
/// forward pass make it O(n); each piece is then a triangle or a trapezoid of speed.
[[nodiscard]] double path_seconds(std::span<const PagePoint> path, double speed_mm_s,
                                  const Motion& motion);

/// Seconds for a straight move of `mm` with the tool up, from rest to rest.
[[nodiscard]] double travel_seconds(double mm, const Motion& motion);

/// Seconds for all strokes of `path` with the ways between them, tool down and up each time;
/// without the way from and to home.
[[nodiscard]] double strokes_seconds(const Toolpath& path, const Motion& motion);

}  // namespace popcut
