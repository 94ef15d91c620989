// SPDX-License-Identifier: MIT
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/fleet/fleet_health.hpp"
#include "daemon/fleet/fleet_nodes.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/fleet_url.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/needs_postgres.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/value.hpp"

namespace fleet_command_test {

using namespace popcut::testing;
using popcut::daemon::FleetFinding;
using popcut::daemon::FleetStep;
using popcut::daemon::FleetUrl;
using popcut::daemon::PostgresDatabase;
using popcut::daemon::StoreFault;

namespace {

struct FleetBench : CommandBench {
  FreshDatabase database;

  [[nodiscard]] Ran fleet(std::vector<std::string> words) const {
    words.insert(words.begin(), "fleet");
    words.insert(words.end(), {"--database", database.url()});
    return popcut(std::move(words));
  }
  void init() const { REQUIRE(fleet({"init"}).exit == 0); }
  /// A node of this name that is alive.
  void begin(const std::string& node) const {
    (void)database.run_sql(fmt::format(
        "SET search_path=popcut; SELECT node_begin('{}', 'i', 'http://{}.lab', '1.2', "
        "NULL, 0); SELECT node_reported('{}', (SELECT epoch FROM node WHERE name='{}'))",
        node, node, node, node));
  }
};

// "note: the database has no standby; do this", one a line.
std::string told(const std::vector<FleetFinding>& findings) {
  std::string text;
  for (const FleetFinding& one : findings)
    text += fmt::format("{}: {}; {}\n",
                        one.level == FleetFinding::Level::Fine   ? "fine"
                        : one.level == FleetFinding::Level::Note ? "note"
                                                                 : "problem",
                        one.what, one.remedy);
  return text;
}

// Each test has names of its own: roles are common to all databases of the server.
std::string fresh_name(const std::string& name) {
  return name + popcut::daemon::hex_of(popcut::daemon::random_bytes(4));
}

}  // namespace

TEST_CASE("addresses of databases are read and written", "[fleet]") {
  const FleetUrl url =
      FleetUrl::parse("postgresql://ann:p%40ss@db.lab:5433/pop?sslmode=require&port=1");
  CHECK(url.user == "ann");
  CHECK(url.password == "p@ss");
  CHECK(url.hosts == "db.lab:5433");
  CHECK(url.database == "pop");
  CHECK(url.value("sslmode") == "require");
  CHECK(url.text() == "postgresql://ann:p%40ss@db.lab:5433/pop?sslmode=require&port=1");
  CHECK(url.shown() == "postgresql://ann@db.lab:5433/pop?sslmode=require&port=1");
  CHECK(url.is_remote());
  CHECK(FleetUrl::parse("postgresql:///pop").text() == "postgresql:///pop");
  CHECK_FALSE(FleetUrl::parse("postgresql:///pop?host=/run/postgresql").is_remote());
  CHECK_FALSE(FleetUrl::parse("postgresql://[::1]:5432/pop").is_remote());
  CHECK(FleetUrl::parse("postgresql://a,b/pop").is_remote());
  const auto each = [](const std::string& text) {
    std::string all;
    for (const FleetUrl& one : FleetUrl::parse(text).each_host()) all += one.text() + " ";
    return all;
  };
  CHECK(each("postgresql://a:1,[::1]:2/pop?x=y") ==
        "postgresql://a:1/pop?x=y postgresql://[::1]:2/pop?x=y ");
  CHECK(each("postgresql://ann@/pop?host=/a,%2Fb&port=1,2") ==
        "postgresql://ann@/pop?host=/a&port=1 postgresql://ann@/pop?host=/b&port=2 ");
  CHECK(each("host=a,b port=5433 dbname=pop") ==
        "postgresql:///pop?host=a&port=5433 postgresql:///pop?host=b&port=5433 ");
  CHECK(each("postgresql:///pop") == "postgresql:///pop ");
  CHECK(each("host=a,b,c port=1,2") == FleetUrl::parse("host=a,b,c port=1,2").text() + " ");
  CHECK(FleetUrl::parse("postgresql://db?sslmode=x").value("sslmode") == "x");
  const FleetUrl words =
      FleetUrl::parse("host=/tmp/a dbname = pop user='an n' password='it\\'s' port=5433");
  CHECK(words.user == "an n");
  CHECK(words.password == "it's");
  CHECK(words.text() == "postgresql://an%20n:it%27s@/pop?host=/tmp/a&port=5433");
}

TEST_CASE("the digest of a password is that of RFC 7677", "[fleet]") {
  const std::string salt("\x5b\x6d\x99\x68\x9d\x12\x35\x8e\xec\xa0\x4b\x14\x12\x36\xfa\x81", 16);
  CHECK(popcut::daemon::scram_verifier("pencil", salt) ==
        "SCRAM-SHA-256$4096:W22ZaJ0SNY7soEsUEjb6gQ==$WG5d8oPm3OtcPnkdi4Uo7BkeZkBFzpcXkuLmtbsT4qY=:"
        "wfPLwcE6nTWhTAmQ7tl2KeoiWGPlZqQxSrmfPwDl2dU=");
}

TEST_CASE("fleet init makes the database, its tables and roles, once", "[fleet]") {
  NEEDS_POSTGRES();
  const CommandBench bench;
  const std::string name = fresh_name("made_");
  const std::string url = shared_postgres().url(name);
  const Ran first = bench.popcut({"fleet", "init", "--database", url});
  CHECK(first.exit == 0);
  CHECK(says(first.out, "created the database " + name));
  CHECK(says(first.out, "made the tables and roles of the fleet (version 1)"));
  CHECK(says(first.err, "popcut fleet join --node NAME"));
  const Ran second = bench.popcut({"fleet", "init", "--database", url, "--json"});
  CHECK(second.exit == 0);
  CHECK(nlohmann::json::parse(second.out) ==
        nlohmann::json({{"created_database", false}, {"version_before", 1}, {"version", 1}}));
  CHECK(shared_postgres().run_sql("SELECT version, least FROM popcut.popcut_schema", name) ==
        "1|1");
  (void)shared_postgres().run_sql("UPDATE popcut.popcut_schema SET version=9", name);
  check_refused(bench.popcut({"fleet", "init", "--database", url}), 5,
                "made by a later popcut (version 9, this one knows 1); install that version");
  (void)shared_postgres().run_sql("DROP DATABASE " + name);
}

TEST_CASE("what is wrong with the address of a fleet is said with what would be right", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  check_refused_at(bench.popcut({"fleet", "nodes"}), 2, "--database: is missing");
  check_refused_at(bench.popcut({"fleet", "nodes", "--database", "db.lab"}), 2,
                   "--database: \"db.lab\" is not the address");
  check_refused_at(bench.popcut({"fleet", "init", "--database", "postgresql://db.lab"}), 2,
                   "--database: names no database");
  check_refused(bench.popcut({"fleet", "nodes", "--database",
                              "postgresql://me:secret@127.0.0.1:1/pop?connect_timeout=2"}),
                5, "postgresql://me@127.0.0.1:1/pop?connect_timeout=2: ");
  check_refused(bench.fleet({"nodes"}), 5, "make them with: popcut fleet init");
  check_refused(bench.fleet({"join", "--node", "a"}), 5, "make them with: popcut fleet init");
  (void)bench.database.run_sql("CREATE SCHEMA popcut");
  check_refused(bench.fleet({"init"}), 5, "give the fleet a database of its own");
  const Ran none = bench.popcut({"fleet"});
  CHECK(none.exit == 2);
}

TEST_CASE("an older fleet is brought to the next version in one transaction", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  PostgresDatabase database({.url = bench.database.url()});
  const std::vector<FleetStep> wrong{{2, 1, "CREATE TABLE popcut.kettle(id bigint)"},
                                     {3, 2, "CREATE TABLE popcut.kettle(id bigint)"}};
  CHECK_THROWS_AS(popcut::daemon::make_fleet(database, wrong), StoreFault);
  CHECK(bench.database.run_sql("SELECT version, least FROM popcut.popcut_schema") == "1|1");
  CHECK(bench.database.run_sql("SELECT to_regclass('popcut.kettle') IS NULL") == "t");
  const std::vector<FleetStep> steps{{2, 1, "CREATE TABLE popcut.kettle(id bigint)"},
                                     {3, 2, "ALTER TABLE popcut.kettle ADD COLUMN warm bigint"}};
  const auto made = popcut::daemon::make_fleet(database, steps);
  CHECK(made.from == 1);
  CHECK(made.to == 3);
  CHECK(bench.database.run_sql("SELECT version, least FROM popcut.popcut_schema") == "3|2");
  CHECK(bench.database.run_sql(
            "SELECT tableowner FROM pg_tables WHERE schemaname='popcut' AND tablename='kettle'") ==
        "popcut_owner");
  CHECK(popcut::daemon::make_fleet(database, steps).from == 3);
  // Version 2 would have left this popcut, which knows 1, at work; version 3 does not.
  CHECK(says(popcut::daemon::schema_misfit(database), "made by a later popcut (version 3"));
  (void)bench.database.run_sql("UPDATE popcut.popcut_schema SET version=2, least=1");
  CHECK(popcut::daemon::schema_misfit(database).empty());
  // A new database gets there in one go.
  const FreshDatabase other;
  PostgresDatabase empty({.url = other.url()});
  CHECK(popcut::daemon::make_fleet(empty, steps).from == 0);
  CHECK(other.run_sql("SELECT version, least FROM popcut.popcut_schema") == "3|2");
}

TEST_CASE("a node that joins gets a login that works, and a new password ends the old one",
          "[fleet]") {
  NEEDS_POSTGRES();
  PostgresServer server({.tcp = true});
  const CommandBench bench;
  const auto fleet = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "fleet");
    words.insert(words.end(), {"--database", server.url("pop")});
    return bench.popcut(std::move(words));
  };
  REQUIRE(fleet({"init"}).exit == 0);
  check_refused(fleet({"join", "--node", "-x"}), 5, "\"-x\" is no name for a node");
  const Ran joined = fleet({"join", "--node", "Room-1", "--url", "https://room-1.lab", "--json"});
  CAPTURE(joined.err);
  REQUIRE(joined.exit == 0);
  const auto json = nlohmann::json::parse(joined.out);
  CHECK(json["login"] == "popcut_n_room_1");
  const std::string section = json["configuration"];
  CHECK(says(section, "[fleet]\ndatabase = \"postgresql://popcut_n_room_1@"));
  CHECK(says(section,
             "password_file = \"/etc/popcut/fleet.password\"\nnode = \"Room-1\"\n"
             "url = \"https://room-1.lab\"\n"));
  const std::string secret = json["password"];
  CHECK(secret.size() == 32);
  const std::string url = server.tcp_url("pop", "popcut_n_room_1", secret);
  CHECK(run_sql(url, "SELECT epoch>0 FROM popcut.node_begin('Room-1', 'i', '', '', NULL, 0)") ==
        "t");
  // It may do no more than a node must.
  CHECK_THROWS(run_sql(url, "UPDATE popcut.node SET draining=1"));
  CHECK_THROWS(run_sql(url, "SELECT popcut.node_forget('Room-1')"));
  CHECK_FALSE(says(server.log(), secret));

  check_refused(fleet({"join", "--node", "Room-1"}), 5, "popcut fleet join --node Room-1 --again");
  check_refused(fleet({"join", "--node", "room.1"}), 5, "node Room-1 has the login");
  check_refused(fleet({"join", "--node", "room-2", "--again"}), 5, "has not joined yet");
  const Ran again = fleet({"join", "--node", "Room-1", "--again", "--write", bench.path("")});
  CAPTURE(again.err);
  REQUIRE(again.exit == 0);
  CHECK(says(again.out, "password_file = \"" + bench.path("fleet.password") + "\""));
  struct stat made {};
  REQUIRE(::stat(bench.path("fleet.password").c_str(), &made) == 0);
  CHECK((made.st_mode & 0777) == 0600);
  std::string other = text_of_file(bench.path("fleet.password"));
  CHECK(other.back() == '\n');
  other.pop_back();
  CHECK_FALSE(says(again.out + again.err, other));
  CHECK_THROWS(run_sql(url, "SELECT 1"));
  CHECK(run_sql(server.tcp_url("pop", "popcut_n_room_1", other), "SELECT 1") == "1");
  // A folder that cannot be written is found before the server has a password that is lost.
  check_refused(fleet({"join", "--node", "room-3", "--write", "/proc/nowhere"}), 7, "--write");
  CHECK(server.run_sql("SELECT count(*) FROM pg_roles WHERE rolname='popcut_n_room_3'") == "0");
}

