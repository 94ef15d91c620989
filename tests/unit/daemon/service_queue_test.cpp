// SPDX-License-Identifier: MIT
#include <atomic>
#include <filesystem>
#include <set>

#include <catch2/catch.hpp>

#include "daemon/http/api/render.hpp"
#include "daemon/model/warnings.hpp"
#include "tests/support/service_bench.hpp"

namespace service_queue_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

Answer<Job> create(ServiceBench& bench, const JobCreate& request) {
  return bench.on(
      [&](LiveService& service) { return service.jobs.create(bench.student, request); });
}

std::vector<std::string> queue(ServiceBench& bench, const std::string& device = "",
                               int limit = 200) {
  std::vector<std::string> ids;
  PageRequest request{.limit = limit, .cursor = {}};
  do {
    const auto page = bench.on([&](LiveService& s) { return s.jobs.queue(device, request); });
    REQUIRE(page);
    CHECK(page->items.size() <= static_cast<std::size_t>(limit));
    for (const Job& job : page->items) ids.push_back(job.id);
    request.cursor = page->next_cursor;
  } while (!request.cursor.empty());
  return ids;
}

Upload upload(ServiceBench& bench, const std::string& bytes) {
  const std::string path = bench.folder() + "/incoming/asset";
  write_text(path, bytes);
  return {path, sha256_hex(bytes), bytes.size()};
}

}  // namespace

TEST_CASE("equal bytes give one design and equal options one plan", "[daemon][service]") {
  ServiceBench bench;
  const auto first = bench.add_design("{\"card\":1}").value();
  CHECK(first.is_new);
  CHECK(first.id == "sha256-" + sha256_hex("{\"card\":1}"));
  const auto again = bench.add_design("{\"card\":1}").value();
  CHECK_FALSE(again.is_new);
  CHECK(bench.on([&](LiveService& s) { return s.designs.list(bench.student, {}).items.size(); }) ==
        1);
  const Job one = bench.create(first.id).value();
  const Job two = bench.create(first.id).value();
  CHECK(one.plan == two.plan);
  bench.wait_for(two.id, JobState::Ready);
  // Planned already: ready at once.
  CHECK(bench.create(first.id)->state == JobState::Ready);
  JobCreate other{.design = first.id, .plan = {}};
  other.options["order"] = "best";
  CHECK(create(bench, other)->plan != one.plan);
  CHECK(fs::is_empty(bench.folder() + "/incoming"));
  CHECK(bench.on([&](LiveService& s) { return s.plans.file(one.plan, "plan.json").has_value(); }));
  CHECK_FALSE(bench.on(
      [&](LiveService& s) { return s.plans.file(one.plan, "../../popcut.db").has_value(); }));
}

TEST_CASE("a design that cannot be read is refused with its place", "[daemon][service]") {
  ServiceBench bench;
  const auto refused = bench.add_design("{\"bad\":1}");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::Validation);
  CHECK(refused.error().errors.at(0).pointer == "/surface");
  CHECK(fs::is_empty(bench.folder() + "/incoming"));
  CHECK(fs::is_empty(bench.folder() + "/designs"));
  CHECK_FALSE(bench.add_design("{}", "two\nlines"));
  CHECK_FALSE(bench.add_design("{}", std::string(121, 'x')));
}

TEST_CASE("a name may have 120 characters of any script", "[daemon][service]") {
  ServiceBench bench;
  std::string longest;
  for (int k = 0; k < 120; ++k) longest += "\u00fc";
  const auto design = bench.add_design("{}", longest);
  REQUIRE(design);
  CHECK(design->name == longest);
  const auto token = [&](const std::string& name) {
    return bench.on([&](LiveService& s) {
      return s.access.create_token(bench.admin, name, Role::Viewer, std::nullopt);
    });
  };
  CHECK(token(longest));
  CHECK_FALSE(token(longest + "x"));
  CHECK_FALSE(bench.add_design("{}", longest + "x"));
}

