// SPDX-License-Identifier: MIT
#include "core/plan/plan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/drawing/clean.hpp"
#include "core/drawing/near_lines.hpp"
#include "core/geometry/angle.hpp"
#include "core/layout/marks.hpp"
#include "core/machines/motion.hpp"
#include "core/plan/drawing_transform.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/plan/marks.hpp"

namespace popcut {
namespace {

// How a job without a mat is ordered.
constexpr double kBandMm = 20.0, kCornerDeg = 60.0;
// Roll left after the drawing, mm; more than any blade's offset.
constexpr double kRollMargin = 10.0;

// The name of the machine's first mat that holds all of a drawing of this size; empty if none does.
std::string mat_for(const Machine& machine, const Box& box, bool marks) {
  for (const Mat& other : machine.mats) {
    auto reach = reach_mm(machine, other);
    if (marks) reach = room_within_marks_mm(reach);
    if ((box.width() <= reach[0] && box.height() <= reach[1]) ||
        (box.height() <= reach[0] && box.width() <= reach[1]))
      return other.name;
  }
  return {};
}

// Adds to the error of `place` what the user can do about it.
Error with_advice(Error error, const Machine& machine, const Mat& mat, const Box& box,
                  const PlanOptions& options) {
  if (error.kind != ErrorKind::Infeasible || options.place.at) return error;
  std::string advice = "omit `no-split` to split it, ";
  if (const std::string other = mat_for(machine, box, options.marks); !other.empty())
    advice += fmt::format("use `mat` {}, ", other);
  advice += "scale it down, use a larger machine, or use `clip` to drop what lies outside";
  const auto reach = reach_mm(machine, mat);
  error.detail = fmt::format(
      "the pattern is {:.1f} x {:.1f} mm, but the {} mat{} holds {:.1f} x {:.1f} mm; {}",
      box.width(), box.height(), machine.name, mat.name.empty() ? "" : " " + mat.name, reach[0],
      reach[1], advice);
  return error;
}

Result<void> check_amount(const LineWork& work, const DashShape& shape) {
  if (work.lines.empty())
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("the drawing has no line to cut or fold; it needs at least one{}{}",
                            work.warnings.empty() ? "" : "; while reading: ",
                            fmt::join(messages_of(work.warnings), "; ")));
  if (work.points.size() > kMaxDrawnPoints)
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("the drawing has {} points; the limit is {}", work.points.size(),
                            kMaxDrawnPoints));
  double folds = 0.0;
  for (const PagePoint& p : work.points)
    if (!(std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate))
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("a point lies at {:g},{:g} mm; it must be within 100 m of the origin",
                              p.x, p.y));
  for (const DrawnLine& line : work.lines)
    if (is_fold(line.operation)) folds += length(work.points_of(line));
  const double dashes = folds / (shape.dash_mm + shape.gap_mm);
  if (dashes > static_cast<double>(kMaxDrawnPoints) / 2)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("{:.0f} m of folds give too many dashes; draw fewer folds or use longer dashes",
                    folds / 1000));
  return {};
}

// Moves a drawing so that it stays `room` away from the border; false if it does not fit.
bool keep_room(Placement& placement, const LineWork& drawing, const std::array<double, 2>& reach,
               double room) {
  Box box;
  for (const PagePoint& p : drawing.points) box.add(placement(p));
  if (box.width() > reach[0] - 2 * room || box.height() > reach[1] - 2 * room) return false;
  placement.x0 += std::max(0.0, room - box.x0) - std::max(0.0, box.x1 - (reach[0] - room));
  placement.y0 += std::max(0.0, room - box.y0) - std::max(0.0, box.y1 - (reach[1] - room));
  return true;
}

