-- SPDX-License-Identifier: MIT
-- The tables of popcutd that SQLite and the database of a fleet have in common, in the words of
-- SQLite. CMake translates them for PostgreSQL (daemon/fleet/CMakeLists.txt), so TEXT, INTEGER and
-- REAL in capitals are always types.
--
-- Times are milliseconds since 1970, ids are ULIDs, lengths are millimetres, flags are 0 or 1.
-- `node`, `epoch`, `planner`, `fence` and `identity` say something in a fleet only.

CREATE TABLE asset(
  id TEXT PRIMARY KEY CHECK (length(id) = 71), bytes INTEGER NOT NULL, created INTEGER NOT NULL,
  name TEXT NOT NULL DEFAULT '', owner TEXT NOT NULL DEFAULT '') STRICT, WITHOUT ROWID;

CREATE TABLE design(
  id TEXT PRIMARY KEY CHECK (length(id) = 71), name TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('spec', 'fold', 'svg', 'dxf', 'pdf')), media_type TEXT NOT NULL,
  owner TEXT NOT NULL, bytes INTEGER NOT NULL, created INTEGER NOT NULL, assets TEXT NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX design_created ON design(created, id);

-- Which design refers to which asset: the inverse of `design.assets`. A trigger fills it.
CREATE TABLE asset_use(
  asset TEXT NOT NULL, design TEXT NOT NULL REFERENCES design(id) ON DELETE CASCADE,
  PRIMARY KEY (asset, design)) STRICT, WITHOUT ROWID;
CREATE INDEX asset_use_design ON asset_use(design);

-- Who uploaded or asked for a thing. Equal bytes and equal requests are one thing with several owners;
-- it goes when the last of them lets it go. The owner of a plan counts while they own its design too,
-- and the owner of a search while they own its model. `owner`, `name` and `created` of the thing
-- itself are those of its first owner.
CREATE TABLE ownership(
  kind TEXT NOT NULL CHECK (kind IN ('asset', 'design', 'plan', 'search')), id TEXT NOT NULL,
  owner TEXT NOT NULL, name TEXT NOT NULL, created INTEGER NOT NULL,
  PRIMARY KEY (kind, id, owner)) STRICT, WITHOUT ROWID;
CREATE INDEX ownership_of ON ownership(owner, kind, id);

-- `key` is the digest of everything that decides the result: equal plans are made once. `planner`
-- is the node that makes the plan now. `begun` counts how often popcutd ended while it made it.
CREATE TABLE plan(
  id TEXT PRIMARY KEY CHECK (length(id) = 26), key TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('design', 'test')), design TEXT NOT NULL,
  material TEXT NOT NULL, machine TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('pending', 'planned', 'failed')), sha256 TEXT NOT NULL,
  sheets INTEGER NOT NULL, paths INTEGER NOT NULL, cut_mm REAL NOT NULL, low_s REAL NOT NULL,
  high_s REAL NOT NULL, width_mm REAL NOT NULL, length_mm REAL NOT NULL, warnings TEXT NOT NULL,
  error TEXT NOT NULL, options TEXT NOT NULL, machine_json TEXT NOT NULL,
  material_json TEXT NOT NULL, created INTEGER NOT NULL, begun INTEGER NOT NULL DEFAULT 0,
  planner TEXT NOT NULL DEFAULT '', planner_epoch INTEGER NOT NULL DEFAULT 0,
  handwork TEXT NOT NULL DEFAULT '',
  CHECK (state != 'planned' OR (sheets > 0 AND length(sha256) = 64))) STRICT, WITHOUT ROWID;
CREATE UNIQUE INDEX plan_key ON plan(key) WHERE state IN ('pending', 'planned');
CREATE INDEX plan_design ON plan(design);
CREATE INDEX plan_pending ON plan(id) WHERE state = 'pending';

CREATE TABLE plan_sheet(
  plan TEXT NOT NULL REFERENCES plan(id) ON DELETE CASCADE,
  sheet INTEGER NOT NULL CHECK (sheet BETWEEN 1 AND 10000),
  paths INTEGER NOT NULL CHECK (paths >= 0), cut_mm REAL NOT NULL, fold_mm REAL NOT NULL,
  travel_mm REAL NOT NULL, seconds REAL NOT NULL,
  seconds_range_1 REAL NOT NULL, seconds_range_2 REAL NOT NULL,
  area_mm_1 REAL NOT NULL, area_mm_2 REAL NOT NULL,
  program_sha256 TEXT NOT NULL CHECK (length(program_sha256) = 64),
  index_sha256 TEXT NOT NULL CHECK (length(index_sha256) = 64),
  mat TEXT NOT NULL, side TEXT NOT NULL,
  PRIMARY KEY (plan, sheet)) STRICT, WITHOUT ROWID;

