// SPDX-License-Identifier: MIT
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"
#include "tests/support/service_bench.hpp"

namespace service_plans_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;

namespace {

namespace fs = std::filesystem;

PlanRequest plan_request(const std::string& design, const std::string& material = "") {
  return {.design = design, .material = material, .device = {}, .machine = {}};
}

}  // namespace

TEST_CASE("a plan can be requested without a job", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"material\":\"pp-150\"}").value();
  const PlanRecord asked =
      bench
          .on([&](LiveService& s) {
            return s.plans.request(
                bench.student, {.design = design.id, .material = {}, .device = {}, .machine = {}});
          })
          .value();
  CHECK(asked.material == "pp-150");  // the design's own
  CHECK(asked.machine == "cameo3");
  const auto plan = [&] {
    return bench.on([&](LiveService& s) { return s.plans.find(asked.id).value(); });
  };
  REQUIRE(bench.wait([&] { return plan().state == PlanState::Planned; }));
  CHECK(plan().sheets.size() == 2);
  CHECK(plan().sheets.at(1).seconds_range == std::array<double, 2>{8, 13});
  CHECK(plan().sha256.size() == 64);
}

TEST_CASE("a plan that was requested is made after a restart though a job of another person ends",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string design = bench.add_design("slow").value().id;
  const std::string plan =
      bench
          .on([&](LiveService& s) { return s.plans.request(bench.student, plan_request(design)); })
          ->id;
  const auto state = [&] {
    return bench.on([&](LiveService& s) { return s.plans.find(plan).value().state; });
  };
  REQUIRE(bench.wait([&] { return bench.planner.started >= 2; }));  // the check and the plan
  bench.crash();
  REQUIRE(bench.start() == "");
  REQUIRE(bench.wait([&] { return bench.planner.started >= 3; }));
  SECTION("another person cancels a job of the same plan") {
    const Job other =
        bench
            .on([&](LiveService& s) {
              return s.jobs.create(bench.other_student, {.design = design, .plan = {}});
            })
            .value();
    REQUIRE(other.plan == plan);
    REQUIRE(bench.act(other.id, JobAction::Cancel));
    CHECK(bench.planner.cancelled == 0);
  }
  SECTION("the planner ends what it makes, as when popcutd stops") {
    bench.planner.cancel(2);  // of the run before
    bench.planner.cancel(3);
    REQUIRE(bench.wait([&] { return bench.planner.started >= 4; }));
    CHECK(state() == PlanState::Pending);
  }
  bench.planner.release();
  CHECK(bench.wait([&] { return state() == PlanState::Planned; }));
}

TEST_CASE("a plan can be deleted while it waits and runs and when it is done",
          "[daemon][service]") {
  ServiceBench bench;
  bench.options.plans_at_once = 1;
  bench.stop();
  REQUIRE(bench.start() == "");
  // All are checked before the planner has something slow to do.
  std::map<std::string, std::string> designs;
  for (const char* text : {"slow 1", "slow 2", "quick"})
    designs[text] = bench.add_design(text).value().id;
  const auto ask = [&](const std::string& text) {
    return bench
        .on([&](LiveService& s) {
          return s.plans.request(bench.student, plan_request(designs.at(text)));
        })
        ->id;
  };
  const auto remove = [&](const Principal& who, const std::string& id) {
    return bench.on([&](LiveService& s) { return s.plans.remove(who, id); });
  };
  const auto state = [&](const std::string& id) -> std::optional<PlanState> {
    const auto plan = bench.on([&](LiveService& s) { return s.plans.find(id); });
    return plan ? std::optional(plan->state) : std::nullopt;
  };
  const std::string running = ask("slow 1"), waiting = ask("slow 2"), last = ask("quick");
  REQUIRE(bench.wait([&] { return bench.planner.started >= 4; }));  // three checks and a plan
  CHECK(remove(bench.other_student, waiting).error().kind == ProblemKind::Forbidden);
  CHECK(remove(bench.student, waiting));
  CHECK_FALSE(state(waiting));
  CHECK(remove(bench.tutor, running));
  CHECK_FALSE(state(running));
  CHECK(remove(bench.student, running).error().kind == ProblemKind::NotFound);
  // The place of the one that ran is free for the next.
  REQUIRE(bench.wait([&] { return state(last) == PlanState::Planned; }));
  CHECK(bench.planner.cancelled == 1);
  CHECK_FALSE(fs::exists(bench.folder() + "/plans/" + running));
  CHECK(fs::exists(bench.folder() + "/plans/" + last));
  CHECK(remove(bench.student, last));
  CHECK_FALSE(fs::exists(bench.folder() + "/plans/" + last));
}

