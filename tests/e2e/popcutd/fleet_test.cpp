// SPDX-License-Identifier: MIT
// Several popcutd with a simulated cutter each on one PostgreSQL.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/e2e/popcutd/fleet_cuts.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

namespace fleet_test {

using namespace popcut;
using namespace popcut::testing;
using namespace fleet_cuts;

namespace {

constexpr int kLines = 60;
constexpr double kSlow = 4;  // so that a sheet of 60 lines takes some seconds

/// popcutd that will not serve: its exit code, and the one line that it said.
struct Refusal {
  int code{};
  std::string said;
};
Refusal refusal_of(const std::string& section) {
  TempFolder folder;
  write_file(folder / "popcutd.toml", "listen = [\"127.0.0.1:0\"]\nsocket = \"" +
                                          (folder / "socket").string() + "\"\nstate = \"" +
                                          (folder / "state").string() + "\"\n" + section);
  const Ran ran = run_program({"/usr/bin/timeout", "120", popcutd_program(), "--config",
                               (folder / "popcutd.toml").string()},
                              folder.path());
  std::string said;
  std::istringstream lines(ran.err);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("popcutd: ", 0) == 0) said += line + "\n";
  return {ran.exit, said};
}

}  // namespace

TEST_CASE("a job queued at one node is armed, started and seen at the other", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet;
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, 5);
  fleet[2].cut(job);
  fleet[2].await_state(job, "done");
  fleet[1].await_state(job, "done");
  CHECK(fleet.lines_cut(2, 5).size() == 5);
  CHECK(wrong_in(fleet[1].ledger(job), 5, {0, 1, 2, 3, 4}) == "");
}

TEST_CASE("only a person at the cutter's node arms, starts and resumes", "[fleet][seconds]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  CHECK(says(
      refusal(fleet[1], job, "arm", sheet_1()),
      "sim:room-2 is at room-2; only a person there may arm, start and resume: http://room-2.lab"));
  fleet[2].act(job, "arm", sheet_1());
  fleet[1].await_state(job, "armed");
  CHECK(says(refusal(fleet[1], job, "start", sheet_1()), "sim:room-2 is at room-2"));
  CHECK(fleet[1].job(job)["state"] == "armed");
  fleet[2].act(job, "start", sheet_1());
  await_knife(fleet[2], job);

  const auto pressed = Clock::now();
  fleet[1].act(job, "pause");
  fleet[2].await_state(job, "paused");
  CHECK(in_time(pressed, 1.5));  // a stroke's end, and at most a second
  CHECK(says(refusal(fleet[1], job, "resume"), "sim:room-2 is at room-2"));
  fleet[2].act(job, "resume");
  fleet[1].await_state(job, "cutting");

  fleet[2].act(job, "pause");
  fleet[1].await_state(job, "paused");
  const Json paused = fleet[1].get("/v1/jobs?limit=200&state=paused")["items"];
  REQUIRE(paused.size() == 1);
  const auto cancelled = Clock::now();
  CHECK(refusal(fleet[1], paused[0]["id"], "cancel") == "");
  fleet[2].await_state(job, "cancelled");
  CHECK(in_time(cancelled, 1.5));
  CHECK(fleet.lines_cut(2, kLines).size() < kLines);
  fleet[1].await_state(job, "cancelled");
}

TEST_CASE("a node killed while it searches: another finds the cards, and all nodes show them",
          "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet;
  fleet.open();
  const auto put = [&](const std::string& target, const std::string& bytes, const char* type) {
    const auto made = fleet[1].ask("POST", target, bytes, type);
    INFO(made.body);
    REQUIRE((made.status >= 200 && made.status < 300));
    return Json::parse(made.body).at("id").get<std::string>();
  };
  const std::string hall = testing::obj(testing::box_mesh({0, 0, 0}, {30, 60, 25}, false));
  const std::string model = put("/v1/assets?name=hall.obj", hall, "application/octet-stream");
  const std::string id =
      put("/v1/assets/" + model + "/search",
          R"({"effort": 0.03, "style": "facets", "up": "z", "marks": true})", "application/json");
  REQUIRE(happens([&] { return !fleet[1].get("/v1/searches/" + id)["progress"].is_null(); }));
  CHECK(fleet[2].get("/v1/searches/" + id)["progress"]["doing"] == "searching at node room-1");
  fleet.kill(1);
  REQUIRE(happens([&] { return fleet[2].get("/v1/searches/" + id)["state"] != "pending"; }, 900));
  const Json found = fleet[2].get("/v1/searches/" + id);
  INFO(found.dump().substr(0, 800));
  REQUIRE(found["state"] == "found");
  CHECK(found["marks"] == true);
  fleet.open(1);
  CHECK(fleet[1].get("/v1/searches/" + id)["cards"] == found["cards"]);
  for (int k : {1, 2})
    CHECK(happens([&] {
      return fleet[k].ask("GET", "/v1/searches/" + id + "/cards/1.png").body.starts_with("\x89PNG");
    }));
}

