// SPDX-License-Identifier: MIT
#include "daemon/store/plan_table.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

namespace popcut::daemon {
namespace {

#define POPCUT_PLAN_COLUMNS                                                                 \
  "id, key, kind, design, material, machine, state, sha256, sheets, paths, cut_mm, low_s, " \
  "high_s, width_mm, length_mm, warnings, error, options, machine_json, material_json, created"
#define POPCUT_SHEET_COLUMNS                                                                 \
  "number, paths, cut_mm, fold_mm, travel_mm, seconds, low_s, high_s, width_mm, length_mm, " \
  "program_sha256"

constexpr std::array<std::string_view, 3> kStates{"pending", "planned", "failed"};

std::optional<PlanRow> first_plan(Rows rows) {
  if (!rows.next()) return std::nullopt;
  int at = 0;
  PlanRow row;
  for (std::string* field :
       {&row.id, &row.key, &row.kind, &row.design, &row.material, &row.machine})
    *field = rows.text(at++);
  const auto state = std::find(kStates.begin(), kStates.end(), rows.text(at++));
  if (state == kStates.end()) throw StoreFault(FaultKind::Corrupt, "a plan's state is invalid");
  row.state = static_cast<PlanState>(state - kStates.begin());
  row.sha256 = rows.text(at++);
  row.sheets = rows.small(at++);
  row.paths = rows.integer(at++);
  for (double* field : {&row.cut_mm, &row.low_s, &row.high_s, &row.width_mm, &row.length_mm})
    *field = rows.real(at++);
  row.warnings = list_from_json(rows.text(at++));
  for (std::string* field : {&row.error, &row.options, &row.machine_json, &row.material_json})
    *field = rows.text(at++);
  row.created = rows.integer(at++);
  return row;
}

SheetPlan sheet_plan(const Rows& rows) {
  SheetPlan sheet;
  sheet.number = rows.small(0);
  sheet.paths = rows.small(1);
  sheet.cut_mm = rows.real(2);
  sheet.fold_mm = rows.real(3);
  sheet.travel_mm = rows.real(4);
  sheet.seconds = rows.real(5);
  sheet.seconds_range = {rows.real(6), rows.real(7)};
  sheet.area_mm = {rows.real(8), rows.real(9)};
  sheet.program_sha256 = rows.text(10);
  return sheet;
}

}  // namespace

std::string_view name_of(PlanState state) { return kStates.at(static_cast<std::size_t>(state)); }

std::string json_list(const std::vector<std::string>& texts) {
  return nlohmann::json(texts).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<std::string> list_from_json(const std::string& json) {
  std::vector<std::string> texts;
  const nlohmann::json list = nlohmann::json::parse(json, nullptr, false);
  if (!list.is_array()) throw StoreFault(FaultKind::Corrupt, "a stored list is invalid");
  for (const nlohmann::json& one : list) {
    if (!one.is_string())
      throw StoreFault(FaultKind::Corrupt, "a stored list contains an item that is not a string");
    texts.push_back(one.get<std::string>());
  }
  return texts;
}

void PlanTable::insert(const PlanRow& row) {
  db_.run("INSERT INTO plan(" POPCUT_PLAN_COLUMNS
          ") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
          row.id, row.key, row.kind, row.design, row.material, row.machine, name_of(row.state),
          row.sha256, row.sheets, row.paths, row.cut_mm, row.low_s, row.high_s, row.width_mm,
          row.length_mm, json_list(row.warnings), row.error, row.options, row.machine_json,
          row.material_json, row.created);
}

void PlanTable::finish(const PlanRow& row, const std::vector<SheetPlan>& sheets) {
  db_.run(
      "UPDATE plan SET state=?, sha256=?, sheets=?, paths=?, cut_mm=?, low_s=?, high_s=?, "
      "width_mm=?, length_mm=?, warnings=?, error=? WHERE id=?",
      name_of(row.state), row.sha256, row.sheets, row.paths, row.cut_mm, row.low_s, row.high_s,
      row.width_mm, row.length_mm, json_list(row.warnings), row.error, row.id);
  for (const SheetPlan& sheet : sheets)
    db_.run("INSERT INTO plan_sheet(plan, " POPCUT_SHEET_COLUMNS
            ") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            row.id, sheet.number, sheet.paths, sheet.cut_mm, sheet.fold_mm, sheet.travel_mm,
            sheet.seconds, sheet.seconds_range[0], sheet.seconds_range[1], sheet.area_mm[0],
            sheet.area_mm[1], sheet.program_sha256);
}

std::optional<PlanRow> PlanTable::find(std::string_view id) {
  return first_plan(db_.rows("SELECT " POPCUT_PLAN_COLUMNS " FROM plan WHERE id=?", id));
}

std::optional<PlanRow> PlanTable::find_key(std::string_view key) {
  return first_plan(db_.rows("SELECT " POPCUT_PLAN_COLUMNS
                             " FROM plan WHERE key=? AND state IN ('pending', 'planned')",
                             key));
}

std::vector<std::string> PlanTable::pending(int limit) {
  std::vector<std::string> ids;
  Rows rows = db_.rows("SELECT id FROM plan WHERE state='pending' ORDER BY id LIMIT ?", limit);
  while (rows.next()) ids.push_back(rows.text(0));
  return ids;
}

std::vector<SheetPlan> PlanTable::sheets(std::string_view plan) {
  std::vector<SheetPlan> all;
  Rows rows = db_.rows(
      "SELECT " POPCUT_SHEET_COLUMNS " FROM plan_sheet WHERE plan=? ORDER BY number", plan);
  while (rows.next()) all.push_back(sheet_plan(rows));
  return all;
}

std::optional<SheetPlan> PlanTable::sheet(std::string_view plan, int number) {
  Rows rows = db_.rows("SELECT " POPCUT_SHEET_COLUMNS " FROM plan_sheet WHERE plan=? AND number=?",
                       plan, number);
  if (!rows.next()) return std::nullopt;
  return sheet_plan(rows);
}

}  // namespace popcut::daemon
