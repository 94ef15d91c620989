// SPDX-License-Identifier: MIT
#include "core/plan/knife/strokes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/plan/knife/blade.hpp"

namespace popcut {
namespace {

constexpr std::array kKinds{"draw", "score", "fold", "cut", "scored fold"};
constexpr std::size_t kScored = 4;

std::size_t kind_of(Operation operation) {
  constexpr std::array<std::size_t, 6> kKindOf{0, 1, 2, 2, 3, 3};  // by operation
  return kKindOf.at(static_cast<std::size_t>(operation));
}

double overcut_of(const Toolpath& path, const Stroke& stroke, const KnifeWork& knife) {
  const auto points = path.points_of(stroke);
  if (!(knife.overcut_mm > 0.0) || !knife.blade(stroke.tool) ||
      !takes_overcut(stroke.operation, points))
    return 0.0;
  return overcut_for(round_mm(points, stroke.rounds), knife.overcut_mm);
}

// Points that overcuts add, so that memory is taken once.
std::size_t overcut_points(const Toolpath& drawn, const KnifeWork& knife) {
  std::size_t count = 0;
  std::vector<PagePoint> ends;
  for (const Stroke& stroke : drawn.strokes) {
    const double mm = overcut_of(drawn, stroke, knife);
    if (!(mm > 0.0)) continue;
    ends.clear();
    append_tail(drawn.points_of(stroke), mm, ends);
    append_head(drawn.points_of(stroke), mm, ends);
    count += ends.size();
  }
  return count;
}

Blade blade_of(const KnifeWork& knife) {
  return {.offset_mm = knife.blade_offset_mm, .swivel_above_rad = knife.swivel_above_rad};
}

// Sets `line` to what the tip draws for a stroke; `mm`: its overcut.
void draw_with_overcut(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& line) {
  line.clear();
  if (mm > 0.0)
    append_with_overcut(points, mm, line);
  else
    line.assign(points.begin(), points.end());
}

}  // namespace

StrokeSettings::StrokeSettings(const Machine& machine, const Material& material, FoldMode folds,
                               std::vector<Warning>& warnings)
    : machine_(machine),
      warnings_(warnings),
      pens_(material.pens),
      tools_{material.draw, material.score.value_or(material.draw), material.fold, material.cut,
             scoring(machine, material).value_or(material.fold)},
      fitted_((material.pens.size() + 1) * kKinds.size()) {
  if (folds == FoldMode::Score && material.score) tools_[2] = *material.score;
  if (folds == FoldMode::Light && material.light) tools_[2] = *material.light;
}

const ToolSettings& StrokeSettings::of(PenOperation operation) {
  return fitted(kind_of(operation), operation.pen);
}

// A pen's force may be one that goes through the paper, which these must not.
const ToolSettings& StrokeSettings::scored() { return fitted(kScored, 0); }

std::optional<ToolSettings> StrokeSettings::scoring(const Machine& machine,
                                                    const Material& material) {
  if (!machine.driven()) return std::nullopt;  // its lines have one tool each, chosen by hand
  const auto can = [&](const std::optional<ToolSettings>& tool) {
    return tool && tool->tool <= machine.tool_holders;
  };
  if (can(material.light) && machine.force_gf.per_step > 0.0) return material.light;
  if (can(material.score) && material.score->tip == ToolTip::Stylus) return material.score;
  return std::nullopt;
}

const ToolSettings& StrokeSettings::fitted(std::size_t kind, std::uint8_t pen) {
  auto& tool = fitted_[pen * kKinds.size() + kind];
  if (tool) return *tool;
  tool = pen == 0 ? tools_[kind] : pens_[pen - 1u].over(tools_[kind]);
  fit(*tool, pen == 0 ? kKinds[kind] : fmt::format("{} {}", pens_[pen - 1u].name, kKinds[kind]));
  return *tool;
}

double StrokeSettings::force_gf(const ToolSettings& tool, int pass) const {
  const double wanted = tool.force_gf + pass * tool.force_step_gf;
  const SteppedScale& scale = machine_.force_gf;
  if (scale.per_step <= 0.0) return std::max(0.0, wanted);
  return std::clamp(wanted, scale.min_step * scale.per_step, scale.max_step * scale.per_step);
}

void StrokeSettings::fit(ToolSettings& tool, const std::string& kind) {
  if (tool.tool > machine_.tool_holders) {
    warnings_.push_back({.code = "no_tool_holder",
                         .message = fmt::format(
                             "{} needs tool {}, but {} has only {}; using tool 1, and if that is "
                             "a knife, it cuts these lines through",
                             kind, tool.tool, machine_.name, machine_.tool_holders),
                         .spoils = true});
    tool.tool = 1;
  }
  fit_scale(tool.force_gf, machine_.force_gf, kind, "force", "gf");
  fit_scale(tool.speed_mm_s, machine_.speed_mm_s, kind, "speed", "mm/s");
}

void StrokeSettings::fit_scale(double& value, const SteppedScale& scale, const std::string& kind,
                               const char* what, const char* unit) {
  const bool is_force = &scale == &machine_.force_gf;
  if (scale.per_step <= 0.0) return;
  const double low = scale.min_step * scale.per_step, high = scale.max_step * scale.per_step;
  const double fitted = std::clamp(value, low, high);
  if (fitted != value)
    warnings_.push_back(
        {.code = fmt::format("{}_out_of_range", what),
         .message = fmt::format("{} {} of {:g} {} is out of range of {}; using {:g} {}", kind, what,
                                value, unit, machine_.name, fitted, unit),
         .spoils = is_force});
  value = fitted;
}

void turn_round(LineWork& work, CutDirection direction) {
  if (direction == CutDirection::Any) return;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    if (!takes_overcut(line.operation, points)) continue;
    if ((twice_area(points) > 0.0) != (direction == CutDirection::Clockwise))
      std::reverse(work.points.begin() + line.first, work.points.begin() + line.first + line.count);
  }
}