// Places the drawing. Where popcut turns the blade, the axis moves beyond what the tip cuts.
Result<Placement> find_place(const LineWork& drawing, const Machine& machine, const Mat& mat,
                             const PlanOptions& options, const std::array<double, 2>& reach,
                             double room) {
  auto placement = place(drawing, reach, options.place);
  const Box box = bounds(drawing);
  if (!placement) return tl::unexpected(with_advice(placement.error(), machine, mat, box, options));
  if (room > 0.0 && !options.place.clip && !keep_room(*placement, drawing, reach, room))
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format(
            "the pattern is {:.1f} x {:.1f} mm, but the area holds {:.1f} x {:.1f} mm, because "
            "the blade's offset needs {:.2f} mm all around; scale the pattern down, or use a "
            "larger area",
            box.width(), box.height(), reach[0] - 2 * room, reach[1] - 2 * room, room));
  return placement;
}

// Replaces folds by dashes; folds without room for one are scored where the machine can, or left
// out with a warning. Leaves folds whole where they are pressed, cut half through, or dashed
// already.
Dashed folded(LineWork work, const Machine& machine, const Material& material, FoldMode mode) {
  const bool any = std::any_of(work.lines.begin(), work.lines.end(),
                               [](const DrawnLine& line) { return is_fold(line.operation); });
  if (mode == FoldMode::Perforate && any && !work.dashed) {
    Dashed dashed = micro_cut(work, material.dashes);
    const auto scoring = StrokeSettings::scoring(machine, material);
    const char* done = !scoring                         ? "stay uncut"
                       : scoring->tip == ToolTip::Blade ? "are cut half through instead of dashed"
                                                        : "are scored instead of dashed";
    if (auto warning = left_out_warning(dashed, material.dashes, done))
      dashed.work.warnings.push_back(std::move(*warning));
    if (scoring) score_left_out(work, material.dashes, dashed);
    return dashed;
  }
  Dashed out;
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    out.line.push_back(i);
    if (is_fold(work.lines[i].operation)) out.fold_line_mm += length(work.points_of(work.lines[i]));
  }
  out.work = std::move(work);
  out.work.dashed = true;
  return out;
}

bool has_folds(const LineWork& work) {
  return std::any_of(work.lines.begin(), work.lines.end(),
                     [](const DrawnLine& line) { return is_fold(line.operation); });
}

Result<FoldMode> fold_mode(const Machine& machine, const Material& material,
                           const PlanOptions& options, const LineWork& drawing) {
  if (!machine.driven()) {
    if (options.knife.folds == FoldMode::Light)
      return fail(
          ErrorKind::OutOfRange, "/options/folds",
          fmt::format("{} cannot cut half through; use `folds` score or perforate", machine.title));
    return options.knife.folds.value_or(machine.folds);
  }
  const FoldMode mode = options.knife.folds.value_or(material.folds);
  const bool missing =
      (mode == FoldMode::Score && !material.score) || (mode == FoldMode::Light && !material.light);
  if (missing)
    return fail(ErrorKind::OutOfRange, "/options/folds",
                fmt::format("material {0} has no settings \"{1}\"; add them to your material "
                            "table, or use `folds` perforate",
                            material.name, fold_mode_name(mode)));
  if (!has_folds(drawing)) return mode;
  // Without its force or its tool a knife would go through the whole fold.
  if (mode == FoldMode::Light && !(machine.force_gf.per_step > 0.0))
    return fail(ErrorKind::OutOfRange, "/options/folds",
                fmt::format("popcut cannot set the force of {}, so its knife would cut the folds "
                            "through; use `folds` perforate",
                            machine.title));
  if (mode == FoldMode::Score && material.score->tool > machine.tool_holders)
    return fail(ErrorKind::OutOfRange, "/options/folds",
                fmt::format("scoring needs tool {}, but {} has only {}, so its knife would cut the "
                            "folds through; use `folds` perforate",
                            material.score->tool, machine.title, machine.tool_holders));
  return mode;
}

