// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/facets/label_pattern.hpp"
#include "core/design/facets/seen_target.hpp"

namespace popcut {

/// Lets cuts follow the contours of the target. Where a cut between two planes
/// goes in steps, along a strip and then across it, from strip to strip, its
/// two corners on the line between the strips become one, at the place where
/// the target goes over from the one plane to the other. Both sides of the cut
/// move alike. Nothing gets narrower than it was on either side of that line,
/// and folds stay where they are. O(runs + vertices log vertices).
///
/// @return how many corners were taken away
std::size_t follow_contours(LabelPattern& pattern, const LabelImage& labels,
                            const FacetPlanes& planes, const SeenTarget& target,
                            double min_panel_mm);

/// Makes cuts smooth that go in small steps, both sides alike: their corners move by at most 0.6 mm
/// towards their neighbours, and those that then lie in line within 0.2 mm are left out. Folds,
/// ends of cuts and places where cuts meet stay. Nothing changes where lines would cross then.
/// O(vertices log vertices).
///
/// @return how many corners were moved
std::size_t smooth_contours(Pattern& pattern);

}  // namespace popcut