TEST_CASE("without its database a node serves what is local, and begins when it is there",
          "[fleet][seconds]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1});
  fleet.server().stop();
  const auto begun = Clock::now();
  fleet[1].open();
  CHECK(in_time(begun, 5));
  CHECK(fleet[1].ask("GET", "/healthz").status == 200);
  CHECK(fleet[1].ask("GET", "/").status == 200);
  const client::HttpResponse ready = fleet[1].ask("GET", "/readyz");
  CHECK(ready.status == 503);
  CHECK(fleet[1].device_state(FleetNodes::device(1)) == "idle");
  const client::HttpResponse jobs = fleet[1].ask("GET", "/v1/jobs");
  CHECK(jobs.status == 503);
  CHECK(says(jobs.body, "the database of the fleet does not answer"));
  CHECK(jobs.retry_after_s.has_value());
  fleet.server().start();
  REQUIRE(happens([&] { return fleet.is_alive(1); }));
  const std::string job = fleet.ready_job(1, 1, 3);
  fleet[1].cut(job);
  fleet[1].await_state(job, "done");
}

TEST_CASE("a fleet that will not do is refused with code 78 and one sentence", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .tcp = true});
  PostgresServer& server = fleet.server();
  const auto with = [](const std::string& url) {
    return "[fleet]\nnode = \"room-1\"\ndatabase = \"" + url + "\"\n";
  };
  const auto refused = [](const Refusal& refusal, const std::string& words) {
    CAPTURE(refusal.said);
    CHECK(refusal.code == 78);
    CHECK(says(refusal.said, words));
    CHECK(std::count(refusal.said.begin(), refusal.said.end(), '\n') == 1);
    CHECK(refusal.said.rfind("popcutd: ", 0) == 0);
    CHECK(refusal.said.find("  ") == std::string::npos);
  };
  refused(refusal_of(with(server.tcp_url("popcut", "popcut_n_room_1", "wrong"))),
          "password authentication failed");
  refused(refusal_of(with(server.url("nowhere", "popcut_n_room_1"))), "does not exist");
  refused(refusal_of(with(server.url("popcut", "nobody_knows"))), "does not exist");
  refused(refusal_of(with("postgresql://popcut_n_room_1@/popcut?host=" + server.folder().string() +
                          "&port=abc")),
          "fleet.database");
  refused(refusal_of(with("postgresql://x/popcut?nonsense=1")), "nonsense");
  refused(refusal_of(with("mysql://x/popcut")), "must be the address of a PostgreSQL");
  server.create_database("bare");
  refused(refusal_of(with(server.url("bare"))), "popcut fleet init");
  fleet.run_sql("UPDATE popcut.popcut_schema SET version=99, least=98");
  refused(refusal_of(with(server.url("popcut", "popcut_n_room_1"))), "later popcut");
  fleet.run_sql("UPDATE popcut.popcut_schema SET version=1, least=1");
  refused(refusal_of(fleet.section(1)), "no password supplied");
  write_file(fleet[1].daemon().folder() / "secret", "not this\n");
  refused(refusal_of(with(server.tcp_url("popcut", "popcut_n_room_1", "")) + "password_file = \"" +
                     (fleet[1].daemon().folder() / "secret").string() + "\"\n"),
          "password authentication failed");
  refused(refusal_of(with(server.tcp_url("popcut", "popcut_n_room_1", "")) +
                     "password_file = \"/no/such/file\"\n"),
          "fleet.password_file");
}

TEST_CASE("a node with a password from a file comes by TCP", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .tcp = true});
  TempFolder folder;
  write_file(folder / "secret", std::string(FleetNodes::kPassword) + "\n");
  RunningDaemon node(
      0, fleet.section(1) + "password_file = \"" + (folder / "secret").string() + "\"\n");
  node.open();
  CHECK(happens([&] { return fleet.is_alive(1); }));
  CHECK_FALSE(says(node.daemon().log(), FleetNodes::kPassword));
}

