// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// How far from the spine the structure reaches when the card is shut, mm: at psi = 0 the point
/// (x, z) lies x + z from it (docs/geometry.md, section 2). The card itself does not count.
/// O(panels).
[[nodiscard]] double shut_reach_mm(const Strips& strips);
/// The same of a pattern, with the tips of its V-folds. O(vertices).
[[nodiscard]] double shut_reach_mm(const Pattern& pattern);

/// Gives strips that stand in a card another wall and another ground, mm. Both must reach past the
/// structure. O(strips).
void set_card(Strips& strips, double wall_mm, double ground_mm);

}  // namespace popcut
