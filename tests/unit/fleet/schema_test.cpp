// SPDX-License-Identifier: MIT
// The rules that a fleet's database keeps by itself, whatever a popcutd asks of it.
#include <array>
#include <atomic>
#include <barrier>
#include <chrono>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/sqlite_database.hpp"
#include "tests/support/fleet_sql.hpp"

namespace popcut::testing::fleet_schema_test {
namespace {

using namespace std::chrono_literals;
using Catch::Contains;
using Catch::StartsWith;

bool skipped() {
  const std::string why = PostgresServer::why_not();
  if (!why.empty()) WARN("skipped: " << why);
  return !why.empty();
}

/// Two rooms with a cutter each, and a job that is ready.
struct TwoRooms {
  TwoRooms() {
    REQUIRE(one.begin().empty());
    REQUIRE(two.begin().empty());
    fleet.add_device("left", "room-1");
    fleet.add_device("right", "room-2");
    fleet.add_job("JOB");
  }
  /// The state of the job, and of an attempt: "cutting", "done".
  std::string state(const std::string& job = "JOB") {
    return fleet("SELECT state FROM job WHERE id='" + FleetSql::id(job) + "'");
  }
  std::string attempt(const std::string& name) {
    return fleet("SELECT started_at, ended, end_kind FROM attempt WHERE id='" + FleetSql::id(name) +
                 "'");
  }
  std::string chunks(const std::string& name) {
    return fleet("SELECT path_from, path_to, state FROM chunk WHERE attempt='" +
                 FleetSql::id(name) + "' ORDER BY path_from");
  }
  void start(FleetNode& node, const std::string& device, const std::string& name,
             const std::string& job = "JOB") {
    REQUIRE(node.arm(job, device).empty());
    REQUIRE(node.start(name, job, device).empty());
  }
  std::string interrupt(const std::string& job = "JOB") {
    return "UPDATE job SET state='interrupted', rev=rev+1 WHERE id='" + FleetSql::id(job) + "';";
  }
  /// The lease of that node is over, and closed.
  void lapse(FleetNode& dead, FleetNode& witness) {
    REQUIRE(dead.beat(0.05) == "t");
    std::this_thread::sleep_for(80ms);
    REQUIRE(lapsed(dead, witness) == "t");
  }
  static std::string lapsed(FleetNode& dead, FleetNode& witness) {
    return witness.line.tried(fmt::format("SELECT node_lapse('{}', {})", dead.name, dead.epoch));
  }
  FleetSql fleet;
  FleetNode one{fleet, "room-1", "popcut_n_room_1"};
  FleetNode two{fleet, "room-2", "popcut_n_room_2"};
};

std::string crash_values(const std::string& name, const std::string& kind, int upto) {
  return fmt::format("'{}', 8, '{}', '', {}", FleetSql::id(name), kind, upto);
}

}  // namespace

TEST_CASE(
    "the schema of a fleet is made in one transaction, in several databases of a cluster, by "
    "an admin who is no superuser",
    "[fleet]") {
  if (skipped()) return;
  const FreshDatabase first, second, third;
  first.run_sql(std::string(daemon::fleet_schema()));
  CHECK(first.run_sql("SELECT version, least, went_back FROM popcut.popcut_schema") == "1|1|0");
  shared_postgres().run_sql("CREATE ROLE boss LOGIN CREATEROLE");
  second.run_sql(fmt::format("GRANT CREATE ON DATABASE {} TO boss", second.name()));
  run_sql(second.url("boss"), std::string(daemon::fleet_schema()));
  CHECK(second.run_sql("SELECT pg_get_userbyid(nspowner) FROM pg_namespace WHERE nspname="
                       "'popcut'") == "popcut_owner");
  CHECK(second.run_sql("SELECT count(*) FROM pg_class WHERE relnamespace='popcut'::regnamespace "
                       "AND pg_get_userbyid(relowner) <> 'popcut_owner'") == "0");
  CHECK_THROWS_WITH(first.run_sql(std::string(daemon::fleet_schema())), Contains("already exists"));
  // Statement by statement, as psql sends them, nothing is made.
  const std::string schema = std::string(daemon::fleet_schema());
  const std::size_t end = schema.find("END $$;", schema.find("FOREACH"));
  FleetLine line(third.url());
  const std::size_t cut = schema.find("DO $$\nDECLARE");
  CHECK(line.tried(schema.substr(0, cut)).empty());
  CHECK_THAT(line.tried(schema.substr(cut, end + 7 - cut)), Contains("in one transaction"));
  CHECK(third.run_sql("SELECT count(*) FROM pg_namespace WHERE nspname='popcut'") == "0");
  second.run_sql("DROP SCHEMA popcut CASCADE; REVOKE CREATE ON DATABASE " + second.name() +
                 " FROM boss");
}

TEST_CASE("every table and column of SQLite is in a fleet's database", "[fleet]") {
  if (skipped()) return;
  using Columns = std::map<std::string, std::string>;  // type by name
  daemon::SqliteDatabase file({.path = ":memory:", .exclusive_wal = false});
  daemon::build_schema(file);
  std::map<std::string, Columns> small, shared;
  std::set<std::string> defaults_small, defaults_shared;
  daemon::Rows columns = file.rows(
      "SELECT t.name, c.name, c.type, c.\"notnull\" OR c.pk > 0, c.dflt_value FROM "
      "pragma_table_list AS t JOIN pragma_table_info(t.name) AS c WHERE t.schema='main' AND "
      "t.name NOT LIKE 'sqlite_%'");
  const std::map<std::string, std::string> types{
      {"TEXT", "text"}, {"INTEGER", "bigint"}, {"REAL", "double precision"}};
  while (columns.next()) {
    small[columns.text(0)][columns.text(1)] =
        types.at(columns.text(2)) + (columns.integer(3) != 0 ? " not null" : "");
    if (!columns.null(4))
      defaults_small.insert(columns.text(0) + "." + columns.text(1) + " " + columns.text(4));
  }
  FleetSql fleet;
  std::istringstream rows(fleet(
      "SELECT table_name, column_name, data_type || CASE is_nullable WHEN 'NO' THEN ' not null' "
      "ELSE '' END, coalesce(collation_name, ''), regexp_replace(coalesce(column_default, ''), "
      "'::text$', '') FROM information_schema.columns JOIN information_schema.tables USING "
      "(table_schema, table_name) WHERE table_schema='popcut' AND table_type='BASE TABLE'"));
  for (std::string row; std::getline(rows, row);) {
    std::vector<std::string> fields(1);
    for (const char c : row)
      if (c == '|')
        fields.emplace_back();
      else
        fields.back() += c;
    REQUIRE(fields.size() == 5);
    shared[fields[0]][fields[1]] = fields[2];
    if (fields[2].starts_with("text")) {
      INFO(fields[0] << "." << fields[1]);
      CHECK(fields[3] == "C");
    }
    if (!fields[4].empty()) defaults_shared.insert(fields[0] + "." + fields[1] + " " + fields[4]);
  }
  CHECK(small.size() > 20);
  // Numbers of rows are counted by the database in both.
  const std::set<std::string> only_there{"node",          "blob",      "blob_part",
                                         "event_counter", "event_new", "popcut_schema"};
  for (const auto& [table, its] : small) {
    INFO(table);
    REQUIRE(shared.contains(table));
    CHECK(shared.at(table) == its);
  }
  for (const auto& [table, its] : shared) {
    INFO(table);
    CHECK(small.contains(table) != only_there.contains(table));
  }
  for (const std::string& one : defaults_small) {
    INFO(one);
    CHECK(defaults_shared.contains(one));
  }
  // Indexes too: what is looked for there is looked for here.
  const std::string there =
      " " + fleet("SELECT string_agg(indexname, ' ') FROM pg_indexes WHERE schemaname='popcut'") +
      " ";
  daemon::Rows indexes = file.rows(
      "SELECT name FROM sqlite_master WHERE type='index' AND sql "
      "IS NOT NULL");
  while (indexes.next()) CHECK_THAT(there, Contains(" " + indexes.text(0) + " "));
  const std::string triggers = " " +
                               fleet(
                                   "SELECT string_agg(DISTINCT trigger_name, ' ') FROM "
                                   "information_schema.triggers WHERE trigger_schema='popcut'") +
                               " ";
  daemon::Rows kept = file.rows("SELECT name FROM sqlite_master WHERE type='trigger'");
  while (kept.next()) CHECK_THAT(triggers, Contains(" " + kept.text(0) + " "));
}

TEST_CASE("a node's name is that of one popcutd at a time", "[fleet]") {
  if (skipped()) return;
  FleetSql fleet;
  FleetNode first(fleet, "room-1", "popcut_n_room_1");
  FleetNode other(fleet, "room-1", "popcut_n_other");
  FleetNode greedy(fleet, "room-9", "popcut_n_room_1");
  FleetNode odd(fleet, "room 1", "popcut_n_odd");
  CHECK(first.begin("folder a").empty());
  CHECK(first.beat() == "t");
  CHECK_THAT(other.begin(), StartsWith("PC001 node room-1 is for the login popcut_n_room_1"));
  CHECK_THAT(greedy.begin(), StartsWith("PC001 the login popcut_n_room_1 is for node room-1"));
  CHECK_THAT(odd.begin(), StartsWith("23514"));
  FleetNode copy(fleet, "room-1", "popcut_n_room_1");
  CHECK_THAT(copy.begin_only("folder b"), StartsWith("PC002 another popcutd is node room-1"));
  // A copy of the whole machine does not know the last life.
  CHECK_THAT(copy.begin_only("folder a", "7"), StartsWith("PC002"));
  const std::string before = first.epoch;
  CHECK(copy.begin_only("folder a", before).empty());
  CHECK(copy.epoch > before);
  CHECK(first.beat() == "f");  // it has a newer life
  CHECK_THAT(first.call("node_end", ""), StartsWith("PC001 node room-1 is in its epoch"));
  CHECK(copy.call("node_end", "").empty());
  CHECK(fleet("SELECT ended, alive FROM node_state") == "1|0");
  CHECK(copy.beat() == "f");
  CHECK(copy.begin_only("folder b").empty());  // nobody is alive there
  other.epoch = copy.epoch;
  CHECK_THAT(other.beat(), StartsWith("PC001 the login popcut_n_other does not speak for node"));
  CHECK_THAT(other.call("node_reported", ""), StartsWith("PC001"));
  CHECK_THAT(copy.beat(0), StartsWith("PC001 a lease of 0 s"));
  // A name that an admin gave to a login is kept for it.
  fleet("SELECT node_join('room-2', 'popcut_n_room_2')");
  FleetNode thief(fleet, "room-2", "popcut_n_thief"), rightful(fleet, "room-2", "popcut_n_room_2");
  CHECK_THAT(thief.begin(), StartsWith("PC001 node room-2 is for the login popcut_n_room_2"));
  CHECK(rightful.begin().empty());
}

TEST_CASE("a lease goes by the clock of the database, and what is over stays over", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "f");
  CHECK(rooms.one.beat(0.05) == "t");
  // A transaction that began before the lease ended sees that it is over.
  CHECK(
      rooms.one.line.tried(fmt::format(
          "BEGIN; SELECT 1; SELECT pg_sleep(0.1); SELECT alive FROM node_beat('room-1', {}, 30, 0)",
          rooms.one.epoch)) == "f");
  rooms.one.line("ROLLBACK");
  CHECK_THAT(rooms.one.arm("JOB", "left"), StartsWith("PC001 the lease of node room-1 is over"));
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "t");
  CHECK(rooms.fleet("SELECT lease_until FROM node WHERE name='room-1'") == "-infinity");
  CHECK(rooms.one.beat() == "f");
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "t");
  const std::string old = rooms.one.epoch;
  CHECK(rooms.one.begin().empty());
  CHECK(rooms.one.beat() == "t");
  rooms.one.epoch = old;
  CHECK_THAT(rooms.one.arm("JOB", "left"), StartsWith("PC001 node room-1 is in its epoch"));
}