TEST_CASE("a spec gets the assets that it names and no others", "[daemon][service]") {
  ServiceBench bench;
  const Asset asset = bench
                          .on([&](LiveService& s) {
                            return s.designs.add_asset(bench.student, upload(bench, "mesh"));
                          })
                          .value();
  CHECK(asset.is_new);
  CHECK_FALSE(bench.on([&](LiveService& s) {
    return s.designs.add_asset(bench.student, upload(bench, "mesh"))->is_new;
  }));
  const auto design = bench
                          .add_design("{\"file\":\"" + asset.id + "\",\"other\":\"sha256-" +
                                      std::string(64, 'a') + "\"}")
                          .value();
  CHECK(design.assets == std::vector<std::string>{asset.id});
  CHECK(bench.on([&](LiveService& s) {
    return s.designs.add_asset(bench.viewer, upload(bench, "other")).error().kind;
  }) == ProblemKind::Forbidden);
}

TEST_CASE("an invalid job is refused with all its faults", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  JobCreate request{.design = design.id, .plan = {}};
  request.copies = 0;
  request.priority = 11;
  request.name = "a\x1b[31m";
  request.device = "sim:cameo4";
  const Problem problem = create(bench, request).error();
  CHECK(problem.kind == ProblemKind::Validation);
  std::set<std::string> pointers;
  for (const RequestFault& fault : problem.errors) pointers.insert(fault.pointer);
  CHECK(pointers == std::set<std::string>{"/copies", "/priority", "/name", "/device"});
  CHECK(create(bench, {.design = "sha256-none", .plan = {}}).error().errors.at(0).pointer ==
        "/design");
  JobCreate material{.design = design.id, .plan = {}};
  material.material = "paper-22";
  CHECK(create(bench, material).error().errors.at(0).pointer == "/material");
  CHECK(create(bench, {}).error().kind == ProblemKind::Validation);
  CHECK(bench.on([&](LiveService& s) {
    return s.jobs.create(bench.viewer, {.design = design.id, .plan = {}}).error().kind;
  }) == ProblemKind::Forbidden);
  CHECK(queue(bench).empty());
}

TEST_CASE("limits on the queue and on sheets are enforced", "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.queue_jobs = 2;
  bench.options.sheets_per_job = 5;
  REQUIRE(bench.start() == "");
  const Job ready = bench.ready_job();
  CHECK(bench.create(ready.design, 3).error().errors.at(0).pointer == "/copies");
  const Job two = bench.create(ready.design, 2).value();
  CHECK(two.sheets_total == 4);
  CHECK(bench.create(ready.design).error().kind == ProblemKind::QueueFull);
  REQUIRE(bench.act(two.id, JobAction::Cancel));
  CHECK(bench.create(ready.design));
  // Told only once the plan is known: then the job fails.
  REQUIRE(bench.act(ready.id, JobAction::Cancel));
  const auto other = bench.add_design("{\"card\":2}").value();
  const Job many = bench.create(other.id, 1000).value();
  const Job failed = bench.wait_for(many.id, JobState::Failed);
  CHECK(failed.state == JobState::Failed);
  CHECK(failed.reason.find("2000 sheets") != std::string::npos);
}

TEST_CASE("copies become additional sheets", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job("{\"card\":1}", 3);
  CHECK(ready.sheets_total == 6);
  const auto sheets = bench.on([&](LiveService& s) { return s.jobs.sheets(ready.id).value(); });
  REQUIRE(sheets.size() == 6);
  CHECK(sheets[0].state == "ready");
  CHECK(sheets[1].state == "waiting");
  CHECK(sheets[4].copy == 3);
  CHECK(sheets[4].number == 5);
  CHECK(sheets[4].plan.program_sha256 == sheets[0].plan.program_sha256);
  bench.started(ready.id);
  bench.cutters.complete(bench.device);
  CHECK(bench.on([&](LiveService& s) { return s.jobs.sheets(ready.id).value()[0].state; }) ==
        "done");
  CHECK(bench.on([&](LiveService& s) { return s.jobs.ledger(ready.id, 7).error().kind; }) ==
        ProblemKind::NotFound);
}

