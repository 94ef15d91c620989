// SPDX-License-Identifier: MIT
// Going on with a sheet that is cut in part.
#include <catch2/catch.hpp>

#include "daemon/http/api/render.hpp"
#include "tests/support/service_bench.hpp"

namespace service_resume_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::broken;
using popcut::testing::ledger;
using popcut::testing::ServiceBench;
using popcut::testing::shown;

namespace {

ActionRequest from_path_2(const char* registration) {
  return {.action = JobAction::ResumeFrom,
          .from_path = 2,
          .registration = registration,
          .accept_double_cut = true};
}

void replug(ServiceBench& bench) {
  const auto is = [&](const char* state) {
    return bench.wait([&] {
      return bench.on([&](LiveService& s) { return s.devices.find(bench.device)->state == state; });
    });
  };
  bench.cutters.unplug(bench.device);
  REQUIRE(is("absent"));
  bench.cutters.plug(bench.device);
  REQUIRE(is("idle"));
}

}  // namespace

TEST_CASE("a retry takes a new blank and resuming the same one", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  const Job retried = bench.act(lost.id, JobAction::RetrySheet).value();
  CHECK(retried.state == JobState::Ready);
  CHECK(retried.blank == 2);
  CHECK(retried.segment == 1);
  bench.started(lost.id);
  REQUIRE(bench.cutters.intend(bench.device, 3));
  bench.cutters.finish(bench.device,
                       {.error = Error{ErrorKind::Timeout, "", "stuck"}, .certain = 2, .doubt = 3});
  ActionRequest request{.action = JobAction::ResumeFrom, .from_path = 3, .registration = "kept"};
  CHECK(bench.act(lost.id, request).error().kind == ProblemKind::StateConflict);
  request.accept_double_cut = true;
  const Job resumed = bench.act(lost.id, request).value();
  CHECK(resumed.state == JobState::Ready);
  CHECK(resumed.blank == 2);
  CHECK(resumed.segment == 2);
  CHECK(resumed.device == bench.device);
  bench.started(lost.id);
  CHECK(bench.cutters.first_stroke(bench.device) == 3);
  bench.cutters.finish(bench.device, {.certain = 4});
  CHECK(shown(bench, lost).sheet == 2);
  const Ledger known = ledger(bench, lost.id);
  CHECK(known.certain_upto == 4);
  CHECK(known.attempts.size() == 3);
  CHECK(known.attempts.at(2).operator_name == bench.tutor.name);
}

TEST_CASE("a sheet stays registered only if its cutter was never unplugged", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  bench.cutters.unplug(bench.device);
  REQUIRE(bench.wait([&] {
    return bench.on(
        [&](LiveService& s) { return s.devices.find(bench.device)->state == "absent"; });
  }));
  bench.cutters.plug(bench.device);
  REQUIRE(bench.wait([&] {
    return bench.on([&](LiveService& s) { return s.devices.find(bench.device)->state == "idle"; });
  }));
  CHECK(shown(bench, lost).state == JobState::Interrupted);
  ActionRequest request{.action = JobAction::ResumeFrom,
                        .from_path = 2,
                        .registration = "kept",
                        .accept_double_cut = true};
  CHECK(bench.act(lost.id, request).error().detail.find("register") != std::string::npos);
  request.registration = "somehow";
  CHECK(bench.act(lost.id, request).error().kind == ProblemKind::Validation);
  request.registration = "re-registered";
  CHECK(bench.act(lost.id, request).value().segment == 2);
}

TEST_CASE("a resumed sheet does not need to be loaded again", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  CHECK(lost.attention->text.find("load") == std::string::npos);
  const Job ready = bench.act(lost.id, from_path_2("kept")).value();
  CHECK(ready.attention->kind == "load_sheet");
  CHECK(ready.attention->text == "leave sheet 1 of 2 in place; the cut continues from path 2");
  CHECK(bench.act(lost.id, JobAction::RetrySheet)->attention->text == "load sheet 1 of 2");
}

TEST_CASE("the position of a sheet is unknown after a replug or a restart", "[daemon][service]") {
  const bool restart = GENERATE(false, true);
  const char* const registration = GENERATE("kept", "re-registered");
  CAPTURE(restart, registration);
  ServiceBench bench;
  const Job lost = broken(bench);
  REQUIRE(bench.act(lost.id, from_path_2(registration)));
  const bool armed = GENERATE(false, true);
  if (armed) REQUIRE(bench.act(lost.id, JobAction::Arm));
  if (restart) {
    bench.crash();
    REQUIRE(bench.start().empty());
  } else {
    replug(bench);
  }
  REQUIRE(bench.wait_for(lost.id, JobState::Ready).state == JobState::Ready);
  const Job told = shown(bench, lost);
  CHECK(told.attention->text.find("the cut continues from path") == std::string::npos);
  CHECK(told.attention->text.find("align the sheet again") != std::string::npos);
  CHECK(std::find(told.actions.begin(), told.actions.end(), "arm") == told.actions.end());
  CHECK(told.attention->actions == told.actions);
  const auto refused = bench.act(lost.id, JobAction::Arm);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::StateConflict);
  CHECK(refused.error().detail.find("align the sheet again") != std::string::npos);
  CHECK(bench.act(lost.id, from_path_2("kept")).error().kind == ProblemKind::StateConflict);
  CHECK(bench.act(lost.id, from_path_2("re-registered"))->segment == 2);
  const int before = bench.cutters.cuts();
  bench.started(lost.id);
  CHECK(bench.cutters.cuts() == before + 1);
  CHECK(bench.cutters.first_stroke(bench.device) == 2);
}

