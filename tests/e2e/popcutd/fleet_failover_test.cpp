// SPDX-License-Identifier: MIT
// The primary of a fleet's database dies and a standby takes over, with the knife down, with a
// START that nobody confirmed, with one that the standby never got; and an old primary comes back.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <set>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/fleet/fleet_health.hpp"
#include "tests/e2e/popcutd/fleet_cuts.hpp"

namespace fleet_failover_test {

using namespace popcut;
using namespace popcut::testing;
using namespace fleet_cuts;
using Standby = FleetNodes::Options::Standby;

namespace {

constexpr int kLines = 60;
constexpr double kSlow = 4;  // so that a sheet of 60 lines takes some seconds

/// Whether a node's log has all these words in a line.
bool has_said(FleetNodes& fleet, int node, const std::string& words) {
  return says(fleet[node].daemon().log(), words);
}

/// Strokes that were cut in attempts which the database does not know.
std::size_t unknown_strokes(FleetNodes& fleet) {
  const auto machine = find_machine("cameo3");
  const std::string known = fleet.run_sql("SELECT id FROM popcut.attempt");
  std::size_t count = 0;
  for (int k = 1; k <= fleet.size(); ++k)
    for (const Received& one : received_log(fleet[k].daemon().folder() / "trace/received.log"))
      if (!says(known, one.attempt)) count += places_cut(one.bytes, *machine).size();
  return count;
}

/// The job as it is then.
Json arm(FleetNodes& fleet, int node, const std::string& job) {
  Json now = fleet[node].act(job, "arm", {{"sheet", 1}, {"device", FleetNodes::device(node)}});
  return now;
}

/// Whether `popcut doctor` at node 1 would say that two databases take writes.
bool says_two_write(const FleetNodes& fleet) {
  const auto found = daemon::fleet_findings(
      {.url = fleet.direct_url(1), .password = "", .node = "room-1", .now_ms = {}});
  return std::any_of(found.begin(), found.end(), [](const daemon::FleetFinding& one) {
    return one.level == daemon::FleetFinding::Level::Problem &&
           says(one.what, "2 databases of this address take writes");
  });
}

/// A job for any cutter.
std::string job_for_any(FleetNodes& fleet, int lines = kLines) {
  const std::string design = fleet[1].design(RunningDaemon::lines_svg(lines));
  std::string job = fleet[1].ready_job(design);
  return job;
}

}  // namespace

TEST_CASE("a synchronous standby takes over while the knife is down and nothing is lost",
          "[fleet][failover]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow, .standby = Standby::Synchronous});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  const std::string next = fleet.ready_job(1, 2, 3);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  fleet.server().kill();
  const client::HttpResponse away = fleet[1].ask("GET", "/v1/jobs/" + job);
  CHECK(away.status == 503);
  CHECK(says(away.body, "the database of the fleet"));
  fleet.promote();
  for (int k : {1, 2}) CHECK(comes_to(fleet[k], job, "done"));
  await_nodes(fleet);
  CHECK(fleet.lines_cut(2, kLines).size() == kLines);
  CHECK(attempts_of(fleet) == "1|room-2|done");
  CHECK(unknown_strokes(fleet) == 0);
  std::set<int> all;
  for (int k = 0; k < kLines; ++k) all.insert(k);
  CHECK(members_of(fleet[1].ledger(job)["certain"]) == all);
  // The fleet goes on, without a person.
  fleet[2].cut(next);
  fleet[1].await_state(next, "done");
  CHECK(cut_twice(fleet, job) + cut_twice(fleet, next) == 0);
}

TEST_CASE("a standby takes over just as a cut ends, which is recorded once", "[fleet][failover]") {
  NEEDS_POSTGRES();
  const bool is_stored = GENERATE(true, false);
  CAPTURE(is_stored);
  FleetNodes fleet({.time_scale = kSlow, .proxies = true, .standby = Standby::Synchronous});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, kLines);
  fleet[2].cut(job);
  await_knife(fleet[2], job);
  // Stored: the end is on the standby's disk and its answer is lost. Not: the end is sent and never
  // arrives.
  const auto ended = [&] {
    return fleet.server().run_sql("SELECT count(*) FROM popcut.attempt WHERE ended IS NOT NULL",
                                  "popcut") == "1";
  };
  REQUIRE(happens([&] { return fleet.lines_cut(2, kLines).size() >= kLines - 2; }));
  fleet.proxy(2).hold(is_stored ? FaultProxy::Way::ToClient : FaultProxy::Way::ToServer);
  if (is_stored)
    (void)happens(ended, 3);
  else
    REQUIRE(happens([&] { return fleet.lines_cut(2, kLines).size() == kLines; }));
  fleet.server().kill();
  fleet.promote();
  fleet.proxy(2).pass();
  fleet.proxy(2).cut_all();
  for (int k : {1, 2}) CHECK(comes_to(fleet[k], job, "done"));
  await_nodes(fleet);
  CHECK(fleet.lines_cut(2, kLines).size() == kLines);
  CHECK(attempts_of(fleet) == "1|room-2|done");
  CHECK(cut_twice(fleet, job) == 0);
}