TEST_CASE("the queue is ordered by priority and by people's moves", "[daemon][service]") {
  ServiceBench bench;
  const Job a = bench.ready_job();
  const Job b = bench.create(a.design).value();
  const Job c = bench.create(a.design).value();
  JobCreate urgent{.design = a.design, .plan = {}};
  urgent.priority = 5;
  const Job d = create(bench, urgent).value();
  CHECK(queue(bench) == std::vector{d.id, a.id, b.id, c.id});
  const auto move = [&](const std::string& id, const std::string& before) {
    return bench.on([&](LiveService& s) { return s.jobs.move(bench.tutor, id, before); });
  };
  REQUIRE(move(c.id, a.id));
  CHECK(queue(bench) == std::vector{d.id, c.id, a.id, b.id});
  // As often as one likes.
  for (int i = 0; i < 60; ++i) REQUIRE(move(i % 2 == 0 ? b.id : c.id, i % 2 == 0 ? c.id : b.id));
  CHECK(queue(bench) == std::vector{d.id, c.id, b.id, a.id});
  REQUIRE(move(c.id, ""));
  CHECK(queue(bench) == std::vector{d.id, b.id, a.id, c.id});
  CHECK_FALSE(move(a.id, d.id));
  CHECK(move(a.id, a.id).error().errors.front().pointer == "/before");
  CHECK_FALSE(move(a.id, "nobody"));
  CHECK(bench.on([&](LiveService& s) {
    return s.jobs.move(bench.student, a.id, "").error().kind;
  }) == ProblemKind::Forbidden);
  REQUIRE(bench.on([&](LiveService& s) {
    return s.jobs.patch(bench.student, a.id, s.jobs.find(a.id)->rev, {.priority = 9});
  }));
  CHECK(queue(bench).front() == a.id);
}

TEST_CASE("a held job cannot be armed until it is released", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  const auto hold = [&](bool held) {
    return bench.on([&](LiveService& s) { return s.jobs.hold(bench.student, ready.id, held); });
  };
  CHECK(hold(true)->held);
  CHECK(bench.act(ready.id, JobAction::Arm).error().kind == ProblemKind::StateConflict);
  CHECK_FALSE(hold(false)->held);
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  CHECK(hold(true)->state == JobState::Ready);
  CHECK(bench.on([&](LiveService& s) {
    return s.jobs.hold(bench.other_student, ready.id, false).error().kind;
  }) == ProblemKind::Forbidden);
}

TEST_CASE("jobs list the devices that fit", "[daemon][service]") {
  ServiceBench bench({"sim:a", "sim:b"}, false);
  bench.options.device_materials["sim:b"] = {"pp-150"};
  REQUIRE(bench.start() == "");
  const Job ready = bench.ready_job();
  // Only a is set up for this paper, so it need not be said.
  CHECK(bench.act(ready.id, JobAction::Arm)->device == "sim:a");
  CHECK(queue(bench, "sim:b").empty());
  const Job second = bench.create(ready.design).value();
  CHECK(bench.act(second.id, JobAction::Arm).error().kind == ProblemKind::StateConflict);
  CHECK(bench.act(second.id, {.action = JobAction::Arm, .device = "sim:b"}).error().kind ==
        ProblemKind::StateConflict);
  bench.planner.area_mm = {400, 200};
  const Job wide = bench.ready_job("{\"wide\":1}");
  const Problem none = bench.act(wide.id, JobAction::Arm).error();
  CHECK(none.kind == ProblemKind::DeviceAbsent);
}