TEST_CASE("the address of a node's database may be another than that of who lets it in",
          "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  const auto address = [&](const std::string& host) {
    const Ran joined =
        bench.fleet({"join", "--node", fresh_name("far-"), "--address", host, "--json"});
    CAPTURE(joined.err);
    REQUIRE(joined.exit == 0);
    const std::string text = nlohmann::json::parse(joined.out)["configuration"];
    const std::size_t from = text.find('@');
    return text.substr(from, text.find('"', from) - from);
  };
  // The fixture's own address says sslmode=disable.
  const std::string rest = "/" + bench.database.name() + "?gssencmode=disable&sslmode=verify-full";
  CHECK(address("db.lab") == "@db.lab" + rest);
  CHECK(address("db1.lab,db2.lab:5433") == "@db1.lab,db2.lab:5433" + rest);
  CHECK(address("127.0.0.1") ==
        "@127.0.0.1/" + bench.database.name() + "?sslmode=disable&gssencmode=disable");
}

TEST_CASE("who looks after a fleet need not be a superuser", "[fleet]") {
  NEEDS_POSTGRES();
  PostgresServer& server = shared_postgres();
  const CommandBench bench;
  const std::string maker = fresh_name("maker_"), guest = fresh_name("guest_"),
                    warden = fresh_name("warden_"), name = fresh_name("db_"),
                    node = fresh_name("room-");
  (void)server.run_sql(
      fmt::format("CREATE ROLE {} LOGIN CREATEROLE CREATEDB; CREATE ROLE {} LOGIN; "
                  "CREATE ROLE {} LOGIN",
                  maker, guest, warden));
  const auto fleet = [&](const std::string& who, std::vector<std::string> words) {
    words.insert(words.begin(), "fleet");
    words.insert(words.end(), {"--database", server.url(name, who)});
    return bench.popcut(std::move(words));
  };
  check_refused(fleet(guest, {"init"}), 5,
                "permission denied to create database; give --database a role that may");
  const Ran made = fleet(maker, {"init"});
  CAPTURE(made.err);
  CHECK(made.exit == 0);
  CHECK(fleet(maker, {"init"}).exit == 0);
  CHECK(fleet(maker, {"join", "--node", node}).exit == 0);
  check_refused(fleet(guest, {"nodes"}), 5, "permission denied for ");
  const Ran refused = fleet(guest, {"join", "--node", fresh_name("x-")});
  CHECK(refused.exit == 5);
  CHECK_FALSE(says(refused.err, "SCRAM"));
  (void)server.run_sql("GRANT popcut_admin TO " + warden);
  CHECK(fleet(warden, {"nodes"}).exit == 0);
  CHECK(fleet(warden, {"drain", node}).exit == 0);
  check_refused(fleet(warden, {"join", "--node", fresh_name("y-")}), 5,
                "permission denied to create role; give --database a role that may");
  const Ran forgotten = fleet(warden, {"forget", node});
  CHECK(forgotten.exit == 0);
  CHECK(says(forgotten.err, "DROP ROLE " + popcut::daemon::login_of(node)));
  // Its login is still there: to let it in again takes a new password.
  check_refused(fleet(maker, {"join", "--node", node}), 5,
                fmt::format("popcut fleet join --node {} --again", node));
  CHECK(fleet(maker, {"join", "--node", node, "--again"}).exit == 0);
  CHECK(fleet(maker, {"forget", node}).err.empty());
  (void)server.run_sql("DROP DATABASE " + name);
}

