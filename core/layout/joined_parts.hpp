// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/pattern/pattern.hpp"
#include "core/drawing/linework.hpp"

namespace popcut {

/// Several patterns with declared seams as one drawing.
struct JoinedParts {
  LineWork drawing;             ///< each part in its place; along seams the parts are not cut
  std::vector<double> seams_x;  ///< where they are to be split again, mm from the left edge
};

/// Puts parts in their places (`Pattern::place`) and takes the outline away along their seams, so
/// that a layout splits them there, with tabs.
[[nodiscard]] JoinedParts join_parts(const std::vector<const Pattern*>& parts);

}  // namespace popcut
