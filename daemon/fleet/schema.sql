-- SPDX-License-Identifier: MIT
-- A fleet's database: PostgreSQL 15 or later, encoding UTF8. docs/fleet.md explains how to run one.
--
-- 'popcut fleet init' runs it once, in one transaction, as a superuser or as a role with CREATEROLE
-- that may create schemas in the database.
--
-- CMake replaces the line "@tables@" by the tables that SQLite has too (daemon/store/tables.sql).
-- Text has the collation "C", as in SQLite, so that ids sort by their bytes. Only leases
-- have times of the database's own clock.
--
-- The rule of the knife: a blank is started once, and only by the node that has the cutter, while
-- its lease lives. So no role of a node may write to node, arm, attempt or chunk: it calls the
-- functions node_* and knife_*, which run as the owner and check who calls. They raise
--   PC001  the caller may not do this: another's login, an old epoch, a lease that is over
--   PC002  the name, or the cutter, belongs to another node that is alive
--   PC003  there is no such attempt, or it is past what was asked
-- 23505 (unique_violation) comes as it is: attempt_once says that the blank was started before.

DO $$
BEGIN
  -- A setting of the transaction is gone with the next statement if there is no transaction.
  PERFORM set_config('popcut.creating', 'yes', true);
END $$;

DO $$
DECLARE
  v_role text;
BEGIN
  IF current_setting('popcut.creating', true) IS DISTINCT FROM 'yes' THEN
    RAISE EXCEPTION 'the schema is made in one transaction; run this file with psql -1';
  END IF;
  IF current_setting('server_version_num')::int < 150000 THEN
    RAISE EXCEPTION 'PostgreSQL is %; a fleet needs version 15 or later',
      current_setting('server_version');
  END IF;
  IF current_setting('server_encoding') <> 'UTF8' THEN
    RAISE EXCEPTION 'the database has the encoding %; create it with encoding UTF8',
      current_setting('server_encoding');
  END IF;
  -- Roles belong to the cluster: a second fleet in another database shares them.
  FOREACH v_role IN ARRAY ARRAY['popcut_owner', 'popcut_node', 'popcut_admin'] LOOP
    BEGIN
      IF NOT EXISTS (SELECT FROM pg_catalog.pg_roles WHERE rolname = v_role) THEN
        EXECUTE format('CREATE ROLE %I NOLOGIN', v_role);
      END IF;
    EXCEPTION WHEN duplicate_object OR unique_violation THEN
      NULL;  -- another database of this cluster was faster
    END;
  END LOOP;
  -- From version 16 on, a member need not be allowed to SET ROLE.
  IF NOT pg_has_role(current_user, 'popcut_owner',
                     CASE WHEN current_setting('server_version_num')::int < 160000
                          THEN 'MEMBER' ELSE 'SET' END) THEN
    EXECUTE format('GRANT popcut_owner TO %I', current_user);
  END IF;
  CREATE SCHEMA popcut AUTHORIZATION popcut_owner;
  SET LOCAL ROLE popcut_owner;
  SET LOCAL search_path = pg_catalog, popcut, pg_temp;  -- for names in functions' bodies
END $$;

-- ---------------------------------------------------------------------------------------------
-- The fleet

-- `least` is the oldest version of a popcutd that may still use the database. `went_back` is when a
-- node last saw that the database is an earlier one than before: restored from a copy.
CREATE TABLE popcut.popcut_schema(
  version bigint NOT NULL, least bigint NOT NULL CHECK (least <= version),
  went_back bigint NOT NULL DEFAULT 0);
CREATE UNIQUE INDEX popcut_schema_one ON popcut.popcut_schema((true));
INSERT INTO popcut.popcut_schema(version, least) VALUES (1, 1);

-- `identity` is that of a machine and its state folder: it distinguishes a node that is back from
-- another one with its name. `generation` is that of the database in which the node last compared
-- its journals with it; `ended` says that it was stopped in order. Every beat writes to this table,
-- so no index has a column that a beat changes.
CREATE TABLE popcut.node(
  name text COLLATE "C" PRIMARY KEY CHECK (name ~ '^[A-Za-z0-9][A-Za-z0-9._-]{0,62}$'),
  login text COLLATE "C" NOT NULL,
  identity text COLLATE "C" NOT NULL,
  epoch bigint NOT NULL,
  url text COLLATE "C" NOT NULL,
  version text COLLATE "C" NOT NULL,
  begun timestamptz NOT NULL,
  heartbeat timestamptz NOT NULL,
  lease_until timestamptz NOT NULL,
  lease_s double precision NOT NULL,
  generation text COLLATE "C" NOT NULL,
  ended bigint NOT NULL CHECK (ended IN (0, 1)),
  draining bigint NOT NULL CHECK (draining IN (0, 1))) WITH (fillfactor = 40);
CREATE INDEX node_generation ON popcut.node(generation);

-- Nodes in the terms of the other tables: milliseconds, 0 for never, and whether the lease lives.
CREATE VIEW popcut.node_state AS
  SELECT name, login, epoch, url, version, draining, ended, generation, lease_s,
         (extract(epoch FROM greatest(begun, 'epoch')) * 1000)::bigint AS begun_ms,
         (extract(epoch FROM greatest(heartbeat, 'epoch')) * 1000)::bigint AS heartbeat_ms,
         (extract(epoch FROM greatest(lease_until, 'epoch')) * 1000)::bigint AS lease_until_ms,
         (lease_until > clock_timestamp())::int::bigint AS alive
  FROM popcut.node;

-- Files of the state folders: designs, assets and what planning makes, in parts of at most 1 MiB.
CREATE TABLE popcut.blob(
  path text COLLATE "C" PRIMARY KEY, sha256 text COLLATE "C" NOT NULL CHECK (length(sha256) = 64),
  bytes bigint NOT NULL CHECK (bytes >= 0), created bigint NOT NULL);
CREATE TABLE popcut.blob_part(
  path text COLLATE "C" NOT NULL REFERENCES popcut.blob(path) ON DELETE CASCADE,
  seq bigint NOT NULL CHECK (seq >= 0),
  data bytea NOT NULL CHECK (octet_length(data) BETWEEN 1 AND 1048576),
  PRIMARY KEY (path, seq));

-- The last number of an event. Numbers have no gaps, and who reads them in their order misses none.
CREATE TABLE popcut.event_counter(
  one bigint PRIMARY KEY CHECK (one = 1), last bigint NOT NULL);
INSERT INTO popcut.event_counter(one, last) VALUES (1, 0);

-- Events without a number, of transactions that are committed since. A transaction that took its
-- numbers itself would keep all others waiting until it is on the disk; event_number() gives many
-- their numbers at once. `data` is the JSON object after its member "seq".
CREATE TABLE popcut.event_new(
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, time bigint NOT NULL,
  kind text COLLATE "C" NOT NULL CHECK (kind IN ('job', 'sheet', 'device', 'queue', 'notice')),
  job text COLLATE "C" NOT NULL, data text COLLATE "C" NOT NULL);

