// SPDX-License-Identifier: MIT
#include <atomic>

#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_actions_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::broken;
using popcut::testing::ledger;
using popcut::testing::ServiceBench;
using popcut::testing::sheet_state;
using popcut::testing::shown;

TEST_CASE("arming names the sheet and the blank and the device and the plan", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  const auto arm = [&](ActionRequest request) {
    request.action = JobAction::Arm;
    return bench.on([&](LiveService& service) {
      return service.cutting.act(bench.tutor, ready.id, service.jobs.find(ready.id)->rev, request);
    });
  };
  CHECK(arm({}).error().errors.at(0).pointer == "/sheet");
  const Problem other_sheet = arm({.sheet = 2}).error();
  CHECK(other_sheet.kind == ProblemKind::StateConflict);
  CHECK(other_sheet.state == "ready");
  CHECK_FALSE(other_sheet.allowed_actions.empty());
  CHECK(arm({.sheet = 1, .blank = 2}).error().kind == ProblemKind::StateConflict);
  CHECK(arm({.sheet = 1, .device = "sim:none"}).error().kind == ProblemKind::Validation);
  CHECK(arm({.sheet = 1, .plan_sha256 = std::string(64, '0')}).error().kind ==
        ProblemKind::StateConflict);
  const std::string sha256 =
      bench.on([&](LiveService& service) { return service.plans.find(ready.plan)->sha256; });
  CHECK(arm({.sheet = 1, .blank = 1, .device = bench.device, .plan_sha256 = sha256}));
  CHECK(shown(bench, ready).state == JobState::Armed);
}

TEST_CASE("an armed job expires after ten minutes of monotonic time", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.skew_ms = 366LL * 86'400'000;  // the wall's clock jumps a year ahead
  bench.on([](LiveService& service) { service.tick(); });
  CHECK(shown(bench, ready).state == JobState::Armed);
  bench.monotonic_skew_ms = 601'000;
  // Even before anyone looked, START comes too late.
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  bench.on([](LiveService& service) { service.tick(); });
  CHECK(shown(bench, ready).state == JobState::Ready);
  CHECK(shown(bench, ready).reason == "arm_expired");
  CHECK(bench.cutters.cuts() == 0);
}

TEST_CASE("an armed job can be started once", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  CHECK(bench.act(ready.id, JobAction::Arm).error().kind == ProblemKind::StateConflict);
  CHECK(bench.cutters.cuts() == 1);
}

TEST_CASE("a restart disarms armed jobs and keeps ready ones", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.crash();
  REQUIRE(bench.start() == "");
  const Job again = shown(bench, ready);
  CHECK(again.state == JobState::Ready);
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  CHECK(bench.cutters.cuts() == 0);
  const auto events = bench.on(
      [&](LiveService& service) { return service.operations.events(0, 1000, ready.id).value(); });
  CHECK(events.back().data.find(R"("recovered":{"from":"armed","to":"ready"})") !=
        std::string::npos);
}

TEST_CASE("unplugging disarms an armed job and asks for the device", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.on([&](LiveService& service) {
    return service.jobs.patch(bench.tutor, ready.id, ready.rev, {.device = bench.device});
  }));
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.cutters.unplug(bench.device);
  const Job after = bench.wait_for(ready.id, JobState::Ready);
  CHECK(after.reason == "device_gone");
  CHECK(after.attention->kind == "device_absent");
  CHECK(bench.act(ready.id, JobAction::Arm).error().kind == ProblemKind::DeviceAbsent);
  bench.cutters.plug(bench.device);
  REQUIRE(bench.wait([&] {
    return bench.on([&](LiveService& s) { return s.devices.find(bench.device)->state == "idle"; });
  }));
  CHECK(shown(bench, ready).state == JobState::Ready);  // replugging arms nothing
  CHECK(shown(bench, ready).attention->kind == "load_sheet");
  CHECK(bench.act(ready.id, JobAction::Arm));
}

TEST_CASE("a cutter that was unplugged for a moment is disarmed, though it was never seen absent",
          "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.cutters.replug(bench.device);
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(shown(bench, ready).state == JobState::Ready);
  CHECK(shown(bench, ready).reason == "device_gone");
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  CHECK(bench.act(ready.id, JobAction::Arm));
}

