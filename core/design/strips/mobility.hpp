// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/strips/pattern_builder.hpp"

namespace popcut {

/// How a pattern of wall- and ground-parallel faces can move.
struct Mobility {
  int degrees_of_freedom{};
  int pieces{};
  std::vector<std::uint8_t> loose;  ///< one a face: 1 where it moves in more than the one way
};

/// Counts the freedoms exactly, in O(faces) where there is one.
///
/// All hinges are parallel to the spine, so every small motion is planar. In the section an upright
/// face at x = X moves with velocities (a - w z, B) and a level one at z = Z with (C, e + w x).
/// Hinges equate them, and the two coordinates part: on each upright face the C of its hinges are
/// affine in z, on each level face the B are affine in x. Both systems are solved by propagation:
/// two known hinges of a face give all its others. What propagation does not reach, loose ends
/// mostly, falls into components, and the rank of each one's interpolation equations is found by a
/// QR factorisation. Freedoms = unknowns of both systems less the three motions of the whole.
[[nodiscard]] Mobility mobility(const BuiltPattern& built);

}  // namespace popcut
