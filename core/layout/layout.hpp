// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/layout/sheet.hpp"
#include "core/layout/tabs.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

struct Pattern;

/// What a layout must respect. Lengths are mm.
struct LayoutOptions {
  std::array<double, 2> area_mm{};  ///< the reachable area of one sheet, along carriage and feed
  PagePoint origin{};               ///< where the first piece goes on its sheet
  TabShape tabs{};
  double min_panel_mm{0.5};       ///< seams leave no narrower stretch of paper
  double spacing_mm{5.0};         ///< between pieces on one sheet
  std::vector<double> seams_x{};  ///< requested seams, from the drawing's left (or top) edge
  std::vector<double> seams_y{};
  bool labels{true};            ///< ticks and letters on both sides of each seam
  std::size_t letters_taken{};  ///< by tabs of the drawing: the first seam has the next letter
};

/// A straight part of a seam between two pieces, in drawing mm.
struct SeamRun {
  bool vertical{};                     ///< true: along y at x = `at`; false: along x at y = `at`
  double at{}, from{}, to{};           ///< `from` < `to`
  std::uint32_t lower{}, upper{};      ///< the pieces before (left of, above) and after it
  std::uint32_t seam{};                ///< all runs between the same two pieces are one seam
  std::vector<SeamStretch> uncut{};    ///< the stretches to glue: paper that no cut follows
  std::vector<SeamStretch> covered{};  ///< the stretches that the drawing cuts anyway
};

/// A seam: where two pieces meet. Its letter is marked on both sides.
struct PieceSeam {
  std::uint32_t lower{}, upper{};
  double glue_mm{};  ///< uncut length
  std::string label;
};

/// One piece of the drawing with its tabs, and its place on a sheet.
struct SheetPiece {
  LineWork work;                 ///< drawing mm: the drawing's lines, the border with tabs, marks
  Box box;                       ///< of `work`
  std::vector<PagePoint> share;  ///< this piece's part of the drawing's box, without tabs
  std::uint32_t column{};        ///< glue the pieces of one column to each other first
  std::uint32_t sheet{};         ///< from 0
  Placement transform{};         ///< drawing -> sheet
  std::uint32_t first_mark{};    ///< from this line on, `work` holds ticks and letters
};

/// One sheet: its pieces, and how much of it they use.
struct LayoutSheet {
  std::array<double, 2> used_mm{};  ///< width and length used, from the area's corner
  std::vector<std::uint32_t> pieces;
};

/// How well pieces fill their sheets. The last sheet counts as far as its pieces reach along it.
struct SheetUse {
  double paper_mm2{};  ///< of the pieces, holes counted in
  double used_mm2{};   ///< of the sheets
  /// The same where the boxes of all pieces are packed in rows: what is used wherever nesting by
  /// shapes saves nothing.
  double rows_used_mm2{};
  std::uint32_t rows_sheets{};

  [[nodiscard]] double share() const { return used_mm2 > 0.0 ? paper_mm2 / used_mm2 : 0.0; }
  [[nodiscard]] double rows_share() const {
    return rows_used_mm2 > 0.0 ? paper_mm2 / rows_used_mm2 : 0.0;
  }
};

/// A drawing split into pieces, with its seams and sheets.
struct Layout {
  std::vector<SheetPiece> pieces;
  std::vector<SeamRun> runs;
  std::vector<PieceSeam> seams;
  std::vector<Tab> tabs;
  std::vector<LayoutSheet> sheets;
  SheetUse use;
  /// Glueing order; each step has seams glued together.
  std::vector<std::vector<std::uint32_t>> steps;
  double glue_mm{};              ///< total length to glue
  std::uint32_t least_sheets{};  ///< lower bound of the number of sheets: paper over sheet area
  std::vector<Warning> warnings;
};

/// Splits a drawing that is larger than the area into pieces with glue tabs, and packs the pieces
/// on as few sheets as it can (docs/geometry.md, section 8).
///
/// Seams in one direction are straight from edge to edge. Seams in the other direction run between
/// them, straight or in steps. Both directions and both orientations of the pieces are tried.
/// Dynamic programming over all valid lines finds the cheapest seams: glued length, crossed folds
/// and cuts, and the number of pieces cost; following an existing cut is free. A line is valid if
/// it runs along no fold and every uncut stretch of it has room for a tab on a single panel.
///
/// `drawing` must be clean (no line twice; see `clean`). O(n log n) in its segments unless lines
/// pile up in one place.
///
/// @retval Infeasible  the area allows no valid seams, or a requested seam is not valid (the detail
///                     names the nearest valid one)
/// @retval OutOfRange  impossible sizes of the area or the tabs, or a seam outside the drawing
[[nodiscard]] Result<Layout> lay_out(const LineWork& drawing, const LayoutOptions& options);

/// All pieces of one sheet as one drawing in sheet mm; `piece_of` gets the piece of each line.
[[nodiscard]] LineWork sheet_work(const Layout& layout, std::uint32_t sheet,
                                  std::vector<std::uint32_t>& piece_of);

/// Several patterns with declared seams as one drawing.
struct JoinedParts {
  LineWork drawing;             ///< each part in its place, without outlines along seams
  std::vector<double> seams_x;  ///< where to split them again, mm from the left edge
};

/// Puts parts in their places (`Pattern::place`) and removes the outlines along their seams, so
/// that a layout splits the drawing there and adds tabs.
[[nodiscard]] JoinedParts join_parts(const std::vector<const Pattern*>& parts);

/// Draws how to glue the pieces together, in mm: the whole drawing with each piece in its own tint,
/// with its number and sheet, the seams with their letters, the tabs, and a list of the glueing
/// steps.
[[nodiscard]] std::string assembly_svg(const Layout& layout, const LineWork& drawing);

}  // namespace popcut