-- ---------------------------------------------------------------------------------------------
-- The tables that SQLite has too

-- @tables@

-- Pages keep room for new versions of a row: most changes of a job move no key of an index, and
-- rows of chunk change in place while a cut runs.
ALTER TABLE popcut.plan SET (fillfactor = 80);
ALTER TABLE popcut.job SET (fillfactor = 80);
ALTER TABLE popcut.sheet SET (fillfactor = 70);
ALTER TABLE popcut.attempt SET (fillfactor = 70);
ALTER TABLE popcut.chunk SET (fillfactor = 50);
ALTER TABLE popcut.device SET (fillfactor = 60);

-- A machine cuts one sheet at a time, and so does a job.
CREATE UNIQUE INDEX attempt_machine ON popcut.attempt(device)
  WHERE started_at IS NOT NULL AND ended IS NULL;
CREATE UNIQUE INDEX attempt_knife ON popcut.attempt(job)
  WHERE started_at IS NOT NULL AND ended IS NULL;
CREATE INDEX attempt_node ON popcut.attempt(node) WHERE ended IS NULL OR end_kind = 'lost';
CREATE INDEX device_node ON popcut.device(node) WHERE node <> '';
ALTER TABLE popcut.attempt ADD UNIQUE (fence);
CREATE SEQUENCE popcut.fence_seq AS bigint;

-- The database numbers these rows; SQLite does so by itself.
ALTER TABLE popcut.audit ALTER seq ADD GENERATED BY DEFAULT AS IDENTITY;
ALTER TABLE popcut.usage ALTER seq ADD GENERATED BY DEFAULT AS IDENTITY;

-- How many jobs each state has. One row per state would be locked by every transaction that changes
-- a job, one after the other until each is on the disk. So each change adds rows of its own. The
-- count is their sum, and node_tidy() merges them.
CREATE TABLE popcut.tally(state text COLLATE "C" NOT NULL, jobs bigint NOT NULL);

-- How attempts ended. Each change adds rows, as in tally.
CREATE TABLE popcut.end_tally(
  device text COLLATE "C" NOT NULL, end_kind text COLLATE "C" NOT NULL, attempts bigint NOT NULL);

-- Rows that live for seconds leave dead rows behind; they are vacuumed early. The default, a fifth
-- of the table, would be too late for a table of a million jobs.
ALTER TABLE popcut.tally SET (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);
ALTER TABLE popcut.end_tally
  SET (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);
ALTER TABLE popcut.arm SET (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);
ALTER TABLE popcut.event_counter
  SET (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);
ALTER TABLE popcut.event_new
  SET (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);
ALTER TABLE popcut.job SET (autovacuum_vacuum_scale_factor = 0.01);
ALTER TABLE popcut.attempt SET (autovacuum_vacuum_scale_factor = 0.01);

-- ---------------------------------------------------------------------------------------------
-- Triggers. Every function that a login reaches sets search_path, temporary tables last: what a
-- caller creates, and where a caller searches, changes nothing here. That costs several µs a call.
-- So those that only these call do without, and those that say popcut. of everything and use no
-- operator.

-- Terminal states never change.
CREATE FUNCTION popcut.job_ended() RETURNS trigger LANGUAGE plpgsql
SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  RAISE EXCEPTION USING ERRCODE = 'integrity_constraint_violation', MESSAGE = 'the job has ended';
END $$;
CREATE TRIGGER job_ended
  BEFORE UPDATE OF state, outcome, finished, started, sheet, blank, segment ON popcut.job
  FOR EACH ROW WHEN (old.state IN ('done', 'failed', 'cancelled'))
  EXECUTE FUNCTION popcut.job_ended();

CREATE FUNCTION popcut.job_kept() RETURNS trigger LANGUAGE plpgsql
SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  RAISE EXCEPTION USING ERRCODE = 'integrity_constraint_violation',
    MESSAGE = 'jobs are never deleted';
END $$;
CREATE TRIGGER job_kept BEFORE DELETE ON popcut.job
  FOR EACH ROW EXECUTE FUNCTION popcut.job_kept();

-- For all rows of a statement at once: a move from SQLite inserts many.
CREATE FUNCTION popcut.tally_insert() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  INSERT INTO tally(state, jobs) SELECT state, count(*) FROM added GROUP BY state;
  RETURN NULL;
END $$;
CREATE TRIGGER tally_insert AFTER INSERT ON popcut.job REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION popcut.tally_insert();

CREATE FUNCTION popcut.tally_update() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  INSERT INTO popcut.tally(state, jobs) VALUES (old.state, -1), (new.state, 1);
  RETURN NULL;
END $$;
CREATE TRIGGER tally_update AFTER UPDATE OF state ON popcut.job
  FOR EACH ROW WHEN (old.state <> new.state) EXECUTE FUNCTION popcut.tally_update();

-- An end may be corrected: what was lost was cut after all.
CREATE FUNCTION popcut.end_tally_change() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  IF tg_op = 'UPDATE' AND old.ended IS NOT NULL THEN
    INSERT INTO end_tally(device, end_kind, attempts) VALUES (old.device, old.end_kind, -1);
  END IF;
  IF new.ended IS NOT NULL THEN
    INSERT INTO end_tally(device, end_kind, attempts) VALUES (new.device, new.end_kind, 1);
  END IF;
  RETURN NULL;
END $$;
CREATE TRIGGER end_tally_insert AFTER INSERT ON popcut.attempt
  FOR EACH ROW WHEN (new.ended IS NOT NULL) EXECUTE FUNCTION popcut.end_tally_change();
CREATE TRIGGER end_tally_update AFTER UPDATE OF ended, end_kind ON popcut.attempt
  FOR EACH ROW WHEN ((old.ended IS NULL) <> (new.ended IS NULL) OR
                     (new.ended IS NOT NULL AND old.end_kind <> new.end_kind))
  EXECUTE FUNCTION popcut.end_tally_change();

CREATE FUNCTION popcut.asset_use_insert() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  INSERT INTO asset_use(asset, design)
    SELECT DISTINCT value, new.id FROM json_array_elements_text(new.assets::json) AS each(value)
    ON CONFLICT DO NOTHING;
  RETURN NULL;
END $$;
CREATE TRIGGER asset_use_insert AFTER INSERT ON popcut.design
  FOR EACH ROW EXECUTE FUNCTION popcut.asset_use_insert();

-- The state of a job and what its knife does agree when a transaction commits. That no job has two
-- open attempts or arms is for the indexes attempt_knife and arm_pkey to say. These functions are
-- half of what an arm costs: they look at as little as they can.
CREATE FUNCTION popcut.check_attempts(p_job text, p_state text, p_sheet bigint, p_blank bigint,
                                      p_segment bigint)
