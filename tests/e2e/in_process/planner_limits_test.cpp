// SPDX-License-Identifier: MIT
#include <atomic>
#include <chrono>
#include <csignal>
#include <set>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/devices/make_cutters.hpp"
#include "daemon/planning/program_file.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/planner_bench.hpp"
#include "tests/support/timing.hpp"

namespace planner_limits_test {

using namespace popcut;
using namespace popcut::testing;
using nlohmann::json;
using Kind = PlanningTask::Kind;
using std::chrono::steady_clock;

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

struct Bench {
  TempFolder temp;
  Outcomes outcomes;
  std::unique_ptr<daemon::Planner> planner;
  int count{};

  Bench(const PlanningLimits& limits, const char* program) {
    planner = daemon::make_planner(limits, program);
  }
  [[nodiscard]] PlanningTask task(const std::string& design, Kind kind = Kind::Plan) {
    PlanningTask task;
    task.kind = kind;
    task.design_path = (temp / ("design-" + std::to_string(++count))).string();
    write_file(task.design_path, design);
    return task;
  }
  std::uint64_t start(const std::string& name, PlanningTask task) {
    return planner->start(std::move(task), outcomes.slot(name));
  }
  Result<PlanningOutcome> run(const std::string& design, Kind kind = Kind::Plan) {
    const std::string name = "run " + std::to_string(++count);
    start(name, task(design, kind));
    return outcomes.wait(name);
  }
};

/// Many units: seconds of work, and some memory.
std::string heavy_spec(int units, int slices) {
  return json{{"popcut", 1},
              {"surface", {{"type", "revolution"}, {"radius", "500 - 0.001*y"}}},
              {"units_per_slice", units},
              {"slices", slices},
              {"widths_mm", 20},
              {"min_panel_mm", 0.01}}
      .dump();
}

/// A drawing whose shortest way takes long to look for.
std::string scattered_svg(int lines) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='290mm' height='290mm' "
      "viewBox='0 0 290 290'><path fill='none' stroke='black' d='";
  for (int k = 0; k < lines; ++k)
    svg += "M" + std::to_string(5 + k * 7919 % 280) + "." + std::to_string(k * 31 % 100) + "," +
           std::to_string(5 + k * 104729 % 280) + "l.5,.5";
  return svg + "'/></svg>";
}

}  // namespace

TEST_CASE("a worker has nothing but its pipes and its limits", "[daemon][planner]") {
  PlanningLimits limits;
  limits.cpu_s = 77;
  limits.memory_bytes = std::uint64_t{3} << 30;
  Bench bench(limits, probe_program());
  ::setenv("POPCUT_SECRET", "token", 1);
  const auto outcome = bench.run("surroundings");
  INFO(why(outcome));
  REQUIRE(outcome);
  const std::string text = outcome->files.at(0).bytes;
  INFO(text);
  const auto says = [&](const std::string& line) { return text.find(line) != std::string::npos; };
  CHECK(says("fds: 0 1 2\n"));
  CHECK(says("environment:\n"));
  CHECK(says("cpu: 77\n"));
#if !defined(__SANITIZE_THREAD__)  // whose runtime needs a file
  CHECK(says("fsize: 0\n"));
#endif
  CHECK(says("core: 0\n"));
  CHECK(says("nofile: 16\n"));
  CHECK(says("NoNewPrivs:\t1\n"));
  CHECK(says("SigBlk:\t0000000000000000\n"));
  CHECK(says("SigIgn:\t0000000000000000\n"));
  if (!kSanitized) CHECK(says("as: 3221225472\n"));
}