-- Who waits for which plan, so that everyone gets a turn.
CREATE TABLE plan_asker(
  owner TEXT NOT NULL, plan TEXT NOT NULL REFERENCES plan(id) ON DELETE CASCADE,
  PRIMARY KEY (owner, plan)) STRICT, WITHOUT ROWID;
CREATE INDEX plan_asker_plan ON plan_asker(plan);

-- Searches for the best cards of a model. They are stored like plans.
CREATE TABLE search(
  id TEXT PRIMARY KEY CHECK (length(id) = 26), key TEXT NOT NULL, owner TEXT NOT NULL,
  model TEXT NOT NULL, state TEXT NOT NULL CHECK (state IN ('pending', 'found', 'failed')),
  words TEXT NOT NULL, machine TEXT NOT NULL, material TEXT NOT NULL, machine_json TEXT NOT NULL,
  material_json TEXT NOT NULL, front TEXT NOT NULL, error TEXT NOT NULL, created INTEGER NOT NULL,
  begun INTEGER NOT NULL DEFAULT 0, planner TEXT NOT NULL DEFAULT '',
  planner_epoch INTEGER NOT NULL DEFAULT 0,
  CHECK (state != 'found' OR front != '')) STRICT, WITHOUT ROWID;
CREATE UNIQUE INDEX search_key ON search(key) WHERE state IN ('pending', 'found');
CREATE INDEX search_model ON search(model);
CREATE INDEX search_pending ON search(owner, id) WHERE state = 'pending';

-- `device` is the cutter that holds the sheet. `tags`, `load`, `handwork`, `warnings` and
-- `unaccepted_warnings` are JSON; the columns of a pair end with _1 and _2 (daemon/model/fields.hpp).
CREATE TABLE job(
  id TEXT PRIMARY KEY CHECK (length(id) = 26), rev INTEGER NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('queued', 'planning', 'ready', 'armed', 'cutting', 'paused',
                                       'interrupted', 'done', 'failed', 'cancelled')),
  reason TEXT NOT NULL, asked TEXT NOT NULL CHECK (asked IN ('', 'pause', 'cancel')),
  name TEXT NOT NULL, note TEXT NOT NULL, owner TEXT NOT NULL, operator TEXT NOT NULL,
  requested_device TEXT NOT NULL, device TEXT NOT NULL, design TEXT NOT NULL,
  plan TEXT NOT NULL REFERENCES plan(id), material TEXT NOT NULL,
  priority INTEGER NOT NULL CHECK (priority BETWEEN -10 AND 10), position INTEGER NOT NULL,
  copies INTEGER NOT NULL CHECK (copies BETWEEN 1 AND 1000),
  held INTEGER NOT NULL CHECK (held IN (0, 1)),
  sheets_total INTEGER NOT NULL CHECK (sheets_total BETWEEN 0 AND 10000),
  sheet INTEGER NOT NULL CHECK (sheet BETWEEN 0 AND sheets_total),
  blank INTEGER NOT NULL CHECK (blank >= 1), segment INTEGER NOT NULL CHECK (segment >= 1),
  first_stroke INTEGER NOT NULL CHECK (first_stroke >= 0), paths_certain INTEGER NOT NULL,
  paths_sent INTEGER NOT NULL, paths_total INTEGER NOT NULL, done_paths INTEGER NOT NULL,
  done_mm REAL NOT NULL, low_s REAL NOT NULL, high_s REAL NOT NULL, created INTEGER NOT NULL,
  started INTEGER, finished INTEGER, outcome TEXT NOT NULL, tags TEXT NOT NULL,
  attention_kind TEXT NOT NULL, attention_text TEXT NOT NULL, attention_since INTEGER NOT NULL,
  deleted INTEGER NOT NULL DEFAULT 0 CHECK (deleted IN (0, 1)), load TEXT NOT NULL DEFAULT '',
  warnings TEXT NOT NULL DEFAULT '[]', unaccepted_warnings TEXT NOT NULL DEFAULT '[]',
  site TEXT NOT NULL DEFAULT '', handwork TEXT NOT NULL DEFAULT '',
  CHECK (state NOT IN ('armed', 'cutting', 'paused') OR (device != '' AND sheet > 0)),
  CHECK (state NOT IN ('ready', 'interrupted') OR sheet > 0),
  CHECK ((state IN ('done', 'failed', 'cancelled')) = (finished IS NOT NULL))
) STRICT, WITHOUT ROWID;
CREATE INDEX job_state ON job(state, id);
CREATE INDEX job_owner ON job(owner, id);
CREATE INDEX job_device ON job(device, id);
CREATE INDEX job_requested_device ON job(requested_device, id) WHERE requested_device != '';
CREATE INDEX job_design ON job(design) WHERE state NOT IN ('done', 'failed', 'cancelled');
CREATE INDEX job_plan ON job(plan, state);
CREATE INDEX job_queue ON job(priority DESC, position, id)
  WHERE state NOT IN ('done', 'failed', 'cancelled');
