// SPDX-License-Identifier: MIT
// What becomes of a cut while nodes, databases and the network between them fail.
#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/e2e/popcutd/fleet_cuts.hpp"

namespace fleet_knife_test {

using namespace popcut;
using namespace popcut::testing;
using namespace fleet_cuts;

namespace {

constexpr int kLines = 60;
constexpr double kSlow = 4;  // so that a sheet of 60 lines takes some seconds

/// A job that the cutter of the first node cuts, its knife down.
std::string begin_cut(FleetNodes& fleet) {
  std::string job = fleet.ready_job(1, 1, kLines);
  fleet[1].cut(job);
  await_knife(fleet[1], job);
  return job;
}

}  // namespace

TEST_CASE("a node killed with the knife down: interrupted everywhere, retried by a person there",
          "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.kill(2);
  const std::set<int> cut = fleet.lines_cut(2, kLines);
  const Json lost = fleet[1].await_state(job, "interrupted");
  CHECK(lost["reason"] == "lost");
  CHECK(wrong_in(fleet[1].ledger(job), kLines, cut) == "");

  fleet.open(2);
  fleet[2].await_state(job, "interrupted");
  for (int k : {1, 2}) CHECK(wrong_in(fleet[k].ledger(job), kLines, cut) == "");
  fleet[1].act(job, "retry-sheet", sheet_1());
  fleet[2].cut(job);
  fleet[1].await_state(job, "done");
  CHECK(fleet.lines_cut(2, kLines).size() == kLines);
  CHECK(cut_twice(fleet, job) == 0);
}

TEST_CASE("a node killed and back before anybody misses it tells what it was cutting", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow, .lease_s = 30, .beat_s = 1});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.kill(2);
  fleet.open(2);
  fleet[1].await_state(job, "interrupted");
  CHECK(wrong_in(fleet[1].ledger(job), kLines, fleet.lines_cut(2, kLines)) == "");
}

TEST_CASE("a node that no network reaches finishes its sheet, and the truth comes later",
          "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow, .proxies = true});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.proxy(2).hold();
  CHECK(fleet[1].await_state(job, "interrupted")["reason"] == "lost");
  REQUIRE(happens([&] { return fleet.lines_cut(2, kLines).size() == kLines; }));
  fleet.proxy(2).pass();
  fleet.proxy(2).cut_all();
  for (int k : {1, 2}) fleet[k].await_state(job, "done");
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(fleet.run_sql("SELECT count(*) FROM popcut.attempt WHERE started_at IS NOT NULL") == "1");
}

TEST_CASE("a cut that nobody acted on is taken up again while it goes on", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = 1, .proxies = true});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.proxy(2).refuse(true);
  fleet.proxy(2).cut_all();
  fleet[1].await_state(job, "interrupted");
  fleet.proxy(2).refuse(false);
  fleet[1].await_state(job, "cutting");
  fleet[1].act(job, "cancel");
  fleet[1].await_state(job, "cancelled");
  CHECK(fleet.lines_cut(2, kLines).size() < kLines);
}

TEST_CASE("whoever took a new blank meanwhile is right and nothing is cut twice", "[fleet]") {
  NEEDS_POSTGRES();
  constexpr int kFew = 40;
  FleetNodes fleet({.time_scale = 1, .first_time_scale = 10, .proxies = true});
  fleet.open();
  const std::string design = fleet[1].design(RunningDaemon::lines_svg(kFew));
  const std::string job = fleet[1].ready_job(design);
  fleet[2].act(job, "arm", {{"sheet", 1}, {"device", FleetNodes::device(2)}});
  fleet[2].act(job, "start", sheet_1());
  await_knife(fleet[2], job);
  fleet.proxy(2).hold();
  fleet[1].await_state(job, "interrupted");
  fleet[1].act(job, "retry-sheet", sheet_1());
  fleet[1].act(job, "arm", {{"sheet", 1}, {"device", FleetNodes::device(1)}});
  fleet[1].act(job, "start", sheet_1());
  fleet.proxy(2).pass();
  fleet.proxy(2).cut_all();
  fleet[1].await_state(job, "done");
  fleet[2].await_state(job, "done");
  REQUIRE(happens([&] { return fleet[2].device_state(FleetNodes::device(2)) == "idle"; }));
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(fleet.lines_cut(1, kFew).size() == kFew);
  CHECK(happens(
      [&] {
        return fleet.run_sql("SELECT blank, end_kind FROM popcut.attempt ORDER BY blank") ==
               "1|superseded\n2|done";
      },
      10));
}

