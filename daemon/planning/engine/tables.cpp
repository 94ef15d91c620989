// SPDX-License-Identifier: MIT
#include "daemon/planning/engine/tables.hpp"

#include <string_view>

#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "core/machines/table.hpp"
#include "core/plan/machine_choice.hpp"
#include "core/text/json_text.hpp"

namespace popcut::planning {
namespace {

Result<nlohmann::ordered_json> named_rows(std::string_view list, std::string_view text) {
  const auto rows = table_rows(list, text, {});
  if (!rows) return tl::unexpected(rows.error());
  auto out = nlohmann::ordered_json::object();
  for (const TableRow& row : *rows) out[row.name] = row.row;
  return out;
}

}  // namespace

Result<std::string> tables_text() {
  const auto all = all_machines();
  if (!all) return tl::unexpected(all.error());
  const auto machines = named_rows("machines", kMachinesJson);
  if (!machines) return tl::unexpected(machines.error());
  const auto materials = named_rows("materials", kMaterialsJson);
  if (!materials) return tl::unexpected(materials.error());
  auto choices = nlohmann::ordered_json::array();
  for (const Machine& machine : *all) choices.push_back(machine_choice(machine));
  return json_line(nlohmann::ordered_json{
      {"machines", choices}, {"rows", {{"machines", *machines}, {"materials", *materials}}}});
}

}  // namespace popcut::planning
