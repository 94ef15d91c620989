// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid/section.hpp"

namespace popcut::rigid {

/// How a section can move.
struct Mobility {
  int degrees_of_freedom{};
  int pieces{};
  std::vector<std::uint8_t> loose;  ///< one a panel: 1 where it moves in more than the one way
};

/// Counts the freedoms exactly, in O(panels) where there is one.
///
/// All folds are parallel to the spine, so every small motion is planar. An upright panel at x = X
/// moves with velocities (a - w z, B) and a level one at z = Z with (C, e + w x). Folds equate
/// them, and the two coordinates part: on each upright panel the C of its folds are affine in z, on
/// each level panel the B are affine in x. Both systems are solved by propagation: two known folds
/// of a panel give all its others. What propagation does not reach, loose ends mostly, falls into
/// components, and the rank of each one's interpolation equations is found by a QR factorisation.
/// Freedoms = unknowns of both systems less the three motions of the whole.
[[nodiscard]] Mobility mobility(const Section& section);

}  // namespace popcut::rigid
