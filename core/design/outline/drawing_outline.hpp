// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/design/outline/area.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// The shapes that the closed lines and filled shapes of a drawing (SVG or DXF) bound, y up, mm.
/// What lies within an odd number of them is inside. White fills take away from what is drawn
/// before them; on a dark fill of the whole page they are holes in it. Its leftmost point is at
/// x = 0, its lowest at y = 0.
///
/// @param height    what the whole becomes; none: as high as it is drawn
/// @param warnings  gets what the drawing has and the shapes have not: text, pictures, open lines
/// @retval Malformed   neither SVG nor DXF, or broken
/// @retval Infeasible  it has no closed line with an area
[[nodiscard]] Result<std::vector<Area>> drawing_areas(const std::string& bytes,
                                                      std::optional<double> height,
                                                      std::vector<Warning>* warnings = nullptr);

}  // namespace popcut
