// SPDX-License-Identifier: MIT
#include "daemon/store/schema.hpp"

#include <string>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// Times are milliseconds since 1970; ids are ULIDs; lengths are millimetres.
constexpr std::string_view kVersion1 = R"sql(
CREATE TABLE asset(
  id TEXT PRIMARY KEY CHECK(length(id) = 71),
  bytes INTEGER NOT NULL, created INTEGER NOT NULL) STRICT, WITHOUT ROWID;

CREATE TABLE design(
  id TEXT PRIMARY KEY CHECK(length(id) = 71),
  name TEXT NOT NULL, kind TEXT NOT NULL CHECK(kind IN ('spec', 'fold', 'svg', 'dxf')),
  media_type TEXT NOT NULL, owner TEXT NOT NULL, bytes INTEGER NOT NULL,
  created INTEGER NOT NULL, assets TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE INDEX design_created ON design(created, id);

-- `key` is the digest of all that decides what comes out: the same is planned once.
CREATE TABLE plan(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  key TEXT NOT NULL, kind TEXT NOT NULL CHECK(kind IN ('design', 'test')),
  design TEXT NOT NULL, material TEXT NOT NULL, machine TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('pending', 'planned', 'failed')),
  sha256 TEXT NOT NULL, sheets INTEGER NOT NULL, paths INTEGER NOT NULL, cut_mm REAL NOT NULL,
  low_s REAL NOT NULL, high_s REAL NOT NULL, width_mm REAL NOT NULL, length_mm REAL NOT NULL,
  warnings TEXT NOT NULL, error TEXT NOT NULL, options TEXT NOT NULL,
  machine_json TEXT NOT NULL, material_json TEXT NOT NULL,
  created INTEGER NOT NULL,
  CHECK(state != 'planned' OR (sheets > 0 AND length(sha256) = 64))) STRICT, WITHOUT ROWID;
CREATE UNIQUE INDEX plan_key ON plan(key) WHERE state IN ('pending', 'planned');
CREATE INDEX plan_design ON plan(design);
CREATE INDEX plan_pending ON plan(id) WHERE state = 'pending';

CREATE TABLE plan_sheet(
  plan TEXT NOT NULL REFERENCES plan(id) ON DELETE CASCADE,
  number INTEGER NOT NULL CHECK(number BETWEEN 1 AND 10000),
  paths INTEGER NOT NULL CHECK(paths >= 0), cut_mm REAL NOT NULL, fold_mm REAL NOT NULL,
  travel_mm REAL NOT NULL, seconds REAL NOT NULL, low_s REAL NOT NULL, high_s REAL NOT NULL,
  width_mm REAL NOT NULL, length_mm REAL NOT NULL,
  program_sha256 TEXT NOT NULL CHECK(length(program_sha256) = 64),
  PRIMARY KEY(plan, number)) STRICT, WITHOUT ROWID;

-- `wish` is the device that was asked for, `device` the one that the sheet lies in.
CREATE TABLE job(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  rev INTEGER NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('queued', 'planning', 'ready', 'armed', 'cutting', 'paused',
                                      'interrupted', 'done', 'failed', 'cancelled')),
  reason TEXT NOT NULL, asked TEXT NOT NULL CHECK(asked IN ('', 'pause', 'cancel')),
  name TEXT NOT NULL, note TEXT NOT NULL, owner TEXT NOT NULL, operator TEXT NOT NULL,
  wish TEXT NOT NULL, device TEXT NOT NULL, design TEXT NOT NULL,
  plan TEXT NOT NULL REFERENCES plan(id), material TEXT NOT NULL,
  priority INTEGER NOT NULL CHECK(priority BETWEEN -10 AND 10), position INTEGER NOT NULL,
  copies INTEGER NOT NULL CHECK(copies BETWEEN 1 AND 1000),
  held INTEGER NOT NULL CHECK(held IN (0, 1)),
  sheets_total INTEGER NOT NULL CHECK(sheets_total BETWEEN 0 AND 10000),
  sheet INTEGER NOT NULL CHECK(sheet BETWEEN 0 AND sheets_total),
  blank INTEGER NOT NULL CHECK(blank >= 1), segment INTEGER NOT NULL CHECK(segment >= 1),
  first_stroke INTEGER NOT NULL CHECK(first_stroke >= 0),
  paths_certain INTEGER NOT NULL, paths_sent INTEGER NOT NULL, paths_total INTEGER NOT NULL,
  done_paths INTEGER NOT NULL, done_mm REAL NOT NULL,
  low_s REAL NOT NULL, high_s REAL NOT NULL,
  created INTEGER NOT NULL, started INTEGER, finished INTEGER,
  outcome TEXT NOT NULL, tags TEXT NOT NULL,
  attention TEXT NOT NULL, attention_text TEXT NOT NULL, attention_since INTEGER NOT NULL,
  deleted INTEGER NOT NULL DEFAULT 0 CHECK(deleted IN (0, 1)),
  CHECK(state NOT IN ('armed', 'cutting', 'paused') OR (device != '' AND sheet > 0)),
  CHECK(state NOT IN ('ready', 'interrupted') OR sheet > 0),
  CHECK((state IN ('done', 'failed', 'cancelled')) = (finished IS NOT NULL))) STRICT, WITHOUT ROWID;