RETURNS void LANGUAGE plpgsql AS $$
BEGIN
  IF p_state = 'cutting' OR p_state = 'paused' THEN
    PERFORM FROM attempt WHERE job = p_job AND started_at IS NOT NULL AND ended IS NULL AND
      k = p_sheet AND blank = p_blank AND segment = p_segment;
    IF NOT FOUND THEN
      RAISE EXCEPTION USING ERRCODE = 'check_violation', CONSTRAINT = 'job_knife', MESSAGE =
        format('job %s is %s, but no attempt at its sheet %s (blank %s, segment %s) is open', p_job,
               p_state, p_sheet, p_blank, p_segment);
    END IF;
  ELSE
    PERFORM FROM attempt WHERE job = p_job AND started_at IS NOT NULL AND ended IS NULL;
    IF FOUND THEN
      RAISE EXCEPTION USING ERRCODE = 'check_violation', CONSTRAINT = 'job_knife', MESSAGE =
        format('job %s is %s, but an attempt at it is open', p_job, p_state);
    END IF;
  END IF;
END $$;

CREATE FUNCTION popcut.check_arm(p_job text, p_state text, p_sheet bigint, p_blank bigint,
                                 p_device text)
RETURNS void LANGUAGE plpgsql AS $$
BEGIN
  IF p_state = 'armed' THEN
    PERFORM FROM arm WHERE job = p_job AND sheet = p_sheet AND blank = p_blank AND
      device = p_device;
    IF NOT FOUND THEN
      RAISE EXCEPTION USING ERRCODE = 'check_violation', CONSTRAINT = 'job_arm', MESSAGE =
        format('job %s is armed, but no one armed sheet %s (blank %s) on %s', p_job, p_sheet,
               p_blank, p_device);
    END IF;
  ELSE
    PERFORM FROM arm WHERE job = p_job;
    IF FOUND THEN
      RAISE EXCEPTION USING ERRCODE = 'check_violation', CONSTRAINT = 'job_arm', MESSAGE =
        format('job %s is %s, but its sheet is still armed', p_job, p_state);
    END IF;
  END IF;
END $$;

-- The job as it is at last, which need not be what this change made of it.
CREATE FUNCTION popcut.knife_of_job() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_state text;
  v_sheet bigint;
  v_blank bigint;
  v_segment bigint;
  v_device text;
BEGIN
  SELECT state, sheet, blank, segment, device INTO v_state, v_sheet, v_blank, v_segment, v_device
    FROM job WHERE id = new.id;
  IF 'cutting' IN (old.state, new.state, v_state) OR 'paused' IN (old.state, new.state, v_state) THEN
    PERFORM check_attempts(new.id, v_state, v_sheet, v_blank, v_segment);
  END IF;
  IF 'armed' IN (old.state, new.state, v_state) THEN
    PERFORM check_arm(new.id, v_state, v_sheet, v_blank, v_device);
  END IF;
  RETURN NULL;
END $$;

-- Of an attempt or an arm. If this transaction has not changed the job, it locks its row and looks
-- again: of two transactions each of which would be right alone the second sees the first.
CREATE FUNCTION popcut.knife_of_row() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_job text;
  v_state text;
  v_sheet bigint;
  v_blank bigint;
  v_segment bigint;
  v_device text;
  v_own boolean;
BEGIN
  v_job := CASE WHEN tg_op = 'INSERT' THEN new.job ELSE old.job END;
  SELECT state, sheet, blank, segment, device, xmin = pg_current_xact_id()::xid
    INTO v_state, v_sheet, v_blank, v_segment, v_device, v_own FROM job WHERE id = v_job;
  IF NOT v_own THEN
    SELECT state, sheet, blank, segment, device
      INTO v_state, v_sheet, v_blank, v_segment, v_device FROM job WHERE id = v_job
      FOR NO KEY UPDATE;
  END IF;
  IF tg_table_name = 'arm' THEN
    PERFORM check_arm(v_job, v_state, v_sheet, v_blank, v_device);
  ELSE
    PERFORM check_attempts(v_job, v_state, v_sheet, v_blank, v_segment);
  END IF;
  RETURN NULL;
END $$;
-- An attempt and an arm keep their job.
CREATE FUNCTION popcut.job_stays() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  RAISE EXCEPTION USING ERRCODE = 'integrity_constraint_violation',
    MESSAGE = 'an attempt or an arm is of one job for good';
END $$;
CREATE TRIGGER job_stays BEFORE UPDATE OF job ON popcut.attempt
  FOR EACH ROW WHEN (old.job <> new.job) EXECUTE FUNCTION popcut.job_stays();
CREATE TRIGGER job_stays BEFORE UPDATE OF job ON popcut.arm
  FOR EACH ROW WHEN (old.job <> new.job) EXECUTE FUNCTION popcut.job_stays();
-- Only changes that can break the rule are looked at: progress of a cut costs nothing.
CREATE CONSTRAINT TRIGGER knife_insert AFTER INSERT ON popcut.job
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW
  WHEN (new.state IN ('armed', 'cutting', 'paused')) EXECUTE FUNCTION popcut.knife_of_job();
CREATE CONSTRAINT TRIGGER knife_update AFTER UPDATE ON popcut.job
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW
  WHEN ((old.state, old.sheet, old.blank, old.segment, old.device) IS DISTINCT FROM
          (new.state, new.sheet, new.blank, new.segment, new.device) AND
        (old.state IN ('armed', 'cutting', 'paused') OR
         new.state IN ('armed', 'cutting', 'paused'))) EXECUTE FUNCTION popcut.knife_of_job();
CREATE CONSTRAINT TRIGGER knife_insert AFTER INSERT ON popcut.attempt
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW
  WHEN (new.started_at IS NOT NULL AND new.ended IS NULL) EXECUTE FUNCTION popcut.knife_of_row();
CREATE CONSTRAINT TRIGGER knife_update AFTER UPDATE ON popcut.attempt
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW
  WHEN ((old.job, old.k, old.blank, old.segment, old.started_at IS NULL, old.ended IS NULL)
        IS DISTINCT FROM
        (new.job, new.k, new.blank, new.segment, new.started_at IS NULL, new.ended IS NULL))
  EXECUTE FUNCTION popcut.knife_of_row();
CREATE CONSTRAINT TRIGGER knife_delete AFTER DELETE ON popcut.attempt
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION popcut.knife_of_row();
CREATE CONSTRAINT TRIGGER knife_change AFTER INSERT OR UPDATE OR DELETE ON popcut.arm
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION popcut.knife_of_row();