TEST_CASE("a database killed and started during a cut costs nothing", "[fleet][seconds]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.server().kill();
  const auto dead = Clock::now();
  const client::HttpResponse away = fleet[2].ask("GET", "/v1/jobs/" + job);
  CHECK(away.status == 503);
  CHECK(says(away.body, "the database of the fleet"));
  CHECK(in_time(dead, 3));
  fleet.server().start();
  CHECK(comes_to(fleet[1], job, "done"));
  CHECK(comes_to(fleet[2], job, "done"));
  CHECK(fleet.lines_cut(2, kLines).size() == kLines);
  CHECK(cut_twice(fleet, job) == 0);
}

TEST_CASE("a database that hangs or is gone does not keep a person from stopping the knife",
          "[fleet]") {
  NEEDS_POSTGRES();
  const bool frozen = GENERATE(true, false);
  const std::string action = frozen ? "pause" : "cancel";
  CAPTURE(action, frozen);
  FleetNodes fleet({.nodes = 1, .time_scale = 0.5});
  fleet.open();
  const std::string job = begin_cut(fleet);
  const Json seen = fleet[1].job(job);
  if (frozen)
    fleet.server().freeze();
  else
    fleet.server().kill();
  const auto pressed = Clock::now();
  const auto answer = fleet[1].api().act(seen, action, Json::object());
  INFO((answer ? std::string("done") : message(answer.error())));
  INFO("the answer came after " << seconds_since(pressed) << " s");
  check_knife_stands(fleet, kLines);
  if (frozen)
    fleet.server().thaw();
  else
    fleet.server().start();
  CHECK(comes_to(fleet[1], job, action == "pause" ? "paused" : "cancelled"));
}

TEST_CASE("a database that answers with errors does not keep a person from stopping the knife",
          "[fleet]") {
  NEEDS_POSTGRES();
  const std::string breaks =
      GENERATE("REVOKE popcut_node FROM popcut_n_room_1", "ALTER TABLE popcut.idem RENAME TO gone",
               "ALTER TABLE popcut.job RENAME segment TO gone");
  const std::string action = breaks.starts_with("REVOKE") ? "pause" : "cancel";
  CAPTURE(breaks, action);
  FleetNodes fleet({.nodes = 1, .time_scale = 0.5});
  fleet.open();
  const std::string job = begin_cut(fleet);
  const Json seen = fleet[1].job(job);
  fleet.run_sql(breaks);
  const auto answer = fleet[1].api().act(seen, action, Json::object());
  CHECK_FALSE(answer);
  check_knife_stands(fleet, kLines);
}

TEST_CASE("nobody changes where an armed sheet begins, nor where a person let it go on",
          "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .time_scale = kSlow});
  fleet.open();
  const std::string job = fleet.ready_job(1, 1, kLines);
  REQUIRE(refusal(fleet[1], job, "arm", sheet_1()).empty());
  fleet.run_sql("UPDATE popcut.job SET first_stroke=5");
  CHECK_THAT(refusal(fleet[1], job, "start"), Catch::Contains("the armed sheet is not the one"));
  fleet.run_sql("UPDATE popcut.job SET first_stroke=0");
  REQUIRE(refusal(fleet[1], job, "start").empty());
  await_knife(fleet[1], job);
  fleet.kill(1);
  fleet.open(1);
  (void)fleet[1].await_state(job, "interrupted");
  const Json doubt = fleet[1].ledger(job)["in_doubt"];
  REQUIRE_FALSE(doubt.empty());
  const std::int64_t from = doubt.back()[1].get<std::int64_t>() + 1;
  REQUIRE(refusal(fleet[1], job, "resume-from",
                  {{"from_path", from}, {"registration", "re-registered"}, {"skip_in_doubt", true}})
              .empty());
  fleet.run_sql("UPDATE popcut.job SET first_stroke=0");
  CHECK_THAT(refusal(fleet[1], job, "arm", sheet_1()),
             Catch::Contains(fmt::format("path {} was requested last", from)));
  fleet.run_sql(fmt::format("UPDATE popcut.job SET first_stroke={}", from));
  CHECK(refusal(fleet[1], job, "arm", sheet_1()).empty());
}

TEST_CASE("marks of a cut that was paused without the database reach it later", "[fleet]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.nodes = 1, .time_scale = kSlow});
  fleet.open();
  const std::string job = begin_cut(fleet);
  const Json seen = fleet[1].job(job);
  fleet.server().kill();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  (void)fleet[1].api().act(seen, "pause", Json::object());
  std::this_thread::sleep_for(std::chrono::seconds(1));
  fleet.server().start();
  REQUIRE(comes_to(fleet[1], job, "paused"));
  CHECK(happens(
      [&] {
        const Json ledger = fleet[1].ledger(job);
        const auto certain = fleet[1].job(job)["progress"]["paths_certain"].get<std::int64_t>();
        return certain > 2 && !ledger["certain"].empty() &&
               ledger["certain"].back()[1].get<std::int64_t>() + 1 == certain;
      },
      20));
}

}  // namespace fleet_knife_test
