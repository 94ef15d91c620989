// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/outline/area.hpp"

namespace popcut {

/// The corners, nine numbers a triangle, of a solid with flat shapes as its front: they stand
/// upright on y (right) and z (up) and reach from x = 0 to x = `depth`. Its triangles face outward
/// and share their corners' places; the back at x = 0 is part of it.
[[nodiscard]] std::vector<float> extruded(const std::vector<Area>& areas, double depth);

}  // namespace popcut
