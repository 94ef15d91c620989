// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/drawing/nesting.hpp"
#include "core/plan/order/order.hpp"

namespace popcut {

/// A drawing whose cuts end at their sharp corners.
struct LinePieces {
  struct Origin {
    std::uint32_t line{};   ///< of the drawing
    std::uint32_t first{};  ///< its vertex at which the piece begins
    bool whole{true};
  };
  LineWork work;
  std::vector<Origin> origin;              ///< by line of `work`
  std::vector<std::uint32_t> first_piece;  ///< by line of the drawing, and one more

  /// A visit of a piece as one of the drawing.
  [[nodiscard]] Visit visit_of(const Visit& visit) const;
};

/// Splits cuts and outlines where they turn by more than `corner_deg`, a closed one into two pieces
/// at least. Closed ones without such a corner, folds and drawn lines stay whole, and so do closed
/// ones with over 64 corners that hold others, since each piece has to wait for each of these.
[[nodiscard]] LinePieces split_at_corners(const LineWork& work, const Nesting& nesting,
                                          double corner_deg);

/// What is around a line is around its pieces, with all of its own.
[[nodiscard]] Nesting nesting_of_pieces(const LinePieces& pieces, const Nesting& nesting);

}  // namespace popcut
