// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/formats/pens/layer_words.hpp"
#include "core/layout/piece_lines.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/knife/strokes.hpp"
#include "core/result.hpp"
#include "daemon/files/user_tables.hpp"
#include "device/compare/expect.hpp"

namespace popcut::cli {

/// What `plan.json` says of one sheet.
struct PlanFacts {
  std::string machine;
  std::string material;
  std::array<double, 2> area_mm{};
  Placement transform;            ///< pattern to sheet
  Placement drawing_transform;    ///< of the pattern, before
  std::vector<PagePoint> copies;  ///< of it, after that
  double weed_box_mm{};
  bool clip{false};  ///< what lies outside the area was left out
  std::optional<int> cut_passes, fold_passes, score_passes, draw_passes;
  std::vector<PenSettings> pens;     ///< of colours, layers and operations, with their passes
  std::vector<PlannedPiece> pieces;  ///< where the pattern was split: those on this sheet
  LineWork also_allowed;             ///< overcuts, lead-ins, marks, labels, scored folds
  std::string folds{"perforate"};
  double snap_mm{}, one_pass_mm{};
  bool weld{false};
  std::string svg_profile{"popcut"};  ///< how the plan read an SVG, as the next two
  double svg_dpi{96}, curve_tolerance_mm{0.02};
  std::uint64_t pdf_page{1};
  LayerUses layers{};                ///< what names mean, where the plan was told
  std::vector<ColourUse> colours{};  ///< and what colours mean
  std::optional<double> unit_mm;
  double blade_offset_mm{};
  std::uint16_t blade_tools{};
};

/// Reads sheet `number` (from 1) of a `plan.json`.
///
/// @retval Malformed   not JSON, or not of a plan's form; place is the file and a JSON pointer
/// @retval OutOfRange  the plan has no such sheet
[[nodiscard]] Result<PlanFacts> read_plan_facts(const std::string& file, std::size_t number);

/// What a simulated cut is to be compared with.
struct Expectation {
  Expected expected;
  std::optional<std::array<double, 2>> page_mm;  ///< width and length of the sheet's drawing
};

/// What the knife does beside a sheet's strokes: closed cuts are overcut from where they begin, and
/// a blade that the program turns is followed by its tip.
void add_knife(const KnifeWork& knife, Expected& expected);

/// Reads a `sheet-NN.svg`, or a pattern (.svg, .fold, or a spec) that `plan` puts on its sheet.
///
/// @retval Usage  a pattern without a plan: its place and its material are not known
/// @retval Malformed, OutOfRange, Infeasible  see `read_drawing`
[[nodiscard]] Result<Expectation> read_expectation(const std::string& file,
                                                   const std::optional<PlanFacts>& plan,
                                                   const UserTables& tables);

}  // namespace popcut::cli