Ordered ordered_for(const LineWork& work, const Machine& machine, const PlanOptions& options,
                    PlannedSheet& sheet, std::vector<Warning>& warnings) {
  OrderOptions how = options.order;
  if (options.mat_free) {
    how.band_mm = kBandMm;
    how.corner_deg = kCornerDeg;
  }
  if (machine.driven()) how.cost = TravelCost::seconds(machine.motion);
  Ordered ordered = order(work, how);
  sheet.order_moves = ordered.moves;
  sheet.order_finished = ordered.finished;
  if (!ordered.finished)
    warnings.push_back(
        {.code = "order_unfinished",
         .message = fmt::format("the search for a short order stopped after {} of {} moves; on "
                                "another machine, or with more time, the order may differ",
                                ordered.moves, ordered.moves_wanted)});
  if (const std::size_t late =
          how.method == OrderMethod::Keep ? outer_before_inner(work, ordered.visits) : 0;
      late > 0)
    warnings.push_back(
        {.code = "outer_before_inner",
         .message = fmt::format("the order is kept as drawn: {} strokes come after the closed line "
                                "around them, so the paper inside may have moved by then",
                                late),
         .spoils = true});
  return ordered;
}

// How far the tool can go past what was cut, up to a centimetre. The axis counts from the side of
// the sheet that comes out first.
double room_to_feed_out(const PlannedSheet& sheet, const Machine& machine) {
  constexpr double kMostMm = 10.0;
  Box box;
  for (const PagePoint& p : sheet.sent_path().points) box.add(p);
  const double room =
      machine.feed_up() ? machine.length_mm - sheet.area_mm[1] + box.y0 : sheet.area_mm[1] - box.y1;
  return std::clamp(room, 0.0, kMostMm);
}

void measure(PlannedSheet& sheet, const Machine& machine, const Material& material,
             const PlanOptions& options) {
  const Toolpath& path = sheet.sent_path();
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    const Stroke& stroke = path.strokes[i];
    const double mm = length(path.points_of(stroke));
    if (is_cut(stroke.operation)) sheet.cut_mm += mm;
    if (is_fold(stroke.operation)) sheet.fold_mm += mm;
    if (i > 0)
      sheet.travel_mm +=
          distance(path.points_of(path.strokes[i - 1]).back(), path.points_of(stroke).front());
  }
  if (!machine.driven()) return;  // its own program, or a person, takes what time it takes
  const Motion& motion = machine.motion;
  for (std::size_t i = 1; i < path.strokes.size(); ++i)
    sheet.travel_s += travel_seconds(distance(path.points_of(path.strokes[i - 1]).back(),
                                              path.points_of(path.strokes[i]).front()),
                                     motion);
  const double out = distance({}, path.points_of(path.strokes.front()).front());
  const double back = distance(path.points_of(path.strokes.back()).back(), {});
  sheet.home_mm = out + back;
  const FirmwareSwivel swivel{machine.firmware_blade_offset ? material.blade_offset_mm : 0.0,
                              sheet.knife.blade_tools};
  sheet.seconds = motion.setup_s + strokes_seconds(path, motion, swivel) +
                  travel_seconds(out, motion) + travel_seconds(back, motion) + motion.trailer_s;
  if (sets_autoblade(machine, options.blade))
    sheet.seconds +=
        motion.autoblade_reset_s + motion.autoblade_tap_s * (10 - material.autoblade_depth);
  if (options.finish == Finish::Below) {
    sheet.feed_out_mm = room_to_feed_out(sheet, machine);
    sheet.seconds += travel_seconds(sheet.area_mm[1], motion);
  }
  sheet.seconds_range = {sheet.seconds * (1 - motion.spread), sheet.seconds * (1 + motion.spread)};
}

// Rounds of the closed cuts in one stroke.
int fewest_rounds(const Toolpath& path) {
  int fewest = 0;
  for (const Stroke& stroke : path.strokes)
    if (is_cut(stroke.operation) && closed(path.points_of(stroke)))
      fewest = fewest == 0 ? stroke.rounds : std::min<int>(fewest, stroke.rounds);
  return std::max(1, fewest);
}

void append(Polylines& lines, std::span<const PagePoint> points) {
  lines.points.insert(lines.points.end(), points.begin(), points.end());
  lines.ends.push_back(static_cast<std::uint32_t>(lines.points.size()));
}