TEST_CASE("a node's name is for one popcutd at a time", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1});
  fleet.open();
  const Refusal taken = refusal_of(fleet.section(1));
  CAPTURE(taken.said);
  CHECK(taken.code == 78);
  CHECK(
      says(taken.said, "another popcutd is node room-1 and is alive; give this one another name"));
  CHECK_FALSE(says(taken.said, "popcut.db"));
  CHECK(std::count(taken.said.begin(), taken.said.end(), '\n') == 1);
  // The one that has it goes on.
  const std::string job = fleet.ready_job(1, 1, 3);
  fleet[1].cut(job);
  fleet[1].await_state(job, "done");
}

TEST_CASE("two nodes with a cutter of one id: the second says so and cuts nothing with it",
          "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet;
  fleet.open(1);
  RunningDaemon twin(0, fleet.section(2), FleetNodes::device(1));
  twin.open();
  REQUIRE(happens([&] { return fleet.is_alive(2); }));
  const std::string job = fleet.ready_job(1, 1, 3);
  const std::string why = refusal(twin, job, "arm", sheet_1());
  CAPTURE(why);
  CHECK(says(why, "room-1"));
  CHECK(says(why, "sim:room-1"));
  fleet[1].cut(job);
  fleet[1].await_state(job, "done");
  // When the first is gone it is the second's.
  fleet[1].daemon().signal(SIGTERM);
  CHECK(fleet[1].daemon().wait() == 0);
  CHECK(happens([&] { return twin.device_state(FleetNodes::device(1)) == "idle"; }));
}

TEST_CASE("a token made at one node opens all, and one that is revoked none", "[fleet][seconds]") {
  NEEDS_POSTGRES();
  FleetNodes fleet;
  fleet.open();
  const Json token =
      Json::parse(fleet[1].ask("POST", "/v1/tokens", R"({"name":"lab","role":"viewer"})").body);
  const std::string secret = token.at("token");
  const auto there = client::parse_address(fleet[2].daemon().url());
  REQUIRE(there);
  client::HttpClient http({*there}, secret);
  http.set_tries(0);
  const auto status = [&] {
    const auto answer = http.ask({.target = "/v1/jobs"});
    return answer ? answer->status : 0;
  };
  CHECK(status() == 200);
  client::EventStream stream(http, "/v1/events");
  (void)stream.next(0.5);
  REQUIRE(stream.connected());
  REQUIRE(fleet[1].ask("DELETE", "/v1/tokens/" + token.at("id").get<std::string>()).status == 204);
  const auto revoked = Clock::now();
  CHECK(happens([&] { return status() == 401; }));
  CHECK(in_time(revoked, 1.2));
  CHECK(happens([&] { return !stream.next(0.1) || !stream.connected(); }));
  CHECK(in_time(revoked, 1.5));
}

TEST_CASE("events are the same at all nodes, in the same order, without a gap", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 3});
  fleet.open();
  std::atomic<bool> over{false};
  std::vector<std::vector<std::string>> seen(3);
  std::vector<std::thread> readers;
  for (int k = 1; k <= 3; ++k)
    readers.emplace_back([&, k] {
      client::EventStream stream(fleet[k].api().http(), "/v1/events?after=0");
      while (!over || true) {
        const auto events = stream.next(0.3);
        if (!events || (events->empty() && over)) return;
        for (const client::SseEvent& event : *events)
          if (!event.id.empty() && event.kind != "progress")
            seen[static_cast<std::size_t>(k - 1)].push_back(event.data);
      }
    });
  std::vector<std::thread> people;
  for (int k = 1; k <= 3; ++k)
    people.emplace_back([&, k] {
      RunningDaemon& node = fleet[k];
      const auto address = client::parse_address("unix:" + node.daemon().socket());
      client::Api api(client::HttpClient({*address}, ""));
      for (int round = 0; round < 8; ++round) {
        const auto design =
            api.upload("/v1/designs?name=lines", RunningDaemon::lines_svg(1 + round, 3 + k),
                       "image/svg+xml", "");
        if (design)
          (void)api.post("/v1/jobs", {{"design", client::text_of(*design, "id")}, {"held", true}},
                         "jobs");
      }
    });
  for (std::thread& person : people) person.join();
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  over = true;
  for (std::thread& reader : readers) reader.join();
  REQUIRE(seen[0].size() >= 24);
  CHECK(seen[0] == seen[1]);
  CHECK(seen[1] == seen[2]);
  std::int64_t last = 0;
  for (const std::string& event : seen[0]) {
    const std::int64_t seq = Json::parse(event).at("seq");
    if (last > 0) CHECK(seq == last + 1);
    last = seq;
  }
}

