// SPDX-License-Identifier: MIT
#include "core/plan/plan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/plan/clean.hpp"
#include "core/plan/micro_cut.hpp"
#include "core/plan/motion.hpp"

namespace popcut {
namespace {

constexpr double kRollMargin = 10.0;  // mm of roll after the drawing

// The error of `place` with what the user can do about it.
Error with_advice(Error error, const Machine& machine, const Mat& mat, const Box& box,
                  const PlanOptions& options) {
  if (error.kind != ErrorKind::Infeasible || options.place.at) return error;
  std::string advice = "splitting is not built yet: ";
  for (const Mat& other : machine.mats) {
    const auto reach = reach_mm(machine, other);
    if ((box.width() <= reach[0] && box.height() <= reach[1]) ||
        (box.height() <= reach[0] && box.width() <= reach[1])) {
      advice += fmt::format("use --mat {}, ", other.name);
      break;
    }
  }
  advice += "scale it down, take a larger machine, or cut off what lies outside with --clip";
  const auto reach = reach_mm(machine, mat);
  error.detail =
      fmt::format("pattern is {:.1f} x {:.1f} mm, the {} mat{} holds {:.1f} x {:.1f} mm; {}",
                  box.width(), box.height(), machine.name, mat.name.empty() ? "" : " " + mat.name,
                  reach[0], reach[1], advice);
  return error;
}

Result<void> check_amount(const LineWork& work, const DashShape& shape) {
  if (work.lines.empty())
    return fail(ErrorKind::OutOfRange, "",
                "the drawing has no line to cut or fold; one at least is due");
  if (work.points.size() > kMaxDrawnPoints)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("the drawing has {} points; at most {}", work.points.size(), kMaxDrawnPoints));
  double folds = 0.0;
  for (const PagePoint& p : work.points)
    if (!(std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate))
      return fail(
          ErrorKind::OutOfRange, "",
          fmt::format("a point lies at {:g},{:g} mm; at most 100 m from the origin", p.x, p.y));
  for (const DrawnLine& line : work.lines)
    if (is_fold(line.operation)) folds += length(work.points_of(line));
  const double dashes = folds / (shape.dash_mm + shape.gap_mm);
  if (dashes > static_cast<double>(kMaxDrawnPoints) / 2)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("{:.0f} m of folds make more dashes than can be planned", folds / 1000));
  return {};
}

// Tool, force and speed of each kind of stroke, within what the machine can; it warns once a kind.
class Settings {
 public:
  Settings(const Machine& machine, const Material& material, std::vector<std::string>& warnings)
      : machine_(machine),
        warnings_(warnings),
        cut_(material.cut),
        fold_(material.fold),
        draw_(material.draw) {}

  const ToolSettings& of(Operation operation) {
    const int kind = operation <= Operation::Score ? 0 : is_fold(operation) ? 1 : 2;
    ToolSettings& tool = kind == 0 ? draw_ : kind == 1 ? fold_ : cut_;
    if (!checked_[static_cast<std::size_t>(kind)])
      fit(tool, kind == 0 ? "draw" : kind == 1 ? "fold" : "cut");
    checked_[static_cast<std::size_t>(kind)] = true;
    return tool;
  }

 private:
  void fit(ToolSettings& tool, const char* kind) {
    if (tool.tool > machine_.tool_holders) {
      warnings_.push_back(fmt::format("{} asks for tool {}, {} has {}; tool 1 is used", kind,
                                      tool.tool, machine_.name, machine_.tool_holders));
      tool.tool = 1;
    }
    fit_scale(tool.force_gf, machine_.force_gf, kind, "force", "gf");
    fit_scale(tool.speed_mm_s, machine_.speed_mm_s, kind, "speed", "mm/s");
  }
  void fit_scale(double& value, const SteppedScale& scale, const char* kind, const char* what,
                 const char* unit) {
    if (scale.per_step <= 0.0) return;
    const double low = scale.min_step * scale.per_step, high = scale.max_step * scale.per_step;
    const double fitted = std::clamp(value, low, high);
    if (fitted != value)
      warnings_.push_back(fmt::format("{} {} of {:g} {} is beyond {}; {:g} {} is used", kind, what,
                                      value, unit, machine_.name, fitted, unit));
    value = fitted;
  }

  const Machine& machine_;
  std::vector<std::string>& warnings_;
  ToolSettings cut_, fold_, draw_;
  std::array<bool, 3> checked_{};
};

