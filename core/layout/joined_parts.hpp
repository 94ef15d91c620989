// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/drawing/linework.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// Several patterns with declared seams as one drawing.
struct JoinedParts {
  LineWork drawing;             ///< each part in its place, without outlines along seams
  std::vector<double> seams_x;  ///< where to split them again, mm from the left edge
};

/// Puts parts in their places (`Pattern::place`) and removes the outlines along their seams, so
/// that a layout splits the drawing there and adds tabs.
[[nodiscard]] JoinedParts join_parts(const std::vector<const Pattern*>& parts);

}  // namespace popcut