TEST_CASE("after a cutter refuses the sheet the same blank can be started again",
          "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.cutters.refuses = true;
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  REQUIRE(bench.act(ready.id, JobAction::Start));
  const Job after = shown(bench, ready);
  CHECK(after.state == JobState::Ready);
  CHECK(after.blank == 1);
  bench.cutters.refuses = false;
  bench.started(ready.id);
  CHECK(bench.cutters.cuts() == 1);
  bench.cutters.complete(bench.device);
  CHECK(shown(bench, ready).sheet == 2);
}

TEST_CASE("a pause is reported when the tool is up and resume continues", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  const Job pausing = bench.act(ready.id, JobAction::Pause).value();
  CHECK(pausing.state == JobState::Cutting);
  CHECK(pausing.reason == "pausing");
  CHECK(bench.cutters.pauses() == 1);
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  CHECK(bench.wait_for(ready.id, JobState::Paused).state == JobState::Paused);
  CHECK(bench.act(ready.id, JobAction::Resume)->state == JobState::Cutting);
  CHECK(bench.cutters.resumes() == 1);
  // Held without having been asked is nothing that leads on.
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  bench.on([](LiveService&) {});
  CHECK(shown(bench, ready).state == JobState::Cutting);
  bench.cutters.complete(bench.device);
  CHECK(shown(bench, ready).sheet == 2);
}

TEST_CASE("a pause that cannot be recorded when the tool is up is recorded by the tick",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Pause));
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("CREATE TRIGGER no_pause BEFORE UPDATE ON job WHEN new.state='paused' BEGIN SELECT "
      "raise(ABORT, 'not now'); END");
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  bench.on([](LiveService&) {});
  CHECK(shown(bench, ready).state == JobState::Cutting);
  sql("DROP TRIGGER no_pause");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(shown(bench, ready).state == JobState::Paused);
  CHECK(bench.act(ready.id, JobAction::Resume)->state == JobState::Cutting);
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(shown(bench, ready).state == JobState::Cutting);
  bench.cutters.complete(bench.device);
  CHECK(shown(bench, ready).sheet == 2);
}

TEST_CASE("a pause can be withdrawn before the stroke has ended", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Pause));
  CHECK(bench.act(ready.id, JobAction::Resume)->reason.empty());
  CHECK(bench.act(ready.id, JobAction::Resume).error().kind == ProblemKind::StateConflict);
}

TEST_CASE("a pause on the panel is shown and ends with the panel", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Paused});
  REQUIRE(bench.wait([&] { return shown(bench, ready).reason == "panel_pause"; }));
  CHECK(shown(bench, ready).state == JobState::Cutting);
  CHECK(shown(bench, ready).attention.has_value());
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Cutting});
  REQUIRE(bench.wait([&] { return shown(bench, ready).reason.empty(); }));
  CHECK_FALSE(shown(bench, ready).attention.has_value());
}

TEST_CASE("cancelling waits for the knife", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  const Job asked =
      bench.act(ready.id, {.action = JobAction::Cancel, .reason = "wrong paper"}).value();
  CHECK(asked.state == JobState::Cutting);
  CHECK(bench.cutters.cancels() == 1);
  CHECK(bench.act(ready.id, JobAction::Pause).error().kind == ProblemKind::StateConflict);
  bench.cutters.finish(bench.device, {.cancelled = true, .certain = 1});
  const Job over = shown(bench, ready);
  CHECK(over.state == JobState::Cancelled);
  CHECK(over.reason == "wrong paper");
  CHECK(ledger(bench, ready.id).attempts.at(0).end_kind == "cancelled");
  CHECK(sheet_state(bench, ready.id) == "interrupted");
  for (const JobAction action : {JobAction::Arm, JobAction::Cancel, JobAction::RetrySheet})
    CHECK(bench.act(ready.id, action).error().kind == ProblemKind::StateConflict);
}

TEST_CASE("cancelling after the last stroke of the last sheet comes too late",
          "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Cancel));
  bench.cutters.complete(bench.device);
  CHECK(shown(bench, ready).state == JobState::Done);
  bench.planner.sheets = 2;
  const Job second = bench.ready_job("{\"another\":1}");
  bench.started(second.id);
  REQUIRE(bench.act(second.id, JobAction::Cancel));
  bench.cutters.complete(bench.device);
  CHECK(shown(bench, second).state == JobState::Cancelled);
  CHECK(sheet_state(bench, second.id) == "done");
}