TEST_CASE("after an outage of the database every node gets time to come back", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  CHECK(rooms.one.beat(0.15) == "t");
  CHECK(rooms.two.beat(0.05) == "t");
  std::this_thread::sleep_for(200ms);  // the database was away: nobody is alive
  CHECK(rooms.two.begin().empty());
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "f");
  std::this_thread::sleep_for(200ms);
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "t");
}

TEST_CASE("only the node that has the cutter arms it, and not while it is drained", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.fleet.add_device("shelf", "");
  CHECK_THAT(rooms.two.arm("JOB", "left"), StartsWith("PC001 device left is at node room-1"));
  CHECK_THAT(rooms.two.arm("JOB", "shelf"), StartsWith("PC001 device shelf is at no node"));
  CHECK_THAT(rooms.two.arm("JOB", "none"), StartsWith("PC001 device none is at no node"));
  FleetNode liar(rooms.fleet, "room-1", "popcut_n_room_2");
  liar.epoch = rooms.one.epoch;
  CHECK_THAT(liar.arm("JOB", "left"),
             StartsWith("PC001 the login popcut_n_room_2 does not speak for node room-1"));
  CHECK_THAT(rooms.one.call("knife_arm", "'" + FleetSql::id("JOB") + "', 1, 1, 'left', '" +
                                             std::string(64, 'b') + "', 'olga', 5, 'run'"),
             StartsWith("PC001 the plan bbb"));
  rooms.fleet("UPDATE job SET site='upstairs'");
  CHECK_THAT(rooms.one.arm("JOB", "left"), StartsWith("PC001 device left is at no site; job "));
  rooms.fleet("UPDATE device SET site='cellar' WHERE id='left'");
  CHECK_THAT(rooms.one.arm("JOB", "left"),
             StartsWith("PC001 device left is at site cellar; job ") && Contains("site upstairs"));
  CHECK(rooms.fleet("SELECT count(*) FROM arm") == "0");
  rooms.fleet("UPDATE device SET site='upstairs' WHERE id='left'");
  rooms.fleet("SELECT node_drain('room-1', 1)");
  CHECK(rooms.one.line.tried(fmt::format("SELECT alive, is_draining FROM node_beat('room-1', {}, "
                                         "30, 0)",
                                         rooms.one.epoch)) == "t|1");
  CHECK_THAT(rooms.one.arm("JOB", "left"), StartsWith("PC001 node room-1 is being drained"));
  rooms.fleet("SELECT node_drain('room-1', 0)");
  CHECK(rooms.state() == "ready");
  CHECK(rooms.one.arm("JOB", "left").empty());
  CHECK(rooms.fleet("SELECT node, epoch FROM arm") == "room-1|" + rooms.one.epoch);
  // Everybody may disarm.
  CHECK(rooms.two.line
            .tried("SELECT knife_disarm('" + FleetSql::id("JOB") +
                   "'); UPDATE job SET state='ready', device=''")
            .empty());
  CHECK(rooms.fleet("SELECT count(*) FROM arm") == "0");
}

