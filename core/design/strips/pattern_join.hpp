// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/design/strips/strips.hpp"

namespace popcut {

/// Strips of several patches in one sheet.
struct JoinedStrips {
  Strips strips;
  std::vector<std::size_t> border;        ///< last strip of each patch but the last one
  std::vector<std::int32_t> first_slice;  ///< of each patch, in the numbering of the whole
};

/// Lays the strips of patches, each in a card of its own, side by side in one card of height
/// `wall_mm` and depth `ground_mm`. The margins between them are left out, so that the patches'
/// outer slices stand beside each other with a plain cut between: joined in wall and ground, which
/// are the same planes, and cut along the rest. Planes and slices are numbered again. O(panels).
///
/// A plain cut takes no freedom and gives none, so that patches with one freedom each have one
/// together.
[[nodiscard]] JoinedStrips join_strips(std::span<const Strips* const> patches, double wall_mm,
                                       double ground_mm);

/// The same strips with only the connectors of the slices `first .. end - 1` left as connectors:
/// the others count as bridges, so that V-folds are put on one patch of a whole.
[[nodiscard]] Strips only_connectors_of(Strips strips, std::int32_t first, std::int32_t end);

}  // namespace popcut