TEST_CASE("jobs that are not being cut are cancelled at once", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  CHECK(bench.act(ready.id, JobAction::Cancel)->state == JobState::Cancelled);
  const Job armed = bench.ready_job();
  REQUIRE(bench.act(armed.id, JobAction::Arm));
  CHECK(bench.act(armed.id, JobAction::Cancel)->state == JobState::Cancelled);
  CHECK(sheet_state(bench, armed.id) == "ready");
  const Job interrupted = broken(bench);
  CHECK(bench.act(interrupted.id, JobAction::Cancel)->state == JobState::Cancelled);
  const auto slow = bench.add_design("{\"slow\":1}").value();
  const Job waiting = bench.create(slow.id).value();
  REQUIRE(bench.wait_for(waiting.id, JobState::Planning).state == JobState::Planning);
  CHECK(bench.act(waiting.id, JobAction::Cancel)->state == JobState::Cancelled);
  CHECK(bench.planner.cancelled == 1);
}

TEST_CASE("the end of a cut that cannot be recorded is logged once and recorded later",
          "[alone][daemon][service]") {
  std::atomic<int> lines{0};
  ServiceBench bench(false);
  bench.options.log = [&](const std::string& line) {
    if (line.find("could not be recorded yet") != std::string::npos) ++lines;
  };
  REQUIRE(bench.start() == "");
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  const auto sql = [&](const char* text) {
    bench.on([&](LiveService&) { bench.store().database().script(text); });
  };
  sql("CREATE TRIGGER no_end BEFORE UPDATE ON attempt WHEN new.ended IS NOT NULL BEGIN SELECT "
      "raise(ABORT, 'not now'); END");
  bench.cutters.complete(bench.device);
  for (int k = 0; k < 3; ++k) bench.on([](LiveService& s) { s.tick(); });
  CHECK(lines == 1);
  CHECK(shown(bench, ready).state == JobState::Cutting);
  sql("DROP TRIGGER no_end");
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(shown(bench, ready).state == JobState::Ready);
  CHECK(shown(bench, ready).sheet == 2);
}

TEST_CASE("each cause that ends a cut early has its own reason", "[daemon][service]") {
  struct Row {
    ErrorKind kind;
    ErrorReason why;
    std::string words, reason, attention;
  };
  using Why = ErrorReason;
  // The words are a machine's as often as popcut's: nothing goes by them.
  const std::string words = "it answered \"stalled, no media, sheet came out, registration mark\"";
  const Row row =
      GENERATE_COPY(Row{ErrorKind::DeviceGone, Why::None, words, "device_gone", "device_absent"},
                    Row{ErrorKind::Timeout, Why::None, words, "stall", "device_fault"},
                    Row{ErrorKind::Refused, Why::None, words + " panel", "refused", "device_fault"},
                    Row{ErrorKind::Refused, Why::Stalled, "s", "stall", "device_fault"},
                    Row{ErrorKind::Refused, Why::Overflow, "o", "stall", "device_fault"},
                    Row{ErrorKind::Refused, Why::PanelStop, "p", "panel_stop", "in_doubt"},
                    Row{ErrorKind::Refused, Why::NoMedia, "n", "media_out", "media_out"},
                    Row{ErrorKind::Refused, Why::NoMarks, "m", "marks_not_found", "device_fault"},
                    Row{ErrorKind::Unwritable, Why::None, words, "store", "in_doubt"});
  CAPTURE(row.words);
  ServiceBench bench;
  const Job after = broken(bench, row.kind, row.words, row.why);
  CHECK(after.state == JobState::Interrupted);
  CHECK(after.reason == row.reason);
  CHECK(after.attention->kind == row.attention);
  CHECK(after.progress.paths_certain == 2);
  CHECK(after.progress.paths_sent == 3);
  const Ledger known = ledger(bench, after.id);
  CHECK(known.certain_upto == 1);
  CHECK(known.in_doubt.at(0).first == 2);
  CHECK(known.in_doubt.at(0).last == 2);
  CHECK(known.not_sent.at(0).first == 3);
  CHECK(known.last_status.find(row.words) != std::string::npos);
}