TEST_CASE("the number of waiting plans is limited like that of jobs", "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.queue_jobs = 2;
  REQUIRE(bench.start() == "");
  const auto design = bench.add_design("slow").value();
  const auto ask = [&](const char* material) {
    return bench.on([&](LiveService& s) {
      return s.plans.request(bench.student, plan_request(design.id, material));
    });
  };
  REQUIRE(ask("paper-220"));
  REQUIRE(ask("paper-160"));
  CHECK(ask("paper-160"));  // the same one
  const auto third = ask("card-300");
  REQUIRE_FALSE(third);
  CHECK(third.error().kind == ProblemKind::QueueFull);
  CHECK(third.error().retry_after_s == 60);
}

TEST_CASE("a plan that a job uses cannot be deleted", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  const Job job = bench.wait_for(bench.create(design.id)->id, JobState::Ready);
  const auto refused =
      bench.on([&](LiveService& s) { return s.plans.remove(bench.tutor, job.plan); });
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::StateConflict);
  CHECK(refused.error().detail.find(job.id) != std::string::npos);
}

TEST_CASE("removing a design removes its plans", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"slow\":1}").value();
  const auto ask = [&](const std::string& material) {
    return bench
        .on([&](LiveService& s) {
          return s.plans.request(bench.student, plan_request(design.id, material));
        })
        ->id;
  };
  const std::string one = ask("paper-220"), two = ask("paper-160");
  REQUIRE(bench.wait([&] { return bench.planner.started >= 2; }));
  CHECK(bench.on([&](LiveService& s) { return s.designs.remove(bench.student, design.id); }));
  for (const std::string& plan : {one, two})
    CHECK_FALSE(bench.on([&](LiveService& s) { return s.plans.find(plan); }));
  REQUIRE(bench.wait([&] { return bench.planner.cancelled >= 1; }));
  // Nothing of them is made any more, and what was made of another has no file left behind.
  const auto made = bench.add_design("{\"card\":1}").value();
  const std::string plan =
      bench
          .on([&](LiveService& s) { return s.plans.request(bench.student, plan_request(made.id)); })
          ->id;
  REQUIRE(bench.wait([&] {
    return bench.on([&](LiveService& s) { return s.plans.find(plan); })->state ==
           PlanState::Planned;
  }));
  CHECK(bench.on([&](LiveService& s) { return s.designs.remove(bench.student, made.id); }));
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/plans"); }));
}

TEST_CASE("plans of a removed design that cannot be removed at once are removed later",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string design = bench.add_design("{\"card\":1}").value().id;
  for (const char* const material : {"paper-220", "paper-160"}) {
    const std::string id =
        bench
            .on([&](LiveService& s) {
              return s.plans.request(bench.student, plan_request(design, material));
            })
            ->id;
    REQUIRE(bench.wait([&] {
      return bench.on([&](LiveService& s) { return s.plans.find(id); })->state ==
             PlanState::Planned;
    }));
  }
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  const auto plans = [&] {
    return bench.on(
        [&](LiveService&) { return bench.store().database().number("SELECT count(*) FROM plan"); });
  };
  // So many sheets that each plan has a turn of its own.
  sql("UPDATE plan SET sheets=1500; CREATE TRIGGER keep_one BEFORE DELETE ON plan WHEN (SELECT "
      "count(*) FROM plan)=1 BEGIN SELECT raise(ABORT, 'not now'); END");
  REQUIRE(bench.on([&](LiveService& s) { return s.designs.remove(bench.student, design); }));
  REQUIRE(bench.wait([&] {
    return bench.thread()
        .turns(ServiceThread::Lane::Asking)
        .longest()
        .contains("plans of a removed design");
  }));
  REQUIRE(plans() == 1);
  sql("DROP TRIGGER keep_one");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(bench.wait([&] { return plans() == 0; }));
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/plans"); }));
}

TEST_CASE("an unknown option is refused at once with a suggestion", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  const auto refused = [&](const char* name, const char* value) -> Problem {
    JobCreate job{.design = design.id, .plan = {}};
    job.options[name] = value;
    PlanRequest plan = plan_request(design.id);
    plan.options = job.options;
    const auto made = bench.on([&](LiveService& s) { return s.jobs.create(bench.student, job); });
    REQUIRE_FALSE(made);
    const auto planned =
        bench.on([&](LiveService& s) { return s.plans.request(bench.student, plan); });
    REQUIRE_FALSE(planned);
    CHECK(planned.error().detail == made.error().detail);
    return made.error();
  };
  const Problem typo = refused("ordr", "best");
  CHECK(typo.kind == ProblemKind::Validation);
  CHECK(typo.errors.at(0).pointer == "/options/ordr");
  CHECK(typo.errors.at(0).detail.find("did you mean order?") != std::string::npos);
  CHECK(refused("order", "fast").errors.at(0).pointer == "/options/order");
  CHECK(refused("snap", "2").errors.at(0).detail.find("from 0 to 1 (mm)") != std::string::npos);
  CHECK(refused("clip", "perhaps").errors.at(0).detail.find("true or false") != std::string::npos);
  CHECK(bench.planner.started == 1);  // the check of the design
}