TEST_CASE("a person chooses if two devices fit", "[daemon][service]") {
  ServiceBench bench({"sim:a", "sim:b"});
  const Job ready = bench.ready_job();
  const Job second = bench.create(ready.design).value();
  CHECK(bench.act(ready.id, JobAction::Arm).error().errors.at(0).pointer == "/device");
  REQUIRE(bench.act(ready.id, {.action = JobAction::Arm, .device = "sim:b"}));
  CHECK(bench.act(second.id, JobAction::Arm)->device == "sim:a");
  REQUIRE(bench.act(ready.id, JobAction::Start));
  REQUIRE(bench.act(second.id, JobAction::Start));
  CHECK(bench.cutters.busy().size() == 2);
  bench.cutters.complete("sim:a");
  bench.cutters.complete("sim:b");
}

TEST_CASE("a disabled device gets no sheets", "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  const auto act = [&](const Principal& who, const std::string& action) {
    return bench.on([&](LiveService& s) {
      return s.devices.act(who, bench.device, s.devices.find(bench.device)->rev,
                           {.action = action});
    });
  };
  CHECK(act(bench.tutor, "disable").error().kind == ProblemKind::Forbidden);
  CHECK(act(bench.admin, "disable")->enabled == false);
  CHECK(bench.job(ready.id).state == JobState::Ready);
  CHECK(bench.act(ready.id, JobAction::Arm).error().kind == ProblemKind::DeviceAbsent);
  bench.stop();
  REQUIRE(bench.start() == "");
  CHECK_FALSE(bench.on([&](LiveService& s) { return s.devices.find(bench.device)->enabled; }));
  CHECK(act(bench.admin, "enable")->enabled);
  CHECK(bench.act(ready.id, JobAction::Arm));
  CHECK(act(bench.admin, "reset").error().kind == ProblemKind::StateConflict);
  CHECK(act(bench.admin, "melt").error().kind == ProblemKind::NotFound);
  CHECK(bench.on([&](LiveService& s) {
    return s.devices.act(bench.admin, bench.device, 0, {.action = "enable"}).error().kind;
  }) == ProblemKind::Stale);
}

TEST_CASE("a reset for which there is no memory ends, and another one can begin",
          "[daemon][service]") {
  ServiceBench bench;
  const auto reset = [&] {
    return bench.on([&](LiveService& s) {
      return s.devices.act(bench.admin, bench.device, s.devices.find(bench.device)->rev,
                           {.action = "reset"});
    });
  };
  bench.cutters.reset_throws = true;
  REQUIRE(reset());
  CHECK(bench.wait([&] { return reset().has_value(); }));
  bench.cutters.reset_throws = false;
  CHECK(bench.wait([&] { return reset().has_value(); }));
}

TEST_CASE("a device whose disabling is rolled back keeps the sheet that is armed there",
          "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  // As HTTP asks, with a response that is not kept.
  bench.on([&](LiveService& s) {
    (void)s.operations.once(bench.admin, {"a-key-of-its-own", "hash"}, [&]() -> Rendered {
      CHECK(s.devices.act(bench.admin, bench.device, s.devices.find(bench.device)->rev,
                          {.action = "disable"}));
      return {.status = 500, .body = {}};
    });
  });
  CHECK(bench.on([&](LiveService& s) { return s.devices.find(bench.device)->enabled; }));
  CHECK(bench.job(ready.id).state == JobState::Armed);
  REQUIRE(bench.act(ready.id, JobAction::Start));
  bench.cutters.complete(bench.device);
  CHECK(bench.wait_for(ready.id, JobState::Ready).sheet == 2);
}

TEST_CASE("the answer to a device action has the device's new state", "[daemon][service]") {
  ServiceBench bench;
  // As HTTP asks: within the transaction of the key.
  const auto answer = bench.on([&](LiveService& s) {
    DeviceRecord told;
    (void)s.operations.once(bench.admin, {"a-key-of-its-own", "hash"}, [&]() -> Rendered {
      told = s.devices
                 .act(bench.admin, bench.device, s.devices.find(bench.device)->rev,
                      {.action = "disable"})
                 .value();
      return {};
    });
    return told;
  });
  CHECK_FALSE(answer.enabled);
  CHECK(answer.rev == bench.on([&](LiveService& s) { return s.devices.find(bench.device)->rev; }));
}