CREATE INDEX job_state ON job(state, id);
CREATE INDEX job_owner ON job(owner, id);
CREATE INDEX job_device ON job(device, id);
CREATE INDEX job_wish ON job(wish, id) WHERE wish != '';
CREATE INDEX job_design ON job(design) WHERE state NOT IN ('done', 'failed', 'cancelled');
CREATE INDEX job_plan ON job(plan, state);
CREATE INDEX job_queue ON job(priority DESC, position, id)
  WHERE state NOT IN ('done', 'failed', 'cancelled');
CREATE INDEX job_position ON job(position);
CREATE INDEX job_waiting ON job(priority DESC, position) WHERE state = 'queued';
-- A device has one sheet in it.
CREATE UNIQUE INDEX job_busy ON job(device) WHERE state IN ('armed', 'cutting', 'paused');
-- Terminal states never change.
CREATE TRIGGER job_ended BEFORE UPDATE OF state, outcome, finished, started, sheet, blank, segment
  ON job WHEN old.state IN ('done', 'failed', 'cancelled')
  BEGIN SELECT RAISE(ABORT, 'the job has ended'); END;
CREATE TRIGGER job_kept BEFORE DELETE ON job
  BEGIN SELECT RAISE(ABORT, 'jobs are never deleted'); END;

-- How many jobs there are of each state, so that nobody has to count them.
CREATE TABLE tally(state TEXT PRIMARY KEY, jobs INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TRIGGER tally_insert AFTER INSERT ON job BEGIN
  INSERT INTO tally(state, jobs) VALUES(new.state, 1)
    ON CONFLICT(state) DO UPDATE SET jobs = jobs + 1; END;
CREATE TRIGGER tally_update AFTER UPDATE OF state ON job WHEN old.state != new.state BEGIN
  UPDATE tally SET jobs = jobs - 1 WHERE state = old.state;
  INSERT INTO tally(state, jobs) VALUES(new.state, 1)
    ON CONFLICT(state) DO UPDATE SET jobs = jobs + 1; END;

-- Sheets that have been the current one; what the others are follows from the plan.
CREATE TABLE sheet(
  job TEXT NOT NULL REFERENCES job(id), k INTEGER NOT NULL CHECK(k BETWEEN 1 AND 10000),
  blank INTEGER NOT NULL, segment INTEGER NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('ready', 'armed', 'cutting', 'interrupted', 'done',
                                      'skipped')),
  started INTEGER, finished INTEGER,
  PRIMARY KEY(job, k)) STRICT, WITHOUT ROWID;

CREATE TABLE arm(
  job TEXT PRIMARY KEY REFERENCES job(id), sheet INTEGER NOT NULL, blank INTEGER NOT NULL,
  device TEXT NOT NULL, plan_sha256 TEXT NOT NULL, operator TEXT NOT NULL,
  armed INTEGER NOT NULL, invocation TEXT NOT NULL) STRICT, WITHOUT ROWID;

CREATE TABLE attempt(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  job TEXT NOT NULL REFERENCES job(id), k INTEGER NOT NULL, blank INTEGER NOT NULL,
  segment INTEGER NOT NULL, first_stroke INTEGER NOT NULL, strokes INTEGER NOT NULL,
  device TEXT NOT NULL, device_session TEXT NOT NULL, operator TEXT NOT NULL,
  plan_sha256 TEXT NOT NULL, invocation TEXT NOT NULL,
  created INTEGER NOT NULL, started_at INTEGER, ended INTEGER, end_kind TEXT NOT NULL,
  bytes_taken INTEGER NOT NULL, last_status TEXT NOT NULL) STRICT, WITHOUT ROWID;
-- The same blank is never started twice.
CREATE UNIQUE INDEX attempt_once ON attempt(job, k, blank, segment) WHERE started_at IS NOT NULL;
CREATE INDEX attempt_job ON attempt(job, k, id);
CREATE INDEX attempt_open ON attempt(id) WHERE ended IS NULL;

