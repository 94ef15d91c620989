// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include <catch2/catch.hpp>

#include "tests/support/fault_vfs.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/service_bench.hpp"

namespace service_faults_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::FakeCutters;
using popcut::testing::FaultVfs;
using popcut::testing::ServiceBench;

namespace {

namespace fs = std::filesystem;

constexpr int kStrokes = 4;

// What was told to somebody, and so must be true for ever.
struct Promises {
  std::mutex mutex;
  std::vector<std::string> jobs;  ///< answered with 201
  std::vector<FakeCutters::Cut> knife;
  std::set<std::string> done;
};

// One job of one sheet from its design to its end, as far as it goes.
struct Run {
  ServiceBench& bench;
  Promises& promises;
  ProblemKind problem{ProblemKind::Internal};
  std::string id{};
  bool started{false};

  template <typename T>
  bool fine(const Answer<T>& answer) {
    if (answer) return true;
    problem = answer.error().kind;
    return false;
  }
  bool make(const std::string& text) {
    const auto design = bench.add_design(text);
    if (!fine(design)) return false;
    const auto job = bench.create(design->id);
    if (!fine(job)) return false;
    const std::lock_guard lock(promises.mutex);
    promises.jobs.push_back(job->id);
    id = job->id;
    return true;
  }
  // With a fault the plan may never come; without one it does, sooner or later.
  bool begin(bool fault = true) {
    for (int i = 0; bench.job(id).state != JobState::Ready; ++i) {
      if (i > 200) bench.on([](LiveService& service) { service.tick(); });
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (i > (fault ? 300 : 60'000)) return false;
    }
    if (!fine(bench.act(id, JobAction::Arm)) || !fine(bench.act(id, JobAction::Start)))
      return false;
    started = !bench.cutters.busy().empty();
    return started;
  }
  // The cutter goes on as long as its journal is written.
  void cut() {
    std::int64_t certain = -1;
    for (std::int64_t stroke = 0; stroke < kStrokes; ++stroke) {
      if (const auto noted = bench.cutters.intend(bench.device, stroke); !noted) {
        bench.cutters.finish(bench.device, {.error = noted.error(), .certain = certain});
        return;
      }
      {
        const std::lock_guard lock(promises.mutex);
        promises.knife = bench.cutters.knife();
      }
      bench.cutters.settle(bench.device, stroke, stroke);
      certain = stroke;
    }
    bench.cutters.finish(bench.device, {.certain = certain});
    if (bench.job(id).state != JobState::Done) return;
    const std::lock_guard lock(promises.mutex);
    promises.done.insert(id);
  }
};

void all_of_it(ServiceBench& bench, Promises& promises) {
  Run run{bench, promises};
  if (run.make("{\"card\":1}") && run.begin(false)) run.cut();
  Run second{bench, promises};
  if (second.make("{\"card\":2}") && second.begin(false)) second.cut();
}

void prepare(ServiceBench& bench) {
  bench.planner.sheets = 1;
  bench.planner.strokes = kStrokes;
}

// What no fault may ever do.
void check_promises(ServiceBench& bench, const Promises& promises) {
  REQUIRE(bench.check_integrity().value() == "ok");
  for (const std::string& id : promises.jobs)
    REQUIRE(bench.on([&](LiveService& s) { return s.jobs.find(id).has_value(); }));
  for (const std::string& id : promises.done) CHECK(bench.job(id).state == JobState::Done);
  // Each stroke at the knife once for each attempt, and known to be at least in doubt.
  std::set<std::pair<std::string, std::int64_t>> seen;
  for (const FakeCutters::Cut& cut : promises.knife) {
    CHECK(seen.insert({cut.attempt, cut.stroke}).second);
    const std::string job = bench.on([&](LiveService&) {
      Rows rows = bench.store().database().rows(
          "SELECT job FROM attempt WHERE id=? AND started_at IS NOT NULL", cut.attempt);
      return rows.next() ? rows.text(0) : std::string();
    });
    REQUIRE_FALSE(job.empty());
    const Ledger ledger = bench.on([&](LiveService& s) { return s.jobs.ledger(job, 1).value(); });
    for (const PathRange& range : ledger.not_sent)
      CHECK_FALSE((range.first <= cut.stroke && cut.stroke <= range.last));
  }
  for (const std::string& id : promises.jobs) {
    const JobState state = bench.job(id).state;
    CHECK(state != JobState::Cutting);
    CHECK(state != JobState::Paused);
    CHECK(state != JobState::Armed);
  }
}

// Events are numbered without a gap.
void check_events(ServiceBench& bench) {
  std::int64_t before = bench.on([](LiveService& s) { return s.operations.first_event(); }) - 1;
  for (const Event& event :
       bench.on([](LiveService& s) { return s.operations.events(0, 1000, "").value(); })) {
    REQUIRE(event.seq == before + 1);
    before = event.seq;
  }
}

}  // namespace

TEST_CASE("a disk that stays full after any write stops new work but never a running cut",
          "[daemon][faults]") {
  std::uint64_t writes = 0;
  {
    FaultVfs vfs;
    ServiceBench bench(false);
    prepare(bench);
    bench.vfs = vfs.name();
    REQUIRE(bench.start() == "");
    const std::uint64_t before = vfs.writes();
    Promises promises;
    all_of_it(bench, promises);
    REQUIRE(promises.done.size() == 2);
    writes = vfs.writes() - before;
    bench.stop();
  }
  int refused = 0, finished = 0, interrupted = 0;
  // Every third in the suite, with and without the usual reserve; each in ./run soak calls.
  const auto step = static_cast<std::uint64_t>(
      std::getenv("POPCUT_EVERY_CALL") == nullptr ? testing::step_of(3) : 1);
  for (std::uint64_t n = 1; n <= writes; n += step) {
    CAPTURE(n, writes);
    FaultVfs vfs;
    ServiceBench bench(false);
    prepare(bench);
    bench.vfs = vfs.name();
    // The usual reserve is enough for a cut; a small one is not, and the end is recorded later.
    const bool usual = n % 2 == 0;
    if (usual) bench.reserve_bytes = 4u << 20;
    REQUIRE(bench.start() == "");
    vfs.fill_at(vfs.writes() + n, bench.folder() + "/reserve", bench.reserve_bytes);
    Promises promises;
    Run run{bench, promises};
    const bool made = run.make("{\"card\":1}");
    if (!made) CHECK(run.problem == ProblemKind::DiskFull);
    if (made && run.begin()) {
      run.cut();
      if (usual) CHECK(bench.job(run.id).state == JobState::Done);
    } else if (made) {
      CHECK(bench.cutters.busy().empty());
    }
    // Reading goes on, and new work is refused in words.
    CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {}).has_value(); }));
    Run late{bench, promises};
    if (!late.make("{\"card\":2}")) {
      CHECK(late.problem == ProblemKind::DiskFull);
      ++refused;
    }
    // There is room again: no restart is needed.
    vfs.heal();
    bench.on([](LiveService& s) { s.tick(); });
    CHECK(bench.on([](LiveService& s) { return s.operations.health().accepts_work; }));
    if (run.started) {
      const JobState end = bench.job(run.id).state;
      CHECK((end == JobState::Done || end == JobState::Interrupted));
      ++(end == JobState::Done ? finished : interrupted);
    }
    // A sheet that was armed but could not be started is taken out of the device.
    if (made && bench.job(run.id).state == JobState::Armed)
      REQUIRE(bench.act(run.id, JobAction::Disarm));
    Run again{bench, promises};
    REQUIRE(again.make("{\"card\":3}"));
    REQUIRE(again.begin(false));
    again.cut();
    CHECK(bench.job(again.id).state == JobState::Done);
    check_promises(bench, promises);
    check_events(bench);
    bench.stop();
    REQUIRE(bench.start() == "");
    check_promises(bench, promises);
  }
  WARN(writes << " writes; refused " << refused << ", cuts finished " << finished
              << ", interrupted " << interrupted);
  CHECK(refused > 0);
  CHECK(finished > 0);
}