DrawnStrokes make_strokes(const Dashed& dashed, const std::vector<Visit>& visits,
                          StrokeSettings& settings) {
  DrawnStrokes out;
  Toolpath& path = out.path;
  path.strokes.reserve(visits.size());
  path.points.reserve(dashed.work.points.size());
  std::vector<PagePoint> points;
  for (const Visit& visit : visits) {
    const PenOperation operation = dashed.work.lines[visit.line].operation;
    const bool scored = visit.line >= dashed.first_scored;
    const ToolSettings& tool = scored ? settings.scored() : settings.of(operation);
    if (tool.tip == ToolTip::Blade)
      out.blade_tools = static_cast<std::uint16_t>(out.blade_tools | 1u << tool.tool);
    points_of_visit(dashed.work, visit, points);
    const bool round = closed(points);
    const bool in_one = round && tool.force_step_gf == 0.0;
    if (in_one) {
      const std::vector<PagePoint> once(points.begin() + 1, points.end());
      for (int pass = 1; pass < tool.passes; ++pass)
        points.insert(points.end(), once.begin(), once.end());
    }
    for (int pass = 0; pass < (in_one ? 1 : tool.passes); ++pass) {
      path.strokes.push_back({operation, static_cast<std::uint32_t>(path.points.size()),
                              static_cast<std::uint32_t>(points.size()), dashed.line[visit.line],
                              static_cast<std::uint8_t>(tool.tool),
                              scored ? std::uint8_t{0} : operation.pen,
                              static_cast<std::uint8_t>(in_one ? tool.passes : 1),
                              settings.force_gf(tool, pass), tool.speed_mm_s});
      path.points.insert(path.points.end(), points.begin(), points.end());
      if (!round) std::reverse(points.begin(), points.end());
    }
  }
  return out;
}

std::optional<Toolpath> sent_strokes(const Toolpath& drawn, const KnifeWork& knife) {
  const bool offset = knife.blade_offset_mm > 0.0 && knife.blade_tools != 0;
  const bool overcut =
      std::any_of(drawn.strokes.begin(), drawn.strokes.end(),
                  [&](const Stroke& stroke) { return overcut_of(drawn, stroke, knife) > 0.0; });
  if (!offset && !overcut) return std::nullopt;
  Toolpath sent;
  sent.strokes.reserve(drawn.strokes.size());
  sent.points.reserve(drawn.points.size() * (offset ? 4 : 1) +
                      (overcut ? overcut_points(drawn, knife) : 0));
  Blade blade = blade_of(knife);
  std::vector<PagePoint> line;
  for (const Stroke& stroke : drawn.strokes) {
    const auto points = drawn.points_of(stroke);
    Stroke copy = stroke;
    copy.first = static_cast<std::uint32_t>(sent.points.size());
    draw_with_overcut(points, overcut_of(drawn, stroke, knife), line);
    if (offset && knife.blade(stroke.tool))
      append_axis_path(line, blade, sent.points);
    else
      sent.points.insert(sent.points.end(), line.begin(), line.end());
    copy.count = static_cast<std::uint32_t>(sent.points.size()) - copy.first;
    sent.strokes.push_back(copy);
  }
  return sent;
}

KnifeMarks knife_marks(const Toolpath& drawn, const KnifeWork& knife, std::size_t first_stroke,
                       std::size_t strokes) {
  KnifeMarks marks;
  const auto end_mark = [&](std::vector<KnifeMarks::Mark>& list, std::uint32_t stroke,
                            std::size_t first) {
    list.push_back({stroke, static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(marks.points.size() - first)});
  };
  Blade blade = blade_of(knife);
  std::vector<PagePoint> line, axis;
  const std::size_t end = first_stroke + std::min(strokes, drawn.strokes.size() - first_stroke);
  for (auto i = static_cast<std::uint32_t>(first_stroke); i < end; ++i) {
    const Stroke& stroke = drawn.strokes[i];
    const auto points = drawn.points_of(stroke);
    const double mm = overcut_of(drawn, stroke, knife);
    draw_with_overcut(points, mm, line);
    if (mm > 0.0) {
      std::size_t first = marks.points.size();
      append_tail(points, mm, marks.points);
      end_mark(marks.overcuts, i, first);
      first = marks.points.size();
      append_head(points, mm, marks.points);
      end_mark(marks.overcuts, i, first);
    }
    if (!(knife.blade_offset_mm > 0.0) || !knife.blade(stroke.tool)) continue;
    axis.clear();
    const std::size_t entry = append_axis_path(line, blade, axis);
    if (entry <= 1) continue;
    const std::size_t first = marks.points.size();
    marks.points.insert(marks.points.end(), axis.begin(),
                        axis.begin() + static_cast<std::ptrdiff_t>(entry));
    end_mark(marks.lead_ins, i, first);
  }
  return marks;
}

}  // namespace popcut