CREATE INDEX job_position ON job(position);
CREATE INDEX job_waiting ON job(priority DESC, position) WHERE state = 'queued';
CREATE INDEX job_waiting_of ON job(owner, priority DESC, position) WHERE state = 'queued';
CREATE INDEX job_open_of ON job(owner) WHERE state NOT IN ('done', 'failed', 'cancelled');
-- A cutter holds one sheet at a time.
CREATE UNIQUE INDEX job_busy ON job(device) WHERE state IN ('armed', 'cutting', 'paused');

-- Sheets that were the current sheet of their job. The state of the others follows from the plan.
CREATE TABLE sheet(
  job TEXT NOT NULL REFERENCES job(id), k INTEGER NOT NULL CHECK (k BETWEEN 1 AND 10000),
  blank INTEGER NOT NULL, segment INTEGER NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('ready', 'armed', 'cutting', 'interrupted', 'done',
                                       'skipped')),
  started INTEGER, finished INTEGER,
  PRIMARY KEY (job, k)) STRICT, WITHOUT ROWID;

CREATE TABLE arm(
  job TEXT PRIMARY KEY REFERENCES job(id), sheet INTEGER NOT NULL, blank INTEGER NOT NULL,
  device TEXT NOT NULL, plan_sha256 TEXT NOT NULL, operator TEXT NOT NULL, armed INTEGER NOT NULL,
  invocation TEXT NOT NULL, node TEXT NOT NULL DEFAULT '',
  epoch INTEGER NOT NULL DEFAULT 0) STRICT, WITHOUT ROWID;

-- `fence` grows with each start in the fleet; a node starts nothing with a fence below the greatest
-- one in its journals. `identity` is the node that started the attempt: its journal knows the most.
CREATE TABLE attempt(
  id TEXT PRIMARY KEY CHECK (length(id) = 26), job TEXT NOT NULL REFERENCES job(id),
  k INTEGER NOT NULL, blank INTEGER NOT NULL, segment INTEGER NOT NULL,
  first_stroke INTEGER NOT NULL, strokes INTEGER NOT NULL, device TEXT NOT NULL,
  device_session TEXT NOT NULL, operator TEXT NOT NULL, plan_sha256 TEXT NOT NULL,
  invocation TEXT NOT NULL, created INTEGER NOT NULL, started_at INTEGER, ended INTEGER,
  end_kind TEXT NOT NULL, bytes_taken INTEGER NOT NULL, last_status TEXT NOT NULL,
  node TEXT NOT NULL DEFAULT '', epoch INTEGER NOT NULL DEFAULT 0, fence INTEGER,
  identity TEXT NOT NULL DEFAULT '') STRICT, WITHOUT ROWID;
-- A blank is started only once.
CREATE UNIQUE INDEX attempt_once ON attempt(job, k, blank, segment)
  WHERE started_at IS NOT NULL;
CREATE INDEX attempt_job ON attempt(job, k, id);
CREATE INDEX attempt_open ON attempt(id) WHERE ended IS NULL;

-- Rows change in place while a cut goes on.
CREATE TABLE chunk(
  attempt TEXT NOT NULL REFERENCES attempt(id), seq INTEGER NOT NULL,
  path_from INTEGER NOT NULL CHECK (path_from >= 0), path_to INTEGER NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('intent', 'sent', 'doubt', 'certain')),
  CHECK (path_to >= path_from),
  PRIMARY KEY (attempt, seq)) STRICT, WITHOUT ROWID;

CREATE TABLE event(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('job', 'sheet', 'device', 'queue', 'notice')),
  job TEXT NOT NULL, data TEXT NOT NULL) STRICT;
