// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/layout/layout.hpp"
#include "core/drawing/clean.hpp"
#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/order/order.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/knife/strokes.hpp"

namespace popcut {

/// What draws ticks and letters on pieces of an oversized drawing.
enum class LabelTool {
  Auto,  ///< the pen where the machine has a holder for it, else the knife
  Pen,
  Cut,  ///< as rows of short cuts
  None,
};

struct PlanOptions {
  std::string mat{};  ///< name or size, see `choose_mat`; empty: the machine's own
  PlaceOptions place{};
  OrderOptions order{};  ///< its `cost` is the machine's
  CleanOptions clean{};
  KnifeOptions knife{};
  bool split{true};  ///< a drawing that is too large is split; else it is refused
  std::vector<double> seams_x{}, seams_y{};  ///< seams that were asked for, drawing mm
  LabelTool labels{LabelTool::Auto};
  bool keep_lines{false};  ///< the sheet keeps its lines as they were before folds were dashed
};

/// One sheet: what the cutter does, in order, and its figures.
struct PlannedSheet {
  Mat mat;
  std::array<double, 2> area_mm{};  ///< what can be reached, along carriage and feed
  Toolpath path;                    ///< strokes in order, as they are drawn
  std::optional<Toolpath> sent;     ///< the same with overcuts and blade offset, if that differs
  KnifeWork knife;
  std::optional<LineWork> lines;      ///< cleaned, folds whole; only where they are to be kept
  Placement transform;                ///< pattern page -> sheet; of a sheet of one piece
  std::vector<std::uint32_t> pieces;  ///< of the plan's layout; empty where nothing was split
  double cut_mm{}, fold_mm{};         ///< tool down, as sent
  double fold_line_mm{};              ///< folds before dashing
  double travel_mm{}, travel_input_mm{}, home_mm{};
  std::uint64_t order_moves{};  ///< that the search for a short way tried
  bool order_finished{true};    ///< false: it was ended early
  std::size_t paths{};          ///< lines of the drawing after cleaning
  double seconds{};
  std::array<double, 2> seconds_range{};
  std::optional<MarkLayout> registration{};  ///< of a printed sheet, which whoever prints it sets

  /// What the program has to hold, stroke for stroke.
  [[nodiscard]] const Toolpath& sent_path() const { return sent ? *sent : path; }
};

struct Plan {
  std::string name;
  Machine machine;
  Material material;
  std::vector<PlannedSheet> sheets;
  std::vector<std::string> warnings;
  std::uint64_t seed{};
  FoldMode folds{FoldMode::Perforate};
  double snap_mm{};
  std::optional<Layout> layout{};  ///< where the drawing was split
  LineWork whole{};                ///< then the drawing, cleaned
};

/// Drawing to ordered strokes: placed on the mat (or split into pieces that are, see `lay_out`),
/// cleaned, folds dashed, put in order, with force, speed and tool from the material within what
/// the machine can; closed cuts get their overcut, and the blade's offset is taken into account
/// where the machine's firmware does not.
///
/// @retval Infeasible  it does not fit; the detail has both sizes in mm
/// @retval OutOfRange  there is nothing to cut, or far too much; the mat is larger than the
/// machine;
///                     an option is out of its range, or the material cannot be folded so
/// @retval Usage       the mat is not known
[[nodiscard]] Result<Plan> plan(LineWork drawing, const Machine& machine, const Material& material,
                                const PlanOptions& options);

}  // namespace popcut
