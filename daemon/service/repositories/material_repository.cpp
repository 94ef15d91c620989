// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/material_repository.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "core/machines/table.hpp"
#include "core/text/json_text.hpp"
#include "core/text/near_names.hpp"
#include "daemon/model/input_limits.hpp"

namespace popcut::daemon {
namespace {

std::map<std::string, std::string> rows_of(std::string_view list, std::string_view built_in,
                                           const std::vector<std::string>& tables) {
  std::map<std::string, std::string> rows;
  if (const auto found = table_rows(list, built_in, tables))
    for (const TableRow& row : *found) rows[row.name] = row.row.dump();
  return rows;
}

std::vector<std::string> names_of(const std::map<std::string, std::string>& rows) {
  std::vector<std::string> names;
  names.reserve(rows.size());
  for (const auto& [name, row] : rows) names.push_back(name);
  return names;
}

Problem stale(std::int64_t rev) {
  Problem problem{ProblemKind::Stale, "the material has changed; read it again"};
  problem.rev = rev;
  return problem;
}

// The complete row, if `json` describes a material.
Answer<std::string> checked_row(const std::string& id, const std::string& json,
                                const std::vector<std::string>& tables) {
  auto parsed = parse_json(json, 32);
  if (!parsed) return tl::unexpected(problem_from(parsed.error()));
  if (!parsed->is_object())
    return refuse_value("", "type", "must be an object", "a material must be a JSON object");
  nlohmann::json row = std::move(*parsed);
  if (row.contains("name") && row["name"] != id)
    return refuse_value("/name", "value", fmt::format("must be {:?} or absent", id),
                        "the name differs from the one in the path");
  row["name"] = id;
  nlohmann::json table;
  table["popcut"] = 1;
  table["materials"] = nlohmann::json::array({row});
  std::vector<std::string> texts = tables;
  texts.push_back(table.dump());
  // The request has a row and no table, so an error gets its place in the row.
  const std::string in_table = fmt::format("table {}: /materials/0", texts.size());
  const auto in_row = [&](Error error) {
    if (error.place.starts_with(in_table)) error.place.erase(0, in_table.size());
    return tl::unexpected(problem_from(error));
  };
  if (const auto found = find_material(id, texts); !found) return in_row(found.error());
  const auto rows = table_rows("materials", kMaterialsJson, texts);
  if (!rows) return in_row(rows.error());
  for (const TableRow& one : *rows)
    if (one.name == id) row = one.row;
  return row.dump();
}

}  // namespace

void MaterialRepository::load_tables() {
  if (loaded_) return;
  materials_ = rows_of("materials", kMaterialsJson, options_.tables);
  machines_ = rows_of("machines", kMachinesJson, options_.tables);
  if (const auto found = table_rows("svg_profiles", kSvgProfilesJson, options_.tables))
    for (const TableRow& row : *found)
      if (row.table >= 0) profiles_[row.name] = row.row.dump();
  loaded_ = true;
}

const std::map<std::string, std::string>& MaterialRepository::materials() {
  load_tables();
  return materials_;
}

// A deleted row stays with an empty `json`, so that its revisions are not used again. Otherwise an
// old ETag would match a new row.
std::optional<MaterialRecord> MaterialRepository::stored(const std::string& id) {
  Rows rows = store_.db().rows("SELECT rev, json FROM material WHERE id=? AND json!=''", id);
  if (!rows.next()) return std::nullopt;
  return MaterialRecord{.id = id, .rev = rows.integer(0), .json = rows.text(1), .built_in = false};
}

std::vector<MaterialRecord> MaterialRepository::list() {
  std::map<std::string, MaterialRecord> all;
  for (const auto& [id, json] : materials())
    all[id] = {.id = id, .rev = 1, .json = json, .built_in = true};
  Rows rows = store_.db().rows("SELECT id, rev, json FROM material WHERE json!='' ORDER BY id");
  while (rows.next())
    all[rows.text(0)] = {
        .id = rows.text(0), .rev = rows.integer(1), .json = rows.text(2), .built_in = false};
  std::vector<MaterialRecord> list;
  list.reserve(all.size());
  for (auto& [id, record] : all) list.push_back(std::move(record));
  return list;
}

Answer<MaterialRecord> MaterialRepository::find(const std::string& id) {
  return store_.read([&]() -> Answer<MaterialRecord> {
    if (const auto own = stored(id)) return *own;
    const auto found = materials().find(id);
    if (found == materials().end())
      return refuse(ProblemKind::NotFound, fmt::format("there is no material {:?}; {}", id,
                                                       suggestion(id, names_of(materials()))));
    return MaterialRecord{.id = id, .rev = 1, .json = found->second, .built_in = true};
  });
}

Answer<MaterialRecord> MaterialRepository::put(const Principal& who, const std::string& id,
                                               std::int64_t if_match, const std::string& json) {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "only an admin may change materials");
  if (!is_material_id(id))
    return refuse_value(
        "/name", "format",
        fmt::format("must be 1 to {} characters of a-z 0-9 - _ .", kMaterialIdLimit.characters),
        "the material's name is not valid");
  return store_.change([&]() -> Answer<MaterialRecord> {
    const Answer<MaterialRecord> before = find(id);
    if (before && if_match != before->rev) return tl::unexpected(stale(before->rev));
    if (!before && if_match != 0)
      return refuse(ProblemKind::NotFound, fmt::format("there is no material {:?} to change", id));
    Answer<std::string> row = checked_row(id, json, options_.tables);
    if (!row) return tl::unexpected(row.error());
    const std::int64_t last = std::max(
        before ? before->rev : 0, store_.db().number("SELECT rev FROM material WHERE id=?", id));
    const MaterialRecord record{
        .id = id, .rev = last + 1, .json = std::move(*row), .built_in = false};
    store_.db().put("material(id, rev, json)", "id", id, record.rev, record.json);
    store_.audit(who.name, "put-material", id, "");
    return record;
  });
}

Answer<void> MaterialRepository::remove(const Principal& who, const std::string& id,
                                        std::int64_t if_match) {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "only an admin may change materials");
  return store_.change([&]() -> Answer<void> {
    const Answer<MaterialRecord> before = find(id);
    if (!before) return tl::unexpected(before.error());
    if (before->built_in)
      return refuse(ProblemKind::StateConflict,
                    id + " is built in and cannot be deleted; change it with PUT");
    if (before->rev != if_match) return tl::unexpected(stale(before->rev));
    store_.db().run("UPDATE material SET json='' WHERE id=?", id);
    store_.audit(who.name, "delete-material", id, "");
    return {};
  });
}

std::string MaterialRepository::profile_row(const std::string& name) {
  load_tables();
  const auto found = profiles_.find(name);
  return found == profiles_.end() ? std::string() : found->second;
}

Answer<std::string> MaterialRepository::machine_row(const std::string& name) {
  load_tables();
  const auto found = machines_.find(name);
  if (found != machines_.end()) return found->second;
  const std::string advice = suggestion(name, names_of(machines_));
  return tl::unexpected(Problem{ProblemKind::Validation,
                                fmt::format("there is no machine {:?}; {}", name, advice),
                                {{"/machine", "unknown", advice}}});
}

}  // namespace popcut::daemon
