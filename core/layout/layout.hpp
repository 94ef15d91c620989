// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/layout/tabs.hpp"
#include "core/drawing/linework.hpp"
#include "core/layout/sheet.hpp"
#include "core/result.hpp"

namespace popcut {

/// What a layout has to keep to; lengths in mm.
struct LayoutOptions {
  std::array<double, 2> area_mm{};  ///< what can be reached on one sheet, along carriage and feed
  PagePoint origin{};               ///< of the sheet, where the first piece goes
  TabShape tabs{};
  double min_panel_mm{0.5};       ///< no seam leaves a narrower stretch of paper
  double spacing_mm{5.0};         ///< between pieces on one sheet
  std::vector<double> seams_x{};  ///< seams that were asked for, from the drawing's left edge
  std::vector<double> seams_y{};
  bool labels{true};  ///< ticks and letters on both sides of each seam
};

/// What lies on one seam between two pieces: a straight run of it in drawing mm.
struct SeamRun {
  bool vertical{};                     ///< along y at x = `at`; else along x at y = `at`
  double at{}, from{}, to{};           ///< `from` < `to`
  std::uint32_t lower{}, upper{};      ///< the pieces before (left of, above) and after it
  std::uint32_t seam{};                ///< all runs between the same two pieces are one seam
  std::vector<SeamStretch> uncut{};    ///< what is glued: every stretch of paper that is not cut
  std::vector<SeamStretch> covered{};  ///< where the drawing is cut anyway
};

/// A seam: where two pieces meet. Its letters stand on both sides.
struct PieceSeam {
  std::uint32_t lower{}, upper{};
  double glue_mm{};  ///< uncut length
  std::string label;
};

/// One piece of the drawing with its tabs, and where it goes.
struct SheetPiece {
  LineWork work;                 ///< drawing mm: lines of the drawing, its border with tabs, marks
  Box box;                       ///< of `work`
  std::vector<PagePoint> share;  ///< what of the drawing's box is this piece's, without tabs
  std::uint32_t column{};        ///< pieces of one column are glued to each other first
  std::uint32_t sheet{};         ///< from 0
  Placement transform{};         ///< drawing -> sheet
  std::uint32_t first_mark{};    ///< lines of `work` from here on are ticks and letters
};

struct LayoutSheet {
  std::array<double, 2> used_mm{};  ///< from the area's corner
  std::vector<std::uint32_t> pieces;
};

struct Layout {
  std::vector<SheetPiece> pieces;
  std::vector<SeamRun> runs;
  std::vector<PieceSeam> seams;
  std::vector<Tab> tabs;
  std::vector<LayoutSheet> sheets;
  std::vector<std::vector<std::uint32_t>> steps;  ///< seams in the order of glueing, at once each
  double glue_mm{};                               ///< length of all stretches that are glued
  std::uint32_t
      least_sheets{};  ///< no layout can take fewer: area of the drawing's box over a sheet's
  std::vector<std::string> warnings;
};

/// Splits a drawing that is larger than the area into pieces with glue tabs and puts the pieces on
/// as few sheets as they need (design reference, section 8).
///
/// Seams are straight lines from edge to edge in one direction, between them straight or stepped
/// ones in the other; both directions and both ways to lay the pieces are tried. Where they go is
/// found by dynamic programming over all lawful lines: what is glued, folds and cuts that are
/// crossed, and pieces cost, cuts that are followed do not. A line is lawful if every uncut stretch
/// of it has room for a tab on a single panel, and if it runs along no fold.
///
/// `drawing` is cleaned (no line twice). O(n log n) in its segments for drawings whose lines do not
/// pile up.
///
/// @retval Infeasible  no lawful seams for this area; a seam that was asked for is not lawful (the
///                     detail names the nearest that is)
/// @retval OutOfRange  an area or a tab with impossible values; a seam beyond the drawing
[[nodiscard]] Result<Layout> lay_out(const LineWork& drawing, const LayoutOptions& options);

/// All pieces of one sheet as one drawing in sheet mm; `piece_of` names the piece of each line.
[[nodiscard]] LineWork sheet_work(const Layout& layout, std::uint32_t sheet,
                                  std::vector<std::uint32_t>& piece_of);

}  // namespace popcut