-- A cutter belongs to the node that has it. Another takes it only when that node is not alive, or
-- says that the cutter is away from it; and a node speaks for itself only.
CREATE FUNCTION popcut.device_owner() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_login text;
BEGIN
  IF new.node <> '' THEN
    SELECT login INTO v_login FROM node WHERE name = new.node;
    IF NOT FOUND THEN
      RAISE EXCEPTION USING ERRCODE = 'foreign_key_violation',
        MESSAGE = format('device %s: there is no node %s', new.id, new.node);
    END IF;
    IF v_login <> session_user AND NOT pg_has_role(session_user, 'popcut_owner', 'MEMBER') THEN
      RAISE EXCEPTION USING ERRCODE = 'PC001',
        MESSAGE = format('device %s: the login %s does not speak for node %s', new.id,
                         session_user, new.node);
    END IF;
  END IF;
  IF tg_op = 'UPDATE' AND old.node <> '' THEN
    SELECT login INTO v_login FROM node WHERE name = old.node AND lease_until > clock_timestamp();
    IF FOUND AND old.state NOT IN ('absent', 'offline') AND v_login <> session_user AND
       NOT pg_has_role(session_user, 'popcut_owner', 'MEMBER') THEN
      RAISE EXCEPTION USING ERRCODE = 'PC002',
        MESSAGE = format('device %s is at node %s; unplug it there first', new.id, old.node);
    END IF;
  END IF;
  RETURN new;
END $$;
CREATE TRIGGER device_owner_insert BEFORE INSERT ON popcut.device
  FOR EACH ROW WHEN (new.node <> '') EXECUTE FUNCTION popcut.device_owner();
CREATE TRIGGER device_owner_update BEFORE UPDATE OF node ON popcut.device
  FOR EACH ROW WHEN (old.node <> new.node) EXECUTE FUNCTION popcut.device_owner();

-- ---------------------------------------------------------------------------------------------
-- Nodes. Leases go by clock_timestamp(), not now(): a transaction may have waited for a lock.

CREATE FUNCTION popcut.clock_ms() RETURNS bigint LANGUAGE sql VOLATILE
AS $$ SELECT (extract(epoch FROM clock_timestamp()) * 1000)::bigint $$;

-- Which of its pasts the database goes on from. A promoted standby and a recovery to a point in time
-- begin another timeline; files that were put back as they were do not, and only a node that knows
-- of later events can tell.
CREATE FUNCTION popcut.popcut_generation() RETURNS text LANGUAGE sql STABLE AS $$
  SELECT pg_catalog.concat(
    pg_catalog.substr(pg_catalog.pg_walfile_name(pg_catalog.pg_current_wal_lsn()), 1, 8), '.',
    went_back) FROM popcut.popcut_schema
$$;

-- Who calls is the login of that node, and of its present life.
CREATE FUNCTION popcut.node_check(one popcut.node, p_node text, p_epoch bigint) RETURNS void
LANGUAGE plpgsql AS $$
BEGIN
  IF one.name IS NULL THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE = format('there is no node %s', p_node);
  END IF;
  IF one.login <> session_user AND NOT pg_has_role(session_user, 'popcut_owner', 'MEMBER') THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('the login %s does not speak for node %s', session_user, p_node);
  END IF;
  IF one.epoch <> p_epoch THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('node %s is in its epoch %s; epoch %s is over', p_node, one.epoch, p_epoch);
  END IF;
END $$;
CREATE FUNCTION popcut.node_speaks(p_node text, p_epoch bigint) RETURNS void LANGUAGE plpgsql AS $$
DECLARE
  one node;
BEGIN
  SELECT * INTO one FROM node WHERE name = p_node;
  PERFORM node_check(one, p_node, p_epoch);
END $$;

-- The same, and its lease lives. This life of the node lasts until the transaction ends; the lock
-- lets beats pass.
CREATE FUNCTION popcut.node_lives(p_node text, p_epoch bigint) RETURNS popcut.node
LANGUAGE plpgsql AS $$
DECLARE
  one node;
BEGIN
  SELECT * INTO one FROM node WHERE name = p_node FOR KEY SHARE;
  PERFORM node_check(one, p_node, p_epoch);
  IF one.lease_until <= clock_timestamp() THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('the lease of node %s is over', p_node);
  END IF;
  RETURN one;
END $$;

-- Nothing is armed or started while a node may know of a start that the database has forgotten.
-- One that was stopped in order missed nothing when a standby took over.
CREATE FUNCTION popcut.generation_check() RETURNS void LANGUAGE plpgsql AS $$
DECLARE
  v_now text := popcut_generation();
  v_name text;
BEGIN
  -- Two ranges instead of one <>, so that the index can answer.
  SELECT name INTO v_name FROM node
    WHERE (generation < v_now OR generation > v_now) AND epoch > 0 AND
      (ended = 0 OR split_part(generation, '.', 2) <> split_part(v_now, '.', 2))
    ORDER BY name LIMIT 1;
  IF FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE =
      format('the database went back to an earlier state, and node %s has not compared its '
             'journals with it since; start it, or forget it: popcut fleet forget %s', v_name,
             v_name);
  END IF;
END $$;

-- A node begins a new life. Its epoch is one that no earlier life had, also when the database went
-- back and forgot some. `p_epoch_before` is that of its last life as it knows it, null if it knows
-- none; `p_last_event` is the greatest number of an event that it has seen. `fence` is the greatest
-- that was given so far.
CREATE FUNCTION popcut.node_begin(p_name text, p_identity text, p_url text, p_version text,
                                  p_epoch_before bigint, p_last_event bigint, OUT epoch bigint,
                                  OUT fence bigint, OUT now_ms bigint, OUT generation text)
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  c_first_lease CONSTANT double precision := 30;
  v_trusted boolean := pg_has_role(session_user, 'popcut_owner', 'MEMBER');
  v_other text;
  one node;
