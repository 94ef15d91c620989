// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/layers/layer_masks.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

/// The border of one half of a layer, which is one piece without holes: a simple polygon, as far
/// from the middle (positive on both halves) and as high as its paper, mm. Places on the middle and
/// on the page stay exactly there; stairs of cells become lines that are off by less than a cell.
[[nodiscard]] std::vector<Vec2> half_outline(const LayerGrid& grid, const LayerMask& mask,
                                             bool is_right);

}  // namespace popcut