TEST_CASE("fleet nodes tells of each node what a person needs", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  const Ran none = bench.fleet({"nodes"});
  CHECK(none.exit == 0);
  CHECK(says(none.err, "popcut fleet join --node NAME"));
  const std::string waiting = fresh_name("w");
  REQUIRE(bench.fleet({"join", "--node", waiting}).exit == 0);
  bench.begin("room-1");
  bench.begin("room-2");
  (void)bench.database.run_sql(
      "SET search_path=popcut; SELECT node_end('room-2', (SELECT epoch FROM node WHERE "
      "name='room-2')); INSERT INTO device(id, rev, model, title, simulated, width_mm, length_mm, "
      "enabled, state, sheets_done, cut_mm, node, site) VALUES('usb:7', 1, 'm', 't', 0, 1, 1, 1, "
      "'idle', 0, 0, 'room-1', 'ground floor')");
  CHECK(bench.fleet({"drain", "room-1"}).exit == 0);
  CHECK(bench.database.run_sql("SELECT begun_ms>0, lease_until_ms FROM popcut.node_state WHERE "
                               "name<>'room-1' ORDER BY name") == "t|0\nf|0");
  const Ran table = bench.fleet({"nodes"});
  CAPTURE(table.out, table.err);
  REQUIRE(table.exit == 0);
  CHECK(says(table.out, "alive for 0 s, draining") != says(table.out, "alive for 1 s, draining"));
  CHECK(says(table.out, "usb:7 idle at ground floor  http://room-1.lab"));
  CHECK(says(table.out, "stopped 0 s ago") != says(table.out, "stopped 1 s ago"));
  CHECK(says(table.out, "never started"));
  CHECK(bench.fleet({"drain", "room-1", "--undo"}).exit == 0);
  const auto nodes = nlohmann::json::parse(bench.fleet({"nodes", "--json"}).out)["nodes"];
  REQUIRE(nodes.size() == 3);
  CHECK(nodes[0]["name"] == "room-1");
  CHECK(nodes[0]["alive"] == true);
  CHECK(nodes[0]["draining"] == false);
  CHECK(nodes[0]["reported"] == true);
  CHECK(nodes[0]["lease_s"] > 20);
  CHECK(nodes[0]["devices"] == nlohmann::json({"usb:7 idle"}));
  CHECK(nodes[0]["site"] == "ground floor");
  CHECK(nodes[1]["site"] == "");
  CHECK(nodes[1]["alive"] == false);
  CHECK(nodes[1]["stopped"] == true);
  CHECK(nodes[2]["name"] == waiting);
  CHECK(nodes[2]["epoch"] == 0);
}