TEST_CASE("the daemon survives anything that a worker sends and reports it", "[daemon][planner]") {
  PlanningLimits limits;
  limits.output_bytes = 8u << 20;
  limits.cpu_s = 1;
  limits.wall_s = 120;
  Bench bench(limits, probe_program());
  const auto descriptors = open_descriptors();
  const struct {
    const char* design;
    ErrorKind kind;
    const char* part;
  } cases[] = {
      {"garbage", ErrorKind::Internal, "only popcutd sends"},
      {"no head", ErrorKind::Internal, "not the start of a frame"},
      {"path", ErrorKind::Internal, "not a file name"},
      {"twice", ErrorKind::Internal, "two files of one name"},
      {"promise", ErrorKind::Infeasible, "more than the 8388608 bytes"},
      {"flood", ErrorKind::Infeasible, "more than the 8388608 bytes"},
      {"nonsense", ErrorKind::Internal, ""},
      {"deep", ErrorKind::Internal, ""},
      {"dies", ErrorKind::Infeasible, kSanitized ? "the planner" : "last words"},
      {"spins", ErrorKind::Infeasible, "1 s of processor time"},
      {"silence", ErrorKind::Infeasible, "code 5"},
  };
  for (const auto& wrong : cases) {
    CAPTURE(wrong.design);
    const auto outcome = bench.run(wrong.design);
    REQUIRE_FALSE(outcome);
    INFO(message(outcome.error()));
    CHECK(outcome.error().kind == wrong.kind);
    CHECK(outcome.error().detail.find(wrong.part) != std::string::npos);
    for (const char c : outcome.error().detail) CHECK(static_cast<unsigned char>(c) >= 0x20);
  }
  // An answer counts, though its worker has to be killed after it.
  CHECK(bench.run("lingers"));
  CHECK(comes_true([] { return children().empty(); }));
  CHECK(comes_true([&] { return open_descriptors() == descriptors; }));
}

TEST_CASE("a check waits for none of somebody else, however many they ask for",
          "[daemon][planner]") {
  Bench bench(PlanningLimits{}, probe_program());
  const auto check = [&](const std::string& word, const char* who) {
    PlanningTask task = bench.task(word, Kind::Check);
    task.who = who;
    return task;
  };
  for (const char* name : {"hog 1", "hog 2", "hog 3"}) bench.start(name, check("sleeps", "hog"));
  REQUIRE(comes_true([] { return children().size() == 2; }));  // that of plans helps
  for (const char* name : {"ana 1", "ana 2", "ana 3"}) bench.start(name, check("naps", "ana"));
  bench.start("ben", check("naps", "ben"));
  for (const char* name : {"ana 1", "ana 2", "ana 3", "ben"}) CHECK(bench.outcomes.wait(name));
  const std::vector<std::string> order = bench.outcomes.order();
  REQUIRE(order.size() == 4);  // and nothing of the hog
  CHECK((order[0] == "ana 1" && order[1] == "ben"));
}

TEST_CASE("workers that have too much memory together lose one of whoever has most",
          "[daemon][planner]") {
  if (kSanitized) return;
  PlanningLimits limits;
  limits.processes = 3;
  limits.together = std::make_shared<planning::WorkerMemory>(std::uint64_t{400} << 20);
  std::mutex mutex;
  std::vector<std::string> lines;
  limits.report = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    lines.push_back(line);
  };
  Bench bench(limits, probe_program());
  const auto plan = [&](const char* who) {
    PlanningTask task = bench.task("eats");
    task.who = who;
    return task;
  };
  bench.start("ana", plan("ana"));
  bench.start("hog 1", plan("hog"));
  bench.start("hog 2", plan("hog"));
  REQUIRE(comes_true([&] { return bench.outcomes.order().size() == 1; }));
  const std::string ended = bench.outcomes.order().at(0);
  CHECK(ended != "ana");
  const auto outcome = bench.outcomes.wait(ended);
  REQUIRE_FALSE(outcome);
  CHECK(outcome.error().kind == ErrorKind::Infeasible);
  CHECK(outcome.error().detail.find("400 MiB for all designs") != std::string::npos);
  const std::lock_guard lock(mutex);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find("a plan of design-") != std::string::npos);
  CHECK(lines[0].find(" of hog ended") != std::string::npos);
}

