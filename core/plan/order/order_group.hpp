// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/nesting.hpp"
#include "core/plan/order/order.hpp"

namespace popcut {

/// Lines that may come in any order, except that inner lines come before outer ones.
struct OrderGroup {
  std::vector<std::uint32_t> lines;
  std::optional<PagePoint> start, end;
  std::uint64_t moves{0};
  std::vector<Visit> known{};  ///< an order to improve; empty: none yet
};

/// Finds a cheap order of one group; see `order`. Costs cover the group from its start to its end.
///
/// @param scratch  a zero for each line of `work`; is all zeros again afterwards
[[nodiscard]] Ordered order_group(const LineWork& work, const Nesting& nesting,
                                  const OrderGroup& group, const OrderOptions& options,
                                  const KeepGoing& keep_going, std::vector<std::uint32_t>& scratch);

/// A drawing whose cuts are split at their sharp corners.
struct LinePieces {
  struct Origin {
    std::uint32_t line{};   ///< index of the line in the drawing
    std::uint32_t first{};  ///< the vertex of that line where the part begins
    bool whole{true};
  };
  LineWork work;
  std::vector<Origin> origin;              ///< per line of `work`
  std::vector<std::uint32_t> first_piece;  ///< per line of the drawing, and one more

  /// The visit of a part as a visit of the drawing's line.
  [[nodiscard]] Visit visit_of(const Visit& visit) const;
};

/// Splits cuts and outlines where they turn by more than `corner_deg`, closed ones into at least
/// two parts. These stay whole: closed lines without such a corner, folds, drawn lines, and closed
/// lines with more than 64 corners that hold others (each part would have to wait for all of
/// these).
[[nodiscard]] LinePieces split_at_corners(const LineWork& work, const Nesting& nesting,
                                          double corner_deg);

/// The nesting of the parts: each part is inside the lines that its line is inside of.
[[nodiscard]] Nesting nesting_of_pieces(const LinePieces& pieces, const Nesting& nesting);

}  // namespace popcut