TEST_CASE("a machine that answers nothing needs a person to say done", "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.cutters.intend(bench.device, 4));
  bench.cutters.finish(bench.device, {.confirmed = false, .certain = -1, .doubt = 4});
  const Job unsure = shown(bench, ready);
  CHECK(unsure.state == JobState::Interrupted);
  CHECK(unsure.attention->kind == "confirm_result");
  const Job bad = bench.act(ready.id, {.action = JobAction::ConfirmResult, .good = false}).value();
  CHECK(bad.state == JobState::Interrupted);
  const Job good = bench.act(ready.id, {.action = JobAction::ConfirmResult, .good = true}).value();
  CHECK(good.state == JobState::Done);
  const auto usage = bench.usage("device");
  CHECK(usage.at(0).sheets == 1);
}

TEST_CASE("a sheet with paths that were never sent cannot be confirmed", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  CHECK(bench.act(lost.id, {.action = JobAction::ConfirmResult, .good = true}).error().kind ==
        ProblemKind::StateConflict);
  CHECK(bench.act(lost.id, JobAction::SkipSheet)->sheet == 2);
  CHECK(bench.act(lost.id, JobAction::SkipSheet)->state == JobState::Done);
  CHECK(shown(bench, lost).outcome == "done with skipped sheets");
}

TEST_CASE("a cut is not done without the device's confirmation", "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  // It claims to be through, but one stroke was never sent.
  bench.cutters.finish(bench.device, {.confirmed = true, .certain = 3, .doubt = 3});
  CHECK(shown(bench, ready).state == JobState::Interrupted);
}

TEST_CASE("a stored program of which any byte changed is not cut", "[daemon][service]") {
  // Between the plan and arming, between arming and the start, between a fault and going on.
  const int moment = GENERATE(0, 1, 2);
  CAPTURE(moment);
  ServiceBench bench;
  const Job job = moment == 2 ? broken(bench) : bench.ready_job();
  if (moment == 1) REQUIRE(bench.act(job.id, JobAction::Arm));
  const int cuts = bench.cutters.cuts();
  for (const char* name : {"sheet-01.gpgl", "sheet-01.program.json"}) {
    const std::string path = bench.folder() + "/plans/" + job.plan + "/" + name;
    const std::string whole = read_whole(path, 1u << 20).value();
    std::vector<std::string> changed;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      changed.push_back(whole);
      changed.back()[at] ^= 1;
    }
    changed.push_back(whole + " ");
    changed.push_back(whole.substr(1));
    for (const std::string& bytes : changed) {
      popcut::testing::write_text(path, bytes);
      if (moment == 2)
        REQUIRE(bench.act(job.id, {.action = JobAction::ResumeFrom,
                                   .from_path = 2,
                                   .registration = "kept",
                                   .accept_double_cut = true}));
      if (moment != 1) REQUIRE(bench.act(job.id, JobAction::Arm));
      const auto refused = bench.act(job.id, JobAction::Start);
      REQUIRE_FALSE(refused);
      CHECK(refused.error().kind == ProblemKind::StateConflict);
      CHECK(refused.error().detail.find("create the job again") != std::string::npos);
      if (moment != 1) REQUIRE(bench.act(job.id, JobAction::Disarm));
    }
    popcut::testing::write_text(path, whole);
  }
  CHECK(bench.cutters.cuts() == cuts);
  // As it was planned, it is cut.
  if (moment != 1) REQUIRE(bench.act(job.id, JobAction::Arm));
  CHECK(bench.act(job.id, JobAction::Start));
}

TEST_CASE("dots are never sent and do not prevent a sheet from being done", "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  bench.options.read_program = [](const std::string& folder, int sheet) {
    auto program = popcut::testing::read_fake_program(folder, sheet);
    if (program) program->program.dots = {0, 3};
    return program;
  };
  bench.stop();
  REQUIRE(bench.start() == "");
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  std::vector<StrokeFate> fates;
  bench.cutters.finish(bench.device, {.certain = 4});
  CHECK(shown(bench, ready).state == JobState::Done);
}