// Plans sheet by sheet: from placed lines to strokes in order.
class Planner {
 public:
  Planner(LineWork&& drawing, const Machine& machine, const Material& material,
          const PlanOptions& options, Mat mat, FoldMode mode)
      : drawing_(std::move(drawing)),
        dashed_(drawing_.dashed),
        options_(options),
        mat_(std::move(mat)),
        room_(host_blade_offset_mm(machine, material)),
        out_{drawing_.name,
             machine,
             material,
             {},
             drawing_.warnings,
             options.order.seed,
             mode,
             options.clean.snap_mm,
             options.clean.one_pass_mm,
             options.weld,
             options.svg_profile,
             options.svg_dpi,
             reading_tolerance_mm(options),
             options.pdf_page,
             options.layers,
             options.colors},
        settings_(out_.machine, out_.material, mode, out_.warnings) {}

  Result<Plan> run() {
    const std::array<double, 2> reach = reach_mm(out_.machine, mat_);
    // Between marks there is less room.
    const std::array<double, 2> room = options_.marks ? within_marks_mm(reach) : reach;
    const auto placement = find_place(drawing_, out_.machine, mat_, options_, room, room_);
    // Requested seams are made even if the drawing would fit.
    const bool asked = !options_.seams_x.empty() || !options_.seams_y.empty();
    const bool too_large = !placement && placement.error().kind == ErrorKind::Infeasible &&
                           placement.error().place.empty();
    auto done = (too_large || asked) && !options_.no_split ? split(reach)
                : placement                                ? whole(*placement, reach)
                                                           : tl::unexpected(placement.error());
    if (!done) return tl::unexpected(done.error());
    return std::move(out_);
  }

 private:
  // On a roll the sheet is as long as what is cut from it, so a machine with y up starts at its
  // origin.
  [[nodiscard]] double sheet_length(double reach, double used) const {
    const bool roll = is_roll(options_.mat) || (out_.machine.mats.empty() && options_.mat.empty());
    return roll ? std::min(reach, std::ceil(used) + kRollMargin) : reach;
  }

  Result<void> whole(const Placement& placement, const std::array<double, 2>& reach) {
    PlannedSheet sheet;
    sheet.transform = placement;
    LineWork work = placed(std::move(drawing_), placement);
    sheet.area_mm = {reach[0], sheet_length(reach[1], bounds(work).y1)};
    if (options_.place.clip) work = clipped(work, sheet.area_mm, room_);
    return add(std::move(work), std::move(sheet));
  }

  Result<void> split(const std::array<double, 2>& reach) {
    tell(options_.progress, "cleaning the drawing");
    LineWork work = clean(drawing_, options_.clean);
    tell(options_.progress, "splitting the drawing into sheets");
    out_.warnings = work.warnings;  // the drawing's own warnings and those of cleaning
    tell_doubles(work);
    LayoutOptions how;
    const PagePoint at = options_.place.at.value_or(PagePoint{});
    const std::array<double, 2> most = options_.marks ? within_marks_mm(reach) : reach;
    how.area_mm = {most[0] - room_, most[1] - room_};
    how.origin = {std::max(at.x, room_), std::max(at.y, room_)};
    how.tabs = out_.material.tabs;
    how.seams_x = options_.seams_x;
    how.seams_y = options_.seams_y;
    how.labels = options_.labels != LabelTool::None;
    how.letters_taken = options_.letters_taken;
    auto layout = lay_out(work, how);
    if (!layout) return tl::unexpected(layout.error());
    const bool pen = out_.material.draw.tool <= out_.machine.tool_holders;
    if (options_.labels == LabelTool::Cut || (options_.labels == LabelTool::Auto && !pen))
      cut_marks(*layout);
    out_.warnings.insert(out_.warnings.end(), layout->warnings.begin(), layout->warnings.end());
    // Pieces that are apart in the drawing, such as a book's cards, are split without glue. Who
    // names a paper has no larger mat.
    const auto is_named = [&](const Mat& mat) { return is_mat_name(mat, options_.mat); };
    const std::vector<Mat>& mats = out_.machine.mats;
    const bool own_paper =
        !options_.mat.empty() && std::none_of(mats.begin(), mats.end(), is_named);
    if (const std::string other = mat_for(out_.machine, bounds(work), options_.marks);
        !own_paper && !other.empty() && !layout->tabs.empty())
      out_.warnings.push_back(
          {.code = "fits_whole",
           .message = fmt::format("the drawing fits whole on `mat` {}, without splitting", other)});
    std::vector<std::uint32_t> piece_of;
    for (std::uint32_t k = 0; k < layout->sheets.size(); ++k) {
      PlannedSheet sheet;
      sheet.pieces = layout->sheets[k].pieces;
      std::sort(sheet.pieces.begin(), sheet.pieces.end());
      sheet.transform = layout->pieces[sheet.pieces.front()].transform;
      sheet.area_mm = {reach[0], sheet_length(reach[1], layout->sheets[k].used_mm[1] + room_)};
      if (auto done = add(sheet_work(*layout, k, piece_of), std::move(sheet)); !done) return done;
    }
    out_.layout = std::move(*layout);
    out_.whole = std::move(work);
    return {};
  }