TEST_CASE("planning takes turns among those who wait for plans", "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.plans_at_once = 1;
  bench.options.plans_each = 60;
  REQUIRE(bench.start() == "");
  const auto blocker = bench.add_design("slow").value().id;
  std::vector<std::string> many;
  for (int k = 0; k < 60; ++k) many.push_back(bench.add_design(std::to_string(k)).value().id);
  const std::string wanted = bench.add_design("wanted").value().id;
  const auto create = [&](const Principal& who, const std::string& design, int priority) {
    JobCreate request;
    request.design = design;
    request.priority = priority;
    return bench.on([&](LiveService& s) { return s.jobs.create(who, request); });
  };
  REQUIRE(create(bench.tutor, blocker, 0));  // the planner has something to do
  std::vector<std::string> jobs;
  for (const std::string& design : many) jobs.push_back(create(bench.student, design, 10)->id);
  // One more is too many of theirs, and nobody else's matter.
  const auto refused = create(bench.student, wanted, 10);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::QueueFull);
  CHECK(refused.error().retry_after_s == 60);
  CHECK(refused.error().detail.find("60 plans of yours") != std::string::npos);
  const std::string late = create(bench.admin, wanted, -10).value().id;
  bench.planner.release();
  bench.wait_for(late, JobState::Ready);
  const std::string plan = bench.job(late).plan;
  const auto events =
      bench.on([](LiveService& s) { return s.operations.events(0, 1000, "").value(); });
  int before = 0;
  for (const Event& event : events) {
    if (event.data.find("\"state\":\"planned\"") == std::string::npos) continue;
    if (event.data.find(plan) != std::string::npos) break;
    ++before;
  }
  CHECK(before < 5);  // and not all sixty
  CHECK(bench.wait_for(jobs.back(), JobState::Ready).state == JobState::Ready);
}

TEST_CASE("one principal cannot fill the queue of jobs", "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.jobs_each = 3;
  REQUIRE(bench.start() == "");
  const auto design = bench.add_design("{\"card\":1}").value();
  for (int k = 0; k < 3; ++k) REQUIRE(bench.create(design.id));
  const auto fourth = bench.create(design.id);
  REQUIRE_FALSE(fourth);
  CHECK(fourth.error().kind == ProblemKind::QueueFull);
  CHECK(bench.on([&](LiveService& s) {
    JobCreate request;
    request.design = design.id;
    return s.jobs.create(bench.other_student, request).has_value();
  }));
}

TEST_CASE("a plan during which popcutd died ten times is given up", "[alone][daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("slow").value();
  const Job job = bench.create(design.id).value();
  for (int k = 0; k < 10; ++k) {
    REQUIRE(bench.wait([&] { return bench.planner.started >= 2 + k; }));
    REQUIRE(bench.wait_for(job.id, JobState::Planning).state == JobState::Planning);
    bench.crash();
    REQUIRE(bench.start() == "");
  }
  const Job failed = bench.wait_for(job.id, JobState::Failed);
  CHECK(failed.state == JobState::Failed);
  CHECK(failed.reason.find("ended 10 times") != std::string::npos);
}