TEST_CASE("the path to resume from can be changed until the sheet is started",
          "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  CHECK(bench.act(bench.ready_job("{\"fresh\":1}").id, from_path_2("kept")).error().kind ==
        ProblemKind::StateConflict);
  ActionRequest request = from_path_2("kept");
  request.from_path = 3;
  request.skip_in_doubt = true;
  REQUIRE(bench.act(lost.id, request));
  const Job ready = bench.act(lost.id, from_path_2("kept")).value();
  CHECK(ready.state == JobState::Ready);
  CHECK(ready.segment == 2);
  bench.started(lost.id);
  CHECK(bench.cutters.first_stroke(bench.device) == 2);
}

TEST_CASE("a sheet that came out of the machine must be registered again", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench, ErrorKind::Refused, "it is gone", ErrorReason::NoMedia);
  CHECK(lost.reason == "media_out");
  CHECK(bench.act(lost.id, from_path_2("kept")).error().kind == ProblemKind::StateConflict);
  CHECK(bench.act(lost.id, from_path_2("re-registered")));
}

TEST_CASE("a cutter reconfigured meanwhile is not started", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.on([&](LiveService& service) {
    service.retune({.device_materials = {{bench.device, {"vinyl"}}}});
  });
  const auto refused = bench.act(ready.id, JobAction::Start);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().detail.find("set up for vinyl") != std::string::npos);
  CHECK(bench.cutters.cuts() == 0);
}

TEST_CASE("a job paused on a disabled cutter waits until it is enabled", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Pause));
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  REQUIRE(bench.wait_for(ready.id, JobState::Paused).state == JobState::Paused);
  const auto turn = [&](const char* action) {
    return bench.on([&](LiveService& s) {
      const auto rev = s.devices.find(bench.device)->rev;
      return s.devices.act(bench.admin, bench.device, rev, {.action = action}).has_value();
    });
  };
  REQUIRE(turn("disable"));
  CHECK(bench.act(ready.id, JobAction::Resume).error().detail.find("disabled") !=
        std::string::npos);
  CHECK(bench.cutters.resumes() == 0);
  REQUIRE(turn("enable"));
  CHECK(bench.act(ready.id, JobAction::Resume));
  bench.cutters.complete(bench.device);
}

ActionRequest request_of(const NextAction& next) {
  ActionRequest request = std::get<ActionRequest>(next.body);
  request.action = job_action_from(next.action).value();
  return request;
}

TEST_CASE("a refused action names complete requests and each of them passes", "[daemon][service]") {
  using enum JobAction;
  const bool restarted = GENERATE(false, true);
  const JobAction wrong = GENERATE(Resume, ResumeFrom, ConfirmResult, RetrySheet, Arm, Start);
  CAPTURE(restarted, name_of(wrong));
  std::size_t count = 1;
  for (std::size_t k = 0; k < count; ++k) {
    ServiceBench bench;
    const Job lost = broken(bench);
    if (restarted) {
      bench.crash();
      REQUIRE(bench.start().empty());
      REQUIRE(bench.wait_for(lost.id, JobState::Interrupted).state == JobState::Interrupted);
    }
    const auto act = [&](const ActionRequest& request) {
      return bench.on([&](LiveService& s) {
        return s.cutting.act(bench.tutor, lost.id, s.jobs.find(lost.id)->rev, request);
      });
    };
    ActionRequest request{.action = wrong, .sheet = 7};
    if (wrong == ResumeFrom) request = {.action = wrong, .from_path = 0, .registration = "kept"};
    if (wrong == ConfirmResult) request.good = true;
    const Problem refused = act(request).error();
    CAPTURE(refused.detail);
    REQUIRE_FALSE(refused.next_actions.empty());
    count = refused.next_actions.size();
    CAPTURE(http::json_of(refused.next_actions[k]).whole());
    // The job itself says the same.
    CHECK_FALSE(shown(bench, lost).next_actions.empty());
    const auto passed = act(request_of(refused.next_actions[k]));
    CHECK(passed);
    if (refused.next_actions[k].action != "resume-from" || !passed) continue;
    // So does the next step.
    const Problem next = act({.action = Start}).error();
    REQUIRE_FALSE(next.next_actions.empty());
    CHECK(next.next_actions.front().action == "arm");
    CHECK(act(request_of(next.next_actions.front())));
  }
}

TEST_CASE("an action that could not be stored changes nothing of what is known of the sheet",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  REQUIRE(bench.act(lost.id, from_path_2("kept")));
  const auto unstored = [&](const ActionRequest& request) {
    const auto sql = [&](const char* text) {
      bench.on([&](LiveService&) { bench.store().database().script(text); });
    };
    sql("CREATE TRIGGER no_audit BEFORE INSERT ON audit BEGIN SELECT raise(ABORT, 'no'); END");
    CHECK_FALSE(bench.act(lost.id, request));
    sql("DROP TRIGGER no_audit");
  };
  SECTION("a retry that was not stored leaves the sheet in its place") {
    unstored({.action = JobAction::RetrySheet});
    CHECK(bench.act(lost.id, JobAction::Arm));
  }
  SECTION("a sheet that was not registered again has no place") {
    replug(bench);
    unstored(from_path_2("re-registered"));
    const auto refused = bench.act(lost.id, JobAction::Arm);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().detail.find("align the sheet again") != std::string::npos);
  }
}

}  // namespace service_resume_test
