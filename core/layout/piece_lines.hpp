// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/layout/line_index.hpp"
#include "core/layout/sheet.hpp"

namespace popcut {

/// What a plan (plan.json) says about one piece of a split drawing.
struct PlannedPiece {
  struct Seam {
    std::array<PagePoint, 2> ends{};                ///< sheet mm
    std::vector<std::array<PagePoint, 2>> glued{};  ///< stretches of paper to glue, sheet mm
  };
  Placement to_sheet{};                          ///< drawing -> sheet
  std::vector<PagePoint> share;                  ///< polygon, drawing mm
  std::vector<Seam> seams;                       ///< straight runs, along an axis
  std::vector<std::array<PagePoint, 4>> tabs{};  ///< the piece's own tabs, root first; sheet mm
};

/// What to cut and fold of a piece, in sheet mm: the drawing's lines within the piece, its border
/// along seams (each part once), and the way around its tabs. Uses only what the plan says and none
/// of the code that splits drawings, so a test can compare the two.
///
/// `lines` indexes `drawing`. O(n s) for n segments of the drawing and s sides of the piece.
[[nodiscard]] LineWork lines_of_piece(const LineWork& drawing, const LineIndex& lines,
                                      const PlannedPiece& piece);

}  // namespace popcut