TEST_CASE("a knife goes down only for what was armed, at the node where it was armed", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"), StartsWith("PC001 sheet 1 (blank 1) of job"));
  REQUIRE(rooms.one.arm("JOB", "left").empty());
  CHECK_THAT(rooms.two.start("A1", "JOB", "left"), Contains("is not armed on left by node room-2"));
  CHECK_THAT(rooms.one.start("A1", "JOB", "right"), Contains("is not armed on right"));
  const auto start_of = [&](int sheet, int blank, const std::string& plan) {
    return rooms.one.call("knife_start",
                          fmt::format("'{}', '{}', {}, {}, 1, 0, 10, 'left', 's', 'olga', '{}', "
                                      "'run', 6, 0",
                                      FleetSql::id("A1"), FleetSql::id("JOB"), sheet, blank, plan));
  };
  CHECK_THAT(start_of(2, 1, FleetSql::plan_sha256()), StartsWith("PC001 sheet 2"));
  CHECK_THAT(start_of(1, 2, FleetSql::plan_sha256()), Contains("(blank 2)"));
  CHECK_THAT(start_of(1, 1, std::string(64, 'b')), StartsWith("PC001"));
  // Without the job there is no start either.
  CHECK_THAT(start_of(1, 1, FleetSql::plan_sha256()), StartsWith("23514"));
  // What an earlier life armed is not started by the next.
  REQUIRE(rooms.one.begin().empty());
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"), Contains("arm it again"));
  REQUIRE(rooms.one
              .call("knife_arm", "'" + FleetSql::id("JOB") + "', 1, 1, 'left', '" +
                                     FleetSql::plan_sha256() + "', 'olga', 5, 'run'")
              .empty());
  rooms.fleet("UPDATE device SET node='' WHERE id='left'");
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"), StartsWith("PC001 device left is no longer"));
  rooms.fleet("UPDATE device SET node='room-1' WHERE id='left'");
  CHECK(rooms.one.beat(0.05) == "t");
  std::this_thread::sleep_for(80ms);
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"), StartsWith("PC001 the lease of node room-1"));
  CHECK(rooms.state() == "armed");
  CHECK(rooms.fleet("SELECT count(*) FROM attempt") == "0");
}

TEST_CASE("a blank is started once, and a machine cuts one sheet at a time", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  CHECK(rooms.fleet("SELECT node, epoch, identity, started_at, fence > 0 FROM attempt") ==
        "room-1|" + rooms.one.epoch + "|room-1|6|t");
  CHECK(rooms.fleet("SELECT count(*) FROM arm") == "0");
  // Sent twice: the arm is used up.
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"), StartsWith("PC001"));
  CHECK_THAT(rooms.one.start("A2", "JOB", "left"), StartsWith("PC001"));
  // Code that forgot that this blank was started.
  REQUIRE(rooms.one.line
              .tried(rooms.one.call_sql("knife_crash", crash_values("A1", "crash", 9)) +
                     rooms.interrupt())
              .empty());
  REQUIRE(rooms.state() == "interrupted");
  rooms.fleet("UPDATE job SET state='ready', device=''");
  REQUIRE(rooms.two.arm("JOB", "right").empty());
  CHECK_THAT(rooms.two.start("A3", "JOB", "right"),
             StartsWith("23505") && Contains("attempt_once"));
  CHECK(rooms.state() == "armed");
  // On another blank it goes, once.
  rooms.fleet("SELECT knife_disarm(id) FROM job; UPDATE job SET state='ready', blank=2, device=''");
  rooms.start(rooms.two, "right", "A3");
  CHECK(rooms.state() == "cutting");
  // The machine is busy, whatever other jobs say of it.
  rooms.fleet.add_job("OTHER");
  CHECK_THAT(rooms.two.arm("OTHER", "right"), StartsWith("23505") && Contains("job_busy"));
  CHECK_THAT(
      rooms.fleet.tried(fmt::format(
          "INSERT INTO attempt SELECT '{}', '{}', k, blank, segment, first_stroke, strokes, "
          "device, device_session, operator, plan_sha256, invocation, created, started_at, ended, "
          "end_kind, bytes_taken, last_status, node, epoch, fence + 100, identity FROM attempt "
          "WHERE id='{}'",
          FleetSql::id("A4"), FleetSql::id("OTHER"), FleetSql::id("A3"))),
      StartsWith("23505") && Contains("attempt_machine"));
}

TEST_CASE("a start has a number above all that the node's journals know", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  REQUIRE(rooms.one.arm("JOB", "left").empty());
  CHECK_THAT(rooms.one.start("A1", "JOB", "left", 500), StartsWith("PC001 the fence ") &&
                                                            Contains("is not above 500") &&
                                                            Contains("restored"));
  CHECK(rooms.state() == "armed");
  CHECK(rooms.one.start("A1", "JOB", "left", 500).empty());
  CHECK(rooms.fleet("SELECT fence > 500 FROM attempt") == "t");
  CHECK(rooms.two.line.tried("SELECT fence > 500 FROM node_begin('room-2', 'room-2', '', '', NULL,"
                             " 0)") == "t");
}

TEST_CASE("marks of a cut only grow", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  CHECK(rooms.one.mark("A1", -1, -1, 4, 0).empty());
  CHECK(rooms.chunks("A1") == "0|4|intent");
  CHECK(rooms.one.mark("A1", 2, 4, 8, 90).empty());
  CHECK(rooms.chunks("A1") == "0|2|certain\n3|4|sent\n5|8|intent");
  CHECK(rooms.one.mark("A1", 1, 3, 6, 80).empty());  // late on its way
  CHECK(rooms.chunks("A1") == "0|2|certain\n3|4|sent\n5|8|intent");
  CHECK(rooms.one.mark("A1", 6, 5, 6, 95).empty());
  CHECK(rooms.chunks("A1") == "0|6|certain\n7|8|intent");
  CHECK(rooms.fleet("SELECT bytes_taken FROM attempt") == "95");
  CHECK(rooms.one.mark("A1", 9, 9, 9, 99).empty());
  CHECK(rooms.chunks("A1") == "0|9|certain");
  CHECK_THAT(rooms.two.mark("A1", 9, 9, 9, 99),
             StartsWith("PC003 attempt") && Contains("is of node room-1, not of node room-2"));
  CHECK_THAT(rooms.one.mark("A9", 9, 9, 9, 99), StartsWith("PC003 there is no attempt"));
  REQUIRE(rooms.one.finish("A1", "JOB").empty());
  CHECK_THAT(rooms.one.mark("A1", 9, 9, 9, 99), StartsWith("PC003") && Contains("ended as done"));
  const std::string old = rooms.one.epoch;
  REQUIRE(rooms.one.begin().empty());
  rooms.one.epoch = old;
  CHECK_THAT(rooms.one.mark("A1", 9, 9, 9, 99), StartsWith("PC001"));
}

