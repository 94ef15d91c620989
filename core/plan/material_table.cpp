// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/plan/json_fields.hpp"
#include "core/plan/machine.hpp"
#include "core/plan/near_names.hpp"
#include "core/plan/table.hpp"
#include "core/plan/tables.hpp"

namespace popcut {
namespace {

DashShape read_dashes(const nlohmann::json& json, std::string pointer,
                      std::optional<Error>& fault) {
  DashShape dashes;
  JsonFields fields(json, std::move(pointer), fault);
  fields.number("dash_mm", dashes.dash_mm, 0.05, 100.0);
  fields.number("gap_mm", dashes.gap_mm, 0.05, 100.0);
  fields.number("clearance_mm", dashes.clearance_mm, 0.0, 100.0);
  fields.number("min_dash_mm", dashes.min_dash_mm, 0.01, dashes.dash_mm);
  fields.nothing_else();
  return dashes;
}

ToolSettings read_tool(const nlohmann::json& json, std::string pointer,
                       std::optional<Error>& fault) {
  ToolSettings tool;
  JsonFields fields(json, std::move(pointer), fault);
  fields.whole("tool", tool.tool, 1, 8);
  fields.number("force_gf", tool.force_gf, 0.0, 10'000.0);
  fields.number("speed_mm_s", tool.speed_mm_s, 0.1, 10'000.0);
  fields.whole("passes", tool.passes, 1, 20);
  fields.nothing_else();
  return tool;
}

Result<Material> read_material(const TableRow& row) {
  Material material;
  std::optional<Error> fault;
  JsonFields fields(row.row, row.pointer, fault);
  fields.text("name", material.name);
  fields.text("title", material.title);
  fields.also("source");
  fields.number("thickness_mm", material.thickness_mm, 0.001, 20.0);
  if (const auto* dashes = fields.object("dashes"))
    material.dashes = read_dashes(*dashes, fields.at("dashes"), fault);
  if (const auto* tool = fields.object("cut"))
    material.cut = read_tool(*tool, fields.at("cut"), fault);
  if (const auto* tool = fields.object("fold"))
    material.fold = read_tool(*tool, fields.at("fold"), fault);
  if (const auto* tool = fields.object("draw"))
    material.draw = read_tool(*tool, fields.at("draw"), fault);
  fields.number("blade_offset_mm", material.blade_offset_mm, 0.0, 5.0);
  fields.whole("autoblade_depth", material.autoblade_depth, 0, 10);
  fields.nothing_else();
  if (fault) return tl::unexpected(in_table(row, *fault));
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