TEST_CASE("a START that no standby confirmed moves no knife", "[fleet][failover]") {
  NEEDS_POSTGRES();
  const bool is_stored = GENERATE(true, false);
  CAPTURE(is_stored);
  FleetNodes fleet({.proxies = is_stored, .standby = Standby::Synchronous});
  fleet.open();
  const std::string job = fleet.ready_job(1, 2, 5);
  const Json armed = arm(fleet, 2, job);
  if (is_stored)
    fleet.proxy(2).cut_at("COMMIT", FaultProxy::Lost::Answer, "knife_start(");
  else
    fleet.standby().stop_following();  // the primary waits for it, and in vain
  // What the node still has to say of the arm may wait for the standby too: then nothing is read.
  const auto started = fleet[2].api().act(armed, "start", sheet_1());
  CHECK_FALSE(started);
  if (is_stored) CHECK_FALSE(fleet.proxy(2).cut_to_come());  // it was this COMMIT
  CHECK(fleet.lines_cut(2, 5).empty());
  fleet.server().kill();
  fleet.promote();
  await_nodes(fleet);
  // The new primary may know the START. Its node takes it back, since its knife never moved.
  REQUIRE(happens([&] {
    const auto now = fleet[1].api().get("/v1/jobs/" + job, job);
    return now && ((*now)["state"] == "ready" || (*now)["state"] == "armed");
  }));
  CHECK(fleet.lines_cut(2, 5).empty());
  CHECK(attempts_of(fleet).empty());
  CHECK(fleet[1].job(job)["blank"] == 1);
  // The same blank, by a person.
  REQUIRE(happens([&] {
    const auto now = fleet[2].api().get("/v1/jobs/" + job, job);
    return now &&
           ((*now)["state"] == "armed" || fleet[2].api().act(*now, "arm", sheet_1()).has_value()) &&
           refusal(fleet[2], job, "start", sheet_1()).empty();
  }));
  fleet[1].await_state(job, "done");
  CHECK(attempts_of(fleet) == "1|room-2|done");
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(unknown_strokes(fleet) == 0);
}

TEST_CASE("a standby that never got the START takes over while the knife is down",
          "[fleet][failover]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = 2, .standby = Standby::Asynchronous});
  fleet.open();
  const std::string job = job_for_any(fleet);
  fleet.standby().stop_following();
  arm(fleet, 2, job);
  fleet[2].act(job, "start", sheet_1());
  await_knife(fleet[2], job);
  fleet.server().kill();
  fleet.promote();
  // The database offers the blank again. Until the journal has told, nobody gets it.
  CHECK(fleet.run_sql("SELECT count(*) FROM popcut.attempt") == "0");
  bool was_armed = false;
  REQUIRE(happens([&] {
    const auto now = fleet[1].api().get("/v1/jobs/" + job, job);
    if (!now) return false;
    if ((*now)["state"] == "ready")
      was_armed |= fleet[1]
                       .api()
                       .act(*now, "arm", {{"sheet", 1}, {"device", FleetNodes::device(1)}})
                       .has_value();
    return (*now)["state"] == "cutting";
  }));
  CHECK_FALSE(was_armed);
  for (int k : {1, 2}) CHECK(comes_to(fleet[k], job, "done"));
  await_nodes(fleet);
  CHECK(fleet.lines_cut(2, kLines).size() == kLines);
  CHECK(attempts_of(fleet) == "1|room-2|done");
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(unknown_strokes(fleet) == 0);
}

TEST_CASE("a standby that never got the START takes over after the sheet was cut",
          "[fleet][failover]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.standby = Standby::Asynchronous});
  fleet.open();
  const std::string job = job_for_any(fleet, 5);
  fleet.standby().stop_following();
  arm(fleet, 2, job);
  fleet[2].act(job, "start", sheet_1());
  fleet[2].await_state(job, "done");  // it has the answer to the end
  fleet.server().kill();
  fleet.promote();
  const Json now = [&] {
    CHECK(comes_to(fleet[1], job, "interrupted"));
    return fleet[1].job(job);
  }();
  await_nodes(fleet);
  // It is said what happened, and not that popcutd broke down.
  CAPTURE(now.dump());
  CHECK(says(now["attention"]["text"], "the database went back"));
  CHECK_FALSE(says(now["attention"]["text"], "popcutd ended"));
  CHECK(has_said(fleet, 2, "the database went back"));
  CHECK(now["blank"] == 1);
  CHECK(members_of(fleet[1].ledger(job)["not_sent"]).empty());
  // A person looks at the paper, and says so.
  fleet[1].act(job, "confirm-result", {{"sheet", 1}, {"good", true}});
  fleet[2].await_state(job, "done");
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(unknown_strokes(fleet) == 0);
}

