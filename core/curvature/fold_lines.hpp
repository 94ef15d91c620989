// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/curvature/fold_vertices.hpp"
#include "core/formats/fold/fold_reader.hpp"

namespace popcut {

/// A fold across strips, at one u, whole: edges that go on into each other are one line, and so are
/// the parts of a valley crease on both sides of a V-fold.
struct FoldLine {
  double u{};
  double v0{}, v1{};  ///< v0 < v1
  bool mountain{};
  bool border{};  ///< no fold: a border of the sheet, where a strip without a card ends
  std::optional<CreaseVFold> v_fold;
};

/// The folds and borders of a flat frame that run along v, in mm. Folds within `tolerance_mm` of
/// constant u are taken for such; slanting ones count only as the sides of V-folds.
[[nodiscard]] std::vector<FoldLine> fold_lines(const FoldFrame& frame, double mm_a_unit,
                                               double tolerance_mm);

}  // namespace popcut