TEST_CASE("the jobs of a plan say what it is at while it is made", "[daemon][service]") {
  ServiceBench bench;
  std::mutex mutex;
  std::vector<Event> heard;
  bench.on([&](LiveService& s) {
    s.operations.listen([&](const Event& event) {
      const std::lock_guard lock(mutex);
      if (event.kind == "progress") heard.push_back(event);
    });
  });
  const auto told = [&] {
    const std::lock_guard lock(mutex);
    return heard;
  };
  const auto design = bench.add_design("slow").value();
  const std::string job = bench.create(design.id).value().id;
  REQUIRE(bench.wait([&] { return bench.planner.last_task().kind == PlanningTask::Kind::Plan; }));
  bench.wait_for(job, JobState::Planning);
  const auto progress = bench.planner.last_task().progress;
  progress({.phase = "slicing", .doing = "cutting \"it\"", .done = 0.254});
  progress({.phase = "checking", .doing = "checking it"});
  REQUIRE(bench.wait([&] { return told().size() == 2; }));
  const auto first = nlohmann::json::parse(told()[0].data);
  CHECK(first == nlohmann::json::parse(fmt::format(
                     R"({{"seq":0,"kind":"progress","job":"{}","state":"planning","rev":{},)"
                     R"("phase":"slicing","doing":"cutting \"it\"","share":0.25}})",
                     job, bench.job(job).rev)));
  CHECK(told()[0].job == job);
  CHECK(nlohmann::json::parse(told()[1].data)["share"].is_null());
  // It is told to who listens, and not stored.
  CHECK(
      bench.on([&](LiveService& s) { return s.operations.events(0, 1000, job).value(); }).size() ==
      2);
  bench.planner.release();
  bench.wait_for(job, JobState::Ready);
  progress({.phase = "writing", .doing = "writing the programs"});  // too late
  bench.on([](LiveService&) {});
  CHECK(told().size() == 2);
}

TEST_CASE("a plan whose failure cannot be stored yet holds up nobody", "[alone][daemon][service]") {
  ServiceBench bench(false);
  bench.options.plans_at_once = 1;
  REQUIRE(bench.start() == "");
  const std::string design = bench.add_design("{\"card\":2}").value().id;
  const Job first = bench.create(bench.add_design("slow").value().id).value();
  REQUIRE(bench.wait_for(first.id, JobState::Planning).state == JobState::Planning);
  const Job second = bench.create(design).value();
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("UPDATE plan SET begun=10 WHERE begun=0; CREATE TRIGGER no_failure BEFORE UPDATE ON plan "
      "WHEN new.state='failed' BEGIN SELECT raise(ABORT, 'not now'); END");
  bench.planner.release();
  CHECK(bench.wait_for(first.id, JobState::Ready).state == JobState::Ready);
  CHECK(bench.job(second.id).state == JobState::Queued);
  sql("DROP TRIGGER no_failure");
  bench.on([](LiveService& s) { s.tick(); });
  const Job failed = bench.wait_for(second.id, JobState::Failed);
  CHECK(failed.reason.find("ended 10 times") != std::string::npos);
}

TEST_CASE("jobs whose plan cannot be stored with them are tried again by the tick only",
          "[alone][daemon][service]") {
  ServiceBench bench(false);
  bench.options.jobs_each = 1000;
  REQUIRE(bench.start() == "");
  const std::string design = bench.add_design("slow").value().id;
  const std::string first = bench.create(design).value().id;
  REQUIRE(bench.wait_for(first, JobState::Planning).state == JobState::Planning);
  std::string last;
  for (int k = 0; k < 200; ++k) last = bench.create(design).value().id;
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  // The commit fails, after the rows were read.
  sql("CREATE TRIGGER none_ready BEFORE INSERT ON event WHEN new.data LIKE '%\"state\":\"ready\"%' "
      "BEGIN SELECT raise(ABORT, 'not now'); END");
  bench.planner.release();
  REQUIRE(bench.wait([&] {
    return bench.thread().turns(ServiceThread::Lane::Asking).longest().contains("plan ended");
  }));
  // What repeats itself waits in each of these turns.
  std::size_t waiting = 100;
  for (int k = 0; k < 3; ++k)
    waiting = std::min(waiting, bench.on([&](LiveService&) { return bench.thread().waiting(); }));
  CHECK(waiting == 0);
  sql("DROP TRIGGER none_ready");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(bench.wait_for(last, JobState::Ready).state == JobState::Ready);
}

namespace {

/// Files of a fleet of which some are still on their way.
struct LateFiles final : SharedFiles {
  std::set<std::string> coming{};
  Result<void> keep(const std::string& /*name*/, const std::string& /*place*/) override {
    return {};
  }
  bool keep_small(const std::string& /*name*/) override { return true; }
  Found fetch(const std::string& name) override {
    return coming.contains(name) ? Found::Coming : Found::Here;
  }
  std::vector<std::string> names(const std::string& /*beginning*/) override { return {}; }
  void forget(const std::string& /*name*/) override {}
};

}  // namespace

