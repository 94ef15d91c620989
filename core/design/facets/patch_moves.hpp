// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/design/facets/label_holding.hpp"
#include "core/design/facets/labelling.hpp"

namespace popcut {

/// Moves the planes of patches, and their folds with them, nearer to the target, and solves each
/// strip again beside the others in the planes that there are, as a whole or in stretches. Planes
/// x = c and z = d meet at c - d, so that a patch and those that it meets change their sizes
/// together; cuts stay where they are. A move is made if the labels cost less and everything still
/// holds. Where hinges cost something, patches also move into the planes of those beside them, and
/// go if their hinges cost more than they bring. O(moves x runs).
///
/// @param labelling  with labels of which all patches are held (`holding_of`); its planes are those
///                   that patches may move to
/// @param min_fold_mm  patches with shorter folds become wider or go, where all still holds
/// @param most_work  runs that are looked at, after which it stops
///
/// @return how many moves were made
std::size_t move_patches(Labelling& labelling, const HoldRule& rule, double min_fold_mm,
                         std::size_t most_work);

}  // namespace popcut
