// SPDX-License-Identifier: MIT
// Part of core/machines/machine.hpp.
#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "core/machines/machine.hpp"
#include "core/machines/table.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/near_names.hpp"

namespace popcut {
namespace {

DashShape read_dashes(FieldReader& fields) {
  DashShape dashes;
  dashes.dash_mm = fields.number("dash_mm", {}, 0.05, 100.0);
  dashes.gap_mm = fields.number("gap_mm", {}, 0.05, 100.0);
  dashes.clearance_mm = fields.number("clearance_mm", {}, 0.0, 100.0);
  dashes.min_dash_mm = fields.number("min_dash_mm", {}, 0.01, dashes.dash_mm);
  return dashes;
}

ToolSettings read_tool(FieldReader& fields, ToolTip usual) {
  ToolSettings tool;
  tool.tool = fields.integer("tool", {}, 1, 8);
  tool.force_gf = fields.number("force_gf", {}, 0.0, 10'000.0);
  tool.speed_mm_s = fields.number("speed_mm_s", {}, 0.1, 10'000.0);
  tool.passes = fields.integer("passes", {}, 1, 20);
  tool.force_step_gf = fields.number("force_step_gf", 0.0, -10'000.0, 10'000.0);
  tool.tip = static_cast<ToolTip>(
      fields.word("tip", static_cast<std::size_t>(usual), {"blade", "pen", "stylus"}));
  return tool;
}

std::optional<ToolSettings> read_optional_tool(FieldReader& fields, const char* name,
                                               ToolTip usual) {
  const nlohmann::json* given = fields.value(name);
  if (given == nullptr || given->is_null()) return std::nullopt;
  std::optional<ToolSettings> tool;
  fields.object(name, [&](FieldReader& inner) { tool = read_tool(inner, usual); });
  return tool;
}

void read_folds(FieldReader& fields, Material& material) {
  material.folds = static_cast<FoldMode>(fields.word("folds", 0, {"perforate", "score", "light"}));
  const bool missing = (material.folds == FoldMode::Score && !material.score) ||
                       (material.folds == FoldMode::Light && !material.light);
  if (missing)
    fields.refuse("folds", ErrorKind::Malformed,
                  fmt::format("is {0}, but this material has no settings \"{0}\"; add them",
                              fold_mode_name(material.folds)));
}

TabShape read_tabs(FieldReader& fields) {
  constexpr double kDegree = 0.017453292519943295;
  TabShape tabs;
  tabs.depth_mm = fields.number("depth_mm", tabs.depth_mm, 0.5, 200.0);
  tabs.min_depth_mm =
      fields.number("min_depth_mm", std::min(tabs.min_depth_mm, tabs.depth_mm), 0.2, tabs.depth_mm);
  tabs.side_rad = kDegree * fields.number("side_deg", tabs.side_rad / kDegree, 20.0, 89.9);
  tabs.pitch_mm = fields.number("pitch_mm", tabs.pitch_mm, 5.0, 10'000.0);
  tabs.clearance_mm = fields.number("clearance_mm", tabs.clearance_mm, 0.0, tabs.pitch_mm / 4);
  tabs.min_root_mm = fields.number("min_root_mm", tabs.min_root_mm, 0.2, tabs.pitch_mm / 4);
  return tabs;
}

Result<Material> read_material(const TableRow& row) {
  Material material;
  FieldReader fields(row.row, row.pointer);
  material.name = fields.text("name", {});
  material.title = fields.text("title", {});
  fields.value("source");
  material.thickness_mm = fields.number("thickness_mm", {}, 0.001, 20.0);
  fields.object("dashes", [&](FieldReader& inner) { material.dashes = read_dashes(inner); });
  const auto read_blade = [](FieldReader& inner) { return read_tool(inner, ToolTip::Blade); };
  fields.object("cut", [&](FieldReader& inner) { material.cut = read_blade(inner); });
  fields.object("fold", [&](FieldReader& inner) { material.fold = read_blade(inner); });
  fields.object("draw",
                [&](FieldReader& inner) { material.draw = read_tool(inner, ToolTip::Pen); });
  material.score = read_optional_tool(fields, "score", ToolTip::Stylus);
  material.light = read_optional_tool(fields, "light", ToolTip::Blade);
  read_folds(fields, material);
  material.overcut_mm = fields.number("overcut_mm", 0.5, 0.0, 10.0);
  material.swivel_above_deg = fields.number("swivel_above_deg", 15.0, 1.0, 90.0);
  material.blade_offset_mm = fields.number("blade_offset_mm", {}, 0.0, 5.0);
  material.autoblade_depth = fields.integer("autoblade_depth", {}, 0, 10);
  fields.optional_object("tabs", [&](FieldReader& inner) { material.tabs = read_tabs(inner); });
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
  return material;
}

}  // namespace

double host_blade_offset_mm(const Machine& machine, const Material& material) {
  if (machine.firmware_blade_offset) return 0.0;
  return machine.blade_offset_mm > 0.0 ? machine.blade_offset_mm : material.blade_offset_mm;
}

const char* fold_mode_name(FoldMode mode) {
  constexpr std::array kNames{"perforate", "score", "light"};
  return kNames[static_cast<std::size_t>(mode)];
}

Result<std::vector<Material>> all_materials(const std::vector<std::string>& user_tables) {
  return table_values("materials", kMaterialsJson, user_tables, read_material);
}

Result<Material> find_material(std::string_view name, const std::vector<std::string>& user_tables) {
  return value_named(name, all_materials(user_tables), "material");
}

}  // namespace popcut