TEST_CASE("a device configured for some materials takes no others", "[daemon][service]") {
  ServiceBench bench({"sim:a", "sim:b"}, false);
  bench.options.device_materials["sim:a"] = {"pp-150"};
  REQUIRE(bench.start() == "");
  const Job paper = bench.ready_job();
  CHECK(bench.on([&](LiveService& s) { return s.devices.find("sim:a")->materials; }) ==
        std::vector<std::string>{"pp-150"});
  const auto refused = bench.act(paper.id, {.action = JobAction::Arm, .device = "sim:a"});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().detail.find("set up for pp-150, not for paper-220") != std::string::npos);
  CHECK(queue(bench, "sim:a").empty());
  CHECK(queue(bench, "sim:b") == std::vector<std::string>{paper.id});
  // It is told when the job is made, not when its sheet is to be cut; its plan is not made yet.
  JobCreate request;
  request.design = bench.add_design("{\"slow\":1}").value().id;
  request.device = "sim:a";
  const auto made = bench.on([&](LiveService& s) { return s.jobs.create(bench.student, request); });
  REQUIRE_FALSE(made);
  CHECK(made.error().errors.at(0).pointer == "/device");
  // Another time it is paper's turn, without a restart.
  bench.on([&](LiveService& s) {
    s.retune({.device_materials = {{"sim:a", {"paper-220"}}, {"sim:b", {"pp-150"}}}});
    return true;
  });
  CHECK(bench.act(paper.id, JobAction::Arm)->device == "sim:a");
}

TEST_CASE("a job for a site is cut only by cutters that stand there", "[daemon][service]") {
  ServiceBench bench({"sim:a", "sim:b"}, false);
  bench.options.fleet.site = "ground floor";
  REQUIRE(bench.start() == "");
  CHECK(bench.on([&](LiveService& s) { return s.devices.find("sim:a")->site; }) == "ground floor");
  const Job anywhere = bench.ready_job();
  JobCreate request;
  request.design = anywhere.design;
  request.site = "upstairs";
  const Job job = create(bench, request).value();
  CHECK(job.site == "upstairs");
  // The cutter may come later; until then the job says that it is not there.
  CHECK_THAT(warnings_json(job.warnings), Catch::Contains("no cutter is at site upstairs"));
  CHECK(job.unaccepted.empty());
  CHECK(queue(bench, "sim:a") == std::vector<std::string>{anywhere.id});
  CHECK(queue(bench).size() == 2);
  const Problem none = bench.act(job.id, JobAction::Arm).error();
  CHECK(none.kind == ProblemKind::DeviceAbsent);
  CHECK_THAT(none.detail,
             Catch::Contains("sim:a: it is at site ground floor; the job is for site upstairs"));
  const Problem refused = bench.act(job.id, {.action = JobAction::Arm, .device = "sim:b"}).error();
  CHECK(refused.kind == ProblemKind::StateConflict);
  CHECK(refused.detail ==
        "sim:b is at site ground floor; the job is for site upstairs; change its site first");
  REQUIRE_FALSE(refused.next_actions.empty());
  CHECK(refused.next_actions.front().action == "change");
  CHECK(http::body_of(refused.next_actions.front()).whole() == R"({"site":"ground floor"})");

  const auto patch = [&](const JobPatch& wanted) {
    return bench.on([&](LiveService& s) {
      return s.jobs.patch(bench.student, job.id, s.jobs.find(job.id)->rev, wanted);
    });
  };
  const Problem at_device = patch({.device = "sim:a"}).error();
  CHECK(at_device.errors.at(0).pointer == "/device");
  REQUIRE(at_device.next_actions.size() == 1);
  CHECK(http::body_of(at_device.next_actions.front()).whole() ==
        R"({"device":"sim:a","site":"ground floor"})");
  CHECK(patch({.site = std::string(257, 'x')}).error().errors.at(0).pointer == "/site");
  CHECK(patch({.site = "a\nb"}).error().errors.at(0).pointer == "/site");
  const auto list = [&](const std::string& site) {
    return bench.on([&](LiveService& s) {
      return s.jobs.list({.site = site}, {200, ""})->items.size();
    });
  };
  CHECK(list("upstairs") == 1);
  CHECK(list("ground floor") == 0);
  REQUIRE(patch({.device = "sim:a", .site = "ground floor"}));
  CHECK(list("ground floor") == 1);
  CHECK(bench.job(job.id).warnings.empty());
  const Problem at_site = patch({.site = "upstairs"}).error();
  CHECK(at_site.errors.at(0).pointer == "/site");
  REQUIRE(at_site.next_actions.size() == 1);
  CHECK(http::body_of(at_site.next_actions.front()).whole() ==
        R"({"device":"","site":"upstairs"})");
  CHECK(queue(bench, "sim:a").size() == 2);
  CHECK(bench.act(job.id, JobAction::Arm)->device == "sim:a");
  CHECK(patch({.site = ""}).error().kind == ProblemKind::StateConflict);

  request.device = "sim:b";
  const Problem contrary = create(bench, request).error();
  CHECK(contrary.kind == ProblemKind::Validation);
  REQUIRE(contrary.errors.size() == 1);
  CHECK(contrary.errors.front().pointer == "/site");
  CHECK_THAT(contrary.errors.front().detail, Catch::Contains("sim:b is at site ground floor"));
}

