// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/design/boxes/block_fit.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// The blocks of a target in a row along the spine, which is their common middle.
struct BlockRow {
  double turn_rad{};          ///< of the target about the vertical, after which they lie along y
  double middle_mm{};         ///< x of the spine, of the turned target
  std::vector<Block> blocks;  ///< by y; they do not overlap
  std::vector<bool> touches;  ///< whether each touches the next
  std::size_t aside{};        ///< blocks that are left out, because they stand beside the spine
  double misfit{};            ///< volume that differs, seen from above, over the target's
  double aside_share{};       ///< volume that is left out beside the spine, over the target's

  [[nodiscard]] bool empty() const { return blocks.empty(); }
};

/// The direction of most upright faces, from -45 to 45 degrees: walls at right angles to each other
/// have one.
[[nodiscard]] double wall_direction_rad(const TriangleSoup& target);

/// Turns a target about the vertical.
void turn_about_z(TriangleSoup& target, double turn_rad);

/// Whether a block opens and shuts, beside a block before its beginning and one behind its end or
/// not.
using CanStand = std::function<bool(const Block&, bool touches_before, bool touches_after)>;

/// The rows of blocks that a target is most like, with the spine along its walls or across them.
struct BlockRows {
  BlockRow nearest;
  /// The nearest of those whose blocks all can stand; the same where those of `nearest` do.
  BlockRow standing;
};

/// Finds the rows of a target. Their stretches are found by dynamic programming over the places
/// where its heights change most: each more block must make up for `kBlockCost` of the target's
/// volume.
///
/// @param target  its foot at z = 0
[[nodiscard]] BlockRows block_rows(const TriangleSoup& target, const BlockSizes& sizes,
                                   const CanStand& can_stand);

}  // namespace popcut
