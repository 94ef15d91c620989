// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/layout/line_index.hpp"
#include "core/layout/sheet.hpp"

namespace popcut {

/// What a plan says of one piece of a split drawing.
struct PlannedPiece {
  struct Seam {
    std::array<PagePoint, 2> ends{};                ///< sheet mm
    std::vector<std::array<PagePoint, 2>> glued{};  ///< stretches that are not cut yet, sheet mm
  };
  Placement to_sheet{};                          ///< drawing -> sheet
  std::vector<PagePoint> share;                  ///< polygon, drawing mm
  std::vector<Seam> seams;                       ///< straight runs, along an axis
  std::vector<std::array<PagePoint, 4>> tabs{};  ///< that are part of it, root first; sheet mm
};

/// What is to be cut and folded of a piece, in sheet mm: the drawing's lines within its share, its
/// border along seams, once, and the way round its tabs. Made from what the plan says, not by
/// the code that splits, so that the two can be compared.
///
/// `lines` is of `drawing`. O(n s) for n segments in the drawing and s sides of the share.
[[nodiscard]] LineWork lines_of_piece(const LineWork& drawing, const LineIndex& lines,
                                      const PlannedPiece& piece);

}  // namespace popcut
