// SPDX-License-Identifier: MIT
// What a page shows of a job: names of people, how long it is armed, how far the knife probably is.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/service_bench.hpp"

namespace service_view_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::broken;
using popcut::testing::ServiceBench;
using popcut::testing::shown;

namespace {

class Heard : public ServiceBench {
 public:
  Heard() : ServiceBench(false) {
    options.user_name = [this](uid_t user) {
      ++looked_up;
      return user == 2 ? std::string("ben") : std::string();
    };
    REQUIRE(start().empty());
    on([this](LiveService& s) {
      s.operations.listen([this](const Event& event) {
        if (event.kind == "progress") told.push_back(event.data);
      });
    });
  }
  void tick_after(std::int64_t ms) {
    monotonic_skew_ms += ms;
    on([](LiveService& s) { s.tick(); });
  }
  int looked_up{0};
  std::vector<std::string> told;
};

}  // namespace

TEST_CASE("a job names its people as people do", "[alone][daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  CHECK(ready.owner == "uid:2");
  CHECK(ready.owner_title == "ben");
  CHECK(ready.operator_title.empty());
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  CHECK(shown(bench, ready).operator_title == "uid:4");  // a user without a login name
  const int before = bench.looked_up;
  for (int i = 0; i < 10; ++i) (void)bench.job(ready.id);
  CHECK(bench.looked_up == before);  // the list of users may be on another computer
  const NewToken lab = bench.on([&](LiveService& s) {
    return s.access.create_token(bench.admin, "<b>Ana's \"tablet\"</b>", Role::Submitter, {})
        .value();
  });
  const std::string principal = "token:" + lab.record.id;
  const auto title = [&](const std::string& name) {
    return bench.on([&](LiveService& s) { return s.access.title_of(name); });
  };
  CHECK(title(principal) == "<b>Ana's \"tablet\"</b>");
  CHECK(title("").empty());
  for (const char* odd : {"token:", "uid:", "uid:x", "uid:99999999999", "token:' OR 1=1", "else"})
    CHECK(title(odd) == odd);
  // Whose token was deleted is known until popcutd restarts, and by its id from then on.
  REQUIRE(
      bench.on([&](LiveService& s) { return s.access.delete_token(bench.admin, lab.record.id); }));
  CHECK(title(principal) == "<b>Ana's \"tablet\"</b>");
  bench.stop();
  REQUIRE(bench.start().empty());
  CHECK(title(principal) == principal);
}

TEST_CASE("an armed job tells until when", "[daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  CHECK_FALSE(ready.armed_until);
  const TimeMs before = bench.options.wall_ms();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  const Job armed = shown(bench, ready);
  REQUIRE(armed.armed_until);
  CHECK(*armed.armed_until >= before + bench.options.arm_s * 1000);
  CHECK(*armed.armed_until <= bench.options.wall_ms() + bench.options.arm_s * 1000);
  CHECK(shown(bench, ready).armed_until == armed.armed_until);
  bench.tick_after(bench.options.arm_s * 1000 + 1);
  CHECK(shown(bench, ready).state == JobState::Ready);
  CHECK_FALSE(shown(bench, ready).armed_until);
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  REQUIRE(bench.act(ready.id, JobAction::Start));
  CHECK_FALSE(shown(bench, ready).armed_until);
}

TEST_CASE("a job tells which strokes are probably cut", "[daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  CHECK(ready.progress.paths_done == 0);
  bench.started(ready.id);
  REQUIRE(bench.cutters.intend(bench.device, 3));
  bench.cutters.progress(
      bench.device,
      {.phase = SessionPhase::Cutting, .strokes_done = 3, .strokes = 5, .seconds_left = 4});
  REQUIRE(bench.wait([&] { return shown(bench, ready).progress.paths_done == 3; }));
  CHECK(shown(bench, ready).progress.paths_certain == 0);
  // What is certain is done, whatever the model says.
  bench.cutters.settle(bench.device, 3, 3);
  bench.cutters.progress(
      bench.device,
      {.phase = SessionPhase::Cutting, .strokes_done = 2, .strokes = 5, .seconds_left = 4});
  REQUIRE(bench.wait([&] { return shown(bench, ready).progress.paths_certain == 4; }));
  CHECK(shown(bench, ready).progress.paths_done == 4);
  bench.cutters.complete(bench.device);
  const Job next = shown(bench, ready);
  CHECK(next.progress.paths_done == next.progress.paths_certain);
  const Job torn = broken(bench);
  CHECK(torn.progress.paths_done == torn.progress.paths_certain);
}

