// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Where a piece was nested: turned by quarters (x toward y), the upper left corner of its turned
/// box at (x, y), in mm of the sheet.
struct NestedPiece {
  std::uint32_t sheet{};
  std::uint32_t quarters{};
  double x{}, y{};
};

/// Pieces on sheets.
struct Nest {
  std::vector<NestedPiece> places;  ///< one a piece
  std::uint32_t sheets{};
};

/// The area within the outlines of a piece, holes counted in, by columns of 1 mm; of its box where
/// the outlines do not close.
[[nodiscard]] double paper_mm2(const LineWork& piece);

/// Nests pieces by their shapes on few sheets (a heuristic). A piece is what its outlines enclose
/// and all its lines, in upright columns of 1 mm (wider on sheets above 1.2 m): in each the
/// stretches of y that it has there. So pieces go into each other's bays, but not into holes.
///
/// Large pieces come first. Each goes to the first sheet with room, in that of its four quarter
/// turns and at that column where its far end is nearest to the sheet's upper edge: at each column
/// it is moved down until it meets nothing. This is done in two orders, by side and by area; the
/// nest with fewer sheets is taken, of equal ones that with the shorter last sheet.
///
/// Two pieces are never nearer to each other than `spacing`: columns hold all of a piece, and the
/// distance between two columns counts without their widths.
///
/// O(pieces sheets columns^2 stretches) at most; a place that ends beyond the best one is left
/// early.
///
/// @param pieces   in mm; each fits the area in at least one quarter turn
/// @param area     width and height of a sheet, mm
/// @param spacing  mm
[[nodiscard]] Nest nest(const std::vector<const LineWork*>& pieces,
                        const std::array<double, 2>& area, double spacing);

}  // namespace popcut