TEST_CASE("a node that is alive is not forgotten, and one that is goes with its login", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  const std::string name = fresh_name("gone-");
  REQUIRE(bench.fleet({"join", "--node", name}).exit == 0);
  bench.begin(name);
  check_refused(bench.fleet({"forget", name}), 5,
                fmt::format("node {} is alive; stop its popcutd first", name));
  (void)bench.database.run_sql(
      "UPDATE popcut.node SET lease_until='-infinity'; INSERT INTO popcut.plan(id, key, kind, "
      "design, "
      "material, machine, state, sha256, sheets, paths, cut_mm, low_s, high_s, width_mm, "
      "length_mm, "
      "warnings, error, options, machine_json, material_json, created) VALUES(repeat('P', 26), "
      "'k', "
      "'test', '', '', '', 'pending', '', 0, 0, 0, 0, 0, 0, 0, '[]', '', '', '', '', 0)");
  const Ran gone = bench.fleet({"forget", name});
  CAPTURE(gone.err);
  CHECK(gone.exit == 0);
  CHECK(gone.out == fmt::format("node {} is forgotten\n", name));
  CHECK(gone.err.empty());
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.node") == "0");
  CHECK(bench.database.run_sql(fmt::format("SELECT count(*) FROM pg_roles WHERE rolname='{}'",
                                           popcut::daemon::login_of(name))) == "0");
  check_refused(bench.fleet({"forget", name}), 5, fmt::format("there is no node {}", name));
  check_refused(bench.fleet({"drain", name}), 5, fmt::format("there is no node {}", name));
}