TEST_CASE("a crash while cutting leaves the paths in transit in doubt", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.cutters.intend(bench.device, 0));
  bench.cutters.settle(bench.device, 0, 0);
  REQUIRE(bench.cutters.intend(bench.device, 2));
  bench.crash();
  REQUIRE(bench.start() == "");
  const Job after = shown(bench, ready);
  CHECK(after.state == JobState::Interrupted);
  CHECK(after.reason == "crash");
  CHECK(after.attention->kind == "in_doubt");
  const Ledger known = ledger(bench, ready.id);
  CHECK(known.certain_upto == 0);
  CHECK(known.in_doubt.at(0).first == 1);
  CHECK(known.in_doubt.at(0).last == 2);
  CHECK(known.not_sent.at(0).first == 3);
  CHECK(known.attempts.at(0).end_kind == "crash");
  CHECK(bench.cutters.cuts() == 1);
  // The cutter may have been switched off meanwhile.
  CHECK_FALSE(bench.act(ready.id, {.action = JobAction::ResumeFrom,
                                   .from_path = 1,
                                   .registration = "kept",
                                   .accept_double_cut = true}));
}

TEST_CASE("a crash while paused interrupts the job too", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Pause));
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  REQUIRE(bench.wait_for(ready.id, JobState::Paused).state == JobState::Paused);
  bench.crash();
  REQUIRE(bench.start() == "");
  CHECK(shown(bench, ready).state == JobState::Interrupted);
}

TEST_CASE("stopping popcutd interrupts its cuts at the ends of their strokes",
          "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.cutters.intend(bench.device, 1));
  bench.on([](LiveService& service) { service.stopping(); });
  bench.cutters.finish(bench.device, {.cancelled = true, .certain = 1});
  CHECK(shown(bench, ready).state == JobState::Interrupted);
  CHECK(shown(bench, ready).reason == "shutdown");
  const Job other = bench.act(ready.id, JobAction::RetrySheet).value();
  REQUIRE(bench.act(other.id, JobAction::Arm));
  CHECK(bench.act(other.id, JobAction::Start).error().kind == ProblemKind::Unavailable);
}

