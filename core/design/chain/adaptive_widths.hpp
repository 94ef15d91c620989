// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/design/target/surface.hpp"
#include "core/result.hpp"

namespace popcut {

/// Widths chosen from the target's curvature along the spine, and what that saved.
struct ChosenWidths {
  std::vector<double> widths_mm;
  int uniform_slices{};  ///< equal slices that the same error and length would take
};

/// Chooses widths so that the target between neighbouring slices bulges at most
/// `adaptive.max_error_mm` from the straight line between their curves (its sagitta, |r''| w^2 / 8
/// for a radius r). Each width is the largest that keeps to it, at most twice or half its
/// neighbour.
///
/// @param most_slices  how many slices there are, or may be where a length is asked for
/// @retval Infeasible  the length takes more slices than that, or slices thinner than 4 min_panel
[[nodiscard]] Result<ChosenWidths> choose_widths(const Surface& surface,
                                                 const AdaptiveWidths& adaptive, int most_slices,
                                                 double min_panel_mm);

}  // namespace popcut
