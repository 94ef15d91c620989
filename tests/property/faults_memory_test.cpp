// SPDX-License-Identifier: MIT
// Memory that fails on the thread of the service, and on that of a cutter while it cuts: each
// allocation in turn. What SQLite takes for itself is not among them.
#include <cstdlib>
#include <new>

#include <catch2/catch.hpp>

#include "daemon/devices/make_cutters.hpp"
#include "daemon/store/sqlite_database.hpp"
#include "tests/support/process.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/support/sim_bench.hpp"

namespace {

// The number of allocations of this thread until one fails, and so many after it; below zero: none.
thread_local long allocations_left = -1;
thread_local long failing = 1;
thread_local std::size_t least_bytes = 1;

bool fails(std::size_t size) {
  if (allocations_left < 0 || size < least_bytes) return false;
  if (allocations_left > 0) {
    --allocations_left;
    return false;
  }
  if (--failing <= 0) allocations_left = -1;
  return true;
}

}  // namespace

void* operator new(std::size_t size) {
  if (fails(size)) throw std::bad_alloc();
  void* const memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
// Both forms: the sanitizers' own would not match the deletes below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return fails(size) ? nullptr : std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using testing::TempFolder;

namespace {

void arm_faults(long at, long count, std::size_t least = 1) {
  failing = count;
  least_bytes = least;
  allocations_left = at;
}
/// Whether one failed.
bool disarm_faults() {
  const bool failed = allocations_left < 0;
  allocations_left = -1;
  return failed;
}

/// Runs `ask` on the service's thread with the n-th allocation failing; true if one did.
template <typename Ask>
bool ask_without_memory(ServiceBench& bench, long n, const Ask& ask, std::size_t least = 1) {
  return bench.on([&](LiveService& service) {
    arm_faults(n, 1, least);
    try {
      ask(service);
    } catch (const std::exception&) {
      // As in the server, which answers 503 then.
    }
    return disarm_faults();
  });
}

void check_service(ServiceBench& bench, const std::string& id) {
  const Job job = bench.job(id);
  // A knife has the job if and only if the job says so.
  const bool at_knife = job.state == JobState::Cutting || job.state == JobState::Paused;
  CHECK(at_knife == !bench.cutters.busy().empty());
}

}  // namespace

TEST_CASE("a failed allocation in a statement leaves no connection to the database behind",
          "[daemon][memory][faults]") {
  const TempFolder folder;
  const SqliteDatabase::Options options{.path = folder / "popcut.db"};
  long n = 0;
  for (bool failed = true; failed && n < 5000; ++n) {
    CAPTURE(n);
    arm_faults(n, 1);
    try {
      SqliteDatabase database(options);
      (void)database.number("SELECT count(*) FROM sqlite_schema");
    } catch (const std::exception&) {
      // Opened or asked without memory.
    }
    failed = disarm_faults();
    // One that is left behind locks the file.
    SqliteDatabase again(options);
    CHECK(again.number("SELECT 1") == 1);
  }
  CHECK(n > 5);
  CHECK(n < 5000);
}

TEST_CASE("a failed allocation in the service never loses a job or leaves a knife without one",
          "[daemon][memory][faults]") {
  struct Step {
    const char* name;
    JobAction action;
    std::vector<JobAction> before;
  };
  const std::vector<Step> steps{
      {"arm", JobAction::Arm, {}},
      {"start", JobAction::Start, {JobAction::Arm}},
      {"pause", JobAction::Pause, {JobAction::Arm, JobAction::Start}},
      {"cancel", JobAction::Cancel, {JobAction::Arm, JobAction::Start}},
  };
  for (const Step& step : steps) {
    CAPTURE(step.name);
    ServiceBench bench;
    bench.planner.sheets = 1;
    const auto design = bench.add_design("{\"card\":1}").value();
    bool failed = true;
    long n = 0;
    for (; failed && n < 5000; ++n) {
      CAPTURE(n);
      const std::string id = bench.create(design.id).value().id;
      REQUIRE(bench.wait_for(id, JobState::Ready).state == JobState::Ready);
      for (const JobAction action : step.before) REQUIRE(bench.act(id, action));
      const Job job = bench.job(id);
      failed = ask_without_memory(bench, n, [&](LiveService& service) {
        ActionRequest request{.action = step.action};
        request.sheet = 1;
        (void)service.cutting.act(bench.tutor, id, job.rev, request);
      });
      bench.on([](LiveService& service) { service.tick(); });
      check_service(bench, id);
      // Asked again it is done, or it was done before.
      if (const Job now = bench.job(id); now.rev == job.rev) CHECK(bench.act(id, step.action));
      for (const std::string& device : bench.cutters.busy())
        bench.cutters.finish(device, {.cancelled = true});
      (void)bench.act(id, JobAction::Cancel);
      const JobState end = bench.job(id).state;
      CHECK((end == JobState::Cancelled || end == JobState::Interrupted));
      if (end == JobState::Interrupted) (void)bench.act(id, JobAction::Cancel);
    }
    CHECK_FALSE(failed);
    CHECK(n > 10);
    CHECK(bench.check_integrity().value() == "ok");
  }
  // Making a job, twice with the same key: one job, or none and then one.
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  bool failed = true;
  std::size_t jobs = 0;
  for (long n = 0; failed && n < 5000; ++n) {
    CAPTURE(n);
    const auto make = [&](LiveService& service) {
      JobCreate request;
      request.design = design.id;
      (void)service.operations.once(
          bench.student, {"a-key-of-sixteen-" + std::to_string(n), "digest"}, [&] {
            const auto job = service.jobs.create(bench.student, request);
            return Rendered{.status = job ? 201 : 503, .body = job ? job->id : ""};
          });
    };
    // Small pieces are let through: nlohmann 3.11 takes some where nothing may be thrown.
    failed = ask_without_memory(bench, n, make, 100);
    bench.on(make);
    ++jobs;
    CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {.limit = 200})->items.size(); }) ==
          jobs);
  }
  CHECK_FALSE(failed);
}