TEST_CASE("popcutd logs each worker that crashed", "[daemon][planner]") {
  PlanningLimits limits;
  std::vector<std::string> lines;
  limits.report = [&](const std::string& line) { lines.push_back(line); };
  {
    Bench bench(limits, probe_program());
    PlanningTask task = bench.task("dies", Kind::Check);
    task.who = "uid:7";
    bench.start("one", std::move(task));
    CHECK_FALSE(bench.outcomes.wait("one"));
  }
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find("the worker for a check of design-") == 0);
  CHECK(lines[0].find(" of uid:7 ") != std::string::npos);
  for (const char c : lines[0]) CHECK(static_cast<unsigned char>(c) >= 0x20);
}

TEST_CASE("a worker answers the signal of its processor time's end", "[daemon][planner]") {
  // On a busy computer the kernel, which counts ticks, sends it after 1.5 s of 2: what popcutd
  // measured says nothing, the worker has to.
  PlanningLimits limits;
  limits.wall_s = 60;
  Bench bench(limits, worker_program());
  auto endless = bench.task(scattered_svg(20'000));
  endless.options = {{"order", "best"}, {"effort", "1000"}};
  std::atomic<bool> stop{false};
  std::thread kernel([&] {
    while (!stop) {
      for (const int pid : children()) ::kill(pid, SIGXCPU);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  bench.start("endless", endless);
  const auto outcome = bench.outcomes.wait("endless");
  stop = true;
  kernel.join();
  REQUIRE_FALSE(outcome);
  INFO(message(outcome.error()));
  CHECK(outcome.error().detail.find("600 s of processor time") != std::string::npos);
}

TEST_CASE("a planner that was killed from outside is tried again twice at most",
          "[daemon][planner]") {
  Bench bench(PlanningLimits{}, probe_program());
  // Kills the first few workers; with a namespace of its own a worker takes no weaker signal.
  const auto run_killing = [&](int most) {
    std::atomic<bool> stop{false};
    std::atomic<int> kills{0};
    std::thread killer([&] {
      for (std::set<int> seen; kills < most && !stop;)
        for (const int pid : children())
          if (kills < most && seen.insert(pid).second && ::kill(pid, SIGKILL) == 0) ++kills;
    });
    auto outcome = bench.run("naps");
    stop = true;
    killer.join();
    CHECK(kills == most);
    return outcome;
  };
  const auto third = run_killing(2);
  INFO(why(third));
  CHECK(third);
  // Three times: that is enough, and the answer names the signal and how often.
  const auto never = run_killing(3);
  REQUIRE_FALSE(never);
  CHECK(never.error().kind == ErrorKind::Infeasible);
  CHECK(never.error().detail.find("tried 3 times") != std::string::npos);
  CHECK(never.error().detail.find("signal 9, then 9, then 9") != std::string::npos);
  // A crash of its own is not tried again: it would come again.
  const auto crashed = bench.run("dies");
  REQUIRE_FALSE(crashed);
  CHECK(crashed.error().detail.find("times") == std::string::npos);
  CHECK(comes_true([] { return children().empty(); }));
}

TEST_CASE("a worker that takes too long is killed and the next one works", "[daemon][planner]") {
  PlanningLimits limits;
  limits.wall_s = 0.5;
  Bench bench(limits, probe_program());
  const auto slow = bench.run("sleeps");
  REQUIRE_FALSE(slow);
  CHECK(slow.error().kind == ErrorKind::Infeasible);
  CHECK(slow.error().detail.find("longer than the 0.5 s") != std::string::npos);
  // On a busy machine that one may take too long too.
  CHECK(comes_true([&] { return bench.run("surroundings").has_value(); }));
}

TEST_CASE("a cancelled task ends within a second and leaves nothing behind",
          "[daemon][planner][seconds]") {
  Bench bench({}, probe_program());
  const auto descriptors = open_descriptors();
  bool is_quick = false;
  // A round may meet a machine that is busy otherwise.
  for (int round = 0; !is_quick && round < 10; ++round) {
    const std::string number = std::to_string(round);
    const auto running = bench.start("running" + number, bench.task("sleeps"));
    const auto waiting = bench.start("waiting" + number, bench.task("surroundings"));
    bench.start("third" + number, bench.task("surroundings"));
    REQUIRE(comes_true([] { return children().size() == 1; }));
    const auto begun = steady_clock::now();
    for (const auto& [name, id] : {std::pair{"waiting" + number, waiting},  // though the only
                                   {"running" + number, running}}) {        // process is taken
      bench.planner->cancel(id);
      const auto outcome = bench.outcomes.wait(name);
      REQUIRE_FALSE(outcome);
      CHECK(outcome.error().kind == ErrorKind::Refused);
    }
    is_quick = in_time(begun, 1);
    CHECK(bench.outcomes.wait("third" + number));
    bench.planner->cancel(running);  // it has ended
    bench.planner->cancel(12345);    // it never was
    CHECK(comes_true([] { return children().empty(); }));
    CHECK(comes_true([&] { return open_descriptors() == descriptors; }));
  }
  CHECK(is_quick);
}

TEST_CASE("tasks start in order and never more at once than allowed", "[daemon][planner]") {
  PlanningLimits limits;
  limits.processes = 2;
  Bench bench(limits, probe_program());
  std::atomic<std::size_t> most{0};
  std::atomic<bool> done{false};
  std::thread watch([&] {
    while (!done) {
      most = std::max<std::size_t>(most, children().size());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  for (int k = 0; k < 20; ++k) bench.start("task " + std::to_string(k), bench.task("surroundings"));
  for (int k = 0; k < 20; ++k) CHECK(bench.outcomes.wait("task " + std::to_string(k)));
  done = true;
  watch.join();
  CHECK(most <= 2);
  Bench single({}, probe_program());
  std::vector<std::string> names;
  for (int k = 0; k < 10; ++k) {
    names.push_back("task " + std::to_string(k));
    single.start(names.back(), single.task("surroundings"));
  }
  CHECK(single.outcomes.wait(names.back()));
  CHECK(single.outcomes.order() == names);
}

TEST_CASE("an upload is checked while a long plan runs and others wait", "[daemon][planner]") {
  Bench bench({}, probe_program());
  const auto running = bench.start("running", bench.task("sleeps"));
  const auto waiting = bench.start("waiting", bench.task("sleeps"));
  REQUIRE(comes_true([] { return children().size() == 1; }));
  for (int k = 0; k < 3; ++k) CHECK(bench.run("surroundings", Kind::Check));
  CHECK(bench.outcomes.order().size() == 3);  // neither plan has ended
  // One that hangs holds no plan up, and takes a place of its own only.
  const auto hangs = bench.start("hangs", bench.task("sleeps", Kind::Check));
  const auto behind = bench.start("behind", bench.task("surroundings", Kind::Check));
  REQUIRE(comes_true([] { return children().size() == 2; }));
  bench.planner->cancel(running);
  bench.planner->cancel(waiting);
  CHECK(bench.outcomes.wait("running").error().kind == ErrorKind::Refused);
  CHECK(bench.run("surroundings"));
  CHECK(bench.outcomes.wait("behind"));  // where no plan waits there is more room for checks
  bench.planner->cancel(hangs);
  bench.planner->cancel(behind);
  CHECK(bench.outcomes.wait("hangs").error().kind == ErrorKind::Refused);
}

TEST_CASE("a planner that is destroyed kills running tasks and answers all waiting ones",
          "[daemon][planner]") {
  Outcomes answers;
  {
    Bench bench({}, probe_program());
    bench.planner->start(bench.task("sleeps"), answers.slot("running"));
    bench.planner->start(bench.task("sleeps"), answers.slot("waiting"));
    REQUIRE(comes_true([] { return !children().empty(); }));
    bench.planner.reset();
  }
  CHECK(answers.wait("running").error().kind == ErrorKind::Refused);
  CHECK(answers.wait("waiting").error().kind == ErrorKind::Refused);
  CHECK(children().empty());
}

TEST_CASE("a design that needs too much memory is refused and the next one is planned",
          "[daemon][planner]") {
  if (kSanitized) {
    WARN("skipped: sanitizers need more room than any limit leaves");
    return;
  }
  PlanningLimits limits;
  limits.memory_bytes = std::uint64_t{200} << 20;
  Bench bench(limits, worker_program());
  const auto large = bench.run(heavy_spec(1000, 500));
  REQUIRE_FALSE(large);
  INFO(message(large.error()));
  CHECK(large.error().kind == ErrorKind::Infeasible);
  CHECK(large.error().detail.find("more memory") != std::string::npos);
  CHECK(bench.run(text_of_file(source_file("examples/sphere.json"))));
}

TEST_CASE("hostile designs hit a limit and never affect a running cut", "[daemon][planner]") {
  PlanningLimits limits;
  limits.cpu_s = kSanitized ? 8 : 2;
  limits.wall_s = 240;
  limits.memory_bytes = std::uint64_t{600} << 20;
  limits.output_bytes = 64u << 20;
  Bench bench(limits, worker_program());
  // 1. A cut that takes its time.
  const auto planned = bench.run(text_of_file(source_file("examples/sphere.json")));
  INFO(why(planned));
  REQUIRE(planned);
  auto program = planning::read_program(file_of(*planned, "sheet-01.program.json")->bytes,
                                        file_of(*planned, "sheet-01.gpgl")->bytes);
  REQUIRE(program);
  const std::size_t strokes = program->strokes.size();
  struct Journal final : daemon::CutJournal {
    Result<void> intend(std::int64_t) override { return {}; }
    Result<void> settle(std::int64_t, std::int64_t, std::uint64_t) override { return {}; }
    void progress(const SessionProgress& p) override { strokes_done = p.strokes_done; }
    void ended(const SessionEnd& last) override {
      end = last;
      over = true;
    }
    std::atomic<std::uint64_t> strokes_done{0};
    std::atomic<bool> over{false};
    SessionEnd end;
  };
  const auto journal = std::make_shared<Journal>();
  daemon::CuttersOptions one;
  one.devices = {{.id = "sim:cameo3", .time_scale = 150, .trace = (bench.temp / "trace").string()}};
  one.usb = false;
  auto cutters = daemon::make_cutters(one);
  REQUIRE(cutters);
  REQUIRE((*cutters)->cut({"A", "sim:cameo3", *program, planned->sheets[0].area_mm, 0}, journal));
  // 2. Meanwhile.
  std::string deep_svg = "<svg xmlns='http://www.w3.org/2000/svg'>";
  for (int k = 0; k < 200'000; ++k) deep_svg += "<g>";
  const std::string deep_json = "{\"a\":" + std::string(500'000, '[');
  std::string laughs = "<svg xmlns='http://www.w3.org/2000/svg'><path id='a0' d='M0,0h1'/>";
  for (int k = 1; k < 40; ++k)
    laughs += fmt::format("<g id='a{0}'><use href='#a{1}'/><use href='#a{1}'/></g>", k, k - 1);
  laughs += "<use href='#a39'/></svg>";
  CHECK_FALSE(bench.run(deep_svg, Kind::Check));
  CHECK_FALSE(bench.run(deep_json, Kind::Check));
  CHECK_FALSE(bench.run(laughs, Kind::Check));
  const auto large = bench.run(heavy_spec(2000, 1000));
  REQUIRE_FALSE(large);
  INFO(message(large.error()));
  CHECK(large.error().kind == ErrorKind::Infeasible);
  CHECK(large.error().detail.find("took longer") == std::string::npos);
  auto endless = bench.task(scattered_svg(20'000));
  endless.options = {{"order", "best"}, {"effort", "1000"}};
  bench.start("endless", endless);
  const auto best = bench.outcomes.wait("endless");
  REQUIRE_FALSE(best);
  INFO(message(best.error()));
  CHECK(best.error().detail.find("processor time") != std::string::npos);
  // 3. The cut came through whole.
  REQUIRE(comes_true([&] { return journal->over.load(); }, 240));
  INFO((journal->end.error ? message(*journal->end.error) : ""));
  CHECK_FALSE(journal->end.error);
  CHECK(journal->end.confirmed);
  const json trace = json::parse(text_of_file(bench.temp / "trace/A.json"));
  CHECK(trace["lifts"] == strokes);
  CHECK(trace["unknown_count"] == 0);
  CHECK((*cutters)->alive());
  CHECK(comes_true([] { return children().empty(); }));
}

}  // namespace planner_limits_test
