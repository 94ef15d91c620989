// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/result.hpp"

namespace popcut::judge {

/// A flat piece of paper that stands upright, and is put in its place from straight above. A place
/// on it is how far along from its origin, and how high.
struct UprightPiece {
  Vec3 origin, along;                    ///< `along` has length 1, and is square to up
  std::vector<std::vector<Vec2>> faces;  ///< polygons that make up its paper
};

/// The lowest and the highest paper on an upright line; none where `low` is above `high`.
struct PaperReach {
  double low{}, high{};
};
[[nodiscard]] PaperReach reach_at(const UprightPiece& piece, double at_mm);

/// Steps in which pieces come down: each slides straight down past all pieces of earlier steps, and
/// none of a step is in the way of another. Two pieces meet on the line in which their planes
/// cross, or all over if they lie in one plane; there the paper of the earlier one must end below
/// that of the later. Each piece has the earliest step that these pairs leave it. O(pieces^2
/// corners).
///
/// @param up  of length 1
/// @return steps, each with indices in ascending order
/// @retval Infeasible  the detail has the indices of two pieces of which neither can come after the
///                     other, or of those that wait for each other in a circle: `stuck` gets them
[[nodiscard]] Result<std::vector<std::vector<std::size_t>>> slide_order(
    const std::vector<UprightPiece>& pieces, const Vec3& up, std::vector<std::size_t>& stuck);

}  // namespace popcut::judge
