// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/slices/slice_lattice.hpp"

namespace popcut {

/// Paper beside a slot that may tear when the pieces are put together.
struct ThinWall {
  std::size_t piece{}, other{};  ///< the piece with the slot, and the one that it is for
  double thick_mm{};             ///< the mean where it is too thin
  double length_mm{};            ///< along the slot, over which it is too thin
  bool is_between_slots{};       ///< the next slot bounds it, not the outline of the solid
};

/// Walls thinner than `least_mm` over more than `length_mm` of a slot, one a piece: the thinnest.
/// Where a slot is open at its side there is no wall.
/// O(crossings log n) for n corners.
[[nodiscard]] std::vector<ThinWall> thin_walls(const std::vector<Slice>& slices,
                                               const SliceLattice& lattice, double slot_mm,
                                               double least_mm, double length_mm);

}  // namespace popcut