  /// Warns of lines that run so close beside others that a knife cuts the same place twice.
  void tell_doubles(const LineWork& work) {
    if (!options_.tells_doubles || dashed_) return;
    const DoubledLines doubled = doubled_lines(work, kHardlyMeantMm);
    if (!(doubled.doubled_mm > 0.0)) return;
    out_.warnings.push_back(
        {.code = "double_lines",
         .message = fmt::format(
             "{:.0f} mm of lines run within {:.2f} mm of another line, so that place is cut twice; "
             "use `one-pass` {:.2f} to cut it once",
             std::ceil(doubled.doubled_mm), doubled.apart_mm,
             std::min(kMostOnePass, std::ceil(100.0 * doubled.apart_mm + 1.0) / 100.0)),
         .spoils = true});
  }

  /// What is being done to the sheet that is added now.
  void say(std::string_view what) const {
    const std::size_t sheet = out_.sheets.size();
    if (options_.progress)
      tell(options_.progress,
           sheet == 0 ? std::string(what) : fmt::format("{} of sheet {}", what, sheet + 1));
  }

  Result<void> add(LineWork work, PlannedSheet sheet) {
    sheet.mat = mat_;
    if (options_.mat_free) {  // the sheet is as large as that mat, but lies on none
      sheet.mat.name.clear();
      sheet.mat.code = 0;
    }
    work.dashed = dashed_;
    work.warnings.clear();
    say("cleaning the lines");
    work = clean(std::move(work), options_.clean);
    if (sheet.pieces.empty()) tell_doubles(work);
    say("drawing the folds");
    turn_round(work, options_.knife.direction);
    sheet.paths = work.lines.size();
    sheet.whole_folds = out_.folds != FoldMode::Perforate && !dashed_;
    for (const DrawnLine& line : work.lines)
      if (!dashed_ && is_fold(line.operation))
        out_.fold_lengths_mm.push_back(length(work.points_of(line)));
    if (options_.keep_lines || !out_.machine.driven()) sheet.lines = work;
    const Dashed dashed = folded(std::move(work), out_.machine, out_.material, out_.folds);
    if (dashed.work.lines.empty())
      return fail(ErrorKind::OutOfRange, "",
                  "nothing is left to cut; is the whole drawing outside the area?");
    out_.warnings.insert(out_.warnings.end(), dashed.work.warnings.begin(),
                         dashed.work.warnings.end());
    sheet.fold_line_mm = dashed.fold_line_mm;
    for (std::size_t i = dashed.first_scored; i < dashed.work.lines.size(); ++i)
      append(sheet.scored, dashed.work.points_of(dashed.work.lines[i]));
    std::vector<Visit> given(dashed.work.lines.size());
    for (std::uint32_t i = 0; i < given.size(); ++i) given[i].line = i;
    sheet.travel_input_mm = travel_mm(dashed.work, given);
    say("ordering the cuts");
    const Ordered ordered = ordered_for(dashed.work, out_.machine, options_, sheet, out_.warnings);
    say("making the strokes");
    DrawnStrokes strokes = make_strokes(dashed, ordered.visits, settings_);
    sheet.path = std::move(strokes.path);
    const Material& material = out_.material;
    const double overcut_mm = out_.machine.driven() ? material.overcut_mm : 0.0;
    sheet.knife = {options_.knife.overcut_mm.value_or(overcut_mm), fewest_rounds(sheet.path), room_,
                   radians(material.swivel_above_deg), strokes.blade_tools};
    sheet.sent = sent_strokes(sheet.path, sheet.knife);
    measure(sheet, out_.machine, material, options_);
    out_.sheets.push_back(std::move(sheet));
    return {};
  }

