// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// An interval along a fold, in mm.
struct Dash {
  double from{}, to{};
};

/// Appends the dashes of a free stretch of length F = `free_mm` between two clearances, symmetric
/// about its middle, with `offset_mm` added.
///
/// With dash d and gap g, n = ceil((F + g) / (d + g)) is the least number of dashes for which no
/// gap needs to exceed g. They would be n d + (n-1) g - F too long, so dashes and gaps shrink by s
/// = F / (n d + (n-1) g). No gap shrinks below 3/4 g, so that the paper between two dashes always
/// holds:
///
///     gap = g max(s, 3/4),    dash = (F - (n-1) gap) / n  <=  d.
///
/// If that dash is shorter than `min_dash_mm`, there is one dash less. Each is then as long as d,
/// or longer if the paper at the two ends would otherwise exceed g.
///
/// @return the number of dashes: 0 if F < `min_dash_mm`
std::size_t append_dashes(double free_mm, double offset_mm, const DashShape& shape,
                          std::vector<Dash>& dashes);

/// The drawing with dashes in place of folds.
struct Dashed {
  LineWork work;                    ///< strokes; each fold is a row of short lines
  std::vector<std::uint32_t> line;  ///< for each line of `work`, its line of the drawing
  double fold_line_mm{};            ///< length of all folds before dashing
};

/// Turns folds into rows of short cuts. A fold keeps at least `clearance_mm` of paper at its ends,
/// at its corners, and on both sides of each place where a cut meets it, crosses it or ends near it
/// (more along the fold if they meet at an angle). Folds that are too short stay uncut; a warning
/// counts them.
[[nodiscard]] Dashed micro_cut(const LineWork& work, const DashShape& shape);

}  // namespace popcut