CREATE TABLE chunk(
  attempt TEXT NOT NULL REFERENCES attempt(id), seq INTEGER NOT NULL,
  path_from INTEGER NOT NULL CHECK(path_from >= 0), path_to INTEGER NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('intent', 'sent', 'doubt', 'certain')),
  CHECK(path_to >= path_from),
  PRIMARY KEY(attempt, seq)) STRICT, WITHOUT ROWID;

CREATE TABLE event(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL,
  kind TEXT NOT NULL CHECK(kind IN ('job', 'sheet', 'device', 'queue', 'notice')),
  job TEXT NOT NULL, data TEXT NOT NULL) STRICT;
CREATE INDEX event_job ON event(job, seq) WHERE job != '';

CREATE TABLE idem(
  principal TEXT NOT NULL, key TEXT NOT NULL, request TEXT NOT NULL, status INTEGER NOT NULL,
  body TEXT NOT NULL, etag TEXT NOT NULL, location TEXT NOT NULL, expires INTEGER NOT NULL,
  PRIMARY KEY(principal, key)) STRICT;  -- with row ids: a body in an index takes a page of its own
CREATE INDEX idem_expires ON idem(expires);

CREATE TABLE audit(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL, principal TEXT NOT NULL,
  action TEXT NOT NULL, subject TEXT NOT NULL, detail TEXT NOT NULL) STRICT;

CREATE TABLE token(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  kind TEXT NOT NULL CHECK(kind IN ('token', 'session')),
  name TEXT NOT NULL, role TEXT NOT NULL CHECK(role IN ('viewer', 'submitter', 'operator',
                                                        'admin')),
  principal TEXT NOT NULL, secret_sha256 TEXT NOT NULL CHECK(length(secret_sha256) = 64),
  created INTEGER NOT NULL, expires INTEGER) STRICT, WITHOUT ROWID;

CREATE TABLE material(
  id TEXT PRIMARY KEY, rev INTEGER NOT NULL, json TEXT NOT NULL) STRICT, WITHOUT ROWID;

CREATE TABLE device(
  id TEXT PRIMARY KEY, rev INTEGER NOT NULL, model TEXT NOT NULL, title TEXT NOT NULL,
  simulated INTEGER NOT NULL, width_mm REAL NOT NULL, length_mm REAL NOT NULL,
  enabled INTEGER NOT NULL CHECK(enabled IN (0, 1)), state TEXT NOT NULL,
  sheets_done INTEGER NOT NULL, cut_mm REAL NOT NULL) STRICT, WITHOUT ROWID;

CREATE TABLE usage(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL, owner TEXT NOT NULL, operator TEXT NOT NULL,
  device TEXT NOT NULL, material TEXT NOT NULL, job TEXT NOT NULL, k INTEGER NOT NULL,
  seconds REAL NOT NULL, cut_mm REAL NOT NULL, sheets INTEGER NOT NULL) STRICT;
CREATE INDEX usage_time ON usage(time);
)sql";

// Sessions have a root, and end with it; those of before had none. Assets say what refers to them.
constexpr std::string_view kVersion2 = R"sql(
DELETE FROM token WHERE kind = 'session';
-- The root is a token, or a user of the unix socket with the groups of the process that asked.
CREATE TABLE session(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  token TEXT REFERENCES token(id) ON DELETE CASCADE,
  uid INTEGER, groups TEXT NOT NULL,
  via TEXT REFERENCES session(id) ON DELETE CASCADE,
  principal TEXT NOT NULL, secret_sha256 TEXT NOT NULL CHECK(length(secret_sha256) = 64),
  created INTEGER NOT NULL, expires INTEGER NOT NULL, ends INTEGER NOT NULL,
  CHECK((token IS NULL) != (uid IS NULL))) STRICT, WITHOUT ROWID;
CREATE INDEX session_token ON session(token) WHERE token IS NOT NULL;
CREATE INDEX session_via ON session(via) WHERE via IS NOT NULL;
CREATE INDEX session_principal ON session(principal, expires);

ALTER TABLE asset ADD COLUMN name TEXT NOT NULL DEFAULT '';
ALTER TABLE asset ADD COLUMN owner TEXT NOT NULL DEFAULT '';
-- Which design refers to which asset: the lists of the designs, the other way round.
CREATE TABLE asset_use(
  asset TEXT NOT NULL, design TEXT NOT NULL REFERENCES design(id) ON DELETE CASCADE,
  PRIMARY KEY(asset, design)) STRICT, WITHOUT ROWID;