TEST_CASE("a popcutd that was alone moves into a fleet with all that it has", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  const std::string node = fresh_name("lab-"), who = fmt::format("uid:{}", ::getuid());
  RunningDaemon lab;
  lab.open();
  const std::string design = lab.design(RunningDaemon::lines_svg(5));
  const std::string cut = lab.ready_job(design), waits = lab.ready_job(design);
  lab.cut(cut);
  lab.await_state(cut, "done");
  const auto token = nlohmann::json::parse(
      lab.ask("POST", "/v1/tokens", R"({"name":"shop","role":"viewer"})").body);
  const auto before = lab.job(cut);
  auto ledger = lab.ledger(cut);
  const auto import = [&](std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"import", "--node", node, "--state", lab.daemon().state()});
    return bench.fleet(std::move(more));
  };
  check_refused(import(), 5, "another popcutd");
  lab.act(waits, "arm", {{"sheet", 1}});
  lab.daemon().signal(SIGKILL);
  lab.daemon().wait();
  check_refused(import(), 5, "popcut fleet join --node " + node);
  const Ran joined = bench.fleet({"join", "--node", node, "--write", bench.path("")});
  REQUIRE(joined.exit == 0);
  check_refused(import(), 5, fmt::format("job {} is armed; start popcutd with this folder", waits));
  lab.open();
  lab.await_state(waits, "ready");
  const auto for_hall = value(lab.api().patch(lab.job(waits), {{"site", "hall"}}));
  CHECK(says(for_hall["warnings"].dump(), "no cutter is at site hall"));
  lab.daemon().signal(SIGTERM);
  CHECK(lab.daemon().wait() == 0);

  // What breaks off near its end leaves nothing behind, and can be done again.
  (void)bench.database.run_sql("ALTER TABLE popcut.event ADD CONSTRAINT none CHECK (seq<0)");
  check_refused(import(), 5, "nothing was moved: ");
  CHECK(bench.database.run_sql("SELECT (SELECT count(*) FROM popcut.job), (SELECT count(*) FROM "
                               "popcut.blob), (SELECT count(*) FROM popcut.audit)") == "0|0|0");
  CHECK(std::filesystem::exists(lab.daemon().state() + "/popcut.db"));
  (void)bench.database.run_sql("ALTER TABLE popcut.event DROP CONSTRAINT none");

  const Ran moved = import({"--json"});
  CAPTURE(moved.err);
  REQUIRE(moved.exit == 0);
  const auto done = nlohmann::json::parse(moved.out);
  CHECK(done["missing"].empty());
  CHECK(done["files"] > 3);
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.job") == "2");
  CHECK(bench.database.run_sql(fmt::format("SELECT site FROM popcut.job WHERE id='{}'", waits)) ==
        "hall");
  CHECK(bench.database.run_sql("SELECT DISTINCT owner FROM popcut.job") == who + "@" + node);
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.audit WHERE principal='" + who + "'") ==
        "0");
  CHECK(bench.database.run_sql("SELECT last=(SELECT max(seq) FROM popcut.event) FROM "
                               "popcut.event_counter") == "t");
  CHECK(bench.database.run_sql("INSERT INTO popcut.audit(time, principal, action, subject, detail) "
                               "VALUES(0, '', '', '', '') RETURNING seq = (SELECT max(seq)+1 FROM "
                               "popcut.audit)") == "t");
  CHECK(bench.database.run_sql("SELECT state, sum(jobs) FROM popcut.tally GROUP BY state ORDER BY "
                               "state") == "done|1\nready|1");
  CHECK(
      bench.database.run_sql(
          "SELECT bool_and(blob.bytes=(SELECT sum(octet_length(data)) FROM popcut.blob_part WHERE "
          "path=blob.path) AND sha256=(SELECT encode(sha256(string_agg(data, '' ORDER BY seq)), "
          "'hex') FROM popcut.blob_part WHERE path=blob.path)) FROM popcut.blob") == "t");
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.blob WHERE path='designs/" + design +
                               "'") == "1");

  // A second time there is nothing; with the database back in its place the ids say so.
  check_refused(import(), 5, "popcut.db: does not exist");
  const std::string original = done["original"];
  std::filesystem::copy_file(original, lab.daemon().state() + "/popcut.db");
  check_refused(import(), 5, "this folder was imported before; move ");
  std::filesystem::remove(lab.daemon().state() + "/popcut.db");
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.job") == "2");
  // Without a fleet it does not begin with an empty queue.
  CHECK_FALSE(lab.daemon().start());
  CHECK(says(lab.daemon().log(), "popcut.db: the jobs of this popcutd have moved to a fleet"));
  check_refused(bench.popcut({"db", "restore", original, "--state", lab.daemon().state()}), 5,
                "have moved to a fleet, and may be cut there");
  CHECK_FALSE(std::filesystem::exists(lab.daemon().state() + "/popcut.db"));

  write_file(lab.daemon().config(),
             text_of_file(lab.daemon().config()) + joined.out + "site = \"hall\"\n");
  lab.open();
  auto after = lab.job(cut);
  CHECK(after["owner"] == who + "@" + node);
  for (const char* key : {"id", "state", "name", "created", "finished", "sheets", "paths"})
    CHECK(after.value(key, nlohmann::json()) == before.value(key, nlohmann::json()));
  ledger["attempts"][0]["operator"] = who + "@" + node;
  CHECK(lab.ledger(cut) == ledger);
  CHECK(lab.get("/v1/tokens").dump().find(token.value("id", "?")) != std::string::npos);
  lab.cut(waits);
  lab.await_state(waits, "done");
}

