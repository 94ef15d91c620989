// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/design/boxes/block_row.hpp"
#include "core/parts/elements.hpp"
#include "core/result.hpp"

namespace popcut {

constexpr double kBoxTab_mm = 7.0;  ///< width of the tabs of boxes

/// The box that stands for a block, without the bends of its ends (`make_firm`).
[[nodiscard]] BoxElement box_of(const Block& block);
/// The tent that stands for a block that is a roof alone.
[[nodiscard]] TentElement tent_of(const Block& block);

/// Bends the ends of a box, and lets an inner wall hold them, so that their middles move by at most
/// 1 mm in paper. Ends that fold the same way can be held so.
///
/// @param is_free  whether it touches no other box: its bent ends then lie half in front of the
///                 shape's ends, and half behind
void make_firm(BoxElement& box, std::array<bool, 2> ends_out, bool is_free);

/// Whether a block opens and shuts, beside a block before its beginning and one behind its end or
/// not. A pyramid that stands with all of its slopes stands without one, too.
[[nodiscard]] bool can_stand(Block block, bool touches_before, bool touches_after,
                             double thickness_mm);

/// The boxes of a row, with ends that fold where there is room as the card shuts: an end that folds
/// outward must not pass through the box beside it, and neither must the slope at a pyramid's end,
/// which is left out where it would. Of all ways, one is taken in which as few boxes as possible
/// have no inner wall.
///
/// @param row  blocks that touch stand apart by the thickness of paper
/// @return one a block; those of tents say nothing
/// @retval Infeasible  two blocks are so near to each other that no way is left; says how far they
///                     must be apart
[[nodiscard]] Result<std::vector<BoxElement>> firm_boxes(const BlockRow& row);

}  // namespace popcut