TEST_CASE("a node that begins asks for all journals at once, however many it keeps", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .proxies = true});
  fleet.open();
  constexpr int kCuts = 6;
  for (int k = 0; k < kCuts; ++k) {
    const std::string job = fleet.ready_job(1, 1, 3 + k);
    fleet[1].cut(job);
    (void)fleet[1].await_state(job, "done");
  }
  fleet[1].daemon().signal(SIGTERM);
  (void)fleet[1].daemon().wait();
  fleet.proxy(1).record(true);
  fleet.open(1);
  std::string said;
  for (std::size_t k = 0; k < fleet.proxy(1).recordings(); ++k) said += fleet.proxy(1).recorded(k);
  const auto times = [&](const std::string& word) {
    int count = 0;
    for (std::size_t at = 0; (at = said.find(word, at)) != std::string::npos; ++at) ++count;
    return count;
  };
  CHECK(times("node_reported") >= 1);
  CHECK(times("string_to_array") == 1);
  CHECK(times("SAVEPOINT") == 0);  // one for each journal that is looked at alone
  // They are kept, for a database that is put back to before them.
  const std::filesystem::path journals = fleet[1].daemon().folder() / "state" / "intents";
  INFO(journals);
  CHECK(std::distance(std::filesystem::directory_iterator(journals),
                      std::filesystem::directory_iterator()) >= kCuts);
}

TEST_CASE("a program that was changed after it was planned is not cut", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet;
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, 5);
  const std::string plan = fleet[1].job(job)["plan"];
  // In the database, and at the node that planned it.
  const std::string name = "plans/" + plan + "/sheet-01.gpgl";
  fleet.run_sql(
      "UPDATE popcut.blob_part SET data=set_byte(data, 20, get_byte(data, 20) # 1) "
      "WHERE path='" +
      name + "'");
  for (int k : {1, 2}) {
    const std::string file = fleet[k].daemon().state() + "/" + name;
    std::string program = text_of_file(file);
    if (program.size() <= 20) continue;
    program[20] = static_cast<char>(program[20] ^ 1);
    write_file(file, program);
  }
  std::string why = refusal(fleet[2], job, "arm", sheet_1());
  if (why.empty()) why = refusal(fleet[2], job, "start", sheet_1());
  CAPTURE(why);
  CHECK((says(why, "create the job again") || says(why, "its digest differs")));
  CHECK(fleet.run_sql("SELECT count(*) FROM popcut.attempt WHERE started_at IS NOT NULL") == "0");
}

TEST_CASE("a database that was put back to before a start does not offer the blank again",
          "[fleet]") {
  NEEDS_POSTGRES();
  const bool finished = GENERATE(false, true);
  CAPTURE(finished);
  FleetNodes fleet({.time_scale = finished ? 0 : kSlow});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet.server().run_sql("SELECT pg_switch_wal()");
  const std::string dump = fleet.server().dump(FleetNodes::kDatabase);
  fleet[2].cut(job);
  if (finished)
    fleet[1].await_state(job, "done");
  else
    await_knife(fleet[2], job);
  fleet.kill(2);
  fleet.kill(1);
  const std::set<int> cut = fleet.lines_cut(2, kLines);
  fleet.server().restore(FleetNodes::kDatabase, dump);

  // The node without the journal comes first. It offers nothing before the other has told.
  fleet[1].open();
  const std::string early = refusal(fleet[1], job, "arm", sheet_1());
  CAPTURE(early);
  CHECK_FALSE(early.empty());
  fleet[2].open();
  const Json now = fleet[1].await_state(job, "interrupted");
  CHECK(now["blank"] == 1);
  fleet[2].await_state(job, "interrupted");
  CHECK_FALSE(fleet[2].refused(job, "retry-sheet", sheet_1()));
  // Node 2 knew of more than node 1, which compares its journals again at its next beat.
  await_nodes(fleet);
  fleet[2].cut(job);
  fleet[1].await_state(job, "done");
  CHECK(fleet[1].job(job)["blank"] == 2);
  CHECK(cut_twice(fleet, job) == 0);
}

}  // namespace fleet_test