TEST_CASE("two that were alone move into one fleet", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  for (const std::string& node : {fresh_name("one-"), fresh_name("two-")}) {
    RunningDaemon lab;
    lab.open();
    // The same design and the same plan at both.
    const std::string job = lab.ready_job(lab.design(RunningDaemon::lines_svg(5)));
    lab.daemon().signal(SIGTERM);
    CHECK(lab.daemon().wait() == 0);
    REQUIRE(bench.fleet({"join", "--node", node}).exit == 0);
    const Ran moved = bench.fleet({"import", "--node", node, "--state", lab.daemon().state()});
    CAPTURE(moved.err);
    REQUIRE(moved.exit == 0);
    CHECK(says(moved.out, "job                 1 rows\n"));
    CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.job WHERE id='" + job + "'") == "1");
  }
  CHECK(bench.database.run_sql("SELECT count(*) FROM popcut.design") == "1");
  CHECK(bench.database.run_sql("SELECT count(*), count(DISTINCT key) FROM popcut.plan") == "2|2");
  // The events of both, in one row without gaps, each with its number in its text.
  CHECK(
      bench.database.run_sql("SELECT max(seq)-min(seq)+1=count(*) AND max(seq)=(SELECT last FROM "
                             "popcut.event_counter) AND bool_and((data::json->>'seq')::bigint=seq) "
                             "FROM popcut.event") == "t");
}