BEGIN
  IF NOT EXISTS (SELECT FROM node WHERE name = p_name) THEN
    -- One login is for one node, so that a stolen one is no more than that.
    IF NOT v_trusted THEN
      SELECT node.name INTO v_other FROM node WHERE login = session_user LIMIT 1;
      IF FOUND THEN
        RAISE EXCEPTION USING ERRCODE = 'PC001',
          MESSAGE = format('the login %s is for node %s; node %s needs one of its own',
                           session_user, v_other, p_name);
      END IF;
    END IF;
    INSERT INTO node(name, login, identity, epoch, url, version, begun, heartbeat, lease_until,
                     lease_s, generation, ended, draining)
      VALUES (p_name, session_user, '', 0, '', '', '-infinity', '-infinity', '-infinity',
              c_first_lease, '', 1, 0) ON CONFLICT (name) DO NOTHING;
  END IF;
  -- Waits for starts of the life before that are still under way.
  SELECT * INTO one FROM node WHERE node.name = p_name FOR UPDATE;
  IF one.login <> session_user AND NOT v_trusted THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('node %s is for the login %s, not for %s', p_name, one.login, session_user);
  END IF;
  IF one.lease_until > clock_timestamp() AND
     (one.identity <> p_identity OR one.epoch <> p_epoch_before) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC002',
      MESSAGE = format('another popcutd is node %s and is alive; give this one another name',
                       p_name);
  END IF;
  -- It does not know of the node's last life, either: that was in another database, as of two that
  -- take writes at once.
  IF p_last_event > (SELECT last FROM event_counter) OR
     (one.epoch > 0 AND p_epoch_before > one.epoch) THEN
    UPDATE popcut_schema SET went_back = greatest(went_back + 1, clock_ms());
  END IF;
  now_ms := clock_ms();
  epoch := greatest(one.epoch + 1, now_ms);
  UPDATE node SET identity = p_identity, epoch = node_begin.epoch, url = p_url,
      version = p_version, begun = clock_timestamp(), heartbeat = clock_timestamp(),
      lease_s = c_first_lease, ended = 0,
      lease_until = clock_timestamp() + make_interval(secs => c_first_lease)
    WHERE node.name = p_name;
  SELECT CASE WHEN is_called THEN last_value ELSE 0 END INTO fence FROM fence_seq;
  generation := popcut_generation();
END $$;

-- The node has compared its journals with the database.
CREATE FUNCTION popcut.node_reported(p_name text, p_epoch bigint) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  PERFORM node_speaks(p_name, p_epoch);
  UPDATE node SET generation = popcut_generation() WHERE name = p_name AND epoch = p_epoch;
END $$;

-- Renews the lease if it lives; if not, the node begins again. So it does when the database went
-- back, also when it knows fewer events than the node has seen, to compare its journals. A beat of
-- its own transaction may have synchronous_commit off: a beat that is lost makes a lease shorter,
-- never longer.
CREATE FUNCTION popcut.node_beat(p_name text, p_epoch bigint, p_lease_s double precision,
                                 p_last_event bigint, OUT alive boolean, OUT now_ms bigint,
                                 OUT is_draining bigint)
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_login text;
BEGIN
  IF p_lease_s IS NULL OR NOT p_lease_s BETWEEN 0.05 AND 3600 THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('a lease of %s s is not between 0.05 s and an hour', p_lease_s);
  END IF;
  UPDATE node SET heartbeat = clock_timestamp(), lease_s = p_lease_s,
      lease_until = clock_timestamp() + make_interval(secs => p_lease_s)
    WHERE name = p_name AND epoch = p_epoch AND lease_until > clock_timestamp() AND
      generation = popcut_generation() AND
      coalesce(p_last_event, 0) <= (SELECT last FROM event_counter)
    RETURNING login, draining INTO v_login, is_draining;
  alive := FOUND;
  IF NOT alive THEN
    SELECT login, draining INTO v_login, is_draining FROM node WHERE name = p_name;
  END IF;
  IF v_login IS NULL THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE = format('there is no node %s', p_name);
  END IF;
  IF v_login <> session_user AND NOT pg_has_role(session_user, 'popcut_owner', 'MEMBER') THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('the login %s does not speak for node %s', session_user, p_name);
  END IF;
  now_ms := clock_ms();
END $$;

-- An orderly stop: other nodes need not wait for the lease.
CREATE FUNCTION popcut.node_end(p_name text, p_epoch bigint) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  PERFORM node_speaks(p_name, p_epoch);
  UPDATE node SET lease_until = '-infinity', ended = 1 WHERE name = p_name AND epoch = p_epoch;
END $$;

-- Whether that life of a node is over. If its lease is, it is closed for good, also for a clock that
-- is put back, and what the node still starts has been waited for: what is read after this is all.
-- For as long as a lease lasts, somebody must have been alive without a break: when the database
-- was away, the leases of all are over, and each gets time to come back before its cut is lost.
CREATE FUNCTION popcut.node_lapse(p_name text, p_epoch bigint) RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one node;
BEGIN
  -- Only a node that may be dead is locked.
  SELECT * INTO one FROM node WHERE name = p_name;
  IF one.lease_until > clock_timestamp() THEN RETURN false; END IF;
  SELECT * INTO one FROM node WHERE name = p_name FOR UPDATE;
  IF one.name IS NULL THEN RETURN true; END IF;  -- it was forgotten
  IF one.lease_until > clock_timestamp() THEN RETURN false; END IF;
  IF one.lease_until = '-infinity' THEN RETURN true; END IF;
  IF NOT EXISTS (SELECT FROM node WHERE lease_until > clock_timestamp() AND
                 begun + make_interval(secs => one.lease_s) <= clock_timestamp()) THEN
    RETURN false;
  END IF;
  UPDATE node SET lease_until = '-infinity' WHERE name = p_name;
  RETURN true;
END $$;

-- For admins: a name for a login, before the node is there. An existing node gets the login.
CREATE FUNCTION popcut.node_join(p_name text, p_login text) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  INSERT INTO node(name, login, identity, epoch, url, version, begun, heartbeat, lease_until,
                   lease_s, generation, ended, draining)
    VALUES (p_name, p_login, '', 0, '', '', '-infinity', '-infinity', '-infinity', 30, '', 1, 0)
    ON CONFLICT (name) DO UPDATE SET login = excluded.login;
END $$;

-- A node that drains arms nothing more.
CREATE FUNCTION popcut.node_drain(p_name text, p_draining bigint) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  UPDATE node SET draining = p_draining WHERE name = p_name;
  IF NOT FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE = format('there is no node %s', p_name);
  END IF;
END $$;

CREATE FUNCTION popcut.node_forget(p_name text) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_until timestamptz;
  v_what text;
BEGIN
  SELECT lease_until INTO v_until FROM node WHERE name = p_name FOR UPDATE;
  IF NOT FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE = format('there is no node %s', p_name);
  END IF;
  IF v_until > clock_timestamp() THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('node %s is alive; stop its popcutd first', p_name);
  END IF;
  SELECT id INTO v_what FROM attempt WHERE node = p_name AND ended IS NULL LIMIT 1;
  IF FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('attempt %s of node %s is open; another node ends it in a moment', v_what,
                       p_name);
  END IF;
  SELECT job INTO v_what FROM arm WHERE node = p_name LIMIT 1;
  IF FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('job %s is armed at node %s; another node disarms it in a moment', v_what,
                       p_name);
  END IF;
  UPDATE device SET node = '', state = 'absent' WHERE node = p_name;
  UPDATE plan SET planner = '', planner_epoch = 0 WHERE planner = p_name;
  UPDATE search SET planner = '', planner_epoch = 0 WHERE planner = p_name;
  DELETE FROM node WHERE name = p_name;
END $$;

