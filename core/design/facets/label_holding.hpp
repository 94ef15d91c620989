// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/facets/label_pattern.hpp"

namespace popcut {

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
                                      const FacetGrid& grid, double min_panel_mm);
[[nodiscard]] LabelHolding holding_of(const LabelImage& image, const FacetPlanes& planes,
                                      double min_panel_mm);

}  // namespace popcut
