// SPDX-License-Identifier: MIT
#include "daemon/store/schema.hpp"

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// What SQLite needs beside the shared tables. A fleet has the same triggers in
// daemon/fleet/schema.sql.
constexpr std::string_view kTriggers = R"sql(
-- Terminal states never change.
CREATE TRIGGER job_ended BEFORE UPDATE OF state, outcome, finished, started, sheet, blank, segment
  ON job WHEN old.state IN ('done', 'failed', 'cancelled')
  BEGIN SELECT RAISE(ABORT, 'the job has ended'); END;
CREATE TRIGGER job_kept BEFORE DELETE ON job
  BEGIN SELECT RAISE(ABORT, 'jobs are never deleted'); END;

CREATE TRIGGER asset_use_insert AFTER INSERT ON design BEGIN
  INSERT OR IGNORE INTO asset_use(asset, design)
    SELECT each.value, new.id FROM json_each(new.assets) AS each; END;

-- How many jobs each state has, so that nobody has to count them.
CREATE TABLE tally(state TEXT PRIMARY KEY, jobs INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TRIGGER tally_insert AFTER INSERT ON job BEGIN
  INSERT INTO tally(state, jobs) VALUES(new.state, 1)
    ON CONFLICT(state) DO UPDATE SET jobs = jobs + 1; END;
CREATE TRIGGER tally_update AFTER UPDATE OF state ON job WHEN old.state != new.state BEGIN
  UPDATE tally SET jobs = jobs - 1 WHERE state = old.state;
  INSERT INTO tally(state, jobs) VALUES(new.state, 1)
    ON CONFLICT(state) DO UPDATE SET jobs = jobs + 1; END;

-- How attempts ended, by cutter.
CREATE TABLE end_tally(
  device TEXT NOT NULL, end_kind TEXT NOT NULL, attempts INTEGER NOT NULL,
  PRIMARY KEY(device, end_kind)) STRICT, WITHOUT ROWID;
CREATE TRIGGER end_tally_insert AFTER INSERT ON attempt WHEN new.ended IS NOT NULL BEGIN
  INSERT INTO end_tally(device, end_kind, attempts) VALUES(new.device, new.end_kind, 1)
    ON CONFLICT(device, end_kind) DO UPDATE SET attempts = attempts + 1; END;
CREATE TRIGGER end_tally_update AFTER UPDATE OF ended ON attempt
  WHEN old.ended IS NULL AND new.ended IS NOT NULL BEGIN
  INSERT INTO end_tally(device, end_kind, attempts) VALUES(new.device, new.end_kind, 1)
    ON CONFLICT(device, end_kind) DO UPDATE SET attempts = attempts + 1; END;
)sql";

}  // namespace

void build_schema(Database& database) {
  Transaction all(database);
  database.script(std::string(shared_tables()));
  database.script(std::string(kTriggers));
  database.script(fmt::format("PRAGMA application_id={}; PRAGMA user_version={};", kApplicationId,
                              kSchemaVersion));
  all.commit();
}

int schema_version(Database& database) {
  return static_cast<int>(database.number("PRAGMA user_version"));
}

std::string version_misfit(int version, const std::string& state) {
  if (version == kSchemaVersion) return {};
  if (version >= kOldestSalvaged && version < kSchemaVersion && !state.empty())
    return fmt::format(
        "was written by an older popcutd (schema {}, this version uses schema {}); bring its jobs "
        "into this version with 'popcut db salvage --state {}', which keeps the old database",
        version, kSchemaVersion, state);
  return fmt::format(
      "was written by another version of popcutd (schema {}, this version uses schema {}); install "
      "that version, or use another state folder to start with an empty queue",
      version, kSchemaVersion);
}

const std::vector<std::string_view>& table_names() {
  static const std::vector<std::string_view> names{
      "asset",   "design",   "plan",   "plan_sheet", "plan_asker", "job",    "sheet",
      "arm",     "attempt",  "chunk",  "event",      "idem",       "audit",  "token",
      "session", "material", "device", "usage",      "calendar",   "search", "ownership"};
  return names;
}

}  // namespace popcut::daemon
