// SPDX-License-Identifier: MIT
#include <optional>

#include <fmt/format.h>

#include "core/json_fields.hpp"
#include "core/plan/machine.hpp"
#include "core/plan/near_names.hpp"
#include "core/plan/read_object.hpp"
#include "core/plan/table.hpp"
#include "core/plan/tables.hpp"

namespace popcut {
namespace {

DashShape read_dashes(JsonFields& fields) {
  DashShape dashes;
  dashes.dash_mm = fields.number("dash_mm", {}, 0.05, 100.0);
  dashes.gap_mm = fields.number("gap_mm", {}, 0.05, 100.0);
  dashes.clearance_mm = fields.number("clearance_mm", {}, 0.0, 100.0);
  dashes.min_dash_mm = fields.number("min_dash_mm", {}, 0.01, dashes.dash_mm);
  return dashes;
}

ToolSettings read_tool(JsonFields& fields) {
  ToolSettings tool;
  tool.tool = fields.integer("tool", {}, 1, 8);
  tool.force_gf = fields.number("force_gf", {}, 0.0, 10'000.0);
  tool.speed_mm_s = fields.number("speed_mm_s", {}, 0.1, 10'000.0);
  tool.passes = fields.integer("passes", {}, 1, 20);
  return tool;
}

Result<Material> read_material(const TableRow& row) {
  Material material;
  JsonFields fields(row.row, row.pointer);
  material.name = fields.text("name", {});
  material.title = fields.text("title", {});
  fields.value("source");
  material.thickness_mm = fields.number("thickness_mm", {}, 0.001, 20.0);
  read_object(fields, "dashes", material.dashes, read_dashes);
  read_object(fields, "cut", material.cut, read_tool);
  read_object(fields, "fold", material.fold, read_tool);
  read_object(fields, "draw", material.draw, read_tool);
  material.blade_offset_mm = fields.number("blade_offset_mm", {}, 0.0, 5.0);
  material.autoblade_depth = fields.integer("autoblade_depth", {}, 0, 10);
  if (const auto whole = fields.finish(); !whole)
    return tl::unexpected(in_table(row, whole.error()));
  return material;
}

}  // namespace

Result<std::vector<Material>> all_materials(const std::vector<std::string>& user_tables) {
  const auto rows = table_rows("materials", kMaterialsJson, user_tables);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Material> materials;
  for (const TableRow& row : *rows) {
    auto material = read_material(row);
    if (!material) return tl::unexpected(material.error());
    materials.push_back(std::move(*material));
  }
  return materials;
}

Result<Material> find_material(std::string_view name, const std::vector<std::string>& user_tables) {
  auto materials = all_materials(user_tables);
  if (!materials) return tl::unexpected(materials.error());
  std::vector<std::string> names;
  for (Material& material : *materials) {
    if (material.name == name) return std::move(material);
    names.push_back(material.name);
  }
  return fail(
      ErrorKind::OutOfRange, "",
      fmt::format("no material is called {}; {}", name.substr(0, 80), suggestion(name, names)));
}

}  // namespace popcut
