// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <map>
#include <random>
#include <set>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_race_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;

namespace {

// All at once, as far as two processors can.
void with_threads(int count, const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  std::atomic<bool> go{false};
  for (int i = 0; i < count; ++i)
    threads.emplace_back([&, i] {
      while (!go) std::this_thread::yield();
      work(i);
    });
  go = true;
  for (std::thread& thread : threads) thread.join();
}

bool lawful_refusal(ProblemKind kind) {
  return kind == ProblemKind::StateConflict || kind == ProblemKind::Stale;
}

}  // namespace

TEST_CASE("exactly one of 64 concurrent starts or pauses or cancels succeeds", "[daemon][race]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  for (int round = 0; round < 20; ++round) {
    CAPTURE(round);
    const Job ready = bench.ready_job("{\"round\":" + std::to_string(round) + "}");
    const Job armed = bench.act(ready.id, JobAction::Arm).value();
    const int cuts = bench.cutters.cuts();
    std::atomic<int> wins{0}, others{0}, odd{0};
    const auto press = [&](JobAction action, std::int64_t rev) {
      const auto done = bench.on([&](LiveService& service) {
        return service.cutting.act(bench.tutor, ready.id, rev, {.action = action});
      });
      if (done)
        ++wins;
      else if (lawful_refusal(done.error().kind))
        ++others;
      else
        ++odd;
    };
    with_threads(64, [&](int) { press(JobAction::Start, armed.rev); });
    CHECK(wins == 1);
    CHECK(others == 63);
    CHECK(bench.cutters.cuts() == cuts + 1);
    const Job cutting = bench.job(ready.id);
    wins = others = 0;
    const int pauses = bench.cutters.pauses(), cancels = bench.cutters.cancels();
    with_threads(
        64, [&](int i) { press(i % 2 == 0 ? JobAction::Pause : JobAction::Cancel, cutting.rev); });
    CHECK(wins == 1);
    CHECK(others == 63);
    CHECK(odd == 0);
    CHECK(bench.cutters.pauses() + bench.cutters.cancels() == pauses + cancels + 1);
    bench.cutters.finish(bench.device, {.cancelled = true});
  }
}

TEST_CASE("a hundred identical requests with one key make one job", "[daemon][race]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  std::atomic<int> replayed{0};
  std::mutex mutex;
  std::set<std::string> bodies;
  const auto send = [&](const std::string& key, const std::string& digest) {
    return bench.on([&](LiveService& service) {
      return service.operations.once(bench.student, {key, digest}, [&] {
        JobCreate request;
        request.design = design.id;
        const auto job = service.jobs.create(bench.student, request);
        return job ? Rendered{.status = 201, .body = job->id, .etag = "\"1\"", .location = "/x"}
                   : Rendered{.status = status_of(job.error().kind), .body = {}};
      });
    });
  };
  with_threads(100, [&](int) {
    const auto answer = send("a-key-of-sixteen", "digest");
    const std::lock_guard lock(mutex);
    bodies.insert(answer ? answer->body : "refused");
    if (answer && answer->replayed) ++replayed;
  });
  CHECK(replayed == 99);
  CHECK(bodies.size() == 1);
  CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {})->items.size(); }) == 1);
  CHECK(send("a-key-of-sixteen", "another").error().kind == ProblemKind::IdempotencyKeyReused);
  // The key outlives a crash between commit and reply, and its week.
  bench.crash();
  REQUIRE(bench.start() == "");
  const auto after = send("a-key-of-sixteen", "digest");
  CHECK(after->replayed);
  CHECK(after->body == *bodies.begin());
  CHECK(after->location == "/x");
  bench.monotonic_skew_ms = bench.skew_ms = 8LL * 86'400'000;
  CHECK_FALSE(send("a-key-of-sixteen", "digest")->replayed);
  CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {})->items.size(); }) == 2);
}

TEST_CASE("a failed request leaves nothing under its key", "[daemon][race]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  const auto send = [&](int status) {
    return bench.on([&](LiveService& service) {
      return service.operations.once(bench.student, {"a-key-of-sixteen", "digest"}, [&] {
        JobCreate request;
        request.design = design.id;
        const auto job = service.jobs.create(bench.student, request);
        return Rendered{.status = status, .body = job.has_value() ? "made" : "not"};
      });
    });
  };
  CHECK(send(503)->body == "made");
  CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {})->items.empty(); }));
  CHECK(send(429)->status == 429);
  CHECK_FALSE(send(201)->replayed);
  CHECK(send(201)->replayed);
  CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {})->items.size(); }) == 1);
}

