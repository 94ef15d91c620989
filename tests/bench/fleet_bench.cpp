// SPDX-License-Identifier: MIT
// A fleet of 1,000 cutters on one PostgreSQL, at ten times the rate at which people load sheets;
// the greatest rate, beside that of a bare queue; lists of many jobs; and planning by several
// popcutd. POPCUT_FLEET_SECONDS is how long the load lasts (60), POPCUT_FLEET_JOBS the most jobs of
// a list (1,000,000), POPCUT_FLEET_DESIGNS how many are planned (200).
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/fleet/postgres_database.hpp"
#include "daemon/jobs/rules.hpp"
#include "daemon/store/job_table.hpp"
#include "tests/support/fleet_load.hpp"
#include "tests/support/fleet_nodes.hpp"
#include "tests/support/timing.hpp"

namespace fleet_bench {

using namespace popcut::daemon;
using namespace popcut::testing;

namespace {

constexpr int kNodes = 1000, kConnections = 64;
constexpr double kSheetsPerSecond = 56;  // ten times that of 1,000 cutters with a sheet each 3 min

double setting(const char* name, double usual) {
  const char* const given = std::getenv(name);
  return given == nullptr ? usual : std::strtod(given, nullptr);
}

// As Debian sets it up, but for the number of connections.
PostgresServer& server() {
  static PostgresServer one(
      {.fsync = true,
       .more = "autovacuum = on\nshared_buffers = '128MB'\nmax_connections = 200\n"
               "max_wal_size = '1GB'\n"});
  return one;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print(const char* title, const FleetLoad::Figures& figures) {
  std::printf("%s: %zu sheets, %zu transactions ran again\n", title, figures.sheets, figures.again);
  std::printf("  call         calls   p50 ms   p99 ms  most ms    p50  p99 of a bare claim's\n");
  const CallTimes& peer = figures.calls.at("bare claim");
  for (const char* call : {"bare claim", "beat", "arm", "start", "mark", "end"}) {
    const CallTimes& times = figures.calls.at(call);
    std::printf("  %-10s %7zu %8.1f %8.1f %8.1f %6.2f %4.2f\n", call, times.count, times.p50_ms,
                times.p99_ms, times.most_ms, times.p50_ms / peer.p50_ms,
                times.p99_ms / peer.p99_ms);
  }
  std::fflush(stdout);
}

}  // namespace

TEST_CASE("a thousand nodes", "[fleet]") {
  FleetSql fleet(server());
  FleetLoad load(fleet, kNodes, kConnections);
  const double seconds = setting("POPCUT_FLEET_SECONDS", 60);
  const FleetLoad::Figures figures = load.paced({.seconds = seconds, .sheets_s = kSheetsPerSecond});
  print("1,000 nodes, 56 sheets/s", figures);
  CHECK(figures.fault == "");
}

TEST_CASE("the greatest rate", "[fleet]") {
  FleetSql fleet(server());
  FleetLoad load(fleet, kNodes, kConnections);
  constexpr int kRounds = 3;
  const double seconds = std::min(10.0, setting("POPCUT_FLEET_SECONDS", 60));
  // In turns, so that what else the machine does falls on all alike.
  std::vector<double> bare, calls, none, stored;
  for (int round = 0; round < kRounds; ++round) {
    bare.push_back(load.bare_claims_s(seconds));
    calls.push_back(load.most_calls_s(seconds));
    none.push_back(3 * load.most_sheets_s(seconds, Events::None));
    stored.push_back(3 * load.most_sheets_s(seconds, Events::Stored));
    fleet("SELECT node_tidy()");
  }
  const double peer = median(bare);
  std::printf("transactions in a second, %d connections, median of %d:\n", kConnections, kRounds);
  std::printf("  claim of a bare queue, one statement     %7.0f   1.00\n", peer);
  for (const auto& [title, values] : {std::pair{"arm, start, end, one statement each", &calls},
                                      std::pair{"as the service sends them, no events", &none},
                                      std::pair{"as the service sends them", &stored}})
    std::printf("  %-40s %7.0f   %4.2f\n", title, median(*values), median(*values) / peer);
}

TEST_CASE("lists of many jobs", "[fleet]") {
  FleetSql fleet(server());
  PostgresDatabase database({.url = fleet.database().url(), .answer_s = 60});
  JobTable jobs(database);
  struct Page {
    const char* title;
    JobFilter filter;
  };
  const std::vector<Page> pages{
      {"newest first", {.newest_first = true}},
      {"of a state", {.states = {JobState::Ready}}},
      {"open", {.states = {JobState::Queued, JobState::Ready, JobState::Armed, JobState::Cutting}}},
      {"of an owner", {.owner = "owner-7", .newest_first = true}}};
  const auto most = static_cast<std::int64_t>(setting("POPCUT_FLEET_JOBS", 1e6));
  std::printf("a page of 50 jobs, ms p50 / p99\n  %9s", "jobs");
  for (const Page& page : pages) std::printf(" %18s", page.title);
  std::printf(" %18s\n", "counts of states");
  std::int64_t there = 0;
  for (std::int64_t size = 10'000; size <= most; size *= 10) {
    // One in a hundred is open.
    for (; there < size; there += 10'000) {
      fleet(new_jobs_sql(there, there + 99, "ready"));
      fleet(new_jobs_sql(there + 100, there + 9'999, "done"));
    }
    fleet("VACUUM ANALYZE job");
    fleet("SELECT node_tidy()");
    std::printf("  %9lld", static_cast<long long>(size));
    const auto times_of = [](const auto& work) {
      std::vector<double> times;
      for (int k = 0; k < 60; ++k) times.push_back(seconds_of(work) * 1000);
      const CallTimes all = call_times(times);
      std::printf("    %6.2f / %6.2f", all.p50_ms, all.p99_ms);
    };
    for (const Page& page : pages)
      times_of([&] {
        std::string looked_to;
        const auto found = jobs.list(page.filter, "", 50, looked_to);
        if (found.empty()) FAIL("the page is empty");
      });
    times_of([&] {
      for (const JobState state : all_states()) (void)jobs.count(state);
    });
    std::printf("\n");
    std::fflush(stdout);
  }
}

TEST_CASE("planning by several nodes", "[fleet]") {
  using Json = nlohmann::json;
  // One worker each, as if each node were a machine of one core.
  const std::string one_worker = "[planner]\nprocesses = 1\n";
  const int designs = static_cast<int>(setting("POPCUT_FLEET_DESIGNS", 200));
  // From the first job that is queued until the last is ready.
  const auto plan_all = [&](RunningDaemon& at, const std::string& device) {
    std::vector<std::string> ids;
    for (int k = 0; k < designs; ++k) {
      const Json spec{{"popcut", 1},
                      {"name", fmt::format("sphere-{}", k)},
                      {"surface",
                       {{"type", "revolution"},
                        {"radius", fmt::format("sqrt({}^2 - (y - 45)^2)", 70 + 0.01 * k)}}},
                      {"units_per_slice", 12},
                      {"slices", 22},
                      {"widths_mm", 4.5},
                      {"min_panel_mm", 1.5}};
      const auto made =
          at.api().upload("/v1/designs?name=sphere", spec.dump(), "application/json", "design");
      if (!made) FAIL(popcut::message(made.error()));
      ids.push_back(made->at("id").get<std::string>());
    }
    return seconds_of([&] {
      std::vector<std::string> jobs;
      for (const std::string& id : ids) {
        const auto made =
            at.api().post("/v1/jobs", Json{{"design", id}, {"device", device}}, "jobs");
        if (!made) FAIL(popcut::message(made.error()));
        jobs.push_back(made->at("id").get<std::string>());
      }
      for (const std::string& job : jobs) (void)at.await_state(job, "ready");
    });
  };
  std::printf("%d designs, one worker a node\n  nodes   seconds   speed-up\n", designs);
  double alone_s = 0;
  {
    RunningDaemon alone(0, one_worker, "sim:alone");
    alone.open();
    alone_s = plan_all(alone, "sim:alone");
    std::printf("  alone (SQLite) %6.1f  1.00\n", alone_s);
    std::fflush(stdout);
  }
  for (const int nodes : {1, 2, 4}) {
    FleetNodes fleet({.nodes = nodes, .lease_s = 10, .beat_s = 2, .more = one_worker});
    fleet.open();
    const double took_s = plan_all(fleet[1], FleetNodes::device(1));
    std::printf("  %5d   %7.1f   %7.2f\n", nodes, took_s, alone_s / took_s);
    std::fflush(stdout);
    CHECK(fleet.run_sql("SELECT count(*) FROM popcut.plan WHERE state='planned'") ==
          std::to_string(designs));
  }
}

}  // namespace fleet_bench
