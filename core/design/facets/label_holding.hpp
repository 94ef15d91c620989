// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/facets/label_pattern.hpp"

namespace popcut {

/// Which patches of a labelling follow the card's one motion, found without building the pattern:
/// the propagation of `mobility`, over whole numbers. Where all are held, the pattern has exactly
/// one freedom and is one piece. O(runs).
///
/// In the section an upright patch at x moves by (a - w z, B) and a level one at z by (C, e + w x);
/// folds equate them. So on upright patches the C of their folds are affine in z, and on level ones
/// the B in x. A patch whose folds at two places are held is held, and so are all that it meets.
struct LabelHolding {
  LabelPatches patches;             ///< with a strip of card before the first and after the last
  std::vector<std::uint8_t> loose;  ///< one a patch
  std::size_t open{};               ///< unknowns that are not held, 0: all patches are
  int pins{};  ///< that would hold all: about the freedoms of what is open, no fewer
};
[[nodiscard]] LabelHolding holding_of(const StripRuns& runs, const FacetPlanes& planes,
                                      const FacetGrid& grid, double min_panel_mm);
[[nodiscard]] LabelHolding holding_of(const LabelImage& image, const FacetPlanes& planes,
                                      double min_panel_mm);

}  // namespace popcut