TEST_CASE("the rules of jobs hold for any sequence of events", "[daemon][race]") {
  // What the listeners saw of each job, to be checked against the rules.
  struct Seen {
    JobState state{JobState::Queued};
    bool ended{false};
  };
  std::set<std::pair<std::string, std::int64_t>> at_the_knife;
  std::size_t checked = 0;
  // How many strokes a round cuts depends on how fast its plans are made.
  for (unsigned seed = 1; seed <= 12 || checked < 20; ++seed) {
    CAPTURE(seed);
    REQUIRE(seed < 200);
    std::mt19937 random(seed);
    ServiceBench bench({"sim:a", "sim:b"});
    bench.planner.strokes = 4;
    std::map<std::string, Seen> seen;
    std::vector<std::string> jobs;
    // The listener runs on the service's thread, where nothing may be asserted.
    std::mutex mutex;
    std::string by_person;  // the action that is being done
    std::vector<std::string> wrong;
    const auto set_person = [&](std::string_view who) {
      const std::lock_guard lock(mutex);
      by_person = who;
    };
    const auto watch = [&] {
      bench.on([&](LiveService& service) {
        service.operations.listen([&](const Event& event) {
          if (event.kind != "job" || event.data.find("\"deleted\"") != std::string::npos) return;
          const std::size_t at = event.data.find("\"state\":\"") + 9;
          const auto state = job_state_from(event.data.substr(at, event.data.find('"', at) - at));
          const std::lock_guard lock(mutex);
          if (!state) return wrong.push_back(event.data);
          Seen& before = seen[event.job];
          if (before.ended && before.state != *state) wrong.push_back("R5 " + event.data);
          if (*state == JobState::Armed && before.state != *state && by_person != "arm")
            wrong.push_back("R1 " + event.data);
          if (*state == JobState::Cutting && before.state != *state && by_person != "start" &&
              by_person != "resume")
            wrong.push_back("R2 " + event.data);
          before = {*state, is_terminal(*state)};
        });
      });
    };
    watch();
    const auto design = bench.add_design("{\"seed\":" + std::to_string(seed) + "}").value();
    for (int step = 0; step < 150; ++step) {
      CAPTURE(step);
      bench.on([](LiveService&) {});
      set_person("");
      const unsigned dice = random() % 100;
      if (dice < 10 || jobs.empty()) {
        jobs.push_back(bench.create(design.id, 1 + static_cast<int>(random() % 2))->id);
      } else if (dice < 75) {
        const std::string& id = jobs[random() % jobs.size()];
        const Job job = bench.job(id);
        // Mostly something lawful, now and then anything.
        JobAction action = static_cast<JobAction>(random() % 10);
        if (!job.actions.empty() && random() % 10 != 0)
          action = *job_action_from(job.actions[random() % job.actions.size()]);
        ActionRequest request{.action = action};
        request.good = random() % 2 == 0;
        if (action == JobAction::Arm) request.device = random() % 2 == 0 ? "sim:a" : "sim:b";
        if (action == JobAction::Arm && !job.device.empty()) request.device = job.device;
        request.from_path = static_cast<std::int64_t>(random() % 5);
        request.registration = random() % 2 == 0 ? "kept" : "re-registered";
        request.accept_double_cut = random() % 2 == 0;
        request.skip_in_doubt = random() % 2 == 0;
        set_person(name_of(action));
        const auto done = bench.act(id, request);
        if (!done)
          CHECK((lawful_refusal(done.error().kind) ||
                 done.error().kind == ProblemKind::DeviceAbsent));
      } else if (dice < 90) {
        for (const std::string& device : bench.cutters.busy()) {
          const unsigned what = random() % 5;
          const std::int64_t first = bench.cutters.first_stroke(device);
          (void)bench.cutters.intend(device, first);
          if (what == 0) {
            bench.cutters.progress(device, {.phase = SessionPhase::Held});
          } else if (what == 1) {
            (void)bench.cutters.intend(device, first);
          } else if (what == 2) {
            bench.cutters.finish(device, {.error = Error{ErrorKind::DeviceGone, "", "gone"},
                                          .certain = first - 1,
                                          .doubt = first});
          } else if (what == 3) {
            bench.cutters.finish(device, {.cancelled = true, .certain = first});
          } else {
            (void)bench.cutters.intend(device, 3);
            bench.cutters.finish(device,
                                 {.confirmed = random() % 4 != 0, .certain = 3, .doubt = 3});
          }
        }
      } else if (dice < 93) {
        bench.cutters.unplug("sim:b");
        bench.cutters.plug("sim:b");
      } else if (dice < 96) {
        bench.monotonic_skew_ms += 700'000;
        bench.on([](LiveService& service) { service.tick(); });
      } else {
        bench.crash();
        REQUIRE(bench.start() == "");
        for (const std::string& id : jobs) {
          const Job job = bench.job(id);
          CHECK(job.state != JobState::Armed);
          CHECK(job.state != JobState::Cutting);
          CHECK(job.state != JobState::Paused);
          const std::lock_guard lock(mutex);
          seen[id] = {job.state, is_terminal(job.state)};
        }
        watch();
      }
      const std::lock_guard lock(mutex);
      REQUIRE(wrong == std::vector<std::string>{});
    }
    // R3: each stroke of each attempt reaches a knife once, each blank has one start a segment.
    std::set<std::pair<std::string, std::int64_t>> strokes;
    for (const auto& cut : bench.cutters.knife())
      CHECK(strokes.insert({cut.attempt, cut.stroke}).second);
    bench.on([&](LiveService&) {
      Database& db = bench.store().database();
      CHECK(db.number("SELECT count(*) FROM (SELECT 1 FROM attempt WHERE started_at IS NOT NULL "
                      "GROUP BY job, k, blank, segment HAVING count(*) > 1)") == 0);
      // R4: a sheet is done only if its last attempt was confirmed, or a person said so.
      CHECK(db.number("SELECT count(*) FROM job WHERE state='done' AND outcome='done' AND NOT "
                      "EXISTS(SELECT 1 FROM attempt WHERE attempt.job=job.id AND end_kind='done') "
                      "AND NOT EXISTS(SELECT 1 FROM audit WHERE subject=job.id AND "
                      "action='confirm-result')") == 0);
      // P2: nothing was cut twice on a blank without a person's word.
      CHECK(db.number("SELECT count(*) FROM attempt WHERE segment > 1 AND NOT EXISTS(SELECT 1 "
                      "FROM audit WHERE subject=attempt.job AND action='resume-from')") == 0);
    });
    checked += strokes.size();
  }
}

}  // namespace service_race_test
