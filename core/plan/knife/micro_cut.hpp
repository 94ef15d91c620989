// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"
#include "core/warning.hpp"

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

/// A stretch of a fold that has no room for a dash, in mm along its line.
struct LeftOut {
  std::uint32_t line{};  ///< of the drawing
  Dash on;
  PagePoint where;  ///< its middle
};

/// The drawing with dashes in place of folds.
struct Dashed {
  LineWork work;                    ///< strokes; each fold is a row of short lines
  std::vector<std::uint32_t> line;  ///< for each line of `work`, its line of the drawing
  double fold_line_mm{};            ///< length of all folds before dashing
  std::size_t shortened{};          ///< dashes shorter than the material's, with less clearance
  std::vector<LeftOut> left_out;    ///< in the order of the lines
  std::size_t first_scored{std::numeric_limits<std::size_t>::max()};  ///< see `score_left_out`
};

/// Dashes and clearances shrink down to this share of the material's before a fold is left out.
inline constexpr double kLeastShare = 0.5;

/// The shortest fold that keeps a dash of `min_dash_mm` between full clearances, mm.
[[nodiscard]] double shortest_good_fold_mm(const DashShape& shape);

/// Turns folds into rows of short cuts. A fold keeps at least `clearance_mm` of paper at its ends,
/// at its corners, and on both sides of each place where a cut meets it, crosses it or ends near it
/// (more along the fold if they meet at an angle).
///
/// Where that leaves no room for a dash, clearance and shortest dash shrink together, in steps of a
/// tenth down to `kLeastShare`, until one dash fits in the middle. Stretches without a dash even
/// then, longer than a gap and than both clearances, are listed in `left_out`: nothing is dropped
/// silently.
[[nodiscard]] Dashed micro_cut(const LineWork& work, const DashShape& shape);

/// Appends each stretch in `dashed.left_out` as one line to score, half a clearance away from
/// dashes; `first_scored` is the first of them in `dashed.work`. `drawing` is what was dashed.
void score_left_out(const LineWork& drawing, const DashShape& shape, Dashed& dashed);

/// How many stretches have no dash, how long they are and where the longest lies; none where all
/// folds are dashed. `done` says what becomes of them: "stay uncut", "are scored".
[[nodiscard]] std::optional<Warning> left_out_warning(const Dashed& dashed, const DashShape& shape,
                                                      std::string_view done);

}  // namespace popcut
