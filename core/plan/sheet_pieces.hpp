// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/plan/plan.hpp"

namespace popcut {

/// How the pattern's page comes onto a sheet: one map for each piece, or copy, that lies on it.
struct PieceMap {
  Placement to_sheet;                            ///< pattern's page -> sheet
  std::vector<std::vector<PagePoint>> polygons;  ///< sheet mm: its share, then its tabs; empty: all
};
/// The pieces of sheet `sheet` with their tabs, or the whole pattern, or its copies.
[[nodiscard]] std::vector<PieceMap> pieces_on_sheet(const Plan& plan, std::size_t sheet);

/// What of a named part of the drawing (`Plan::parts`) lies on a sheet, in one piece.
struct PartOnSheet {
  std::string name;
  Box box;                                      ///< sheet mm
  std::vector<std::vector<PagePoint>> outline;  ///< of its piece, sheet mm; empty: not known
};
/// Piece by piece, in the order of the parts.
[[nodiscard]] std::vector<PartOnSheet> parts_on_sheet(const Plan& plan, std::size_t sheet);

/// Their names in words, each once: "card 1, card 2"; empty without parts.
[[nodiscard]] std::string part_names(std::span<const PartOnSheet> parts);

/// The names of the parts as lines, SVG paths in sheet mm: each beside what it names, where the
/// paper is cut away: beside its box, else in a bay or a hole of its outline. `single_stroke`
/// letters, so that no font is needed.
///
/// @param room   where they may stand
/// @param taken  where they may not: marks, tabs
/// @return the paths, or nothing; `without` gets the parts that have no room beside them
[[nodiscard]] std::string part_labels_svg(std::span<const PartOnSheet> parts, const Box& room,
                                          std::vector<Box> taken,
                                          std::vector<std::string>* without = nullptr);

/// The plan's `glue_marks` on a sheet, SVG paths in sheet mm; empty if there are none.
[[nodiscard]] std::string glue_marks_svg(const Plan& plan, std::size_t sheet);

}  // namespace popcut
