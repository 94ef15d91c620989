// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/layers/layer_masks.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

/// The borders of one half of a layer, which is one piece, mm: as far from the middle (positive on
/// both halves) and as high as its paper. A half with holes is parted by upright lines through them
/// into several faces without holes, which touch along these lines. Each border is a simple
/// polygon; places on the middle, on the page and on those lines stay exactly there. Stairs of
/// cells become lines that are off by less than a cell.
[[nodiscard]] std::vector<std::vector<Vec2>> half_outlines(const LayerGrid& grid,
                                                           const LayerMask& mask, bool is_right);

/// How far paper goes along the page from the middle without a gap, mm.
[[nodiscard]] double foot_mm(const LayerGrid& grid, const LayerMask& mask, bool is_right);

}  // namespace popcut