// Strokes in order. Further passes go round a closed line without lifting, and back along an open
// one.
Toolpath strokes(const Dashed& dashed, const std::vector<Visit>& visits, Settings& settings) {
  Toolpath path;
  std::vector<PagePoint> points;
  for (const Visit& visit : visits) {
    const Operation operation = dashed.work.lines[visit.line].operation;
    const ToolSettings& tool = settings.of(operation);
    points_of_visit(dashed.work, visit, points);
    if (closed(points)) {
      const std::vector<PagePoint> once(points.begin() + 1, points.end());
      for (int pass = 1; pass < tool.passes; ++pass)
        points.insert(points.end(), once.begin(), once.end());
    }
    const int repeats = closed(points) ? 1 : tool.passes;
    for (int pass = 0; pass < repeats; ++pass) {
      path.strokes.push_back({operation, static_cast<std::uint32_t>(path.points.size()),
                              static_cast<std::uint32_t>(points.size()), dashed.line[visit.line],
                              static_cast<std::uint8_t>(tool.tool), tool.force_gf,
                              tool.speed_mm_s});
      path.points.insert(path.points.end(), points.begin(), points.end());
      std::reverse(points.begin(), points.end());
    }
  }
  return path;
}

Ordered ordered_for(const LineWork& work, const Machine& machine, OrderOptions how,
                    PlannedSheet& sheet, std::vector<std::string>& warnings) {
  how.cost = TravelCost::seconds(machine.motion);
  Ordered ordered = order(work, how);
  sheet.order_moves = ordered.moves;
  sheet.order_finished = ordered.finished;
  if (!ordered.finished)
    warnings.push_back(fmt::format(
        "the search for a short way was ended after {} of {} moves; on another machine, or with "
        "more time, the order may differ",
        ordered.moves, ordered.moves_wanted));
  if (const std::size_t late =
          how.method == OrderMethod::Keep ? outer_before_inner(work, ordered.visits) : 0;
      late > 0)
    warnings.push_back(fmt::format(
        "the order is kept as drawn: {} strokes come after the closed line around them, which may "
        "have moved by then",
        late));
  return ordered;
}

void measure(PlannedSheet& sheet, const Machine& machine, const Material& material) {
  const Toolpath& path = sheet.path;
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    const Stroke& stroke = path.strokes[i];
    const double mm = length(path.points_of(stroke));
    if (is_cut(stroke.operation)) sheet.cut_mm += mm;
    if (is_fold(stroke.operation)) sheet.fold_mm += mm;
    if (i > 0)
      sheet.travel_mm +=
          distance(path.points_of(path.strokes[i - 1]).back(), path.points_of(stroke).front());
  }
  const Motion& motion = machine.motion;
  const double out = distance({}, path.points_of(path.strokes.front()).front());
  const double back = distance(path.points_of(path.strokes.back()).back(), {});
  sheet.home_mm = out + back;
  sheet.seconds = motion.setup_s + strokes_seconds(path, motion) + travel_seconds(out, motion) +
                  travel_seconds(back, motion) + motion.trailer_s;
  if (machine.autoblade)
    sheet.seconds +=
        motion.autoblade_reset_s + motion.autoblade_tap_s * (10 - material.autoblade_depth);
  sheet.seconds_range = {sheet.seconds * (1 - motion.spread), sheet.seconds * (1 + motion.spread)};
}

}  // namespace

Result<Plan> plan(const LineWork& drawing, const Machine& machine, const Material& material,
                  const PlanOptions& options) {
  if (auto amount = check_amount(drawing, material.dashes); !amount)
    return tl::unexpected(amount.error());
  const auto mat = choose_mat(machine, options.mat);
  if (!mat) return tl::unexpected(mat.error());
  PlannedSheet sheet;
  sheet.mat = *mat;
  sheet.area_mm = reach_mm(machine, *mat);
  const auto placement = place(drawing, sheet.area_mm, options.place);
  if (!placement)
    return tl::unexpected(with_advice(placement.error(), machine, *mat, bounds(drawing), options));
  sheet.transform = *placement;

  LineWork work = placed(drawing, *placement);
  // On a roll the sheet is as long as what is cut from it; so a y-up machine starts at its origin.
  if (machine.mats.empty() && options.mat.empty())
    sheet.area_mm[1] = std::min(sheet.area_mm[1], std::ceil(bounds(work).y1) + kRollMargin);
  if (options.place.clip) work = clipped(work, sheet.area_mm);
  work = clean(work);
  sheet.paths = work.lines.size();
  const Dashed dashed = micro_cut(work, material.dashes);
  if (dashed.work.lines.empty())
    return fail(ErrorKind::OutOfRange, "",
                "nothing is left to cut; is all of it outside of the area?");
  sheet.fold_line_mm = dashed.fold_line_mm;

  std::vector<Visit> given(dashed.work.lines.size());
  for (std::uint32_t i = 0; i < given.size(); ++i) given[i].line = i;
  sheet.travel_input_mm = travel_mm(dashed.work, given);
  Plan out{drawing.name, machine, material, {}, dashed.work.warnings, options.order.seed};
  Settings settings(machine, material, out.warnings);
  const Ordered ordered = ordered_for(dashed.work, machine, options.order, sheet, out.warnings);
  sheet.path = strokes(dashed, ordered.visits, settings);
  measure(sheet, machine, material);
  out.sheets.push_back(std::move(sheet));
  return out;
}

}  // namespace popcut