TEST_CASE("an end is recorded once, by the node that cut", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  REQUIRE(rooms.one.mark("A1", 2, 4, 8, 90).empty());
  CHECK_THAT(rooms.two.finish("A1", "JOB"), StartsWith("PC003"));
  CHECK_THAT(rooms.one.finish("A2", "JOB"), StartsWith("PC003 there is no attempt"));
  CHECK(rooms.one.line
            .tried(rooms.one.call_sql("knife_end",
                                      "'" + FleetSql::id("A1") +
                                          "', 9, 'stall', 'jammed', 200, '{0,4,6}', '{3,3,9}', "
                                          "'{certain,doubt,doubt}'") +
                   rooms.interrupt())
            .empty());
  CHECK(rooms.chunks("A1") == "0|3|certain\n6|9|doubt");
  CHECK(rooms.attempt("A1") == "6|9|stall");
  CHECK(rooms.fleet("SELECT bytes_taken, last_status FROM attempt") == "200|jammed");
  CHECK_THAT(rooms.one.finish("A1", "JOB"), StartsWith("PC003") && Contains("ended as stall"));
  CHECK_THAT(rooms.one.call("knife_crash", crash_values("A1", "crash", 9)), StartsWith("PC003"));
  CHECK_THAT(rooms.one.call("knife_never", "'" + FleetSql::id("A1") + "', 9"), StartsWith("PC003"));
  CHECK_THAT(rooms.one.call("knife_again", "'" + FleetSql::id("A1") + "'"), StartsWith("PC003"));
}

TEST_CASE("late truth goes over what was taken for lost", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  REQUIRE(rooms.one.mark("A1", 2, 4, 8, 90).empty());
  const std::string lost = rooms.two.call_sql("knife_crash", crash_values("A1", "lost", 9));
  CHECK_THAT(rooms.two.line.tried(lost + rooms.interrupt()),
             StartsWith("PC001") && Contains("is of node room-1, which is alive"));
  rooms.lapse(rooms.one, rooms.two);
  CHECK_THAT(rooms.two.line.tried(lost), StartsWith("23514"));
  CHECK(rooms.two.line.tried(lost + rooms.interrupt()).empty());
  CHECK(rooms.attempt("A1") == "6|8|lost");
  CHECK(rooms.chunks("A1") == "0|2|certain\n3|9|doubt");
  CHECK(rooms.fleet("SELECT end_kind, sum(attempts) FROM end_tally GROUP BY 1") == "lost|1");
  CHECK_THAT(rooms.two.line.tried(lost), StartsWith("PC003"));
  // The old life still has its epoch, and tells the truth late.
  SECTION("it was cut to the end") {
    CHECK(rooms.one.finish("A1", "JOB").empty());
    CHECK(rooms.attempt("A1") == "6|9|done");
    CHECK(rooms.chunks("A1") == "0|9|certain");
    CHECK(rooms.state() == "done");
    CHECK(rooms.fleet("SELECT end_kind, sum(attempts) FROM end_tally GROUP BY 1 HAVING "
                      "sum(attempts) <> 0") == "done|1");
  }
  const std::string again = "'" + FleetSql::id("A1") + "'";
  const std::string cutting = "UPDATE job SET state='cutting', rev=rev+1;";
  SECTION("it is cut still, and taken up again") {
    CHECK_THAT(rooms.one.call("knife_again", again), StartsWith("PC001 the lease"));
    REQUIRE(rooms.one.begin().empty());
    CHECK_THAT(rooms.one.call("knife_again", again), StartsWith("23514"));
    CHECK(rooms.one.line.tried(rooms.one.call_sql("knife_again", again) + cutting).empty());
    CHECK(rooms.attempt("A1") == "6||");
    CHECK(rooms.chunks("A1") == "0|2|certain");
    CHECK(rooms.fleet("SELECT epoch FROM attempt") == rooms.one.epoch);
    CHECK(rooms.one.mark("A1", 3, 5, 8, 95).empty());
    CHECK(rooms.one.finish("A1", "JOB").empty());
    CHECK(rooms.fleet("SELECT end_kind, sum(attempts) FROM end_tally GROUP BY 1 HAVING "
                      "sum(attempts) <> 0") == "done|1");
  }
  SECTION("a person has taken a new blank") {
    rooms.fleet("UPDATE job SET state='ready', blank=2, device='', rev=rev+1");
    rooms.start(rooms.two, "right", "A2");
    REQUIRE(rooms.one.begin().empty());
    CHECK_THAT(rooms.one.line.tried(rooms.one.call_sql("knife_again", again) + cutting),
               StartsWith("PC003") && Contains("superseded"));
    CHECK_THAT(rooms.two.call("knife_again", again), StartsWith("PC003"));
    CHECK(rooms.one.call("knife_crash", crash_values("A1", "superseded", 9)).empty());
    CHECK(rooms.attempt("A1") == "6|8|superseded");
    CHECK_THAT(rooms.one.call("knife_crash", crash_values("A1", "crash", 9)), StartsWith("PC003"));
    // What it cut is said when its knife stands still; that it is superseded stays.
    CHECK(rooms.one
              .call("knife_end", "'" + FleetSql::id("A1") +
                                     "', 12, 'stopped', '', 99, '{0}', '{7}', '{certain}'")
              .empty());
    CHECK(rooms.attempt("A1") == "6|12|superseded");
    CHECK(rooms.chunks("A1") == "0|7|certain");
    CHECK(rooms.state() == "cutting");  // the new blank
  }
  SECTION("it was not started at all") {
    CHECK_THAT(rooms.one.call("knife_never", again + ", 9"),
               StartsWith("PC003") && Contains("was about to send strokes"));
  }
}

TEST_CASE("an attempt that sent nothing never was a start", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  const std::string never = "'" + FleetSql::id("A1") + "', 9";
  CHECK_THAT(rooms.two.call("knife_never", never), StartsWith("PC003"));
  CHECK_THAT(rooms.one.call("knife_never", never), StartsWith("23514"));
  CHECK(rooms.one.line
            .tried(rooms.one.call_sql("knife_never", never) +
                   "UPDATE job SET state='ready', device=''")
            .empty());
  CHECK(rooms.attempt("A1") == "|9|refused");
  CHECK(rooms.chunks("A1").empty());
  rooms.start(rooms.one, "left", "A2");  // the same blank
  CHECK(rooms.state() == "cutting");
  // What was about to be sent may have been.
  REQUIRE(rooms.one.mark("A2", -1, -1, 4, 0).empty());
  CHECK_THAT(rooms.one.call("knife_never", "'" + FleetSql::id("A2") + "', 9"),
             StartsWith("PC003") && Contains("was about to send strokes"));
}

