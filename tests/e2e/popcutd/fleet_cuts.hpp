// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/support/fleet_nodes.hpp"
#include "tests/support/needs_postgres.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/timing.hpp"

/// What tests of cuts in a fleet ask and look at.
namespace fleet_cuts {

using namespace popcut;
using namespace popcut::testing;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// Waits until the knife has been down.
inline void await_knife(RunningDaemon& node, const std::string& job) {
  node.await(job, [](const Json& now) {
    return now["state"] == "cutting" && now["progress"]["paths_certain"] >= 2;
  });
}

/// Why an action is refused; empty: it is done. Waits until the job can be read.
inline std::string refusal(RunningDaemon& node, const std::string& job, const std::string& action,
                           const Json& body = Json::object()) {
  auto now = node.api().get("/v1/jobs/" + job, job);
  (void)happens([&] { return now || (now = node.api().get("/v1/jobs/" + job, job)); });
  if (!now) return message(now.error());
  const auto done = node.api().act(*now, action, body);
  return done ? std::string() : message(done.error());
}

/// Waits for a state through times in which nothing is answered.
inline bool comes_to(RunningDaemon& node, const std::string& job, const std::string& state) {
  return happens([&] {
    const auto now = node.api().get("/v1/jobs/" + job, job);
    return now && (*now)["state"] == state;
  });
}

/// Waits until all nodes have compared their journals with the database that is asked now, and
/// answer.
inline void await_nodes(FleetNodes& fleet) {
  for (int k = 1; k <= fleet.size(); ++k) {
    INFO(fleet[k].daemon().log());
    REQUIRE(happens([&] {
      return fleet.is_alive(k) && fleet[k].ask("GET", "/v1/jobs?limit=1").status == 200;
    }));
  }
}

/// Waits until the knife of the first node stands, which it must do before its last line: for three
/// seconds, in which it would cut several lines at a `time_scale` of 0.5.
inline void check_knife_stands(FleetNodes& fleet, int lines) {
  std::size_t cut = 0, before = 1;
  const auto all = static_cast<std::size_t>(lines);
  while (cut != before && cut < all) {
    before = fleet.lines_cut(1, lines).size();
    std::this_thread::sleep_for(std::chrono::seconds(3));
    cut = fleet.lines_cut(1, lines).size();
  }
  CHECK(cut < all);
}

inline Json sheet_1() { return {{"sheet", 1}}; }

/// The strokes that each attempt at a sheet cut: "BLANK" -> count of each line, over all nodes.
inline std::map<int, std::map<std::string, int>> cut_by_blank(FleetNodes& fleet,
                                                              const std::string& job) {
  const auto machine = find_machine("cameo3");
  std::map<std::string, int> blanks;
  const std::string rows =
      fleet.run_sql("SELECT id, blank FROM popcut.attempt WHERE job='" + job + "'");
  std::istringstream lines(rows);
  for (std::string line; std::getline(lines, line);)
    blanks[line.substr(0, line.find('|'))] = std::atoi(line.substr(line.find('|') + 1).c_str());
  std::map<int, std::map<std::string, int>> cut;
  for (int k = 1; k <= fleet.size(); ++k)
    for (const Received& one : received_log(fleet[k].daemon().folder() / "trace/received.log"))
      if (const auto blank = blanks.find(one.attempt); blank != blanks.end())
        for (const std::string& place : places_cut(one.bytes, *machine))
          ++cut[blank->second][place];
  return cut;
}

/// Lines that were cut more than once on one blank.
inline std::size_t cut_twice(FleetNodes& fleet, const std::string& job) {
  std::size_t count = 0;
  for (const auto& [blank, places] : cut_by_blank(fleet, job))
    for (const auto& [place, times] : places) count += times > 1 ? 1 : 0;
  return count;
}

/// STARTs as the database knows them: "1|room-2|done", by blanks.
inline std::string attempts_of(FleetNodes& fleet) {
  return fleet.run_sql(
      "SELECT blank, node, end_kind FROM popcut.attempt WHERE started_at IS NOT NULL ORDER BY "
      "blank, segment, id");
}

}  // namespace fleet_cuts