CREATE INDEX asset_use_design ON asset_use(design);
INSERT OR IGNORE INTO asset_use(asset, design)
  SELECT each.value, design.id FROM design, json_each(design.assets) AS each
  WHERE json_valid(design.assets);
CREATE TRIGGER asset_use_insert AFTER INSERT ON design BEGIN
  INSERT OR IGNORE INTO asset_use(asset, design)
    SELECT each.value, new.id FROM json_each(new.assets) AS each; END;

-- The wall's clock as far as it is believed, and one that says otherwise (daemon/service/calendar).
CREATE TABLE calendar(
  one INTEGER PRIMARY KEY CHECK(one = 1), believed INTEGER NOT NULL,
  claimed INTEGER NOT NULL, held_ms INTEGER NOT NULL) STRICT;
)sql";

// What a program's bytes are for is protected like the bytes. Plans of before are not trusted: what
// they say now may not be what was planned. They lose their key, so that the same is planned again.
constexpr std::string_view kVersion3 = R"sql(
ALTER TABLE plan_sheet ADD COLUMN index_sha256 TEXT NOT NULL DEFAULT ''
  CHECK(length(index_sha256) IN (0, 64));
UPDATE plan SET key = 'before-version-3-' || id WHERE state = 'planned';
)sql";

// Who waits for which plan, so that all get their turn; how often popcutd ended while it made a
// plan; how attempts ended, so that nobody has to count them.
constexpr std::string_view kVersion4 = R"sql(
ALTER TABLE plan ADD COLUMN begun INTEGER NOT NULL DEFAULT 0;
CREATE TABLE plan_asker(
  owner TEXT NOT NULL, plan TEXT NOT NULL REFERENCES plan(id) ON DELETE CASCADE,
  PRIMARY KEY(owner, plan)) STRICT, WITHOUT ROWID;
CREATE INDEX plan_asker_plan ON plan_asker(plan);
INSERT OR IGNORE INTO plan_asker(owner, plan)
  SELECT job.owner, job.plan FROM job JOIN plan ON plan.id = job.plan
  WHERE plan.state = 'pending' AND job.state IN ('queued', 'planning');
INSERT OR IGNORE INTO plan_asker(owner, plan)
  SELECT coalesce((SELECT owner FROM design WHERE design.id = plan.design), ''), plan.id FROM plan
  WHERE plan.state = 'pending' AND plan.id NOT IN (SELECT plan FROM plan_asker);
CREATE INDEX job_waiting_of ON job(owner, priority DESC, position) WHERE state = 'queued';
CREATE INDEX job_open_of ON job(owner) WHERE state NOT IN ('done', 'failed', 'cancelled');

CREATE TABLE end_tally(
  device TEXT NOT NULL, end_kind TEXT NOT NULL, attempts INTEGER NOT NULL,
  PRIMARY KEY(device, end_kind)) STRICT, WITHOUT ROWID;
INSERT INTO end_tally(device, end_kind, attempts)
  SELECT device, end_kind, count(*) FROM attempt WHERE ended IS NOT NULL GROUP BY device, end_kind;
CREATE TRIGGER end_tally_insert AFTER INSERT ON attempt WHEN new.ended IS NOT NULL BEGIN
  INSERT INTO end_tally(device, end_kind, attempts) VALUES(new.device, new.end_kind, 1)
    ON CONFLICT(device, end_kind) DO UPDATE SET attempts = attempts + 1; END;
CREATE TRIGGER end_tally_update AFTER UPDATE OF ended ON attempt
  WHEN old.ended IS NULL AND new.ended IS NOT NULL BEGIN
  INSERT INTO end_tally(device, end_kind, attempts) VALUES(new.device, new.end_kind, 1)
    ON CONFLICT(device, end_kind) DO UPDATE SET attempts = attempts + 1; END;
)sql";

// Warnings have a code and a place, and jobs have those of their plan, and what to load. Whoever
// has a job that is open was not asked about them so far, and is not asked now.
constexpr std::string_view kVersion5 = R"sql(
UPDATE plan SET warnings = (
  SELECT json_group_array(json_object('code', 'note', 'message', value, 'place', NULL, 'spoils',
                                      json('false'))) FROM json_each(plan.warnings))
  WHERE warnings != '[]' AND json_valid(warnings);