TEST_CASE("no function of the knife listens to an old life, or to another's login", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  const std::string attempt = "'" + FleetSql::id("A1") + "'", job = "'" + FleetSql::id("JOB") + "'";
  const std::string plan = "'" + FleetSql::plan_sha256() + "'";
  const std::map<std::string, std::string> values{
      {"knife_arm", job + ", 1, 1, 'left', " + plan + ", 'olga', 5, 'run'"},
      {"knife_start",
       attempt + ", " + job + ", 1, 1, 1, 0, 10, 'left', 's', 'olga', " + plan + ", 'run', 6, 0"},
      {"knife_mark", attempt + ", 0, 1, 1, 1, 1"},
      {"knife_end", attempt + ", 9, 'done', '', 1, '{0}', '{9}', '{certain}'"},
      {"knife_never", attempt + ", 9"},
      {"knife_crash", crash_values("A1", "crash", 9)},
      {"knife_again", attempt},
      {"knife_bring_back", attempt + ", " + job + ", 1, 1, 1, 0, 10, 'left', 's', 'olga', " + plan +
                               ", 'run', 6, 6, 40, 'folder'"},
      {"node_end", ""},
      {"node_reported", ""}};
  CHECK(rooms.fleet(
            "SELECT string_agg(proname, ' ' ORDER BY proname) FROM pg_proc WHERE "
            "pronamespace='popcut'::regnamespace AND (proname LIKE 'knife\\_%' AND prorettype "
            "<> 'trigger'::regtype)") ==
        "knife_again knife_arm knife_bring_back knife_crash knife_disarm knife_end knife_mark "
        "knife_never knife_start");
  FleetNode thief(rooms.fleet, "room-1", "popcut_n_room_2"),
      nobody(rooms.fleet, "room-8", "popcut_n_room_1");
  thief.epoch = nobody.epoch = rooms.one.epoch;
  const std::string old = rooms.one.epoch;
  REQUIRE(rooms.one.begin().empty());
  FleetNode before(rooms.fleet, "room-1", "popcut_n_room_1");
  before.epoch = old;
  thief.epoch = rooms.one.epoch;
  for (const auto& [function, given] : values) {
    INFO(function);
    CHECK_THAT(before.call(function, given), StartsWith("PC001 node room-1 is in its epoch"));
    CHECK_THAT(thief.call(function, given),
               StartsWith("PC001 the login popcut_n_room_2 does not speak for node room-1"));
    CHECK_THAT(nobody.call(function, given), StartsWith("PC001 there is no node room-8"));
  }
  CHECK(rooms.attempt("A1") == "6||");
}

TEST_CASE("a start that a restored database forgot comes back", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  const auto back = [&](FleetNode& node, const std::string& name, const std::string& job,
                        const std::string& started, const std::string& fence) {
    return node.call_sql("knife_bring_back",
                         fmt::format("'{}', '{}', 1, 1, 1, 0, 10, 'left', 's', 'olga', '{}', "
                                     "'run', 6, {}, {}, 'folder'",
                                     FleetSql::id(name), FleetSql::id(job), FleetSql::plan_sha256(),
                                     started, fence));
  };
  CHECK_THAT(rooms.one.line.tried(back(rooms.one, "A1", "GONE", "6", "40")),
             StartsWith("PC003") && Contains("which the database does not know"));
  CHECK(rooms.one.line
            .tried(back(rooms.one, "A1", "JOB", "6", "40") +
                   rooms.one.call_sql("knife_crash", crash_values("A1", "crash", 6)) +
                   rooms.interrupt())
            .empty());
  CHECK(rooms.attempt("A1") == "6|8|crash");
  CHECK(rooms.chunks("A1") == "0|6|doubt");
  CHECK(rooms.fleet("SELECT fence, identity FROM attempt") == "40|folder");
  // A start of the same blank is refused from now on, and fences go on above.
  rooms.fleet("UPDATE job SET state='ready', device=''");
  REQUIRE(rooms.two.arm("JOB", "right").empty());
  CHECK_THAT(rooms.two.start("A2", "JOB", "right"), StartsWith("23505"));
  rooms.fleet("SELECT knife_disarm(id) FROM job; UPDATE job SET state='ready', blank=2, device=''");
  rooms.start(rooms.two, "right", "A3");
  CHECK(rooms.fleet("SELECT fence > 40 FROM attempt WHERE id='" + FleetSql::id("A3") + "'") == "t");
  // That job cuts elsewhere: what comes back is no second open start. Its number was given again.
  CHECK_THAT(rooms.one.line.tried(back(rooms.one, "A4", "JOB", "6", "40")), StartsWith("23505"));
  CHECK(rooms.one.line.tried(back(rooms.one, "A4", "JOB", "NULL", "40")).empty());
  CHECK(rooms.fleet("SELECT count(DISTINCT fence), count(*) FROM attempt") == "3|3");
  // No journal ends the numbers of all.
  CHECK_THAT(rooms.one.line.tried(back(rooms.one, "A5", "JOB", "NULL", "9223372036854775807")),
             StartsWith("PC001 the fence 9223372036854775807 is no number"));
}

TEST_CASE("an event of no kind stops no other", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  const auto put = [&](const std::string& kind) {
    return rooms.one.line.tried("INSERT INTO event_new(time, kind, job, data) VALUES(1, '" + kind +
                                "', '', '\"kind\":\"" + kind + "\"}')");
  };
  CHECK_THAT(put("evil"), StartsWith("23514"));
  CHECK(put("notice").empty());
  CHECK(rooms.two.line("SELECT event_number('room-2'), event_number('room-2')") == "1|0");
  CHECK(rooms.fleet("SELECT seq, data FROM event") == R"(1|{"seq":1,"kind":"notice"})");
}

TEST_CASE("a database that went back starts nothing until every node has compared its journals",
          "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.fleet("UPDATE event_counter SET last=10");
  CHECK(rooms.one.call("node_beat", "30, 10").starts_with("(t,"));
  CHECK(rooms.one.call("node_beat", "30, 11").starts_with("(f,"));  // it begins again
  REQUIRE(rooms.one.arm("JOB", "left").empty());
  // Room 2 has seen an event that there is not: the database is an older one.
  REQUIRE(rooms.two.begin_only("room-2", rooms.two.epoch, 11).empty());
  CHECK(rooms.two.beat() == "f");
  CHECK(rooms.one.beat() == "f");
  CHECK_THAT(rooms.one.start("A1", "JOB", "left"),
             StartsWith("PC001 the database went back to an earlier state, and node room-1"));
  REQUIRE(rooms.one.begin_only("room-1", rooms.one.epoch, 10).empty());
  CHECK(rooms.one.call("node_reported", "").empty());
  CHECK(rooms.one.beat() == "t");
  rooms.fleet("SELECT knife_disarm(id) FROM job; UPDATE job SET state='ready', device=''");
  CHECK_THAT(rooms.one.arm("JOB", "left"), Contains("node room-2 has not compared its journals"));
  SECTION("it reports") {
    CHECK(rooms.two.call("node_reported", "").empty());
    CHECK(rooms.two.beat() == "t");
  }
  SECTION("it is forgotten") {
    CHECK_THAT(rooms.fleet.tried("SELECT node_forget('room-2')"),
               StartsWith("PC001") && Contains("is alive"));
    CHECK(rooms.two.call("node_end", "").empty());
    CHECK_THAT(rooms.one.arm("JOB", "left"), Contains("node room-2 has not"));  // before it ended
    CHECK(rooms.fleet.tried("SELECT node_forget('room-2')").empty());
    CHECK(rooms.fleet("SELECT node, state FROM device WHERE id='right'") == "|absent");
  }
  CHECK(rooms.one.arm("JOB", "left").empty());
}

TEST_CASE("another timeline counts as going back, but not for who was stopped in order",
          "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  CHECK(rooms.fleet("SELECT popcut_generation()") == "00000001.0");
  REQUIRE(rooms.two.call("node_end", "").empty());
  rooms.fleet("UPDATE node SET generation='00000000.0'");
  CHECK(rooms.one.beat() == "f");
  CHECK_THAT(rooms.one.arm("JOB", "left"), Contains("node room-1 has not compared"));
  CHECK(rooms.one.begin().empty());
  CHECK(rooms.one.arm("JOB", "left").empty());
  // One that joined and never began has nothing to compare.
  rooms.fleet("SELECT node_join('room-3', 'popcut_n_room_3')");
  CHECK(rooms.one.start("A1", "JOB", "left").empty());
}

