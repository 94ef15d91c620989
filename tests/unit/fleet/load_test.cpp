// SPDX-License-Identifier: MIT
// './run bench fleet' in small: that it still measures what it says.
#include <catch2/catch.hpp>

#include "tests/support/fleet_load.hpp"
#include "tests/support/needs_postgres.hpp"

namespace popcut::testing::fleet_load_test {

TEST_CASE("forty sheets by fifty nodes, and not one stroke twice", "[fleet]") {
  NEEDS_POSTGRES();
  FleetSql fleet;
  FleetLoad load(fleet, 50, 8);
  const FleetLoad::Figures figures =
      load.paced({.seconds = 1, .sheets_s = 40, .beat_s = 0.5, .marks = 2});
  REQUIRE(figures.fault == "");
  CHECK(figures.sheets == 40);
  CHECK(figures.calls.at("beat").count == 100);
  for (const char* call : {"arm", "start", "end"}) CHECK(figures.calls.at(call).count == 40);
  CHECK(figures.calls.at("mark").count == 80);
  CHECK(figures.calls.at("start").p50_ms > 0);
  CHECK(figures.calls.at("start").p99_ms >= figures.calls.at("start").p50_ms);
  CHECK(fleet("SELECT end_kind, count(*), count(DISTINCT (job, k, blank, segment)), count(DISTINCT "
              "fence) FROM attempt GROUP BY end_kind") == "done|40|40|40");
  CHECK(fleet("SELECT state, sum(jobs) FROM tally GROUP BY state HAVING sum(jobs) <> 0") ==
        "done|40");
  CHECK(fleet("SELECT min(path_from), max(path_to), count(*), string_agg(DISTINCT state, ' ') FROM "
              "chunk") == "0|9|40|certain");
  // Events are numbered without gaps.
  CHECK(fleet("SELECT count(*), min(seq), max(seq), (SELECT last FROM event_counter) FROM event") ==
        "120|1|120|120");
  CHECK(load.most_sheets_s(0.2, Events::None) > 0);
  CHECK(load.most_calls_s(0.2) > 0);
  // Also when all connections give numbers at once: none is forgotten, and those of a job are in
  // the order of its changes.
  CHECK(load.most_sheets_s(0.5, Events::Stored) > 0);
  CHECK(fleet("SELECT count(*) FROM event_new") == "0");
  CHECK(fleet("SELECT min(seq), max(seq) = count(*), max(seq) = (SELECT last FROM event_counter), "
              "bool_and((data::json->>'seq')::bigint = seq) FROM event") == "1|t|t|t");
  CHECK(fleet("SELECT DISTINCT string_agg(data::json->>'state', ' ' ORDER BY seq) FROM event "
              "GROUP BY job") == "armed cutting done");
  CHECK(load.bare_claims_s(0.2) > 0);
  CHECK(fleet("SELECT count(*) FROM attempt WHERE ended IS NULL") == "0");
}

TEST_CASE("the times of calls are medians and the worst of a hundred", "[fleet]") {
  std::vector<double> times;
  for (int k = 200; k >= 0; --k) times.push_back(k);
  const CallTimes all = call_times(times);
  CHECK(all.count == 201);
  CHECK(all.p50_ms == 100);
  CHECK(all.p99_ms == 198);
  CHECK(all.most_ms == 200);
  CHECK(call_times({}).count == 0);
}

}  // namespace popcut::testing::fleet_load_test