namespace {

/// Written on the cutter's thread, where it lets memory fail after its first stroke.
class FailingJournal final : public CutJournal {
 public:
  FailingJournal(long at, long count) : at_(at), count_(count) {}
  Result<void> intend(std::int64_t last) override {
    intended = last;
    if (!armed_) arm_faults(at_, count_);
    armed_ = true;
    return {};
  }
  Result<void> settle(std::int64_t, std::int64_t, std::uint64_t) override { return {}; }
  void progress(const SessionProgress&) override {}
  void ended(const SessionEnd& last) override {
    if (armed_ && disarm_faults()) failed = true;
    error = last.error.has_value();
    fates = last.fates;
    ++ends;
  }
  std::atomic<std::int64_t> intended{-1};
  std::atomic<int> ends{0};
  std::atomic<bool> failed{false};
  std::vector<StrokeFate> fates;
  bool error{false};

 private:
  long at_, count_;
  bool armed_{false};
};

}  // namespace

TEST_CASE("a failed allocation at the cutter never ends popcutd or falsifies the ledger",
          "[daemon][memory][faults]") {
  std::mt19937 random(5);
  const Material paper = testing::value(find_material("paper-220"));
  const Toolpath path = testing::random_toolpath(random, 60, 190, paper);
  JobOptions job;
  job.page_length_mm = 300;
  const Machine cameo = testing::machine("cameo3");
  const EncodedProgram program = testing::value(encode(path, cameo, paper, job));
  bool failed = true;
  int broken = 0;
  for (const long count : {1L, 3L, 20L}) {
    long step = 1;
    failed = true;
    for (long n = 0; failed && n < 400'000; n += step, step += n / 40) {
      CAPTURE(n, count);
      TempFolder temp;
      CuttersOptions options;
      options.devices = {{.id = "sim:cameo3", .time_scale = 0, .trace = (temp / "trace").string()}};
      options.usb = false;
      auto cutters = testing::value(make_cutters(std::move(options)));
      const auto journal = std::make_shared<FailingJournal>(n, count);
      REQUIRE(cutters->cut({"A1", "sim:cameo3", program, {304.8, 300}, 0}, journal));
      for (int i = 0; i < 60'000 && journal->ends == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      REQUIRE(journal->ends == 1);
      failed = journal->failed;
      REQUIRE(journal->fates.size() == program.strokes.size());
      if (journal->error) ++broken;
      // What came down on the sheet is certain or in doubt.
      const auto log = testing::received_log(temp / "trace/received.log");
      REQUIRE_FALSE(log.empty());
      std::size_t cut = testing::places_cut(log.back().bytes, cameo).size(), sent = 0;
      for (const StrokeFate fate : journal->fates) sent += fate != StrokeFate::NotSent ? 1 : 0;
      CHECK(cut <= sent);
      for (std::size_t k = static_cast<std::size_t>(journal->intended + 1);
           k < journal->fates.size(); ++k)
        CHECK(journal->fates[k] == StrokeFate::NotSent);
      // It cuts again.
      const auto again = std::make_shared<FailingJournal>(10'000'000, 1);
      if (n % 5 == 0 && cutters->cut({"A2", "sim:cameo3", program, {304.8, 300}, 0}, again)) {
        for (int i = 0; i < 60'000 && again->ends == 0; ++i)
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK_FALSE(again->error);
      }
    }
    CHECK_FALSE(failed);
  }
  CHECK(broken > 3);
}