TEST_CASE("a node that has something open is not forgotten", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  REQUIRE(rooms.one.arm("JOB", "left").empty());
  REQUIRE(rooms.one.call("node_end", "").empty());
  CHECK_THAT(rooms.fleet.tried("SELECT node_forget('room-1')"),
             StartsWith("PC001 job") && Contains("is armed at node"));
  REQUIRE(rooms.one.begin().empty());
  rooms.fleet("SELECT knife_disarm(id) FROM job; UPDATE job SET state='ready', device=''");
  rooms.start(rooms.one, "left", "A1");
  REQUIRE(rooms.one.call("node_end", "").empty());
  CHECK_THAT(rooms.fleet.tried("SELECT node_forget('room-1')"),
             StartsWith("PC001 attempt") && Contains("is open"));
  CHECK_THAT(rooms.fleet.tried("SELECT node_forget('room-7')"), StartsWith("PC001 there is no"));
  CHECK(rooms.lapsed(rooms.one, rooms.two) == "t");
  CHECK(rooms.two.line
            .tried(rooms.two.call_sql("knife_crash", crash_values("A1", "lost", 9)) +
                   rooms.interrupt())
            .empty());
  CHECK(rooms.fleet.tried("SELECT node_forget('room-1')").empty());
  // It may come back under its name, and tells how its cut ended.
  CHECK(rooms.one.begin().empty());
  CHECK(rooms.one.finish("A1", "JOB").empty());
}

TEST_CASE("a node's login writes to nodes, arms and attempts by functions only", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  rooms.start(rooms.one, "left", "A1");
  FleetLine& line = rooms.one.line;
  for (const char* table : {"node", "arm", "attempt", "chunk", "popcut_schema"}) {
    INFO(table);
    CHECK(line.tried(fmt::format("SELECT count(*) >= 0 FROM {}", table)) == "t");
    CHECK_THAT(line.tried(fmt::format("DELETE FROM {}", table)), StartsWith("42501"));
    CHECK_THAT(line.tried(fmt::format("INSERT INTO {} SELECT * FROM {}", table, table)),
               StartsWith("42501"));
    CHECK_THAT(line.tried(fmt::format("TRUNCATE {}", table)), StartsWith("42501"));
    CHECK_THAT(line.tried(fmt::format("SELECT * FROM {} FOR UPDATE", table)), StartsWith("42501"));
  }
  CHECK_THAT(line.tried("UPDATE node SET epoch=1"), StartsWith("42501"));
  CHECK_THAT(line.tried("UPDATE arm SET node='room-1'"), StartsWith("42501"));
  CHECK_THAT(line.tried("UPDATE attempt SET ended=1"), StartsWith("42501"));
  CHECK_THAT(line.tried("UPDATE chunk SET state='certain'"), StartsWith("42501"));
  CHECK_THAT(line.tried("TRUNCATE job CASCADE"), StartsWith("42501"));
  for (const char* sql :
       {"ALTER FUNCTION knife_disarm(text) SECURITY INVOKER",
        "CREATE OR REPLACE FUNCTION popcut.knife_disarm(p_job text) RETURNS void LANGUAGE sql AS "
        "'SELECT 1'",
        "DROP FUNCTION knife_disarm(text)",
        "CREATE TABLE popcut.mine(i int)",
        "CREATE FUNCTION popcut.mine() RETURNS int LANGUAGE sql AS 'SELECT 1'",
        "ALTER TABLE job DISABLE TRIGGER ALL",
        "DROP TRIGGER job_kept ON job",
        "SET session_replication_role = replica",
        "SET ROLE popcut_owner",
        "SET SESSION AUTHORIZATION postgres",
        "SELECT setval('fence_seq', 1)",
        "SELECT nextval('fence_seq')",
        "UPDATE event_counter SET last=3",
        "SELECT node_drain('room-1', 1)",
        "SELECT node_forget('room-2')",
        "SELECT node_join('x', 'popcut_n_room_1')",
        "SELECT node_speaks('room-1', 1)",
        "SELECT node_lives('room-1', 1)",
        "SELECT fence_above(1)",
        "SELECT attempt_of('room-1', 'x', '{}')",
        "SELECT put_chunk('x', 1, 1, 1, 'certain')",
        "SELECT check_arm('x', 'armed', 1, 1, 'x')",
        "GRANT popcut_owner TO popcut_n_room_1"}) {
    INFO(sql);
    CHECK_THAT(line.tried(sql), StartsWith("42501"));
  }
  // Who is no node may not even look.
  rooms.fleet("CREATE ROLE stranger LOGIN");
  FleetLine stranger(rooms.fleet.database().url("stranger"));
  CHECK_THAT(stranger.tried("SELECT count(*) FROM popcut.job"), StartsWith("42501"));
  CHECK_THAT(stranger.tried("SELECT popcut.knife_disarm('x')"), StartsWith("42501"));
  rooms.fleet("DROP ROLE stranger");
  // Admins of the fleet look after nodes, and touch nothing else.
  rooms.fleet("CREATE ROLE warden LOGIN; GRANT popcut_admin TO warden");
  FleetLine warden(rooms.fleet.database().url("warden"));
  CHECK(warden.tried("SELECT node_drain('room-1', 1)").empty());
  CHECK(warden.tried("SELECT name FROM node_state WHERE draining=1") == "room-1");
  CHECK_THAT(warden.tried("SELECT knife_disarm('x')"), StartsWith("42501"));
  CHECK_THAT(warden.tried("UPDATE job SET rev=1"), StartsWith("42501"));
  rooms.fleet("DROP ROLE warden");
  CHECK(rooms.attempt("A1") == "6||");
}

TEST_CASE("what a login creates and where it searches does not change the functions", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  FleetLine& line = rooms.one.line;
  // Tables of its own in the way of the real ones, and operators that always say yes.
  line(
      "CREATE TEMP TABLE node AS SELECT * FROM popcut.node; "
      "UPDATE pg_temp.node SET login='popcut_n_room_1', lease_until='infinity';"
      "CREATE TEMP TABLE arm AS SELECT * FROM popcut.arm;"
      "CREATE TEMP TABLE attempt AS SELECT * FROM popcut.attempt;"
      "CREATE TEMP TABLE job AS SELECT * FROM popcut.job;"
      "CREATE TEMP TABLE tally AS SELECT * FROM popcut.tally;"
      "CREATE FUNCTION pg_temp.pg_has_role(name, text, text) RETURNS boolean LANGUAGE sql AS "
      "'SELECT true';"
      "CREATE FUNCTION pg_temp.clock_timestamp() RETURNS timestamptz LANGUAGE sql AS "
      "'SELECT ''-infinity''::timestamptz';"
      "CREATE FUNCTION pg_temp.same(text, text) RETURNS boolean LANGUAGE sql AS 'SELECT true';"
      "CREATE OPERATOR pg_temp.<> (LEFTARG=text, RIGHTARG=text, FUNCTION=pg_temp.same);"
      "SET search_path = pg_temp, popcut");
  const std::string who = fmt::format("'room-2', {}", rooms.two.epoch);
  CHECK_THAT(line.tried("SELECT popcut.knife_arm(" + who + ", '" + FleetSql::id("JOB") +
                        "', 1, 1, 'right', '" + FleetSql::plan_sha256() + "', 'olga', 5, 'run')"),
             StartsWith("PC001 the login popcut_n_room_1 does not speak for node room-2"));
  CHECK_THAT(line.tried("SELECT popcut.node_beat(" + who + ", 30, 0)"), StartsWith("PC001"));
  // The checks of a commit look at the real tables.
  CHECK_THAT(line.tried("UPDATE popcut.job SET state='cutting', device='left'"),
             StartsWith("23514"));
  CHECK(line.tried("UPDATE popcut.job SET note='x', state='interrupted'").empty());
  CHECK(line("SELECT count(*) FROM pg_temp.tally") == "1");
  CHECK(rooms.fleet("SELECT sum(jobs) FROM tally WHERE state='interrupted'") == "1");
  // Who may be called by a login, or runs as the owner, says where it searches; but for two that
  // look nothing up.
  CHECK(rooms.fleet("SELECT string_agg(proname, ' ' ORDER BY proname) FROM pg_proc WHERE "
                    "pronamespace='popcut'::regnamespace AND (prosecdef OR has_function_privilege("
                    "'popcut_node', oid, 'EXECUTE')) AND ('search_path=pg_catalog, popcut, "
                    "pg_temp' = ANY(proconfig)) IS NOT TRUE") == "clock_ms popcut_generation");
}