TEST_CASE("cutters and jobs keep their sites, and cutters that are off move with their node",
          "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.fleet.site = "hall";
  REQUIRE(bench.start() == "");
  const Job made = bench.ready_job();
  const auto patched = bench.on([&](LiveService& s) {
    return s.jobs.patch(bench.student, made.id, made.rev, {.site = "hall"});
  });
  REQUIRE(patched);
  const auto stored = [&] {
    return bench.on([&](LiveService&) {
      return first_of(bench.store().database().rows("SELECT site FROM device"), first_text);
    });
  };
  CHECK(stored() == "hall");
  bench.stop();
  bench.cutters.unplug(bench.device);
  bench.options.fleet.site = "cellar";
  REQUIRE(bench.start() == "");
  CHECK(stored() == "cellar");
  CHECK(bench.job(made.id).site == "hall");
  bench.cutters.plug(bench.device);
  bench.on([](LiveService& s) { s.tick(); });
  const Problem refused = bench.act(made.id, JobAction::Arm).error();
  CHECK_THAT(refused.detail, Catch::Contains("it is at site cellar; the job is for site hall"));
}

TEST_CASE("a job for a site without cutters is planned for those that there are",
          "[daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  CHECK(ready.warnings.empty());
  JobCreate request;
  request.design = ready.design;
  request.site = "upstairs";
  const Job job = create(bench, request).value();
  CHECK(job.plan == ready.plan);
  // A way to plan again leads to where that cutter stands.
  bench.cutters.plug("sim:z", "idle", "cameo4");
  bench.on([](LiveService& s) { s.tick(); });
  const Problem refused = bench.act(job.id, {.action = JobAction::Arm, .device = "sim:z"}).error();
  REQUIRE_FALSE(refused.next_actions.empty());
  CHECK(http::body_of(refused.next_actions.front()).whole() ==
        R"({"device":"sim:z","site":"","plan_again":true})");
}