TEST_CASE("while a sheet is cut popcutd sends its progress at least every two seconds",
          "[daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  bench.tick_after(5000);
  CHECK(bench.told.empty());  // nothing is known yet
  bench.cutters.progress(
      bench.device,
      {.phase = SessionPhase::Cutting, .strokes_done = 1, .strokes = 5, .seconds_left = 4});
  bench.on([](LiveService&) {});
  REQUIRE(
      bench.wait([&] { return bench.on([&](LiveService&) { return bench.told.size(); }) == 1; }));
  bench.tick_after(500);
  CHECK(bench.told.size() == 1);
  for (std::size_t times = 2; times < 6; ++times) {
    bench.tick_after(1000);
    REQUIRE(bench.told.size() == times);
  }
  const auto last = nlohmann::json::parse(bench.told.back());
  CHECK(last.at("job") == ready.id);
  CHECK(last.at("paths_done") == 1);
  CHECK(last.at("paths") == 5);
  CHECK(last.at("state") == "cutting");
  const auto left = last.at("remaining_s");
  REQUIRE(left.size() == 2);
  CHECK(left[0].get<double>() > 0);
  CHECK(left[0].get<double>() <= left[1].get<double>());
  bench.cutters.complete(bench.device);
  bench.told.clear();
  bench.tick_after(5000);
  CHECK(bench.told.empty());
}

TEST_CASE("a job says whether it is a test cut, and a brief answer has no ways",
          "[daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  CHECK(ready.kind == "job");
  const auto device = bench.on([&](LiveService& s) {
    const auto now = s.devices.find(bench.device).value();
    return s.devices.act(bench.tutor, bench.device, now.rev, {.action = "test-cut", .material = {}})
        .value();
  });
  CHECK(bench.job(device.test_job).kind == "test-cut");
  const Job torn = broken(bench);
  CHECK_FALSE(torn.next_actions.empty());
  const auto brief = [&](const std::string& id) {
    return bench.on([&](LiveService& s) { return s.jobs.brief(id); });
  };
  CHECK(brief(torn.id)->next_actions.empty());
  CHECK(brief(torn.id)->rev == torn.rev);
  CHECK(brief("01JD0000000000000000000000").error().kind == ProblemKind::NotFound);
}

TEST_CASE("the machines that sheets can be planned for include those of users' tables",
          "[daemon][service][view]") {
  ServiceBench bench(false);
  bench.options.tables = {R"({"popcut": 1, "machines": [{"name": "old-cameo", "like": "cameo3",
                                            "title": "the old one", "source": "me"}]})"};
  REQUIRE(bench.start().empty());
  const auto machines = bench.on([](LiveService& s) { return s.plans.machines(); }).value();
  const auto has = [&](const std::string& name) {
    return std::any_of(machines.begin(), machines.end(),
                       [&](const Machine& machine) { return machine.name == name; });
  };
  CHECK(has("old-cameo"));
  CHECK(has("cameo3"));
  CHECK(has("none"));
}

TEST_CASE("until when a job is armed follows a clock that was put right",
          "[daemon][service][view]") {
  Heard bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.skew_ms += 3'600'000;
  const Job armed = shown(bench, ready);
  REQUIRE(armed.armed_until);
  CHECK(*armed.armed_until > bench.options.wall_ms());
  CHECK(*armed.armed_until <= bench.options.wall_ms() + bench.options.arm_s * 1000);
}

}  // namespace service_view_test