TEST_CASE("a standby that never got the START takes over and its node is dead: nobody arms",
          "[fleet][failover]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.time_scale = kSlow, .standby = Standby::Asynchronous});
  fleet.open();
  const std::string job = job_for_any(fleet);
  const std::string other = job_for_any(fleet, 3);
  fleet.standby().stop_following();
  arm(fleet, 2, job);
  fleet[2].act(job, "start", sheet_1());
  await_knife(fleet[2], job);
  fleet.kill(2);
  const std::set<int> cut = fleet.lines_cut(2, kLines);
  fleet.server().kill();
  fleet.promote();
  REQUIRE(happens([&] { return fleet.is_alive(1); }));
  for (const std::string& one : {job, other}) {
    const std::string why =
        refusal(fleet[1], one, "arm", {{"sheet", 1}, {"device", FleetNodes::device(1)}});
    CAPTURE(why);
    CHECK(says(why, "the database went back to an earlier state"));
    CHECK(says(why, "node room-2"));
    CHECK(says(why, "popcut fleet forget room-2"));
  }
  fleet.open(2);
  const Json now = fleet[1].await_state(job, "interrupted");
  CHECK(now["blank"] == 1);
  CHECK(wrong_in(fleet[1].ledger(job), kLines, cut) == "");
  await_nodes(fleet);
  arm(fleet, 1, other);
  fleet[1].act(other, "start", sheet_1());
  fleet[2].await_state(other, "done");
  fleet[1].act(job, "retry-sheet", sheet_1());
  arm(fleet, 1, job);
  fleet[1].act(job, "start", sheet_1());
  fleet[2].await_state(job, "done");
  CHECK(fleet[1].job(job)["blank"] == 2);
  CHECK(cut_twice(fleet, job) == 0);
  CHECK(unknown_strokes(fleet) == 0);
}

TEST_CASE("two databases take writes: only where all nodes are is a sheet armed",
          "[fleet][failover]") {
  NEEDS_POSTGRES();
  FleetNodes fleet({.proxies = true, .standby = Standby::Asynchronous});
  fleet.open();
  const std::string job = job_for_any(fleet, 5), other = job_for_any(fleet, 4);
  const auto at_standby = [&](const std::string& sql) {
    return fleet.standby().run_sql(sql, FleetNodes::kDatabase);
  };
  const auto arm_at = [&](int node, const std::string& one) {
    const auto now = fleet[node].api().get("/v1/jobs/" + one, one);
    if (!now) return message(now.error());
    const auto done =
        fleet[node].api().act(*now, "arm", {{"sheet", 1}, {"device", FleetNodes::device(node)}});
    return done ? std::string() : message(done.error());
  };
  // The network breaks between node 2 and the primary, and somebody promotes the standby, though
  // node 1 still reaches the primary.
  fleet.proxy(2).refuse(true);
  fleet.proxy(2).cut_all();
  fleet.standby().stop_following();
  fleet.standby().promote();
  REQUIRE(happens([&] {
    return at_standby(
               "SELECT generation=popcut.popcut_generation() FROM popcut.node WHERE "
               "name='room-2'") == "t";
  }));
  std::string why = arm_at(2, job);
  CAPTURE(why);
  CHECK(says(why, "node room-1 has not compared its journals"));
  CHECK(says_two_write(fleet));
  CHECK(arm_at(1, job).empty());
  fleet[1].act(job, "start", sheet_1());
  fleet[1].await_state(job, "done");

  // Node 1 comes over. Its journal knows the sheet that this database does not.
  fleet.proxy(1).refuse(true);
  fleet.proxy(1).cut_all();
  fleet.ask_standby();
  CHECK(comes_to(fleet[2], job, "interrupted"));
  await_nodes(fleet);
  CHECK(unknown_strokes(fleet) == 0);

  // It goes back to the old primary, whose rows say that node 2 is there too.
  fleet.proxy(1).refuse(false);
  fleet.proxy_to_standby(1).refuse(true);
  fleet.proxy_to_standby(1).cut_all();
  const auto at_old = [&](const std::string& sql) {
    return fleet.server().run_sql(sql, FleetNodes::kDatabase);
  };
  REQUIRE(happens([&] {
    return at_old(
               "SELECT generation=popcut.popcut_generation() AND generation NOT LIKE '%.0' FROM "
               "popcut.node WHERE name='room-1'") == "t";
  }));
  CHECK(has_said(fleet, 1, "the database went back to an earlier state"));
  why = arm_at(1, other);
  INFO(why);
  CHECK(says(why, "node room-2 has not compared its journals"));
  CHECK(arm_at(2, other).empty());
  fleet[2].act(other, "start", sheet_1());
  CHECK(comes_to(fleet[2], other, "done"));
  CHECK_FALSE(arm_at(1, other).empty());

  // The old one is fenced.
  fleet.server().kill();
  fleet.proxy_to_standby(1).refuse(false);
  await_nodes(fleet);
  CHECK_FALSE(says_two_write(fleet));
  for (int k : {1, 2}) CHECK(comes_to(fleet[k], other, "done"));
  CHECK(attempts_of(fleet) == "1|room-1|crash\n1|room-2|done");
  CHECK(cut_twice(fleet, job) + cut_twice(fleet, other) == 0);
  CHECK(unknown_strokes(fleet) == 0);
}

}  // namespace fleet_failover_test
