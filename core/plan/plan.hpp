// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/layout/layout.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/knife/strokes.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/plan_options.hpp"

namespace popcut {

/// One planned sheet: what the cutter does, in order, and figures about it.
struct PlannedSheet {
  Mat mat;
  std::array<double, 2> area_mm{};  ///< reachable area, along carriage and feed
  Toolpath path;                    ///< strokes in order, as drawn
  std::optional<Toolpath> sent;     ///< the same with overcuts and blade offset, if it differs
  KnifeWork knife;
  std::optional<LineWork> lines;      ///< cleaned lines with whole folds; set if `keep_lines`
  Placement transform;                ///< pattern page -> sheet; of the sheet's first piece
  std::vector<std::uint32_t> pieces;  ///< indices into the layout's pieces; empty: not split
  double cut_mm{}, fold_mm{};         ///< length with the tool down, as sent
  double fold_line_mm{};              ///< length of folds before dashing
  double travel_mm{}, travel_input_mm{}, home_mm{};
  std::uint64_t order_moves{};  ///< moves that the search for a short order tried
  bool order_finished{true};    ///< false: the search was stopped early
  std::size_t paths{};          ///< lines of the drawing after cleaning
  double seconds{};
  std::array<double, 2> seconds_range{};
  std::optional<MarkLayout> registration{};  ///< of a printed sheet; the caller sets it

  /// The strokes of the program that is sent, one for one.
  [[nodiscard]] const Toolpath& sent_path() const { return sent ? *sent : path; }
};

/// A plan of one or more sheets, with what it was made from.
struct Plan {
  std::string name;
  Machine machine;
  Material material;
  std::vector<PlannedSheet> sheets;
  std::vector<std::string> warnings;
  std::uint64_t seed{};
  FoldMode folds{FoldMode::Perforate};
  double snap_mm{};
  std::optional<Layout> layout{};  ///< set if the drawing was split
  LineWork whole{};                ///< set if the drawing was split: the cleaned drawing
};

/// Turns a drawing into ordered strokes. Steps: place it on the mat (or split it into pieces that
/// fit, see `lay_out`), clean it, dash the folds, order the strokes. The material gives force,
/// speed and tool, within the limits of the machine. Closed cuts get their overcut. The blade
/// offset is compensated unless the machine's firmware does it.
///
/// @retval Infeasible  the drawing does not fit; the detail has both sizes in mm
/// @retval OutOfRange  nothing to cut, or far too much; the mat is larger than the machine; an
///                     option is out of range; the material has no settings for this kind of fold
/// @retval Usage       unknown mat, or two options that contradict each other
/// An error about an option has `pointer_to` that option as its place.
[[nodiscard]] Result<Plan> plan(LineWork drawing, const Machine& machine, const Material& material,
                                const PlanOptions& options);

}  // namespace popcut