-- Makes the rows of tallies few again. Two at once would each fold what the other did.
CREATE FUNCTION popcut.node_tidy() RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  IF NOT pg_try_advisory_xact_lock(hashtextextended('popcut.node_tidy', 0)) THEN RETURN; END IF;
  WITH gone AS (DELETE FROM tally RETURNING state, jobs)
    INSERT INTO tally(state, jobs)
    SELECT state, sum(jobs) FROM gone GROUP BY state HAVING sum(jobs) <> 0;
  WITH gone AS (DELETE FROM end_tally RETURNING device, end_kind, attempts)
    INSERT INTO end_tally(device, end_kind, attempts)
    SELECT device, end_kind, sum(attempts) FROM gone GROUP BY device, end_kind
    HAVING sum(attempts) <> 0;
END $$;

-- ---------------------------------------------------------------------------------------------
-- Events

-- Gives numbers to committed events, and wakes the nodes that listen, but for `p_node`, which calls.
-- One caller at a time does the work; others get 0 at once. That caller must call again until
-- the answer is 0, and so also numbers the events of those who were turned away meanwhile.
-- Events of one job keep their order: a transaction takes their ids while it holds the job's row.
CREATE FUNCTION popcut.event_number(p_node text) RETURNS bigint LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  c_at_once CONSTANT bigint := 1000;
  v_last bigint;
  v_count bigint;
BEGIN
  -- A caller that finds nothing takes no lock and keeps no other caller out.
  PERFORM FROM event_new ORDER BY id LIMIT 1;
  IF NOT FOUND THEN RETURN 0; END IF;
  IF NOT pg_try_advisory_xact_lock(hashtextextended('popcut.event_counter', 0)) THEN
    RETURN 0;
  END IF;
  SELECT last INTO v_last FROM event_counter FOR UPDATE;
  WITH first AS (SELECT id FROM event_new ORDER BY id LIMIT c_at_once),
    gone AS (DELETE FROM event_new USING first WHERE event_new.id = first.id
             RETURNING event_new.id, time, kind, job, data),
    numbered AS (SELECT v_last + row_number() OVER (ORDER BY id) AS seq, time, kind, job, data
                 FROM gone)
    INSERT INTO event(seq, time, kind, job, data)
    SELECT seq, time, kind, job, '{"seq":' || seq || ',' || data FROM numbered;
  GET DIAGNOSTICS v_count = ROW_COUNT;
  IF v_count > 0 THEN
    UPDATE event_counter SET last = v_last + v_count;
    PERFORM pg_notify('popcut', p_node);
  END IF;
  RETURN greatest(v_count, 1);  -- 1 too if others were faster: this call may have turned some away
END $$;

-- ---------------------------------------------------------------------------------------------
-- The knife

CREATE FUNCTION popcut.knife_arm(p_node text, p_epoch bigint, p_job text, p_sheet bigint,
                                 p_blank bigint, p_device text, p_plan_sha256 text,
                                 p_operator text, p_armed bigint, p_invocation text)
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one node;
  v_at text;
  v_here text;
  v_site text;
BEGIN
  one := node_lives(p_node, p_epoch);
  PERFORM generation_check();
  IF one.draining = 1 THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('node %s is being drained and arms nothing more', p_node);
  END IF;
  SELECT node, site INTO v_at, v_here FROM device WHERE id = p_device;
  IF v_at IS DISTINCT FROM p_node THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE =
      CASE WHEN coalesce(v_at, '') = ''
        THEN format('device %s is at no node; plug it in at node %s', p_device, p_node)
        ELSE format('device %s is at node %s; arm it there', p_device, v_at) END;
  END IF;
  SELECT job.site INTO v_site FROM job JOIN plan ON plan.id = job.plan
    WHERE job.id = p_job AND plan.sha256 = p_plan_sha256;
  IF NOT FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('the plan %s is not that of job %s', p_plan_sha256, p_job);
  END IF;
  IF v_site <> '' AND v_site <> v_here THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE =
      format('device %s is at %s; job %s is for site %s', p_device,
             CASE WHEN v_here = '' THEN 'no site' ELSE 'site ' || v_here END, p_job, v_site);
  END IF;
  INSERT INTO arm(job, sheet, blank, device, plan_sha256, operator, armed, invocation, node, epoch)
    VALUES (p_job, p_sheet, p_blank, p_device, p_plan_sha256, p_operator, p_armed, p_invocation,
            p_node, p_epoch)
    ON CONFLICT (job) DO UPDATE SET sheet = excluded.sheet, blank = excluded.blank,
      device = excluded.device, plan_sha256 = excluded.plan_sha256, operator = excluded.operator,
      armed = excluded.armed, invocation = excluded.invocation, node = excluded.node,
      epoch = excluded.epoch;
END $$;

-- To disarm is safe at any time, so every node may.
CREATE FUNCTION popcut.knife_disarm(p_job text) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  DELETE FROM arm WHERE job = p_job;
END $$;

-- The fences given from now on are above `p_least`. Not undone if the transaction is: that is
-- what makes the next try succeed.
CREATE FUNCTION popcut.fence_above(p_least bigint) RETURNS void LANGUAGE plpgsql AS $$
DECLARE
  c_most_at_once CONSTANT bigint := 1000000000;  -- no backup is so old; and the numbers never end
BEGIN
  IF p_least > (SELECT last_value FROM fence_seq) + c_most_at_once THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('the fence %s is no number that this database can have given', p_least);
  END IF;
  PERFORM pg_advisory_xact_lock(hashtextextended('popcut.fence_seq', 0));
  IF (SELECT last_value < p_least OR (last_value = p_least AND NOT is_called) FROM fence_seq) THEN
    PERFORM setval('fence_seq', p_least);
  END IF;
END $$;

-- The only way to lower a knife: what was armed is started, once.
CREATE FUNCTION popcut.knife_start(p_node text, p_epoch bigint, p_id text, p_job text, p_k bigint,
                                   p_blank bigint, p_segment bigint, p_first_stroke bigint,
                                   p_strokes bigint, p_device text, p_device_session text,
                                   p_operator text, p_plan_sha256 text, p_invocation text,
                                   p_created bigint, p_least_fence bigint)
RETURNS bigint LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one node;
  v_fence bigint;
