// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/design/facets/labels.hpp"
#include "core/design/facets/seen_target.hpp"

namespace popcut {

/// Cuts windows where a patch hides what should be seen farther back through it, such as the inside
/// of a letter: cells whose part of the target is more than `deeper_mm` behind the patch, with
/// `min_panel_mm` and a strip of the patch left all around. Such cells get no label. What is seen
/// must jump back along most of a window's border: a belly that curves away behind its patch stays
/// paper.
///
/// @param min_side_mm  of a square: smaller windows are not cut
/// @return how many windows there are
std::size_t cut_windows(LabelImage& image, const FacetPlanes& planes, const SeenTarget& target,
                        double deeper_mm, double min_panel_mm, double min_side_mm);

}  // namespace popcut