TEST_CASE("a program that differs from the planned one is not cut", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  const std::string file = bench.folder() + "/plans/" + ready.plan + "/sheet-01.gpgl";
  const std::string bytes = read_whole(file, 10'000).value();
  std::string changed = bytes;
  changed[20] = 'x';
  popcut::testing::write_text(file, changed);
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  remove_tree(file);
  CHECK(bench.act(ready.id, JobAction::Start).error().kind == ProblemKind::StateConflict);
  CHECK(bench.cutters.cuts() == 0);
  popcut::testing::write_text(file, bytes);
  CHECK(bench.act(ready.id, JobAction::Start));
}

TEST_CASE("roles decide who may do what to whose job", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  const auto as = [&](const Principal& who, JobAction action) {
    return bench.on([&](LiveService& service) {
      return service.cutting.act(who, ready.id, service.jobs.find(ready.id)->rev,
                                 {.action = action, .sheet = 1});
    });
  };
  CHECK(as(bench.student, JobAction::Arm).error().kind == ProblemKind::Forbidden);
  CHECK(as(bench.viewer, JobAction::Cancel).error().kind == ProblemKind::Forbidden);
  CHECK(as(bench.other_student, JobAction::Cancel).error().kind == ProblemKind::Forbidden);
  CHECK(as(bench.tutor, JobAction::Arm));
  CHECK(as(bench.student, JobAction::Cancel));
}

TEST_CASE("an action on an outdated revision is refused", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  const Problem stale = bench
                            .on([&](LiveService& service) {
                              return service.cutting.act(bench.tutor, ready.id, ready.rev,
                                                         {.action = JobAction::Arm, .sheet = 1});
                            })
                            .error();
  CHECK(stale.kind == ProblemKind::Stale);
  CHECK(stale.rev == ready.rev + 1);
  CHECK(stale.state == "armed");
}

TEST_CASE("actions leave an audit trail with the person's name", "[daemon][service]") {
  ServiceBench bench;
  const Job lost = broken(bench);
  REQUIRE(bench.act(lost.id, {.action = JobAction::ResumeFrom,
                              .from_path = 2,
                              .registration = "kept",
                              .accept_double_cut = true}));
  const std::string detail = bench.on([&](LiveService&) {
    Rows rows = bench.store().database().rows(
        "SELECT principal, detail FROM audit WHERE action='resume-from'");
    return rows.next() ? rows.text(0) + " " + rows.text(1) : std::string();
  });
  CHECK(detail.find("uid:4 ") == 0);
  CHECK(detail.find("double cut accepted") != std::string::npos);
}

TEST_CASE("effects after a commit never run for another commit", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  // Whoever renders the reply fails: the start is undone, and no knife moves with the next commit.
  bench.on([&](LiveService& service) {
    CHECK_THROWS_AS(
        service.operations.once(bench.tutor, {"a-key-of-sixteen", "digest"},
                                [&]() -> Rendered {
                                  const auto now = service.jobs.find(ready.id);
                                  if (!service.cutting.act(bench.tutor, ready.id, now->rev,
                                                           {.action = JobAction::Start}))
                                    return {.status = 409, .body = {}};
                                  throw std::bad_alloc();
                                }),
        std::bad_alloc);
  });
  CHECK(bench.job(ready.id).state == JobState::Armed);
  REQUIRE(bench.create(ready.design));
  CHECK(bench.cutters.cuts() == 0);
  REQUIRE(bench.act(ready.id, JobAction::Start));
  CHECK(bench.cutters.cuts() == 1);
  bench.cutters.complete(bench.device);
}

TEST_CASE(
    "a sheet that was planned for another machine or material is armed only if that is accepted",
    "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 2;
  const Job ready = bench.ready_job();
  CHECK(ready.unaccepted.empty());
  SECTION("the machine was measured and popcutd restarted") {
    bench.stop();
    bench.options.tables = {R"({"popcut": 1, "machines": [{"name": "cameo3", "like": "cameo3",
                                              "title": "measured", "source": "me"}]})"};
    REQUIRE(bench.start().empty());
    const Answer<Job> refused = bench.act(ready.id, JobAction::Arm);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().kind == ProblemKind::StateConflict);
    CHECK(refused.error().detail.find("cameo3 has changed since the sheets were planned") !=
          std::string::npos);
    CHECK(refused.error().detail.find("\"measured\"") != std::string::npos);
    REQUIRE_FALSE(refused.error().next_actions.empty());
    CHECK(refused.error().next_actions[0].action == "change");
    const Job told = bench.job(ready.id);
    CHECK(told.state == JobState::Ready);
    CHECK(told.unaccepted == std::vector<std::string>{"machine_changed"});
    CHECK(told.warnings.at(0).spoils);
    // As it is, and then it is not asked again for the next sheet.
    const ActionRequest accepted{.action = JobAction::Arm, .accept_warnings = {"machine_changed"}};
    CHECK(bench.act(ready.id, accepted)->state == JobState::Armed);
    REQUIRE(bench.act(ready.id, JobAction::Start));
    bench.cutters.complete(bench.device);
    REQUIRE(bench.wait_for(ready.id, JobState::Ready).sheet == 2);
    CHECK(bench.act(ready.id, JobAction::Arm)->state == JobState::Armed);
  }
  SECTION("the material was changed, and the job is planned again") {
    REQUIRE(bench.on([&](LiveService& s) {
      return s.materials.put(bench.admin, ready.material, 1,
                             R"({"like": "paper-220", "thickness_mm": 0.3})");
    }));
    const Answer<Job> refused = bench.act(ready.id, JobAction::Arm);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().detail.find("the material " + ready.material + " has changed") !=
          std::string::npos);
    const auto patch = std::get<JobPatch>(refused.error().next_actions.at(0).body);
    CHECK(patch.plan_again);
    const Job now = bench.job(ready.id);
    REQUIRE(bench.on(
        [&](LiveService& s) { return s.jobs.patch(bench.student, ready.id, now.rev, patch); }));
    REQUIRE(bench.wait([&] { return bench.job(ready.id).state == JobState::Ready; }));
    CHECK(bench.job(ready.id).unaccepted.empty());
    CHECK(bench.job(ready.id).plan != ready.plan);
    CHECK(bench.act(ready.id, JobAction::Arm)->state == JobState::Armed);
  }
}

}  // namespace service_actions_test