BEGIN
  one := node_lives(p_node, p_epoch);
  PERFORM generation_check();
  DELETE FROM arm WHERE job = p_job AND sheet = p_k AND blank = p_blank AND device = p_device AND
      plan_sha256 = p_plan_sha256 AND node = p_node AND epoch = p_epoch;
  IF NOT FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE =
      format('sheet %s (blank %s) of job %s is not armed on %s by node %s in its epoch %s; '
             'arm it again', p_k, p_blank, p_job, p_device, p_node, p_epoch);
  END IF;
  IF NOT EXISTS (SELECT FROM device WHERE id = p_device AND node = p_node) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('device %s is no longer at node %s', p_device, p_node);
  END IF;
  v_fence := nextval('fence_seq');
  IF v_fence <= coalesce(p_least_fence, 0) THEN
    PERFORM fence_above(p_least_fence);
    RAISE EXCEPTION USING ERRCODE = 'PC001', MESSAGE =
      format('the fence %s is not above %s, which a journal of node %s knows: the database was '
             'restored to an earlier time; restart the node, so that it reports what it started since',
             v_fence, p_least_fence, p_node);
  END IF;
  INSERT INTO attempt(id, job, k, blank, segment, first_stroke, strokes, device, device_session,
                      operator, plan_sha256, invocation, created, started_at, ended, end_kind,
                      bytes_taken, last_status, node, epoch, fence, identity)
    VALUES (p_id, p_job, p_k, p_blank, p_segment, p_first_stroke, p_strokes, p_device,
            p_device_session, p_operator, p_plan_sha256, p_invocation, p_created, p_created, NULL,
            '', 0, '', p_node, p_epoch, v_fence, one.identity);
  RETURN v_fence;
END $$;

-- An attempt of that node, locked: an open one, or one that ended as one of p_kinds.
CREATE FUNCTION popcut.attempt_of(p_node text, p_id text, p_kinds text[]) RETURNS popcut.attempt
LANGUAGE plpgsql AS $$
DECLARE
  one attempt;
BEGIN
  SELECT * INTO one FROM attempt WHERE id = p_id FOR NO KEY UPDATE;
  IF one.id IS NULL THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003', MESSAGE = format('there is no attempt %s', p_id);
  END IF;
  IF one.node <> p_node THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003',
      MESSAGE = format('attempt %s is of node %s, not of node %s', p_id, one.node, p_node);
  END IF;
  IF one.ended IS NOT NULL AND one.end_kind <> ALL (p_kinds) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003',
      MESSAGE = format('attempt %s has ended as %s', p_id, one.end_kind);
  END IF;
  RETURN one;
END $$;

-- One chunk as it should be; without strokes it goes. Written only if it differs, in place.
CREATE FUNCTION popcut.put_chunk(p_attempt text, p_seq bigint, p_from bigint, p_to bigint,
                                 p_state text)
RETURNS void LANGUAGE plpgsql AS $$
BEGIN
  IF p_to < p_from THEN
    DELETE FROM chunk WHERE attempt = p_attempt AND seq = p_seq;
    RETURN;
  END IF;
  INSERT INTO chunk(attempt, seq, path_from, path_to, state)
    VALUES (p_attempt, p_seq, p_from, p_to, p_state)
    ON CONFLICT (attempt, seq) DO UPDATE
      SET path_from = p_from, path_to = p_to, state = p_state
      WHERE (chunk.path_from, chunk.path_to, chunk.state) IS DISTINCT FROM
            (p_from, p_to, p_state);
END $$;

-- Strokes p_first .. p_certain are cut, those up to p_taken have a byte with the device, those up
-- to p_intended are about to be sent. What is marked only grows: a statement that was late on its
-- way takes nothing back.
CREATE FUNCTION popcut.knife_mark(p_node text, p_epoch bigint, p_id text, p_first bigint,
                                  p_certain bigint, p_taken bigint, p_intended bigint,
                                  p_bytes bigint)
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  v_certain bigint;
  v_taken bigint;
  v_intended bigint;
BEGIN
  PERFORM node_speaks(p_node, p_epoch);
  PERFORM attempt_of(p_node, p_id, '{}');
  SELECT max(path_to) FILTER (WHERE state = 'certain'), max(path_to) FILTER (WHERE state = 'sent'),
         max(path_to) INTO v_certain, v_taken, v_intended FROM chunk WHERE attempt = p_id;
  v_certain := greatest(v_certain, p_certain);
  v_taken := greatest(v_taken, v_certain, p_taken);
  v_intended := greatest(v_intended, p_intended);
  PERFORM put_chunk(p_id, 0, p_first, v_certain, 'certain');
  PERFORM put_chunk(p_id, 1, greatest(p_first, v_certain + 1), v_taken, 'sent');
  PERFORM put_chunk(p_id, 2, greatest(p_first, v_taken + 1), v_intended, 'intent');
  UPDATE attempt SET bytes_taken = p_bytes WHERE id = p_id AND bytes_taken < p_bytes;
END $$;

-- The final fates; they replace what was marked. The truth of the node that cut goes over what
-- others took for lost; of an attempt that is superseded only the fates become true.
CREATE FUNCTION popcut.knife_end(p_node text, p_epoch bigint, p_id text, p_ended bigint,
                                 p_end_kind text, p_last_status text, p_bytes bigint,
                                 p_from bigint[], p_to bigint[], p_state text[])
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  PERFORM node_speaks(p_node, p_epoch);
  PERFORM attempt_of(p_node, p_id, '{lost,superseded}');
  UPDATE attempt SET ended = p_ended,
      end_kind = CASE WHEN end_kind = 'superseded' THEN end_kind ELSE p_end_kind END,
      last_status = p_last_status,
      bytes_taken = greatest(bytes_taken, p_bytes) WHERE id = p_id;
  DELETE FROM chunk WHERE attempt = p_id;
  INSERT INTO chunk(attempt, seq, path_from, path_to, state)
    SELECT p_id, row_number() OVER (ORDER BY n) - 1, f, t, s
    FROM unnest(p_from, p_to, p_state) WITH ORDINALITY AS runs(f, t, s, n) WHERE t >= f;
END $$;

-- As if it had never been started: not a byte was sent. One that is marked was about to send some.
CREATE FUNCTION popcut.knife_never(p_node text, p_epoch bigint, p_id text, p_ended bigint)
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one attempt;
BEGIN
  PERFORM node_speaks(p_node, p_epoch);
  one := attempt_of(p_node, p_id, '{lost}');
  IF one.bytes_taken > 0 OR EXISTS (SELECT FROM chunk WHERE attempt = p_id) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003',
      MESSAGE = format('attempt %s was about to send strokes, so it was started', p_id);
  END IF;
  UPDATE attempt SET started_at = NULL, ended = p_ended, end_kind = 'refused' WHERE id = p_id;
  DELETE FROM chunk WHERE attempt = p_id;
END $$;

-- Strokes that are not certain, up to p_doubt_upto, become doubtful: it cannot be known any more.
-- By the node that cut; by any other only when the lease of that node is over.
CREATE FUNCTION popcut.knife_crash(p_node text, p_epoch bigint, p_id text, p_ended bigint,
                                   p_end_kind text, p_last_status text, p_doubt_upto bigint)
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one attempt;
  v_certain bigint;
