// SPDX-License-Identifier: MIT
#include "daemon/store/plan_table.hpp"

#include <fmt/format.h>

#include "daemon/model/json_leaves.hpp"
#include "daemon/model/json_object.hpp"
#include "daemon/store/columns.hpp"

namespace popcut::daemon {
template <typename See>
void list_fields(const PlanRow*, See&& see) {
  see("id", &PlanRow::id, kFixed);
  see("key", &PlanRow::key, kFixed);
  see("kind", &PlanRow::kind, kFixed);
  see("design", &PlanRow::design, kFixed);
  see("material", &PlanRow::material, kFixed);
  see("machine", &PlanRow::machine, kFixed);
  see("state", &PlanRow::state);
  see("sha256", &PlanRow::sha256);
  see("sheets", &PlanRow::sheets);
  see("paths", &PlanRow::paths);
  see("cut_mm", &PlanRow::cut_mm);
  see("low_s", &PlanRow::low_s);
  see("high_s", &PlanRow::high_s);
  see("width_mm", &PlanRow::width_mm);
  see("length_mm", &PlanRow::length_mm);
  see("warnings", &PlanRow::warnings);
  see("error", &PlanRow::error);
  see("options", &PlanRow::options, kFixed);
  see("machine_json", &PlanRow::machine_json, kFixed);
  see("material_json", &PlanRow::material_json, kFixed);
  see("created", &PlanRow::created, kFixed);
  see("begun", &PlanRow::begun);
  see("planner", &PlanRow::planner);
  see("handwork", &PlanRow::handwork);
}

namespace {

// "SELECT id, key, ... FROM plan WHERE " and the rest.
std::string select_plan(std::string_view rest) {
  return fmt::format("SELECT {} FROM plan WHERE {}", column_names<PlanRow>(), rest);
}
std::string select_sheet(std::string_view rest) {
  return fmt::format("SELECT {} FROM plan_sheet WHERE {}", column_names<SheetPlan>(), rest);
}

}  // namespace

std::string json_list(const std::vector<std::string>& texts) {
  std::string out = "[";
  for (const std::string& text : texts) out += (out.size() > 1 ? "," : "") + json_text(text);
  return out + ']';
}

std::vector<std::string> list_from_json(const std::string& json) {
  std::vector<std::string> texts;
  bool only_texts = true;
  const bool whole = each_json_leaf(json, [&](const JsonLeaf& leaf) {
    only_texts = only_texts && leaf.depth == 1 && leaf.name.empty() && leaf.text;
    if (leaf.text) texts.emplace_back(*leaf.text);
  });
  if (!whole || !json.starts_with('['))
    throw StoreFault(FaultKind::Corrupt, "a stored list is invalid");
  if (!only_texts)
    throw StoreFault(FaultKind::Corrupt, "a stored list contains an item that is not a string");
  return texts;
}

void PlanTable::insert(const PlanRow& row) {
  static const std::string into = "plan(" + column_names<PlanRow>() + ")";
  ColumnValues values;
  put_row(values, row);
  db_.insert_list(into, values.all());
}

void PlanTable::put_sheets(std::string_view plan, std::span<const SheetPlan> sheets) {
  static const std::string into = "plan_sheet(plan, " + column_names<SheetPlan>() + ")";
  for (const SheetPlan& sheet : sheets) {
    ColumnValues values;
    values.put(plan);
    put_row(values, sheet);
    db_.put_list(into, "plan, sheet", values.all());
  }
}

void PlanTable::finish(const PlanRow& row) {
  static const std::string sql = fmt::format("UPDATE plan SET planner_epoch=0, {} WHERE id=?",
                                             column_names<PlanRow>(false, "=?"));
  PlanRow done = row;
  done.begun = 0;
  done.planner.clear();
  ColumnValues values;
  put_row(values, done, false);
  values.put(row.id);
  db_.run_list(sql, values.all());
  db_.run("DELETE FROM plan_sheet WHERE plan=? AND sheet>?", row.id, row.sheets);
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

void PlanTable::unask(std::string_view plan, std::string_view owner) {
  db_.run("DELETE FROM plan_asker WHERE owner=? AND plan=?", owner, plan);
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
  static const std::string sql = select_plan("id=?");
  return first_of(db_.rows(sql, id), read_row<PlanRow>);
}

std::optional<PlanRow> PlanTable::find_key(std::string_view key) {
  static const std::string sql = select_plan("key=? AND state IN ('pending', 'planned')");
  return first_of(db_.rows(sql, key), read_row<PlanRow>);
}

std::vector<std::string> PlanTable::pending(int limit) {
  return all_of(
      db_.rows("SELECT id FROM plan WHERE state='pending' AND planner='' ORDER BY id LIMIT ?",
               limit),
      first_text);
}

std::vector<SheetPlan> PlanTable::sheets(std::string_view plan, int after, int limit) {
  static const std::string sql = select_sheet("plan=? AND sheet>? ORDER BY sheet LIMIT ?");
  return all_of(db_.rows(sql, plan, after, limit), read_row<SheetPlan>);
}

std::optional<SheetPlan> PlanTable::sheet(std::string_view plan, int number) {
  static const std::string sql = select_sheet("plan=? AND sheet=?");
  return first_of(db_.rows(sql, plan, number), read_row<SheetPlan>);
}

}  // namespace popcut::daemon
