// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_jobs_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::test::ServiceBench;

TEST_CASE("a job goes from its design through all sheets to done", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  CHECK(ready.sheets_total == 2);
  CHECK(ready.sheet == 1);
  CHECK(ready.attention->kind == "load_sheet");
  CHECK(ready.progress.paths_total == 10);
  CHECK(ready.est.remaining_s == std::array<double, 2>{16, 26});

  for (int sheet = 1; sheet <= 2; ++sheet) {
    CAPTURE(sheet);
    const Job armed = bench.act(ready.id, JobAction::Arm).value();
    CHECK(armed.state == JobState::Armed);
    CHECK(armed.device == bench.device);
    const Job cutting = bench.act(ready.id, JobAction::Start).value();
    CHECK(cutting.state == JobState::Cutting);
    CHECK(cutting.sheet == sheet);
    bench.cutters.complete(bench.device);
  }
  const Job done = bench.job(ready.id);
  CHECK(done.state == JobState::Done);
  CHECK(done.outcome == "done");
  CHECK(done.progress.paths_certain == 10);
  CHECK(done.finished.has_value());
  CHECK(done.actions.empty());
  CHECK(bench.cutters.knife().size() == 10);

  const auto usage = bench.usage("owner");
  REQUIRE(usage.size() == 1);
  CHECK(usage[0].key == "uid:2");
  CHECK(usage[0].sheets == 2);
  CHECK(usage[0].cut_mm == Approx(300));
}

}  // namespace service_jobs_test