TEST_CASE("doctor tells of a node and its fleet in plain sentences", "[fleet]") {
  NEEDS_POSTGRES();
  const FleetBench bench;
  bench.init();
  const std::string node = fresh_name("room-");
  const Ran joined = bench.fleet({"join", "--node", node, "--write", bench.path("")});
  REQUIRE(joined.exit == 0);
  write_file(bench.temp / "popcutd.toml", joined.out);
  const auto doctor = [&] {
    const Ran ran = bench.popcut({"doctor", "--config", bench.path("popcutd.toml"), "--json"});
    CAPTURE(ran.err);
    // fsync is off in a server of tests, which is a problem of the fleet.
    check_refused(ran, 5, "popcut: fleet: ");
    const auto fleet = nlohmann::json::parse(ran.out)["fleet"];
    std::string text = fleet["title"].get<std::string>() + "\n";
    for (const auto& one : fleet["findings"])
      text += fmt::format("{}: {}; {}\n", one["level"].get<std::string>(),
                          one["what"].get<std::string>(), one.value("do", ""));
    return text;
  };
  std::string text = doctor();
  CAPTURE(text);
  CHECK(text.starts_with("node " + node + "\n"));
  CHECK(says(text, "the fleet's database answers: postgresql://popcut_n_"));
  CHECK(says(text, "its tables fit this popcut (version 1)"));
  CHECK(says(text, fmt::format("is that of node {};", node)));
  CHECK(says(text, "this machine's clock agrees with the database's"));
  CHECK(says(
      text,
      fmt::format("node {} has joined, and its popcutd was never started; start popcutd", node)));
  CHECK(says(text, "(fsync or full_page_writes is off)"));
  CHECK(says(text, "0 of 1 nodes are alive"));

  bench.begin(node);
  bench.begin("hall-9");
  REQUIRE(bench.fleet({"drain", node}).exit == 0);
  (void)bench.database.run_sql(
      "UPDATE popcut.node SET generation='earlier.0', lease_until='-infinity' WHERE name='hall-9'");
  CHECK(says(bench.fleet({"nodes"}).out, " s, has journals to compare"));
  text = doctor();
  CHECK(says(text, fmt::format("node {} is alive; its lease lasts ", node)));
  CHECK(
      says(text, fmt::format("node {0} is being drained: it arms no sheet; popcut fleet drain {0} "
                             "--undo",
                             node)));
  CHECK(says(text,
             "no sheet can be armed: the database went back to an earlier state, and node hall-9 "
             "has not compared its journals with it since; start its popcutd; if it is gone for "
             "good: popcut fleet forget hall-9"));
  // One that was stopped in order missed nothing at a failover, and holds nobody up.
  (void)bench.database.run_sql(
      "UPDATE popcut.node SET ended=1 WHERE name='hall-9'; UPDATE popcut.node "
      "SET generation='earlier.0' WHERE name<>'hall-9'");
  text = doctor();
  CHECK_FALSE(says(text, "hall-9"));
  CHECK(
      says(text, fmt::format("node {} is alive, and compares its journals within seconds", node)));
  (void)bench.database.run_sql(fmt::format(
      "UPDATE popcut.node SET ended=0, generation=popcut.popcut_generation() WHERE name='hall-9'; "
      "UPDATE "
      "popcut.node SET lease_until='-infinity' WHERE name='{0}'; UPDATE popcut.node SET "
      "login='other' "
      "WHERE name='{0}'",
      node));
  text = doctor();
  CHECK(says(text, "node hall-9 is silent for "));
  CHECK(says(text, fmt::format("node {} has no lease: its popcutd was last heard ", node)));
  CHECK(says(text, fmt::format("node {} has the login other, and [fleet] has popcut_n_", node)));
  (void)bench.database.run_sql("UPDATE popcut.popcut_schema SET version=9, least=9");
  CHECK(
      says(doctor(), "made by a later popcut (version 9, this one knows 1); install that version"));

  std::filesystem::remove(bench.temp / "fleet.password");
  text = doctor();
  CHECK(says(text,
             "the password_file of [fleet], does not exist; as the administrator of the database: "
             "popcut fleet join --node " +
                 node + " --again"));
  write_file(bench.temp / "popcutd.toml", "[fleet]\ndatabse = 1\n");
  CHECK(says(doctor(), "--check-config"));
  // Without a fleet it speaks of none.
  write_file(bench.temp / "popcutd.toml", "listen = []\n");
  const Ran alone = bench.popcut({"doctor", "--config", bench.path("popcutd.toml"), "--json"});
  CHECK_FALSE(says(alone.out, "\"fleet\""));
}