TEST_CASE("a pause that begins when the disk is full is recorded with the reserve",
          "[daemon][faults]") {
  FaultVfs vfs;
  ServiceBench bench(false);
  prepare(bench);
  bench.vfs = vfs.name();
  bench.reserve_bytes = 4u << 20;
  REQUIRE(bench.start() == "");
  bench.on([](LiveService& s) { s.tick(); });  // so that no other write finds the disk full
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.act(ready.id, JobAction::Pause));
  vfs.fill_at(vfs.writes() + 1, bench.folder() + "/reserve", bench.reserve_bytes);
  bench.cutters.progress(bench.device, {.phase = SessionPhase::Held});
  CHECK(bench.job(ready.id).state == JobState::Paused);
  vfs.heal();
  CHECK(bench.act(ready.id, JobAction::Resume)->state == JobState::Cutting);
  bench.cutters.complete(bench.device);
  CHECK(bench.job(ready.id).state == JobState::Done);
}

TEST_CASE("after a failed sync or write nothing is written until a restart", "[daemon][faults]") {
  std::uint64_t syncs = 0, writes = 0;
  {
    FaultVfs vfs;
    ServiceBench bench(false);
    prepare(bench);
    bench.vfs = vfs.name();
    REQUIRE(bench.start() == "");
    const auto before = std::pair(vfs.syncs(), vfs.writes());
    Promises promises;
    Run run{bench, promises};
    REQUIRE(run.make("{\"card\":1}"));
    REQUIRE(run.begin(false));
    run.cut();
    bench.on([&](LiveService&) { bench.store().file()->checkpoint(false); });
    syncs = vfs.syncs() - before.first;
    writes = vfs.writes() - before.second;
  }
  for (const bool by_sync : {true, false}) {
    for (std::uint64_t n = 1; n <= (by_sync ? syncs : writes);
         n += static_cast<std::uint64_t>(testing::step_of(by_sync ? 1 : 3))) {
      CAPTURE(by_sync, n, syncs, writes);
      FaultVfs vfs;
      ServiceBench bench(false);
      prepare(bench);
      bench.vfs = vfs.name();
      REQUIRE(bench.start() == "");
      if (by_sync)
        vfs.fail_sync_at(vfs.syncs() + n);
      else
        vfs.fail_write_at(vfs.writes() + n);
      Promises promises;
      Run run{bench, promises};
      if (run.make("{\"card\":1}") && run.begin()) run.cut();
      bench.on([&](LiveService& service) {
        // The log is moved in the tick; here at once.
        try {
          if (service.operations.health().database) bench.store().file()->checkpoint(false);
        } catch (const StoreFault&) {
          bench.store().give_up();
        }
        service.tick();
      });
      const bool degraded =
          !bench.on([](LiveService& s) { return s.operations.health().database; });
      if (degraded) {
        CHECK(vfs.writes_after_failure() == 0);
        Run late{bench, promises};
        CHECK_FALSE(late.make("{\"card\":2}"));
        CHECK(late.problem == ProblemKind::Unavailable);
        CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {}).has_value(); }));
        CHECK_FALSE(bench.on([](LiveService& s) { return s.operations.health().accepts_work; }));
      }
      // Whoever has the knife was told to stop, or has ended.
      for (const std::string& device : bench.cutters.busy()) {
        CHECK(bench.cutters.cancels() > 0);
        bench.cutters.finish(device, {.cancelled = true});
      }
      bench.crash();
      vfs.heal();
      REQUIRE(bench.start() == "");
      check_promises(bench, promises);
    }
  }
}

