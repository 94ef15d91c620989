// SPDX-License-Identifier: MIT
#include "daemon/store/plan_table.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "daemon/model/warnings.hpp"

namespace popcut::daemon {
namespace {

#define POPCUT_PLAN_COLUMNS                                                                    \
  "state, warnings, id, key, kind, design, material, machine, sha256, sheets, paths, cut_mm, " \
  "low_s, high_s, width_mm, length_mm, error, options, machine_json, material_json, created, " \
  "begun, planner"
#define POPCUT_SHEET_COLUMNS                                                                 \
  "number, paths, cut_mm, fold_mm, travel_mm, seconds, low_s, high_s, width_mm, length_mm, " \
  "program_sha256, index_sha256, mat, side"

constexpr std::array<std::string_view, 3> kStates{"pending", "planned", "failed"};

// The members in the order of the columns, without the state and the warnings.
template <typename Row>
auto plan_values(Row& row) {
  return std::tie(row.id, row.key, row.kind, row.design, row.material, row.machine, row.sha256,
                  row.sheets, row.paths, row.cut_mm, row.low_s, row.high_s, row.width_mm,
                  row.length_mm, row.error, row.options, row.machine_json, row.material_json,
                  row.created, row.begun, row.planner);
}

PlanRow plan_row(const Rows& rows) {
  PlanRow row;
  const auto state = std::find(kStates.begin(), kStates.end(), rows.text(0));
  if (state == kStates.end()) throw StoreFault(FaultKind::Corrupt, "a plan's state is invalid");
  row.state = static_cast<PlanState>(state - kStates.begin());
  row.warnings = warnings_from_json(rows.text(1));
  rows.read(2, plan_values(row));
  return row;
}

template <typename Sheet>
auto sheet_values(Sheet& sheet) {
  return std::tie(sheet.number, sheet.paths, sheet.cut_mm, sheet.fold_mm, sheet.travel_mm,
                  sheet.seconds, sheet.seconds_range[0], sheet.seconds_range[1], sheet.area_mm[0],
                  sheet.area_mm[1], sheet.program_sha256, sheet.index_sha256, sheet.mat,
                  sheet.side);
}

SheetPlan sheet_plan(const Rows& rows) {
  SheetPlan sheet;
  rows.read(0, sheet_values(sheet));
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
  db_.insert("plan(" POPCUT_PLAN_COLUMNS ")",
             std::tuple_cat(std::tuple(name_of(row.state), warnings_json(row.warnings)),
                            plan_values(row)));
}

void PlanTable::put_sheets(std::string_view plan, std::span<const SheetPlan> sheets) {
  for (const SheetPlan& sheet : sheets)
    db_.put("plan_sheet(plan, " POPCUT_SHEET_COLUMNS ")", "plan, number",
            std::tuple_cat(std::tuple(plan), sheet_values(sheet)));
}

void PlanTable::finish(const PlanRow& row) {
  db_.run(
      "UPDATE plan SET state=?, sha256=?, sheets=?, paths=?, cut_mm=?, low_s=?, high_s=?, "
      "width_mm=?, length_mm=?, warnings=?, error=?, begun=0, planner='', planner_epoch=0 "
      "WHERE id=?",
      name_of(row.state), row.sha256, row.sheets, row.paths, row.cut_mm, row.low_s, row.high_s,
      row.width_mm, row.length_mm, warnings_json(row.warnings), row.error, row.id);
  db_.run("DELETE FROM plan_sheet WHERE plan=? AND number>?", row.id, row.sheets);
  db_.run("DELETE FROM plan_asker WHERE plan=?", row.id);
}

bool PlanTable::claim(std::string_view plan, const NodeMark& node) {
  return db_.run(
             "UPDATE plan SET begun=begun+1, planner=?, planner_epoch=? WHERE id=? AND "
             "state='pending' AND planner=''",
             node.name, node.epoch, plan) == 1;
}

void PlanTable::give_back(std::string_view plan, int begun) {
  db_.run("UPDATE plan SET begun=?, planner='', planner_epoch=0 WHERE id=?", begun, plan);
}

void PlanTable::ask(std::string_view plan, std::string_view owner) {
  db_.put("plan_asker(owner, plan)", "owner, plan", owner, plan);
}

bool PlanTable::has_asked(std::string_view plan, std::string_view owner) {
  return db_.number("SELECT EXISTS(SELECT 1 FROM plan_asker WHERE owner=? AND plan=?)", owner,
                    plan) != 0;
}

std::int64_t PlanTable::asked_by(std::string_view owner) {
  return db_.number("SELECT count(*) FROM plan_asker WHERE owner=?", owner);
}

std::optional<std::string> PlanTable::asker_after(std::string_view owner) {
  return first_of(
      db_.rows("SELECT owner FROM plan_asker WHERE owner>? ORDER BY owner LIMIT 1", owner),
      first_text);
}

std::vector<std::string> PlanTable::wanted_by(std::string_view owner, int limit) {
  std::vector<std::string> plans = all_of(
      db_.rows("SELECT job.plan FROM job JOIN plan ON plan.id=job.plan WHERE job.owner=? "
               "AND job.state='queued' AND plan.state='pending' AND plan.planner='' ORDER BY "
               "job.priority "
               "DESC, job.position LIMIT ?",
               owner, limit),
      first_text);
  const std::vector<std::string> others = all_of(
      db_.rows("SELECT plan_asker.plan FROM plan_asker JOIN plan ON plan.id=plan_asker.plan WHERE "
               "owner=? AND plan.planner='' ORDER BY plan_asker.plan LIMIT ?",
               owner, limit),
      first_text);
  plans.insert(plans.end(), others.begin(), others.end());
  return plans;
}

std::optional<PlanRow> PlanTable::find(std::string_view id) {
  return first_of(db_.rows("SELECT " POPCUT_PLAN_COLUMNS " FROM plan WHERE id=?", id), plan_row);
}

std::optional<PlanRow> PlanTable::find_key(std::string_view key) {
  return first_of(db_.rows("SELECT " POPCUT_PLAN_COLUMNS
                           " FROM plan WHERE key=? AND state IN ('pending', 'planned')",
                           key),
                  plan_row);
}

std::vector<std::string> PlanTable::pending(int limit) {
  return all_of(
      db_.rows("SELECT id FROM plan WHERE state='pending' AND planner='' ORDER BY id LIMIT ?",
               limit),
      first_text);
}

std::vector<SheetPlan> PlanTable::sheets(std::string_view plan, int after, int limit) {
  return all_of(db_.rows("SELECT " POPCUT_SHEET_COLUMNS
                         " FROM plan_sheet WHERE plan=? AND number>? ORDER BY number LIMIT ?",
                         plan, after, limit),
                sheet_plan);
}

std::optional<SheetPlan> PlanTable::sheet(std::string_view plan, int number) {
  return first_of(
      db_.rows("SELECT " POPCUT_SHEET_COLUMNS " FROM plan_sheet WHERE plan=? AND number=?", plan,
               number),
      sheet_plan);
}

}  // namespace popcut::daemon