TEST_CASE("a job's state and its knife agree at every commit", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  FleetLine& line = rooms.one.line;
  const std::string job = FleetSql::id("JOB");
  CHECK_THAT(line.tried("UPDATE job SET state='cutting', device='left'"),
             StartsWith("23514 job " + job + " is cutting, but no attempt at its sheet 1"));
  CHECK_THAT(line.tried("UPDATE job SET state='paused', device='left'"), StartsWith("23514"));
  CHECK_THAT(line.tried("UPDATE job SET state='armed', device='left'"),
             StartsWith("23514") && Contains("no one armed sheet 1 (blank 1) on left"));
  const std::string armed = rooms.one.call_sql(
      "knife_arm", "'" + job + "', 1, 1, 'left', '" + FleetSql::plan_sha256() + "', 'o', 5, 'r'");
  CHECK_THAT(line.tried(armed), StartsWith("23514") && Contains("its sheet is still armed"));
  CHECK_THAT(line.tried(armed + "UPDATE job SET state='armed', device='right'"),
             StartsWith("23514"));
  CHECK_THAT(line.tried(armed + "UPDATE job SET state='armed', device='left', blank=2"),
             StartsWith("23514"));
  // In between anything may be: it is looked at when all is done, whatever the order.
  CHECK(line.tried("UPDATE job SET state='armed', device='left';" + armed).empty());
  CHECK_THAT(line.tried("UPDATE job SET state='ready', device=''"), StartsWith("23514"));
  CHECK_THAT(line.tried("UPDATE job SET blank=2"), StartsWith("23514"));
  CHECK_THAT(line.tried("SELECT knife_disarm('" + job + "')"), StartsWith("23514"));
  CHECK_THAT(line.tried("SET CONSTRAINTS ALL DEFERRED; UPDATE job SET sheet=0, state='queued'"),
             StartsWith("23514"));
  REQUIRE(rooms.one.start("A1", "JOB", "left").empty());
  CHECK(line.tried("UPDATE job SET state='paused'").empty());
  CHECK(line.tried("UPDATE job SET state='cutting', paths_certain=3").empty());
  CHECK_THAT(line.tried("UPDATE job SET segment=2"), StartsWith("23514"));
  CHECK_THAT(line.tried("UPDATE job SET state='interrupted'"),
             StartsWith("23514") && Contains("but an attempt at it is open"));
  CHECK_THAT(line.tried("UPDATE job SET state='done', finished=1"), StartsWith("23514"));
  CHECK_THAT(rooms.fleet.tried("DELETE FROM attempt"), StartsWith("23514"));
  // Who ends an attempt waits for who is changing the job, and judges what that one leaves.
  FleetLine other(rooms.fleet.database().url());
  FleetLine third(rooms.fleet.database().url());
  other("BEGIN; UPDATE attempt SET ended=9, end_kind='stall'");
  third("BEGIN; UPDATE job SET note='x'");
  std::string first;
  std::atomic<bool> over{false};
  std::thread waits([&] {
    first = other.tried("COMMIT");
    over = true;
  });
  std::this_thread::sleep_for(30ms);
  CHECK_FALSE(over);
  CHECK(third.tried("COMMIT").empty());
  waits.join();
  CHECK_THAT(first, StartsWith("23514"));
}

TEST_CASE("what has ended stays, and jobs are never deleted", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  CHECK_THAT(rooms.one.line.tried("DELETE FROM job"), StartsWith("23000 jobs are never deleted"));
  rooms.start(rooms.one, "left", "A1");
  REQUIRE(rooms.one.finish("A1", "JOB").empty());
  CHECK_THAT(rooms.one.line.tried("UPDATE job SET state='ready', finished=NULL"),
             StartsWith("23000 the job has ended"));
  CHECK_THAT(rooms.one.line.tried("UPDATE job SET outcome='good'"), StartsWith("23000"));
  CHECK(rooms.one.line.tried("UPDATE job SET deleted=1, rev=rev+1").empty());
}

TEST_CASE("a cutter belongs to one living node", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  const std::string take = "UPDATE device SET node='room-2' WHERE id='left'";
  CHECK_THAT(rooms.two.line.tried(take), StartsWith("PC002 device left is at node room-1"));
  CHECK_THAT(rooms.two.line.tried("UPDATE device SET node='room-1' WHERE id='right'"),
             StartsWith("PC001 device right: the login popcut_n_room_2 does not speak for"));
  CHECK_THAT(rooms.two.line.tried("UPDATE device SET node='room-9' WHERE id='right'"),
             StartsWith("23503 device right: there is no node room-9"));
  CHECK_THAT(rooms.two.line.tried("UPDATE device SET node='' WHERE id='left'"),
             StartsWith("PC002"));
  CHECK(rooms.two.line.tried("UPDATE device SET title='by the window' WHERE id='left'").empty());
  SECTION("it is unplugged there") {
    CHECK(rooms.one.line.tried("UPDATE device SET state='absent' WHERE id='left'").empty());
    CHECK(rooms.two.line.tried(take).empty());
  }
  SECTION("that node is gone") {
    CHECK(rooms.one.call("node_end", "").empty());
    CHECK(rooms.two.line.tried(take).empty());
  }
  SECTION("that node lets go") {
    CHECK(rooms.one.line.tried("UPDATE device SET node='' WHERE id='left'").empty());
    CHECK(rooms.two.line.tried(take).empty());
  }
}

TEST_CASE("tallies are right while many change them, and few rows when they are folded",
          "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  for (int i = 0; i < 40; ++i) rooms.fleet.add_job(fmt::format("T{:02}", i));
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      FleetLine line(rooms.fleet.database().url("popcut_n_room_1"));
      for (int i = t; i < 40; i += 4) {
        line(fmt::format("UPDATE job SET state='interrupted' WHERE id='{}'",
                         FleetSql::id(fmt::format("T{:02}", i))));
        line("SELECT node_tidy()");
      }
    });
  for (std::thread& one : threads) one.join();
  const std::string sums =
      "SELECT state, sum(jobs) FROM tally GROUP BY state HAVING sum(jobs) <> 0 ORDER BY state";
  CHECK(rooms.fleet(sums) == "interrupted|40\nready|1");
  rooms.fleet("SELECT node_tidy()");
  CHECK(rooms.fleet(sums) == "interrupted|40\nready|1");
  CHECK(rooms.fleet("SELECT count(*) FROM tally") == "2");
  rooms.fleet(
      fmt::format("INSERT INTO design(id, name, kind, media_type, owner, bytes, created, assets) "
                  "VALUES('{}', 'd', 'svg', 'image/svg+xml', 'anna', 1, 1, '[\"b\",\"a\",\"b\"]')",
                  std::string(71, 'd')));
  CHECK(rooms.fleet("SELECT asset FROM asset_use ORDER BY asset") == "a\nb");
}