TEST_CASE("a power cut at any write loses nothing that was confirmed", "[daemon][faults]") {
  struct Cut {
    FaultVfs::Images images;
    std::string witness;
    std::vector<std::string> jobs;
    std::vector<FakeCutters::Cut> knife;
    std::set<std::string> done;
  };
  std::vector<Cut> cuts;
  FaultVfs vfs;
  ServiceBench bench(false);
  prepare(bench);
  bench.vfs = vfs.name();
  REQUIRE(bench.start() == "");
  std::mt19937 random(20261121);
  Promises promises;
  std::atomic<bool> over{false};  // the service's threads still write while this one goes on
  vfs.after_each = [&] {
    if (over) return;
    for (const double kept : {0.0, 0.5, 1.0}) {
      // The bytes of a file that is not synced may be there all the same; take some of each.
      if (kept != 0.0 && random() % 4 != 0) continue;
      const std::lock_guard lock(promises.mutex);
      cuts.push_back({vfs.power_cut(random, kept),
                      read_whole(bench.folder() + "/witness", 100).value_or(""), promises.jobs,
                      promises.knife, promises.done});
    }
  };
  all_of_it(bench, promises);
  bench.on([&](LiveService&) { bench.store().file()->checkpoint(false); });
  REQUIRE(promises.done.size() == 2);
  over = true;

  // What is not the database: files are synced before the database speaks of them.
  popcut::testing::TempFolder scratch{popcut::testing::TempFolder::Place::Memory};
  const std::string original = (scratch / "original").string();
  bench.crash();
  vfs.after_each = nullptr;
  fs::copy(bench.folder(), original, fs::copy_options::recursive);
  std::shuffle(cuts.begin(), cuts.end(), random);
  const auto most = static_cast<std::size_t>(testing::rounds(150));
  if (cuts.size() > most) cuts.resize(most);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    CAPTURE(i);
    ServiceBench after(false);
    prepare(after);
    fs::remove_all(after.folder());
    fs::copy(original, after.folder(), fs::copy_options::recursive);
    for (const auto& [path, bytes] : cuts[i].images) {
      const std::string name = fs::path(path).filename().string();
      if (name == "popcut.db" || name == "popcut.db-wal")
        popcut::testing::write_text(after.folder() + "/" + name, bytes);
    }
    popcut::testing::write_text(after.folder() + "/witness", cuts[i].witness);
    REQUIRE(after.start() == "");
    Promises kept;
    kept.jobs = cuts[i].jobs;
    kept.knife = cuts[i].knife;
    kept.done = cuts[i].done;
    check_promises(after, kept);
    check_events(after);
    CHECK(after.cutters.cuts() == 0);
  }
  WARN(cuts.size() << " power cuts");
}

}  // namespace service_faults_test
