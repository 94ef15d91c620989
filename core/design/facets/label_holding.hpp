// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/facets/label_pattern.hpp"

namespace popcut {

/// What holds a patch.
struct HoldRule {
  double min_panel_mm{};  ///< shorter joints and folds are none
  /// Two folds of a patch count as one place if they are nearer to each other than `apart_mm`, or
  /// than `apart_share` of the patch's length across the spine (docs/hands.md, section 1). 0: only
  /// if they are at the same place.
  double apart_mm{}, apart_share{};
  double min_fold_mm{};  ///< shorter folds between two patches, all together, hold nothing
};
/// What holds in paper: folds 5 mm and a third of the patch apart.
/// @param strength  factor of both; more than 1 for a card that does not hold yet
[[nodiscard]] constexpr HoldRule paper_rule(double min_panel_mm, double strength = 1.0) {
  return {min_panel_mm, 5.0 * strength, strength / 3.0};
}

/// Which patches of a labelling follow the card's one motion, found without building the pattern,
/// by `rigid::Propagation` from the card's wall and ground. Where all are held, the pattern has
/// exactly one freedom and is one piece. O(runs).
struct LabelHolding {
  LabelPatches patches;             ///< with a strip of card before the first and after the last
  std::vector<std::uint8_t> loose;  ///< one a patch
  std::size_t open{};               ///< unknowns that are not held, 0: all patches are
  int pins{};  ///< that would hold all: about the freedoms of what is open, no fewer
};
[[nodiscard]] LabelHolding holding_of(const StripRuns& runs, const FacetPlanes& planes,
                                      const FacetGrid& grid, const HoldRule& rule);
[[nodiscard]] LabelHolding holding_of(const LabelImage& image, const FacetPlanes& planes,
                                      const HoldRule& rule);

}  // namespace popcut