TEST_CASE("of 64 connections that start the same sheet at once one starts it", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  constexpr int kMany = 64, kRounds = 5;
  for (int i = 0; i < kMany; ++i)
    rooms.fleet.add_device(fmt::format("d{}", i), i % 2 == 0 ? "room-1" : "room-2");
  std::vector<FleetNode> nodes;
  for (int i = 0; i < kMany; ++i) {
    const FleetNode& as = i % 2 == 0 ? rooms.one : rooms.two;
    nodes.emplace_back(rooms.fleet, as.name,
                       as.name == "room-1" ? "popcut_n_room_1" : "popcut_n_room_2");
    nodes.back().epoch = as.epoch;
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::string job = fmt::format("R{}", round);
    rooms.fleet.add_job(job);
    std::atomic<int> arms{0}, starts{0}, again{0};
    std::barrier together(kMany);
    std::vector<std::thread> threads;
    for (int i = 0; i < kMany; ++i)
      threads.emplace_back([&, i] {
        FleetNode& node = nodes[static_cast<std::size_t>(i)];
        const std::string device = fmt::format("d{}", i);
        together.arrive_and_wait();
        if (node.arm(job, device).empty()) ++arms;
        // Every one of them tries, also for whoever armed it: two presses of a button.
        together.arrive_and_wait();
        const std::string armed = node.line.tried("SELECT device, node FROM arm");
        if (armed.empty()) return;
        const std::string at = armed.substr(0, armed.find('|'));
        if (node.start(fmt::format("R{}N{}", round, i), job, at).empty()) ++starts;
        if (node.start(fmt::format("R{}M{}", round, i), job, at).empty()) ++again;
      });
    for (std::thread& one : threads) one.join();
    CHECK(arms == 1);
    CHECK(starts + again == 1);
    CHECK(rooms.fleet(fmt::format("SELECT count(*) FROM attempt WHERE job='{}' AND started_at IS "
                                  "NOT NULL",
                                  FleetSql::id(job))) == "1");
    CHECK(rooms.state(job) == "cutting");
  }
  CHECK(rooms.fleet("SELECT count(DISTINCT fence) FROM attempt") == std::to_string(kRounds));
}

TEST_CASE("two nodes that sweep at once end each lost attempt once", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  FleetNode three{rooms.fleet, "room-3", "popcut_n_room_3"};
  REQUIRE(three.begin().empty());
  constexpr int kLost = 20;
  for (int i = 0; i < kLost; ++i) {
    rooms.fleet.add_device(fmt::format("d{}", i), "room-1");
    rooms.fleet.add_job(fmt::format("J{}", i));
    rooms.start(rooms.one, fmt::format("d{}", i), fmt::format("A{}", i), fmt::format("J{}", i));
  }
  REQUIRE(rooms.one.beat(0.05) == "t");
  std::this_thread::sleep_for(80ms);
  std::array<FleetNode*, 2> sweepers{&rooms.two, &three};
  std::array<int, 2> ended{};
  std::array<std::string, 2> wrong{};
  std::barrier together(2);
  std::vector<std::thread> threads;
  for (std::size_t who = 0; who < 2; ++who)
    threads.emplace_back([&, who] {
      FleetNode& node = *sweepers[who];
      together.arrive_and_wait();
      if (node.line(fmt::format("SELECT node_lapse('room-1', {})", rooms.one.epoch)) != "t")
        wrong[who] = "not lapsed";
      for (;;) {
        // The job is what a node may lock: whoever has it ends the attempt.
        node.line("BEGIN");
        const std::string found = node.line(
            "SELECT attempt.id, job.id FROM attempt JOIN job ON job.id=attempt.job WHERE "
            "attempt.node='room-1' AND attempt.ended IS NULL AND job.state='cutting' ORDER BY "
            "job.id LIMIT 1 FOR UPDATE OF job SKIP LOCKED");
        if (found.empty()) {
          node.line("ROLLBACK");
          break;
        }
        const std::string attempt = found.substr(0, 26), job = found.substr(27);
        const std::string said = node.line.tried(
            node.call_sql("knife_crash", fmt::format("'{}', 8, 'lost', '', 9", attempt)) +
            fmt::format("UPDATE job SET state='interrupted', rev=rev+1 WHERE id='{}'; COMMIT",
                        job));
        if (said.empty())
          ++ended[who];
        else
          wrong[who] = said;
      }
    });
  for (std::thread& one : threads) one.join();
  CHECK(wrong == std::array<std::string, 2>{});
  CHECK(ended[0] + ended[1] == kLost);
  CHECK(rooms.fleet("SELECT count(*) FROM attempt WHERE end_kind='lost'") == std::to_string(kLost));
  CHECK(rooms.fleet("SELECT sum(attempts) FROM end_tally WHERE end_kind='lost'") ==
        std::to_string(kLost));
}

TEST_CASE("a sweep waits for a start that is under way", "[fleet]") {
  if (skipped()) return;
  TwoRooms rooms;
  REQUIRE(rooms.one.arm("JOB", "left").empty());
  REQUIRE(rooms.one.beat(0.2) == "t");
  rooms.one.line("BEGIN");
  const std::string start = fmt::format(
      "SELECT knife_start('room-1', {}, '{}', '{}', 1, 1, 1, 0, 10, 'left', 's', 'olga', '{}', "
      "'run', 6, 0); UPDATE job SET state='cutting'",
      rooms.one.epoch, FleetSql::id("A1"), FleetSql::id("JOB"), FleetSql::plan_sha256());
  rooms.one.line(start);
  std::this_thread::sleep_for(250ms);
  std::string lapsed;
  std::thread sweep([&] { lapsed = rooms.lapsed(rooms.one, rooms.two); });
  std::this_thread::sleep_for(30ms);
  CHECK(lapsed.empty());  // it waits
  rooms.one.line("COMMIT");
  sweep.join();
  CHECK(lapsed == "t");
  CHECK(rooms.two.line("SELECT count(*) FROM attempt WHERE ended IS NULL") == "1");
  // A beat is not held up by a start.
  REQUIRE(rooms.two.begin().empty());
  FleetNode same(rooms.fleet, "room-2", "popcut_n_room_2");
  same.epoch = rooms.two.epoch;
  rooms.fleet.add_job("OTHER");
  REQUIRE(rooms.two.arm("OTHER", "right").empty());
  rooms.two.line("BEGIN; " + fmt::format("SELECT knife_start('room-2', {}, '{}', '{}', 1, 1, 1, 0, "
                                         "10, 'right', 's', 'olga', '{}', "
                                         "'run', 6, 0)",
                                         rooms.two.epoch, FleetSql::id("A2"), FleetSql::id("OTHER"),
                                         FleetSql::plan_sha256()));
  same.line("SET lock_timeout = '1s'");
  CHECK(same.beat() == "t");
  rooms.two.line("ROLLBACK");
}

}  // namespace popcut::testing::fleet_schema_test