TEST_CASE("a plan has the material of its design also if the file comes late",
          "[alone][daemon][service]") {
  ServiceBench bench(false);
  LateFiles* files = nullptr;
  bench.opened_store = [&](Store& store) {
    auto made = std::make_unique<LateFiles>();
    files = made.get();
    store.share_files(std::move(made));
  };
  REQUIRE(bench.start() == "");
  const std::string design = bench.add_design(R"({"material":"paper-160"})").value().id;
  const std::string place = bench.folder() + "/designs/" + design;
  std::filesystem::rename(place, place + "-away");
  bench.on([&](LiveService&) { files->coming = {"designs/" + design}; });
  const Answer<Job> early = bench.create(design);
  REQUIRE_FALSE(early);
  CHECK(early.error().kind == ProblemKind::Unavailable);
  std::filesystem::rename(place + "-away", place);
  bench.on([&](LiveService&) { files->coming.clear(); });
  CHECK(bench.create(design).value().material == "paper-160");
}

TEST_CASE("a plan that another node has taken over is left to that node",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string design = bench.add_design("slow").value().id;
  const Job job = bench.create(design).value();
  REQUIRE(bench.wait_for(job.id, JobState::Planning).state == JobState::Planning);
  const auto take_over = [&] {
    bench.store().database().script("UPDATE plan SET planner='another'");
  };
  SECTION("this node cannot make it") {
    bench.on([&](LiveService&) { take_over(); });
    bench.planner.sheets = 0;
    bench.planner.release();
  }
  SECTION("this node gives it back because nobody waited for it") {
    bench.on([&](LiveService& s) {
      REQUIRE(s.cutting.act(bench.tutor, job.id, s.jobs.find(job.id)->rev,
                            {.action = JobAction::Cancel}));
      JobCreate again;
      again.design = design;
      REQUIRE(s.jobs.create(bench.other_student, again)->plan == job.plan);
      take_over();
    });
  }
  REQUIRE(bench.wait([&] {
    return bench.thread().turns(ServiceThread::Lane::Asking).longest().contains("plan ended");
  }));
  bench.on([&](LiveService& s) {
    CHECK(s.plans.find(job.plan)->state == PlanState::Pending);
    CHECK(bench.store().database().number("SELECT count(*) FROM plan WHERE planner='another'") ==
          1);
  });
}

TEST_CASE("a cancelled plan is released though the store cannot say who waits for it",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string design = bench.add_design("slow").value().id;
  const Job job = bench.create(design).value();
  REQUIRE(bench.wait_for(job.id, JobState::Planning).state == JobState::Planning);
  const auto sql = [&](const char* text) { bench.store().database().script(text); };
  bench.on([&](LiveService& s) {
    REQUIRE(s.cutting.act(bench.tutor, job.id, s.jobs.find(job.id)->rev,
                          {.action = JobAction::Cancel}));
    JobCreate again;
    again.design = design;
    REQUIRE(s.jobs.create(bench.other_student, again)->plan == job.plan);
    sql("ALTER TABLE plan_asker RENAME TO plan_asker_away");
  });
  REQUIRE(bench.wait([&] {
    return bench.thread().turns(ServiceThread::Lane::Asking).longest().contains("plan ended");
  }));
  const int before = bench.planner.started;
  bench.on([&](LiveService& s) {
    sql("ALTER TABLE plan_asker_away RENAME TO plan_asker");
    s.tick();
  });
  REQUIRE(bench.wait([&] { return bench.planner.started > before; }));
  // It was claimed twice, and released in between.
  CHECK(bench.on([&](LiveService&) {
    return bench.store().database().number("SELECT begun FROM plan");
  }) == 1);
}

TEST_CASE("a long name of a material in a spec is not repeated at length", "[daemon][service]") {
  ServiceBench bench;
  for (const std::string before : {"", "x", "xx"}) {  // also where a character would be cut apart
    std::string name = before;
    for (int k = 0; k < 30'000; ++k) name += "\u20ac";
    const Design design = bench.add_design(R"({"material":")" + name + R"("})").value();
    const Answer<Job> refused = bench.create(design.id);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().detail.size() < 1000);
    CHECK(is_utf8(refused.error().detail));
  }
}

TEST_CASE("a plan that cannot be stored at once is stored later and not made again",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const Job job = bench.create(bench.add_design("slow").value().id).value();
  REQUIRE(bench.wait_for(job.id, JobState::Planning).state == JobState::Planning);
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("CREATE TRIGGER none_planned BEFORE UPDATE ON plan WHEN new.state='planned' BEGIN "
      "SELECT raise(ABORT, 'not now'); END");
  const int begun = bench.planner.started;
  bench.planner.release();
  REQUIRE(bench.wait([&] {
    return bench.thread().turns(ServiceThread::Lane::Asking).longest().contains("plan ended");
  }));
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(bench.job(job.id).state == JobState::Planning);
  sql("DROP TRIGGER none_planned");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(bench.wait_for(job.id, JobState::Ready).state == JobState::Ready);
  CHECK(bench.planner.started == begun);
}

}  // namespace service_plans_test
