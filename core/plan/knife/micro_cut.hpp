// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// An interval along a fold, mm.
struct Dash {
  double from{}, to{};
};

/// The dashes of a free stretch of length `free_mm` between two clearances, symmetric about its
/// middle, appended with `offset_mm` added.
///
/// With dash d, gap g: n = ceil((F + g) / (d + g)) is the least number of dashes whose gaps need
/// not exceed g. They would be D = n d + (n-1) g - F too long, so both shrink by s = F / (n d +
/// (n-1) g), but no gap below 3/4 g, so that the paper between two dashes always holds:
///
///     gap = g max(s, 3/4),    dash = (F - (n-1) gap) / n  <=  d.
///
/// Where that dash is shorter than `min_dash_mm`, one dash less is cut, as long as d or as long as
/// it takes for the paper at the two ends to stay within g. Returns the number of dashes: none
/// where F < `min_dash_mm`.
std::size_t append_dashes(double free_mm, double offset_mm, const DashShape& shape,
                          std::vector<Dash>& dashes);

/// The drawing with each fold replaced by its dashes.
struct Dashed {
  LineWork work;                    ///< strokes; folds are now short lines
  std::vector<std::uint32_t> line;  ///< for each line of `work` the line of the drawing
  double fold_line_mm{};            ///< length of all folds before dashing
};

/// Folds become rows of short cuts. A fold keeps at least `clearance_mm` of paper at its ends, at
/// its corners, and on both sides of each place where a cut meets it, crosses it or ends near it
/// (farther along the fold where they meet at a slant). Too short folds are left uncut and told in
/// the warnings.
[[nodiscard]] Dashed micro_cut(const LineWork& work, const DashShape& shape);

}  // namespace popcut