BEGIN
  PERFORM node_speaks(p_node, p_epoch);
  IF p_end_kind NOT IN ('crash', 'lost', 'superseded') THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003',
      MESSAGE = format('an attempt breaks off as crash, lost or superseded, not as %s', p_end_kind);
  END IF;
  SELECT * INTO one FROM attempt WHERE id = p_id FOR NO KEY UPDATE;
  IF one.node = p_node THEN
    one := attempt_of(p_node, p_id, '{lost}');
  ELSIF EXISTS (SELECT FROM node WHERE name = one.node AND lease_until > clock_timestamp()) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC001',
      MESSAGE = format('attempt %s is of node %s, which is alive', p_id, one.node);
  ELSE
    PERFORM node_lives(p_node, p_epoch);
    one := attempt_of(one.node, p_id, '{}');
  END IF;
  UPDATE attempt SET ended = p_ended, end_kind = p_end_kind, last_status = p_last_status
    WHERE id = p_id;
  DELETE FROM chunk WHERE attempt = p_id AND state <> 'certain';
  SELECT coalesce(max(path_to), -1) INTO v_certain FROM chunk WHERE attempt = p_id;
  INSERT INTO chunk(attempt, seq, path_from, path_to, state)
    SELECT p_id, (SELECT coalesce(max(seq), 0) + 1 FROM chunk WHERE attempt = p_id),
           greatest(one.first_stroke, v_certain + 1), p_doubt_upto, 'doubt'
    WHERE p_doubt_upto >= greatest(one.first_stroke, v_certain + 1);
END $$;

-- A node that is back continues its cut, if the job has not been changed since.
CREATE FUNCTION popcut.knife_again(p_node text, p_epoch bigint, p_id text) RETURNS void
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
DECLARE
  one attempt;
BEGIN
  PERFORM node_lives(p_node, p_epoch);
  one := attempt_of(p_node, p_id, '{lost}');
  IF one.started_at IS NULL OR NOT EXISTS (
      SELECT FROM job WHERE id = one.job AND sheet = one.k AND blank = one.blank AND
        segment = one.segment AND state IN ('interrupted', 'cutting', 'paused')) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003', MESSAGE =
      format('attempt %s is superseded: job %s has moved on from sheet %s (blank %s, segment %s)',
             p_id, one.job, one.k, one.blank, one.segment);
  END IF;
  UPDATE attempt SET ended = NULL, end_kind = '', last_status = '', epoch = p_epoch
    WHERE id = p_id;
  -- The node's journal knows what of this was sent, and marks it at once.
  DELETE FROM chunk WHERE attempt = p_id AND state = 'doubt';
END $$;

-- An attempt that a journal knows and the database does not: the database is an older one,
-- restored. It comes back as lost, and the caller says at once how it ended. If its fence was given
-- again since, it gets another one.
CREATE FUNCTION popcut.knife_bring_back(p_node text, p_epoch bigint, p_id text, p_job text,
                                        p_k bigint, p_blank bigint, p_segment bigint,
                                        p_first_stroke bigint, p_strokes bigint, p_device text,
                                        p_device_session text, p_operator text,
                                        p_plan_sha256 text, p_invocation text, p_created bigint,
                                        p_started_at bigint, p_fence bigint, p_identity text)
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, popcut, pg_temp AS $$
BEGIN
  PERFORM node_speaks(p_node, p_epoch);
  IF NOT EXISTS (SELECT FROM job WHERE id = p_job) THEN
    RAISE EXCEPTION USING ERRCODE = 'PC003',
      MESSAGE = format('attempt %s is of job %s, which the database does not know', p_id, p_job);
  END IF;
  IF p_fence IS NOT NULL THEN PERFORM fence_above(p_fence); END IF;
  INSERT INTO attempt(id, job, k, blank, segment, first_stroke, strokes, device, device_session,
                      operator, plan_sha256, invocation, created, started_at, ended, end_kind,
                      bytes_taken, last_status, node, epoch, fence, identity)
    VALUES (p_id, p_job, p_k, p_blank, p_segment, p_first_stroke, p_strokes, p_device,
            p_device_session, p_operator, p_plan_sha256, p_invocation, p_created, p_started_at,
            p_created, 'lost', 0, '', p_node, p_epoch,
            CASE WHEN p_fence IS NULL OR EXISTS (SELECT FROM attempt WHERE fence = p_fence)
                 THEN nextval('fence_seq') ELSE p_fence END, p_identity);
END $$;

-- ---------------------------------------------------------------------------------------------
-- Who may do what

REVOKE ALL ON ALL FUNCTIONS IN SCHEMA popcut FROM PUBLIC;
GRANT USAGE ON SCHEMA popcut TO popcut_node, popcut_admin;

GRANT SELECT ON ALL TABLES IN SCHEMA popcut TO popcut_node;
GRANT SELECT ON ALL SEQUENCES IN SCHEMA popcut TO popcut_node;
GRANT INSERT, UPDATE, DELETE ON popcut.blob, popcut.blob_part, popcut.asset,
  popcut.design, popcut.asset_use, popcut.plan, popcut.plan_sheet, popcut.plan_asker, popcut.job,
  popcut.search, popcut.ownership,
  popcut.tally, popcut.sheet, popcut.event, popcut.event_new, popcut.idem, popcut.audit, popcut.token,
  popcut.session, popcut.material, popcut.device, popcut.usage, popcut.calendar, popcut.end_tally
  TO popcut_node;
GRANT EXECUTE ON FUNCTION popcut.clock_ms(), popcut.popcut_generation(),
  popcut.node_begin(text, text, text, text, bigint, bigint), popcut.node_reported(text, bigint),
  popcut.node_beat(text, bigint, double precision, bigint), popcut.node_lapse(text, bigint),
  popcut.node_end(text, bigint), popcut.node_tidy(), popcut.event_number(text),
  popcut.knife_arm(text, bigint, text, bigint, bigint, text, text, text, bigint, text),
  popcut.knife_disarm(text),
  popcut.knife_start(text, bigint, text, text, bigint, bigint, bigint, bigint, bigint, text, text,
                     text, text, text, bigint, bigint),
  popcut.knife_mark(text, bigint, text, bigint, bigint, bigint, bigint, bigint),
  popcut.knife_end(text, bigint, text, bigint, text, text, bigint, bigint[], bigint[], text[]),
  popcut.knife_never(text, bigint, text, bigint),
  popcut.knife_crash(text, bigint, text, bigint, text, text, bigint),
  popcut.knife_again(text, bigint, text),
  popcut.knife_bring_back(text, bigint, text, text, bigint, bigint, bigint, bigint, bigint, text,
                          text, text, text, text, bigint, bigint, bigint, text)
  TO popcut_node;

GRANT SELECT ON popcut.popcut_schema, popcut.node, popcut.node_state, popcut.attempt, popcut.arm,
  popcut.device, popcut.job TO popcut_admin;
GRANT EXECUTE ON FUNCTION popcut.node_join(text, text), popcut.node_drain(text, bigint),
  popcut.node_forget(text) TO popcut_admin;

RESET ROLE;
SET LOCAL search_path TO DEFAULT;