  LineWork drawing_;  ///< until it has been placed
  bool dashed_;
  const PlanOptions& options_;
  Mat mat_;
  double room_;
  Plan out_;
  StrokeSettings settings_;
};

}  // namespace

bool sets_autoblade(const Machine& machine, BladeKind blade) {
  return machine.autoblade &&
         (blade == BladeKind::Autoblade || (blade == BladeKind::Auto && machine.reports_tools()));
}

Result<Plan> plan(LineWork drawing, const Machine& machine, const Material& material,
                  const PlanOptions& options) {
  if (auto valid = check_plan_options(options); !valid) return tl::unexpected(valid.error());
  const Placement map = drawing_transform(drawing, options);
  drawing = transformed(std::move(drawing), map);
  if (auto amount = check_amount(drawing, material.dashes); !amount)
    return tl::unexpected(amount.error());
  auto mat = choose_mat(machine, options.mat);
  if (!mat) return tl::unexpected(mat.error());
  constexpr double kBetweenCopiesMm = 3;
  std::array<double, 2> room = reach_mm(machine, *mat);
  for (double& mm : room) mm -= 2 * options.weed_box_mm;
  if (options.place.at) room = {room[0] - options.place.at->x, room[1] - options.place.at->y};
  const auto copies =
      copies_at(drawing, static_cast<int>(options.per_sheet), room, kBetweenCopiesMm);
  if (!copies) return tl::unexpected(copies.error());
  if (!copies->empty()) {
    if (drawing.points.size() > kMaxDrawnPoints / copies->size())
      return fail(ErrorKind::OutOfRange, "/options/per-sheet",
                  fmt::format("makes {} points of a drawing with {}; a plan has at most {}",
                              copies->size() * drawing.points.size(), drawing.points.size(),
                              kMaxDrawnPoints));
    drawing = copied(std::move(drawing), *copies);
    if (auto amount = check_amount(drawing, material.dashes); !amount)
      return tl::unexpected(amount.error());
  }
  drawing = with_weed_box(std::move(drawing), options.weed_box_mm);
  if (options.blade == BladeKind::Autoblade && !machine.autoblade)
    return fail(ErrorKind::OutOfRange, "/options/blade",
                fmt::format("{} cannot hold an autoblade; leave `blade` out", machine.title));
  const auto mode = fold_mode(machine, material, options, drawing);
  if (!mode) return tl::unexpected(mode.error());
  // Where popcut does not drive, each line is drawn once; how often to cut it is chosen there.
  Material once = material;
  if (!machine.driven()) {
    for (ToolSettings* tool : {&once.cut, &once.fold, &once.draw}) tool->passes = 1;
    if (once.score) once.score->passes = 1;
    for (PenSettings& pen : once.pens) pen.passes.reset();
  }
  auto planned = Planner(std::move(drawing), machine, once, options, std::move(*mat), *mode).run();
  if (planned)
    planned->drawing_transform = map, planned->copies = *copies,
    planned->weed_box_mm = options.weed_box_mm, planned->clip = options.place.clip;
  return planned;
}

LineWork test_shape() {
  LineWork work;
  work.name = "test";
  work.append(Operation::FoldValley, std::array<PagePoint, 2>{{{14, 0}, {14, 10}}});
  work.append(Operation::Cut, std::array<PagePoint, 4>{{{2, 8}, {8, 8}, {5, 3}, {2, 8}}});
  work.append(Operation::Outline,
              std::array<PagePoint, 5>{{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}}});
  return work;
}

}  // namespace popcut
