// SPDX-License-Identifier: MIT
#include "core/plan/plan_json.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

// Nanometres are plenty; more digits only make files that differ between machines.
double rounded(double mm) { return std::round(mm * 1e6) / 1e6; }

Json blade_tools(const KnifeWork& knife) {
  Json tools = Json::array();
  for (int tool = 1; tool < 16; ++tool)
    if (knife.blade(tool)) tools.push_back(tool);
  return tools;
}

// Runs of one operation in the order of cutting.
Json operations(const Toolpath& path) {
  Json list = Json::array();
  for (std::size_t i = 0; i < path.strokes.size();) {
    const Operation operation = path.strokes[i].operation;
    const auto kind = [](Operation o) { return is_fold(o) ? Operation::FoldMountain : o; };
    double mm = 0.0;
    std::size_t j = i;
    for (; j < path.strokes.size() && kind(path.strokes[j].operation) == kind(operation); ++j)
      mm += length(path.points_of(path.strokes[j]));
    const Stroke& first = path.strokes[i];
    list.push_back({{"operation", is_fold(operation) ? "fold" : operation_name(operation)},
                    {"strokes", j - i},
                    {"mm", rounded(mm)},
                    {"tool", first.tool},
                    {"force_gf", first.force_gf},
                    {"speed_mm_s", first.speed_mm_s}});
    i = j;
  }
  return list;
}

Json sheet_json(const PlannedSheet& sheet, std::size_t number) {
  const Placement& t = sheet.transform;
  const KnifeWork& knife = sheet.knife;
  return {{"name", fmt::format("sheet-{:02}", number)},
          {"mat", sheet.mat.name},
          {"area_mm", sheet.area_mm},
          {"cut_mm", rounded(sheet.cut_mm)},
          {"fold_mm", rounded(sheet.fold_mm)},
          {"fold_line_mm", rounded(sheet.fold_line_mm)},
          {"travel_mm", rounded(sheet.travel_mm)},
          {"travel_input_mm", rounded(sheet.travel_input_mm)},
          {"home_mm", rounded(sheet.home_mm)},
          {"lifts", sheet.path.strokes.size()},
          {"paths", sheet.paths},
          {"order_moves", sheet.order_moves},
          {"order_finished", sheet.order_finished},
          {"seconds", rounded(sheet.seconds)},
          {"seconds_range", {rounded(sheet.seconds_range[0]), rounded(sheet.seconds_range[1])}},
          {"transform", {{t.xx, t.xy, t.x0}, {t.yx, t.yy, t.y0}}},
          {"operations", operations(sheet.sent_path())},
          {"overcut_mm", knife.overcut_mm},
          {"blade_offset_mm", knife.blade_offset_mm},
          {"blade_tools", blade_tools(knife)},
          {"tabs", Json::array()},
          {"seams", Json::array()},
          {"marks", Json::array()},
          {"overcuts", Json::array()},
          {"lead_ins", Json::array()}};
}

// Lists that may be long are written an entry a line.
std::string entries(const std::vector<KnifeMark>& marks) {
  std::string text = "[";
  for (const KnifeMark& mark : marks) {
    Json points = Json::array();
    for (const PagePoint& p : mark.points) points.push_back({rounded(p.x), rounded(p.y)});
    text += text.size() > 1 ? ",\n        " : "\n        ";
    text += Json{{"stroke", mark.stroke}, {"points", std::move(points)}}.dump();
  }
  return text + (marks.empty() ? "]" : "\n      ]");
}

void fill_list(std::string& text, std::size_t from, const char* name, const std::string& list) {
  const std::string empty = fmt::format("\"{}\": []", name);
  const std::size_t at = text.find(empty, from);
  text.replace(at + empty.size() - 2, 2, list);
}

}  // namespace

std::string plan_json(const Plan& plan) {
  Json json{{"name", plan.name},
            {"machine", plan.machine.name},
            {"material", plan.material.name},
            {"gap_mm", plan.material.dashes.gap_mm},
            {"folds", fold_mode_name(plan.folds)},
            {"snap_mm", plan.snap_mm},
            {"sheets", Json::array()},
            {"warnings", plan.warnings},
            {"seed", plan.seed}};
  for (std::size_t i = 0; i < plan.sheets.size(); ++i)
    json["sheets"].push_back(sheet_json(plan.sheets[i], i + 1));
  std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  std::size_t from = text.find("\"sheets\": [");
  for (const PlannedSheet& sheet : plan.sheets) {
    const KnifeMarks marks = knife_marks(sheet.path, sheet.knife);
    fill_list(text, from, "overcuts", entries(marks.overcuts));
    fill_list(text, from, "lead_ins", entries(marks.lead_ins));
    from = text.find("\"lead_ins\"", from) + 1;
  }
  return text;
}

}  // namespace popcut
