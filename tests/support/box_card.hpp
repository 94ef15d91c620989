// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut::testing {

/// The smallest card worth a test, by hand: a wall of 40 mm, a ground of 30 mm, 70 mm wide, and one
/// box cut out of it over v = 20..45, 24.5 mm high and 13.3 mm deep. Four faces (wall, ground, the
/// box's top and front), slits at v = 20 and v = 45 over u = 15.5..53.3; not symmetric in any way,
/// so that a mirrored drawing shows.
[[nodiscard]] Pattern box_card_pattern();
[[nodiscard]] Strips box_card_strips();

/// As many such faces as asked for, side by side along v: `columns` boxes on one card.
[[nodiscard]] Pattern row_of_boxes(int columns);

}  // namespace popcut::testing
