// SPDX-License-Identifier: MIT
// The machines of a fleet: clocks that are wrong, disks that are full.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/e2e/popcutd/fleet_cuts.hpp"
#include "tests/support/fault_page.hpp"
#include "tests/support/small_disk.hpp"

namespace fleet_machines_test {

using namespace popcut;
using namespace popcut::testing;
using namespace fleet_cuts;

namespace {

constexpr int kLines = 60;
constexpr double kSlow = 4;
constexpr std::int64_t kHour_s = 3600;

/// How far the times of all jobs and attempts are from the database's clock at most, in seconds;
/// for a test that takes less than a few minutes.
double furthest_s(FleetNodes& fleet) {
  return std::atof(
      fleet
          .run_sql(
              "SELECT max(abs(extract(epoch FROM clock_timestamp()) - t/1000.0)) FROM ("
              "SELECT unnest(ARRAY[created, started, finished]) AS t FROM popcut.job UNION ALL "
              "SELECT unnest(ARRAY[created, started_at, ended]) FROM popcut.attempt UNION ALL "
              "SELECT time FROM popcut.event UNION ALL SELECT time FROM popcut.audit UNION ALL "
              "SELECT created FROM popcut.plan) AS times WHERE t IS NOT NULL")
          .c_str());
}

/// Whether a node may arm: a job that is cut there, to its end.
void cut_one(FleetNodes& fleet, int node) {
  const std::string job = fleet.ready_job(1, node, 3);
  fleet[node].cut(job);
  fleet[node].await_state(job, "done");
}

int status_of_new_job(RunningDaemon& node, const std::string& design) {
  return node
      .ask("POST", "/v1/jobs", Json{{"design", design}, {"device", FleetNodes::device(1)}}.dump())
      .status;
}

}  // namespace

TEST_CASE("clocks that are hours or years wrong change no lease and no time of a job",
          "[fleet][machines]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow});
  std::vector<std::unique_ptr<FaultPage>> pages;
  for (int k : {1, 2})
    pages.push_back(std::make_unique<FaultPage>((fleet[k].daemon().folder() / "page").string()));
  (*pages[0])->clock_s = 7 * kHour_s;
  (*pages[1])->clock_s = -9 * kHour_s;
  for (int k : {1, 2}) fleet.open(k, pages[static_cast<std::size_t>(k - 1)]->environment());
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  // Even more, while the knife is down and leases run.
  (*pages[0])->clock_s = -400 * 24 * kHour_s;
  (*pages[1])->clock_s = 400 * 24 * kHour_s;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  for (int k : {1, 2}) CHECK(fleet.is_alive(k));
  fleet[1].await_state(job, "done");
  CHECK(attempts_of(fleet) == "1|room-2|done");
  CHECK(furthest_s(fleet) < 120);

  // What a node finds at its start it writes down with the right time, too; and the journal of a
  // cut that is not old stays.
  const std::string lost = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(lost);
  await_knife(fleet[2], lost);
  fleet.kill(2);
  const std::string journals = fleet[2].daemon().state() + "/intents";
  const auto count = [&] {
    return std::distance(std::filesystem::directory_iterator(journals),
                         std::filesystem::directory_iterator());
  };
  const auto before = count();
  CHECK(before >= 2);
  fleet.open(2, pages[1]->environment());
  fleet[1].await_state(lost, "interrupted");
  CHECK(furthest_s(fleet) < 120);
  CHECK(count() == before);
  // A token ends when it should, by the one clock.
  const Json token = Json::parse(
      fleet[1]
          .ask("POST", "/v1/tokens", R"({"name":"lab","role":"viewer","lifetime_s":3600})")
          .body);
  CAPTURE(token.dump());
  CHECK(
      std::abs(
          std::atof(fleet
                        .run_sql("SELECT expires/1000.0-extract(epoch FROM clock_timestamp()) FROM "
                                 "popcut.token")
                        .c_str()) -
          3600) < 120);
}

TEST_CASE("a database whose disk is full ends no cut and takes no work until it has room",
          "[fleet][machines]") {
  NEEDS_POSTGRES();
  TempFolder place;
  std::filesystem::permissions(place.path(), std::filesystem::perms{0755});
  const SmallDisk disk(place.path(), 96 << 20);
  if (!disk.why_not().empty()) {
    WARN("skipped: " << disk.why_not());
    return;
  }
  // Without room for its log PostgreSQL ends itself.
  const bool ends = GENERATE(false, true);
  CAPTURE(ends);
  FleetNodes fleet({.nodes = 1,
                    .time_scale = kSlow,
                    .database_place = place.path(),
                    .database_more = ends ? "wal_recycle = off\nmin_wal_size = 2MB\n" : ""});
  fleet.open();
  const std::string job = fleet.ready_job(1, 1, kLines);
  const std::string design = fleet[1].design(RunningDaemon::lines_svg(3));
  fleet[1].cut(job);
  await_knife(fleet[1], job);
  disk.fill();
  if (ends)
    REQUIRE(happens(
        [&] {
          try {
            fleet.run_sql("SELECT pg_switch_wal(); SELECT pg_current_xact_id()");
            return false;
          } catch (const std::exception&) {
            return says(fleet.server().log(), "PANIC");
          }
        },
        20));
  // Work until it notices. What cannot be stored is refused, with a word that says why.
  client::HttpResponse refused{};
  REQUIRE(happens([&] {
    refused = fleet[1].ask("POST", "/v1/designs?name=big", RunningDaemon::lines_svg(20'000),
                           "image/svg+xml");
    return refused.status >= 500;
  }));
  CAPTURE(refused.body, fleet.server().running());
  CHECK(refused.status == (ends ? 503 : 507));
  CHECK((says(refused.body, "the database of the fleet") ||
         says(refused.body, "the fleet's database: its disk is full")));
  CHECK_FALSE(says(refused.body, "INSERT"));
  REQUIRE(happens([&] { return fleet.lines_cut(1, kLines).size() == kLines; }));
  disk.clear();
  if (ends) {  // whoever runs it starts it again
    fleet.server().kill();
    fleet.server().start();
  }
  CHECK(comes_to(fleet[1], job, "done"));
  REQUIRE(happens([&] { return fleet.is_alive(1); }));
  CHECK(attempts_of(fleet) == "1|room-1|done");
  CHECK(cut_twice(fleet, job) == 0);
  REQUIRE(happens([&] { return status_of_new_job(fleet[1], design) == 201; }));
  cut_one(fleet, 1);
}

TEST_CASE("a node whose disk is full starts nothing and loses nothing", "[fleet][machines]") {
  NEEDS_POSTGRES();
  const bool during = GENERATE(false, true);
  CAPTURE(during);
  FleetNodes fleet({.time_scale = kSlow});
  std::filesystem::create_directory(fleet[2].daemon().state());
  const SmallDisk disk(fleet[2].daemon().state(), 32 << 20);
  if (!disk.why_not().empty()) {
    WARN("skipped: " << disk.why_not());
    return;
  }
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  if (!during) {
    fleet[2].act(job, "arm", sheet_1());
    disk.fill();
    // The reserve is for the last records of a cut; it may be enough to start one.
    const std::string why = refusal(fleet[2], job, "start", sheet_1());
    INFO(why);
    if (!why.empty()) {
      CHECK(says(why, "disk"));
      CHECK(attempts_of(fleet).empty());
      CHECK(fleet.lines_cut(2, kLines).empty());
      disk.clear();
      REQUIRE(happens([&] { return refusal(fleet[2], job, "start", sheet_1()).empty(); }));
    }
  } else {
    fleet[2].cut(job);
    await_knife(fleet[2], job);
    disk.fill();
  }
  REQUIRE(happens([&] {
    const std::string state = fleet[1].job(job)["state"];
    return state == "done" || state == "interrupted";
  }));
  const std::set<int> cut = fleet.lines_cut(2, kLines);
  CHECK(wrong_in(fleet[1].ledger(job), kLines, cut) == "");
  const std::string end = fleet[1].job(job)["state"];
  CAPTURE(end);
  CHECK((end == "interrupted" || cut.size() == kLines));
  // Its lease does not need the disk, and another node goes on.
  CHECK(fleet.is_alive(2));
  cut_one(fleet, 1);
  disk.clear();
  if (end == "interrupted") fleet[1].act(job, "retry-sheet", sheet_1());
  REQUIRE(happens([&] { return fleet[2].device_state(FleetNodes::device(2)) == "idle"; }));
  cut_one(fleet, 2);
  CHECK(cut_twice(fleet, job) == 0);
}

TEST_CASE("without the database a token that is known stops a knife and does nothing else",
          "[fleet][machines]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .time_scale = 0.5});
  fleet.open();
  const std::string job = fleet.ready_job(1, 1, kLines);
  const auto new_token = [&](const char* name, const char* role) {
    return Json::parse(
        fleet[1].ask("POST", "/v1/tokens", Json{{"name", name}, {"role", role}}.dump()).body);
  };
  const Json used = new_token("tutor", "operator"), unused = new_token("spare", "operator"),
             revoked = new_token("gone", "operator");
  const auto there = client::parse_address(fleet[1].daemon().url());
  REQUIRE(there);
  const auto with = [&](const Json& token) {
    client::HttpClient http({*there}, token.at("token").get<std::string>());
    http.set_tries(0);
    return http;
  };
  const auto status = [&](const Json& token, const client::HttpRequest& request) {
    auto http = with(token);
    const auto answer = http.ask(request);
    return answer ? answer->status : 0;
  };
  for (const Json* one : {&used, &revoked}) CHECK(status(*one, {.target = "/v1/jobs"}) == 200);
  REQUIRE(fleet[1].ask("DELETE", "/v1/tokens/" + revoked.at("id").get<std::string>()).status ==
          204);
  REQUIRE(happens([&] { return status(revoked, {.target = "/v1/jobs"}) == 401; }));
  fleet[1].cut(job);
  await_knife(fleet[1], job);
  const Json seen = fleet[1].job(job);
  // Whenever a token is revoked, all must show again that they are none of it.
  CHECK(status(used, {.target = "/v1/jobs"}) == 200);
  fleet.server().kill();
  const auto stop = [&](const Json& token) {
    client::Api api(with(token));
    return api.act(seen, "cancel", Json::object());
  };
  CHECK(status(used, {.target = "/v1/jobs"}) == 503);
  CHECK(status(revoked, {.target = "/v1/jobs"}) != 200);
  // One that was revoked before, or was not used lately, stops nothing.
  for (const Json* one : {&revoked, &unused}) {
    const std::size_t cut = fleet.lines_cut(1, kLines).size();
    CHECK_FALSE(stop(*one));
    CHECK(happens([&] { return fleet.lines_cut(1, kLines).size() > cut; }));
  }
  (void)stop(used);
  check_knife_stands(fleet, kLines);
  fleet.server().start();
  CHECK(comes_to(fleet[1], job, "cancelled"));
}

}  // namespace fleet_machines_test