TEST_CASE("doctor tells what keeps a node from its database, and a clock that is wrong",
          "[fleet]") {
  NEEDS_POSTGRES();
  PostgresServer server({.tcp = true});
  (void)server.create_database("pop");
  const auto look = [&](const std::string& url, std::int64_t late_ms = 0) {
    return told(popcut::daemon::fleet_findings(
        {.url = url, .password = "", .node = "a", .now_ms = [late_ms] {
           return std::chrono::duration_cast<std::chrono::milliseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count() -
                  late_ms;
         }}));
  };
  CHECK(says(look("postgresql://a@127.0.0.1:1/pop"),
             "problem: the fleet's database does not answer at"));
  CHECK(says(look(server.tcp_url("pop", "postgres", "wrong")),
             "problem: the fleet's database does not let this node in: "));
  CHECK(
      says(look(server.url("none")), "problem: the fleet's database does not let this node in: "));
  CHECK(says(look(server.url("pop")),
             "problem: the database has no tables of popcut; make them with"));
  PostgresDatabase database({.url = server.url("pop")});
  (void)popcut::daemon::make_fleet(database);
  (void)server.run_sql("CREATE ROLE stranger LOGIN");
  CHECK(says(look(server.url("pop", "stranger")),
             "problem: the login of [fleet] may not read the fleet's tables; as the administrator "
             "of the"));
  const std::string late = look(server.url("pop"), 3 * 3'700'000);
  CHECK(says(late,
             "note: this machine's clock is 3 h behind the database's, which popcut uses; "
             "timedatectl set-ntp true"));
  CHECK(says(late, "note: the login postgres may do anything in the fleet's database"));
  CHECK(says(late,
             "problem: the fleet has no node a; as the administrator of the database: popcut fleet "
             "join --node a"));
  CHECK(says(look(server.url("pop"), -200'000), "is 3 min ahead of the database's"));
  (void)server.run_sql("ALTER ROLE postgres SET synchronous_commit=off");
  CHECK(says(look(server.url("pop")), "problem: commits do not wait for the disk"));
}

TEST_CASE("doctor tells what a failover may lose", "[fleet]") {
  NEEDS_POSTGRES();
  PostgresServer server({.fsync = true});
  PostgresDatabase database({.url = server.url()});
  (void)popcut::daemon::make_fleet(database);
  const auto look = [&] {
    return told(popcut::daemon::fleet_findings({.url = server.url(), .password = "", .node = "a"}));
  };
  CHECK(says(look(), "note: the database has no standby: if its machine is lost, a backup"));
  {
    const PostgresServer standby =
        PostgresServer::standby_of(server, PostgresServer::Commits::Asynchronous);
    CHECK(happens([&] {
      return says(look(), "note: a standby follows without being waited for: a failover may lose");
    }));
  }
  const PostgresServer standby =
      PostgresServer::standby_of(server, PostgresServer::Commits::Synchronous);
  CHECK(happens([&] {
    return says(look(), "fine: each START is on the disk of a standby before the knife moves");
  }));
  (void)server.run_sql("ALTER ROLE postgres SET synchronous_commit=local");
  CHECK(says(look(), "note: synchronous_commit = local: a START does not wait for the standby"));
}

}  // namespace fleet_command_test