TEST_CASE("a test cut is armed by a person like any other job", "[daemon][service]") {
  ServiceBench bench;
  const auto test = [&](const std::string& material) {
    return bench.on([&](LiveService& s) {
      return s.devices.act(bench.tutor, bench.device, s.devices.find(bench.device)->rev,
                           {.action = "test-cut", .material = material});
    });
  };
  CHECK(test("papier").error().errors.at(0).pointer == "/material");
  REQUIRE(test("pp-150"));
  const std::string id = queue(bench).at(0);
  CHECK(bench.job(id).material == "pp-150");
  const Job ready = bench.wait_for(id, JobState::Ready);
  CHECK(ready.name == "test cut");
  CHECK(ready.device == bench.device);
  CHECK(bench.planner.last_task().kind == PlanningTask::Kind::TestCut);
  CHECK(bench.cutters.cuts() == 0);
  bench.started(id);
  bench.cutters.complete(bench.device);
  bench.cutters.unplug(bench.device);
  CHECK(test("").error().kind == ProblemKind::DeviceAbsent);
}

TEST_CASE("the queue is paged in its order", "[daemon][service]") {
  ServiceBench bench;
  const Job first = bench.ready_job();
  for (const int priority : {0, 5, -10, 0, 10, 0, -3, 5}) {
    JobCreate request;
    request.design = first.design;
    request.priority = priority;
    REQUIRE(create(bench, request));
  }
  const std::vector<std::string> whole = queue(bench);
  CHECK(whole.size() == 9);
  for (const int limit : {1, 2, 3, 8, 9, 10}) {
    CAPTURE(limit);
    CHECK(queue(bench, "", limit) == whole);
    CHECK(queue(bench, bench.device, limit) == whole);
  }
  for (const char* bad : {"x", "1", "1.2", "1.2.3", "1.2.01JD", ".1.01JD0000000000000000000001",
                          "+1.2.01JD0000000000000000000001", "99999999999.1.x"}) {
    CAPTURE(bad);
    const auto page = bench.on([&](LiveService& s) { return s.jobs.queue("", {10, bad}); });
    REQUIRE_FALSE(page);
    CHECK(page.error().errors.at(0).pointer == "?cursor");
  }
}

