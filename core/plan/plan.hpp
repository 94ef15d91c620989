// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/hands/folding.hpp"
#include "core/layout/layout.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/knife/strokes.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/plan_options.hpp"
#include "core/warning.hpp"

namespace popcut {

/// One planned sheet: what the cutter does, in order, and figures about it.
struct PlannedSheet {
  Mat mat;
  std::array<double, 2> area_mm{};  ///< reachable area, along carriage and feed
  Toolpath path;                    ///< strokes in order, as drawn
  std::optional<Toolpath> sent;     ///< the same with overcuts and blade offset, if it differs
  KnifeWork knife;
  std::optional<LineWork> lines;      ///< cleaned lines with whole folds; set if `keep_lines`, or
                                      ///< if popcut does not drive the machine
  Placement transform;                ///< pattern page -> sheet; of the sheet's first piece
  std::vector<std::uint32_t> pieces;  ///< indices into the layout's pieces; empty: not split
  double cut_mm{}, fold_mm{};         ///< length with the tool down, as sent
  double fold_line_mm{};              ///< length of folds before dashing
  Polylines scored;                   ///< stretches of folds scored for want of room for a dash
  double travel_mm{}, travel_input_mm{}, home_mm{};
  double travel_s{};  ///< of `travel_mm`, by the machine's motion; 0 where popcut does not drive it
  std::uint64_t order_moves{};          ///< moves that the search for a short order tried
  bool order_finished{true};            ///< false: the search was stopped early
  bool whole_folds{false};              ///< its folds are whole lines: pressed, or cut half through
  std::size_t paths{};                  ///< lines of the drawing after cleaning
  std::optional<double> feed_out_mm{};  ///< how far past what was cut the tool goes at the end
  double seconds{};                     ///< 0 if popcut does not drive the machine
  std::array<double, 2> seconds_range{};
  std::optional<MarkLayout> registration{};  ///< of a printed sheet; the caller sets it

  /// The strokes of the program that is sent, one for one.
  [[nodiscard]] const Toolpath& sent_path() const { return sent ? *sent : path; }
};

/// A part of a drawing that has a name: a card of a book.
struct DrawnPart {
  std::string name;  ///< "card 1"
  Box box;           ///< on the drawing's page, before `Plan::drawing_transform`
};

/// A plan of one or more sheets, with what it was made from.
struct Plan {
  std::string name;
  Machine machine;
  Material material;
  std::vector<PlannedSheet> sheets;
  std::vector<Warning> warnings;
  std::uint64_t seed{};
  FoldMode folds{FoldMode::Perforate};
  double snap_mm{}, one_pass_mm{};
  bool weld{false};           ///< filled shapes that lie over each other became one
  std::string svg_profile{};  ///< how an SVG was read, as the next two
  double svg_dpi{}, curve_tolerance_mm{};
  std::uint64_t pdf_page{1};
  std::string layers{};             ///< what names mean, where `layers` said it
  std::string colors{};             ///< what colours mean, where `colors` said it
  std::optional<double> unit_mm{};  ///< of a DXF or FOLD file, where `units` gave it
  Placement drawing_transform{};    ///< what `scale`, `rotate` and `mirror` did to the drawing
  bool clip{false};                 ///< what lay outside the area was left out
  double weed_box_mm{};             ///< of the box around the drawing or its copies; 0: none
  std::vector<PagePoint> copies{};  ///< where `per-sheet` put them; empty: one
  std::optional<Layout> layout{};   ///< set if the drawing was split
  std::vector<DrawnPart> parts{};   ///< what has a name; the caller sets it
  /// What is printed on the parts of a card so that a person can glue them: outlines where tabs go,
  /// and letters; on the drawing's page, before `drawing_transform`. The caller sets it.
  Polylines glue_marks{};
  LineWork whole{};  ///< set if the drawing was split: the cleaned drawing
  /// Of each fold on all sheets, once the lines are cleaned; none where folds are dashes already.
  std::vector<double> fold_lengths_mm{};
  std::optional<hands::Handwork> handwork{};  ///< of all sheets; the caller sets it
};

/// Whether programs set the depth of the autoblade: a person says that it is one, or the machine
/// will report it before the cut.
[[nodiscard]] bool sets_autoblade(const Machine& machine, BladeKind blade);

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

/// The text of `plan.json`: sheets with their figures in mm and seconds, warnings, and the seed.
/// `transform` is [[xx, xy, x0], [yx, yy, y0]], from the pattern's page (x = v, y = u, mm) to the
/// sheet; `drawing_transform`, in the same form, is applied to the pattern before.
[[nodiscard]] std::string plan_json(const Plan& plan);

/// A picture of a sheet's plan, true to scale: strokes coloured from blue (first) to red (last),
/// moves between strokes as hairlines, marks where the first stroke begins and the last one ends,
/// and a legend with lifts, lengths and time. Coordinates are rounded to 0.01 mm. Strokes of the
/// same of 48 colours share a path, so the file stays small.
[[nodiscard]] std::string plan_svg(const PlannedSheet& sheet, const std::string& title);

/// What will be cut on one sheet, true to scale in mm. Every stroke and every dash is its own path,
/// in the order of cutting (`data-order`), in the layer of its operation and with `data-assignment`
/// (M, V, C for cuts, B for the outline; score and draw by name). Paths have no dashed style. The
/// root element has `data-popcut="dashes"` where the folds are dashes already, and "sheet" where
/// they are whole lines: who plans that drawing again must not cut them through.
///
/// @param print  what is printed on the sheet, SVG elements in its mm: a layer below the others, or
///               empty
[[nodiscard]] std::string sheet_svg(const PlannedSheet& sheet, const std::string& title,
                                    const std::string& print = {});

/// A picture of how the sheets come together, not for cutting: `assembly_svg` of the layout, or for
/// an unsplit drawing each sheet's outline and folds with its name and its place on the mat.
[[nodiscard]] std::string assembly_svg(const Plan& plan);

/// A test cut for a material: a square of 10 mm with a triangle inside, which must fall out in one
/// piece, and beside it a fold of 10 mm, which must bend without tearing.
[[nodiscard]] LineWork test_shape();

}  // namespace popcut