ALTER TABLE plan_sheet ADD COLUMN mat TEXT NOT NULL DEFAULT '';
ALTER TABLE plan_sheet ADD COLUMN side TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN load TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN warnings TEXT NOT NULL DEFAULT '[]';
ALTER TABLE job ADD COLUMN unaccepted TEXT NOT NULL DEFAULT '';
UPDATE job SET warnings = (SELECT plan.warnings FROM plan WHERE plan.id = job.plan)
  WHERE state NOT IN ('done', 'failed', 'cancelled');
)sql";

// Plans have a file of their strokes, for those who draw them. Those of before lose their key, so
// that the same is planned again. Sessions of tablets have a name, and may do less than their root.
constexpr std::string_view kVersion6 = R"sql(
ALTER TABLE session ADD COLUMN name TEXT NOT NULL DEFAULT '';
ALTER TABLE session ADD COLUMN most TEXT NOT NULL DEFAULT ''
  CHECK(most IN ('', 'viewer', 'submitter', 'operator', 'admin'));
UPDATE plan SET key = 'before-version-6-' || id WHERE state = 'planned';
)sql";

// What the tables of a fleet have too (daemon/fleet/schema.sql). Here there is one node, without a
// name.
constexpr std::string_view kVersion7 = R"sql(
ALTER TABLE device ADD COLUMN node TEXT NOT NULL DEFAULT '';
ALTER TABLE device ADD COLUMN machine TEXT NOT NULL DEFAULT '';
ALTER TABLE device ADD COLUMN materials TEXT NOT NULL DEFAULT '';
ALTER TABLE device ADD COLUMN reasons TEXT NOT NULL DEFAULT '[]';
ALTER TABLE device ADD COLUMN firmware TEXT NOT NULL DEFAULT '';
ALTER TABLE arm ADD COLUMN node TEXT NOT NULL DEFAULT '';
ALTER TABLE arm ADD COLUMN epoch INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN node TEXT NOT NULL DEFAULT '';
ALTER TABLE attempt ADD COLUMN epoch INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN fence INTEGER;
ALTER TABLE attempt ADD COLUMN identity TEXT NOT NULL DEFAULT '';
ALTER TABLE plan ADD COLUMN planner TEXT NOT NULL DEFAULT '';
ALTER TABLE plan ADD COLUMN planner_epoch INTEGER NOT NULL DEFAULT 0;
)sql";

// Where cutters stand, and where a job is to be cut.
constexpr std::string_view kVersion8 = R"sql(
ALTER TABLE device ADD COLUMN site TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN site TEXT NOT NULL DEFAULT '';
)sql";

// Searches for the best cards of a model, as plans are stored: the same is searched once.
constexpr std::string_view kVersion9 = R"sql(
CREATE TABLE search(
  id TEXT PRIMARY KEY CHECK(length(id) = 26),
  key TEXT NOT NULL, owner TEXT NOT NULL, model TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('pending', 'found', 'failed')),
  words TEXT NOT NULL, machine TEXT NOT NULL, material TEXT NOT NULL,
  machine_json TEXT NOT NULL, material_json TEXT NOT NULL,
  front TEXT NOT NULL, error TEXT NOT NULL, created INTEGER NOT NULL,
  begun INTEGER NOT NULL DEFAULT 0,
  planner TEXT NOT NULL DEFAULT '', planner_epoch INTEGER NOT NULL DEFAULT 0,
  CHECK(state != 'found' OR front != '')) STRICT, WITHOUT ROWID;
CREATE UNIQUE INDEX search_key ON search(key) WHERE state IN ('pending', 'found');
CREATE INDEX search_model ON search(model);
CREATE INDEX search_pending ON search(owner, id) WHERE state = 'pending';
)sql";

}  // namespace

const std::vector<Migration>& migrations() {
  static const std::vector<Migration> all{{1, kVersion1}, {2, kVersion2}, {3, kVersion3},
                                          {4, kVersion4}, {5, kVersion5}, {6, kVersion6},
                                          {7, kVersion7}, {8, kVersion8}, {9, kVersion9}};
  return all;
}

const std::vector<std::string_view>& table_names() {
  static const std::vector<std::string_view> names{
      "asset",   "design",   "plan",   "plan_sheet", "plan_asker", "job",   "sheet",
      "arm",     "attempt",  "chunk",  "event",      "idem",       "audit", "token",
      "session", "material", "device", "usage",      "calendar",   "search"};
  return names;
}

void build_schema(Database& database, const std::vector<Migration>& steps, int version) {
  Transaction all(database);
  for (const Migration& step : steps)
    if (step.version <= version) database.script(std::string(step.sql));
  database.script(
      fmt::format("PRAGMA application_id={}; PRAGMA user_version={};", kApplicationId, version));
  all.commit();
}

}  // namespace popcut::daemon