CREATE INDEX event_job ON event(job, seq) WHERE job != '';

-- With row ids: a body in an index would take a page of its own.
CREATE TABLE idem(
  principal TEXT NOT NULL, key TEXT NOT NULL, request TEXT NOT NULL, status INTEGER NOT NULL,
  body TEXT NOT NULL, etag TEXT NOT NULL, location TEXT NOT NULL, expires INTEGER NOT NULL,
  PRIMARY KEY (principal, key)) STRICT;
CREATE INDEX idem_expires ON idem(expires);

CREATE TABLE audit(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL, principal TEXT NOT NULL, action TEXT NOT NULL,
  subject TEXT NOT NULL, detail TEXT NOT NULL) STRICT;

CREATE TABLE token(
  id TEXT PRIMARY KEY CHECK (length(id) = 26),
  kind TEXT NOT NULL CHECK (kind IN ('token', 'session')), name TEXT NOT NULL,
  role TEXT NOT NULL CHECK (role IN ('viewer', 'submitter', 'operator', 'admin')),
  principal TEXT NOT NULL, secret_sha256 TEXT NOT NULL CHECK (length(secret_sha256) = 64),
  created INTEGER NOT NULL, expires INTEGER) STRICT, WITHOUT ROWID;

-- The root of a session is a token, or a user of the unix socket with the groups of the process
-- that asked. The session ends with its root. A tablet's session has a `name`; `most` limits its
-- role.
CREATE TABLE session(
  id TEXT PRIMARY KEY CHECK (length(id) = 26), token TEXT REFERENCES token(id) ON DELETE CASCADE,
  uid INTEGER, groups TEXT NOT NULL, via TEXT REFERENCES session(id) ON DELETE CASCADE,
  principal TEXT NOT NULL, secret_sha256 TEXT NOT NULL CHECK (length(secret_sha256) = 64),
  created INTEGER NOT NULL, expires INTEGER NOT NULL, ends INTEGER NOT NULL,
  name TEXT NOT NULL DEFAULT '',
  most TEXT NOT NULL DEFAULT '' CHECK (most IN ('', 'viewer', 'submitter', 'operator', 'admin')),
  CHECK ((token IS NULL) != (uid IS NULL))) STRICT, WITHOUT ROWID;
CREATE INDEX session_token ON session(token) WHERE token IS NOT NULL;
CREATE INDEX session_via ON session(via) WHERE via IS NOT NULL;
CREATE INDEX session_principal ON session(principal, expires);

CREATE TABLE material(
  id TEXT PRIMARY KEY, rev INTEGER NOT NULL, json TEXT NOT NULL) STRICT, WITHOUT ROWID;

-- `node` is the node that has the cutter; '' if none does. `materials` is a JSON list of the
-- materials that the cutter is set up for, '' for any; `reasons` is a JSON list.
CREATE TABLE device(
  id TEXT PRIMARY KEY, rev INTEGER NOT NULL, model TEXT NOT NULL, title TEXT NOT NULL,
  simulated INTEGER NOT NULL, width_mm REAL NOT NULL, length_mm REAL NOT NULL,
  enabled INTEGER NOT NULL CHECK (enabled IN (0, 1)), state TEXT NOT NULL,
  sheets_done INTEGER NOT NULL, cut_mm REAL NOT NULL, node TEXT NOT NULL DEFAULT '',
  machine TEXT NOT NULL DEFAULT '', materials TEXT NOT NULL DEFAULT '',
  reasons TEXT NOT NULL DEFAULT '[]', firmware TEXT NOT NULL DEFAULT '',
  site TEXT NOT NULL DEFAULT '') STRICT, WITHOUT ROWID;

CREATE TABLE usage(
  seq INTEGER PRIMARY KEY, time INTEGER NOT NULL, owner TEXT NOT NULL, operator TEXT NOT NULL,
  device TEXT NOT NULL, material TEXT NOT NULL, job TEXT NOT NULL, k INTEGER NOT NULL,
  seconds REAL NOT NULL, cut_mm REAL NOT NULL, sheets INTEGER NOT NULL) STRICT;
CREATE INDEX usage_time ON usage(time);

-- The last believed time of the system clock, and a time that contradicts it
-- (daemon/service/calendar.hpp).
CREATE TABLE calendar(
  one INTEGER PRIMARY KEY CHECK (one = 1), believed INTEGER NOT NULL, claimed INTEGER NOT NULL,
  held_ms INTEGER NOT NULL) STRICT;
