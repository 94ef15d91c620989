// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

namespace popcut::testing {

/// SQL that makes the tables of the newest version those of an earlier one (2 to 8) again.
[[nodiscard]] inline std::string back_to(int version) {
  static const std::map<int, const char*> undo{
      {9, "DROP TABLE search;"},
      {8, "ALTER TABLE device DROP COLUMN site; ALTER TABLE job DROP COLUMN site;"},
      {7,
       "ALTER TABLE device DROP COLUMN node; ALTER TABLE device DROP COLUMN machine;"
       "ALTER TABLE device DROP COLUMN materials; ALTER TABLE device DROP COLUMN reasons;"
       "ALTER TABLE device DROP COLUMN firmware;"
       "ALTER TABLE arm DROP COLUMN node; ALTER TABLE arm DROP COLUMN epoch;"
       "ALTER TABLE attempt DROP COLUMN node; ALTER TABLE attempt DROP COLUMN epoch;"
       "ALTER TABLE attempt DROP COLUMN fence; ALTER TABLE attempt DROP COLUMN identity;"
       "ALTER TABLE plan DROP COLUMN planner; ALTER TABLE plan DROP COLUMN planner_epoch;"},
      {6, "ALTER TABLE session DROP COLUMN name; ALTER TABLE session DROP COLUMN most;"},
      {5,
       "ALTER TABLE job DROP COLUMN warnings; ALTER TABLE job DROP COLUMN unaccepted;"
       "ALTER TABLE job DROP COLUMN load; ALTER TABLE plan_sheet DROP COLUMN mat;"
       "ALTER TABLE plan_sheet DROP COLUMN side;"},
      {4,
       "DROP TRIGGER end_tally_insert; DROP TRIGGER end_tally_update; DROP TABLE end_tally;"
       "DROP INDEX job_waiting_of; DROP INDEX job_open_of; DROP TABLE plan_asker;"
       "ALTER TABLE plan DROP COLUMN begun;"},
      {3, "ALTER TABLE plan_sheet DROP COLUMN index_sha256;"},
  };
  std::string sql;
  for (auto step = undo.rbegin(); step != undo.rend() && step->first > version; ++step)
    sql += step->second;
  return sql + "PRAGMA user_version=" + std::to_string(version) + ";";
}

}  // namespace popcut::testing