TEST_CASE("lists are paged by id and filtered as requested", "[daemon][service]") {
  ServiceBench bench;
  const Job first = bench.ready_job();
  std::vector<std::string> ids{first.id};
  for (int i = 0; i < 24; ++i) ids.push_back(bench.create(first.design)->id);
  for (const std::size_t i : {3u, 9u, 20u}) REQUIRE(bench.act(ids[i], JobAction::Cancel));
  std::vector<std::string> seen;
  std::string cursor;
  do {
    const auto page = bench.on([&](LiveService& s) {
      return s.jobs.list({}, {7, cursor}).value();
    });
    for (const Job& job : page.items) seen.push_back(job.id);
    cursor = page.next_cursor;
    // Removing one does not make another be missed.
    if (seen.size() == 7)
      REQUIRE(bench.on([&](LiveService& s) { return s.jobs.remove(bench.student, ids[3]); }));
  } while (!cursor.empty());
  CHECK(seen == ids);
  const auto all = [&](JobFilter filter, int limit) {
    std::vector<std::string> found;
    std::string at;
    do {
      const auto page = bench.on([&](LiveService& s) {
        return s.jobs.list(filter, {limit, at}).value();
      });
      for (const Job& job : page.items) found.push_back(job.id);
      at = page.next_cursor;
    } while (!at.empty());
    return found;
  };
  // The newest first: the same jobs, turned round, whatever the filter and the pages.
  const std::int64_t middle = bench.job(ids[12]).created;
  for (const JobFilter& filter :
       {JobFilter{}, JobFilter{.states = {JobState::Cancelled, JobState::Ready}},
        JobFilter{.states = {JobState::Cancelled}}, JobFilter{.owner = "uid:2"},
        JobFilter{.since = middle}, JobFilter{.states = {JobState::Ready}, .since = middle}}) {
    std::vector<std::string> oldest_first = all(filter, 5);
    CHECK_FALSE(oldest_first.empty());
    std::reverse(oldest_first.begin(), oldest_first.end());
    JobFilter newest = filter;
    newest.newest_first = true;
    for (const int limit : {1, 3, 12, 200}) CHECK(all(newest, limit) == oldest_first);
  }
  const auto count = [&](const JobFilter& filter) {
    return bench.on([&](LiveService& s) { return s.jobs.list(filter, {200, ""})->items.size(); });
  };
  CHECK(count({.states = {JobState::Cancelled}}) == 2);
  CHECK(count({.states = {JobState::Ready, JobState::Cancelled}}) == 24);
  CHECK(count({.owner = "uid:2"}) == 24);
  CHECK(count({.owner = "uid:9"}) == 0);
  CHECK(count({.device = "sim:cameo3"}) == 0);
  CHECK(count({.since = bench.job(ids[24]).created + 60'000}) == 0);
  CHECK(count({.since = first.created}) == 24);
  CHECK(bench.on([](LiveService& s) {
    return s.jobs.list({}, {10, "' OR 1=1"}).error().kind;
  }) == ProblemKind::Validation);
}

TEST_CASE("a job is found by its own time however slowly the service reads the clock",
          "[daemon][service]") {
  ServiceBench bench{false};
  std::atomic<TimeMs> reading{1'790'000'000'000};
  bench.options.wall_ms = [&reading] { return reading += 5; };
  REQUIRE(bench.start().empty());
  const Job first = bench.ready_job();
  for (const std::string& id : {first.id, bench.create(first.design)->id}) {
    const TimeMs created = bench.job(id).created;
    const auto found = bench.on([&](LiveService& s) {
      return s.jobs.list({.since = created, .newest_first = true}, {200, ""}).value();
    });
    REQUIRE_FALSE(found.items.empty());
    CHECK(found.items.back().id == id);
  }
}

TEST_CASE("only finished jobs can be removed and their usage is kept", "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const Job ready = bench.ready_job();
  const auto remove = [&](const Principal& who) {
    return bench.on([&](LiveService& s) { return s.jobs.remove(who, ready.id); });
  };
  CHECK(remove(bench.student).error().kind == ProblemKind::StateConflict);
  CHECK(bench.on([&](LiveService& s) {
    return s.designs.remove(bench.student, ready.design).error().kind;
  }) == ProblemKind::StateConflict);
  bench.started(ready.id);
  bench.cutters.complete(bench.device);
  CHECK(remove(bench.other_student).error().kind == ProblemKind::Forbidden);
  REQUIRE(remove(bench.student));
  CHECK(remove(bench.student).error().kind == ProblemKind::NotFound);
  CHECK(bench.usage("owner").at(0).sheets == 1);
  REQUIRE(bench.on([&](LiveService& s) { return s.designs.remove(bench.student, ready.design); }));
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/designs"); }));
  CHECK(bench.usage("device", 1, 2).empty());
}

TEST_CASE("planning continues after a crash and finished plans are kept", "[daemon][service]") {
  ServiceBench bench;
  const auto slow = bench.add_design("{\"slow\":1}").value();
  const Job waiting = bench.create(slow.id).value();
  REQUIRE(bench.wait_for(waiting.id, JobState::Planning).state == JobState::Planning);
  bench.crash();
  bench.planner.release();
  REQUIRE(bench.start() == "");
  CHECK(bench.wait_for(waiting.id, JobState::Ready).state == JobState::Ready);
}

TEST_CASE("a failed plan fails its jobs and can be requested again", "[daemon][service]") {
  ServiceBench bench;
  bench.planner.sheets = 0;
  const auto design = bench.add_design("{\"card\":1}").value();
  const Job job = bench.create(design.id).value();
  CHECK(bench.wait_for(job.id, JobState::Failed).reason == "the design contains nothing to cut");
  bench.planner.sheets = 1;
  const Job again = bench.create(design.id).value();
  CHECK(again.plan != job.plan);
  CHECK(bench.wait_for(again.id, JobState::Ready).state == JobState::Ready);
  CHECK(create(bench, {.design = {}, .plan = job.plan}).error().errors.at(0).pointer == "/plan");
  CHECK(create(bench, {.design = {}, .plan = again.plan})->state == JobState::Ready);
}

}  // namespace service_queue_test
