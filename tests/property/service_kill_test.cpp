// SPDX-License-Identifier: MIT
// popcutd's service dies, or its disk fails, at every call that changes a file: at its start, its
// end, in a cut, in a backup, a restore.
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/store/integrity.hpp"
#include "daemon/store/restore.hpp"
#include "daemon/store/salvage.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/support/traced_child.hpp"

namespace service_kill_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::test::ScratchFolder;
using popcut::test::ServiceBench;
using popcut::test::write_text;
using popcut::testing::CallFate;
using popcut::testing::ChildEnd;
using popcut::testing::count_calls_from_here;
using popcut::testing::run_with_fate;

namespace {

namespace fs = std::filesystem;

constexpr int kStrokes = 3;

/// What the child was told or told somebody, and so must be true when it is dead.
struct Told {
  std::atomic<int> jobs;
  std::array<std::array<char, 32>, 16> ids;
  std::atomic<int> strokes;  ///< of the first job's sheet: at the knife
  std::atomic<int> done;     ///< the first job was said to be done
};

class Shared {
 public:
  Shared()
      : told_(static_cast<Told*>(::mmap(nullptr, sizeof(Told), PROT_READ | PROT_WRITE,
                                        MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~Shared() { ::munmap(told_, sizeof(Told)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  Told* operator->() { return told_; }
  Told& operator*() { return *told_; }

 private:
  Told* told_;
};

void note_job(Told& told, const std::string& id) {
  std::strncpy(told.ids.at(static_cast<std::size_t>(told.jobs)).data(), id.c_str(), 31);
  ++told.jobs;
}

void prepare(ServiceBench& bench) {
  bench.planner.sheets = 1;
  bench.planner.strokes = kStrokes;
}

/// A state folder to begin from, and the jobs that are in it.
struct Folder {
  std::string path;
  std::vector<std::string> jobs;  ///< ready; the last is done
};

/// One folder that was closed in order, one whose popcutd was killed while it cut.
class Folders {
 public:
  Folders() {
    ServiceBench bench(false);
    prepare(bench);
    REQUIRE(bench.start() == "");
    const std::string first = bench.ready_job("{\"card\":1}").id;
    const std::string second = bench.ready_job("{\"card\":2}").id;
    bench.started(second);
    bench.cutters.complete(bench.device);
    REQUIRE(bench.job(second).state == JobState::Done);
    bench.stop();
    closed = {scratch_.path() + "/closed", {first, second}};
    fs::copy(bench.folder(), closed.path, fs::copy_options::recursive);
    REQUIRE(bench.start() == "");
    bench.started(first);
    REQUIRE(bench.cutters.intend(bench.device, 1));
    bench.crash();
    killed = {scratch_.path() + "/killed", {first, second}};
    fs::copy(bench.folder(), killed.path, fs::copy_options::recursive);
  }
  Folder closed, killed, none;

 private:
  ScratchFolder scratch_;
};

Folders& folders() {
  static Folders all;
  return all;
}

using Work = std::function<int(ServiceBench&, Told&)>;

bool holds(const std::vector<PathRange>& ranges, std::int64_t stroke) {
  return std::any_of(ranges.begin(), ranges.end(), [&](const PathRange& range) {
    return range.first <= stroke && stroke <= range.last;
  });
}

/// The next popcutd, and what it must know.
void check_promises(ServiceBench& bench, const Folder& folder, Told& told) {
  REQUIRE(bench.start() == "");
  std::vector<std::string> jobs = folder.jobs;
  for (int i = 0; i < told.jobs; ++i)
    jobs.emplace_back(told.ids.at(static_cast<std::size_t>(i)).data());
  for (const std::string& id : jobs) {
    CAPTURE(id);
    REQUIRE(bench.on([&](LiveService& s) { return s.jobs.find(id).has_value(); }));
    const JobState state = bench.job(id).state;
    CHECK(state != JobState::Armed);
    CHECK(state != JobState::Cutting);
    CHECK(state != JobState::Paused);
  }
  if (!folder.jobs.empty()) {
    CHECK(bench.job(folder.jobs.back()).state == JobState::Done);
    if (told.done != 0) CHECK(bench.job(folder.jobs.front()).state == JobState::Done);
    const Ledger ledger =
        bench.on([&](LiveService& s) { return s.jobs.ledger(folder.jobs.front(), 1).value(); });
    for (int stroke = 0; stroke < told.strokes; ++stroke) {
      CAPTURE(stroke);
      CHECK_FALSE(holds(ledger.not_sent, stroke));
    }
  }
  CHECK(bench.cutters.cuts() == 0);
  CHECK(bench.check_integrity().value() == "ok");
  bench.stop();
}

/// In the suite not all writes to one file in a row, in a soak each call.
bool every_call() { return std::getenv("POPCUT_EVERY_CALL") != nullptr; }

/// The calls that are chosen: all but some of the writes that stand between others of their kind.
/// With fewer rounds every fourth one of these, and more of them where there are few.
std::vector<int> chosen(const std::vector<std::string>& calls) {
  constexpr std::size_t kOf = 20, kLeast = 12;
  const auto repeated = [&](std::size_t i) {
    return calls[i] == "pwrite" && i > 0 && i + 1 < calls.size() && calls[i - 1] == "pwrite" &&
           calls[i + 1] == "pwrite";
  };
  std::vector<int> of_note, all;
  for (std::size_t i = 0; i < calls.size(); ++i)
    if (!repeated(i)) of_note.push_back(static_cast<int>(i) + 1);
  const std::size_t apart = std::clamp<std::size_t>(
      of_note.size() / kLeast, 1, static_cast<std::size_t>(testing::step_of(1, 4)));
  for (std::size_t i = 0; i < calls.size(); ++i)
    if (every_call() || i % kOf == 0) all.push_back(static_cast<int>(i) + 1);
  for (std::size_t k = 0; k < of_note.size(); k += apart) all.push_back(of_note[k]);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

const char* name_of_fate(CallFate fate) {
  return fate == CallFate::Dies ? "killed" : fate == CallFate::NoRoom ? "ENOSPC" : "EIO";
}

/// Lets each fate befall each call of `work`, which counts from where it says so; each in a folder
/// of its own. `mend` is what a person does before the next start.
void at_every_call(const char* what, const Folder& from, const Work& work,
                   const std::function<void(ServiceBench&)>& mend = {}) {
  const bool rare = static_cast<bool>(mend);  // no part of a day's work
  const ScratchFolder scratch;
  const std::string place = scratch.path() + "/state";
  const auto run = [&](int number, CallFate fate) {
    fs::remove_all(place);
    if (!from.path.empty()) fs::copy(from.path, place, fs::copy_options::recursive);
    Shared told;
    const ChildEnd end = run_with_fate(number, fate, [&] {
      ServiceBench bench(false);
      bench.place = place;
      prepare(bench);
      return work(bench, *told);
    });
    const std::string call = end.chosen ? end.calls.back() : "none";
    CAPTURE(what, number, name_of_fate(fate), call, end.code);
    if (end.chosen && fate == CallFate::Dies) REQUIRE(end.code == 128 + SIGKILL);
    if (!end.chosen) REQUIRE(end.code == 0);
    ServiceBench bench(false);
    bench.place = place;
    prepare(bench);
    if (mend) mend(bench);
    check_promises(bench, from, *told);
    return end;
  };
  const std::vector<std::string> calls = run(0, CallFate::Dies).calls;
  const std::vector<int> numbers = chosen(calls);
  CHECK(numbers.size() > 5);
  for (const CallFate fate : {CallFate::Dies, CallFate::NoRoom, CallFate::BadDisk})
    for (const int number : numbers)
      // Who dies can do so anywhere; of calls that fail some tell the same.
      if (fate == CallFate::Dies || every_call() || (!rare && number % 5 == 0))
        (void)run(number, fate);
  std::map<std::string, int> counts;
  for (const std::string& call : calls) ++counts[call];
  std::string text;
  for (const auto& [name, count] : counts) text += fmt::format(" {} {}", count, name);
  std::printf("%s: %zu calls (%s), of these tried %zu\n", what, calls.size(),
              text.c_str() + (text.empty() ? 0 : 1), numbers.size());
}

int start_only(ServiceBench& bench, Told&) {
  count_calls_from_here();
  (void)bench.start();
  return 0;
}

/// As popcutd ends.
void end_in_order(ServiceBench& bench) {
  bench.on([](LiveService& service) { service.stopping(); });
  bench.cutters.stop_all(1);
  bench.stop();
}

int end_idle(ServiceBench& bench, Told& told) {
  if (!bench.start().empty()) return 1;
  note_job(told, bench.ready_job("{\"card\":3}").id);
  count_calls_from_here();
  end_in_order(bench);
  return 0;
}

int end_cutting(ServiceBench& bench, Told& told) {
  if (!bench.start().empty()) return 1;
  bench.started(folders().closed.jobs.front());
  if (!bench.cutters.intend(bench.device, 0)) return 2;
  told.strokes = 1;
  count_calls_from_here();
  if (bench.cutters.intend(bench.device, 1)) told.strokes = 2;
  bench.cutters.settle(bench.device, 0, 1);
  bench.on([](LiveService& service) { service.stopping(); });
  bench.cutters.finish(bench.device, {.cancelled = true, .certain = 0, .doubt = 1});
  bench.stop();
  return 0;
}

int cut_a_sheet(ServiceBench& bench, Told& told) {
  if (!bench.start().empty()) return 1;
  const std::string id = folders().closed.jobs.front();
  count_calls_from_here();
  if (!bench.act(id, JobAction::Arm) || !bench.act(id, JobAction::Start)) return 0;
  if (bench.cutters.busy().empty()) return 0;
  for (int stroke = 0; stroke < kStrokes; ++stroke) {
    if (const auto noted = bench.cutters.intend(bench.device, stroke); !noted) {
      bench.cutters.finish(bench.device, {.error = noted.error(), .certain = stroke - 1});
      return 0;
    }
    told.strokes = stroke + 1;
    bench.cutters.settle(bench.device, stroke, stroke);
  }
  bench.cutters.finish(bench.device, {.certain = kStrokes - 1});
  if (bench.job(id).state == JobState::Done) told.done = 1;
  return 0;
}

int back_up_now(ServiceBench& bench, Told&) {
  if (!bench.start().empty()) return 1;
  count_calls_from_here();
  (void)bench.backup(bench.admin);
  return 0;
}

/// Whatever has the name of a backup is a whole one.
void check_backups(ServiceBench& bench) {
  ScratchFolder scratch;
  for (const auto& entry : fs::directory_iterator(bench.folder() + "/backups")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("popcut-")) continue;
    const Integrity found = integrity_of(entry.path().string(), scratch.path() + "/looked-at");
    CHECK(found.damage.empty());
    CHECK(found.jobs == 2);
  }
}

void damage(const std::string& folder) {
  const std::string path = folder + "/popcut.db";
  std::string bytes = read_whole(path, 1u << 26).value();
  bytes[100] = static_cast<char>(bytes[100] ^ 0x40);  // the kind of the first page's tree
  write_text(path, bytes);
}

}  // namespace

#define POPCUT_NEEDS_TRACING()                                                  \
  if (!popcut::testing::can_trace()) {                                          \
    WARN("skipped: processes cannot be traced here, or not on this processor"); \
    return;                                                                     \
  }

TEST_CASE("killed at every call of its end popcutd starts the next time and knows all",
          "[daemon][kill]") {
  POPCUT_NEEDS_TRACING();
  at_every_call("end", folders().closed, end_idle);
  at_every_call("end after a kill", folders().killed, end_idle);
  at_every_call("end in a cut", folders().closed, end_cutting);
}

TEST_CASE("killed at every call of its start popcutd starts the next time and knows all",
          "[daemon][kill]") {
  POPCUT_NEEDS_TRACING();
  at_every_call("first start", folders().none, start_only);
  at_every_call("start", folders().closed, start_only);
  at_every_call("start after a kill", folders().killed, start_only);
}

TEST_CASE("killed at every call of a cut popcutd knows of each stroke", "[daemon][kill]") {
  POPCUT_NEEDS_TRACING();
  at_every_call("cut", folders().closed, cut_a_sheet);
}

TEST_CASE("killed at every call of a backup popcutd loses nothing", "[daemon][kill]") {
  POPCUT_NEEDS_TRACING();
  at_every_call("backup", folders().closed, back_up_now, check_backups);
}

TEST_CASE("killed at every call of a salvage or a restore it can be done again", "[daemon][kill]") {
  POPCUT_NEEDS_TRACING();
  ScratchFolder scratch;
  // A database that changed since it was closed, and a copy from before.
  Folder changed{scratch.path() + "/changed", folders().closed.jobs};
  fs::copy(folders().closed.path, changed.path, fs::copy_options::recursive);
  const std::string copy = "/backups/popcut-1.db";
  fs::copy_file(changed.path + "/popcut.db", changed.path + copy);
  write_text(changed.path + "/database-state", "clean of another\n");
  const Work salvage_it = [](ServiceBench& bench, Told&) {
    count_calls_from_here();
    (void)salvage(bench.folder());
    return 0;
  };
  const auto salvage_again = [](ServiceBench& bench) {
    if (bench.start() == "") return bench.stop();
    bench.stop();
    REQUIRE(salvage(bench.folder()));
  };
  at_every_call("salvage", changed, salvage_it, salvage_again);
  damage(changed.path);
  const Work restore_it = [&](ServiceBench& bench, Told&) {
    count_calls_from_here();
    (void)restore(bench.folder(), bench.folder() + copy, false);
    return 0;
  };
  const auto restore_again = [&](ServiceBench& bench) {
    if (bench.start() == "") return bench.stop();
    bench.stop();
    const auto done = restore(bench.folder(), bench.folder() + copy, false);
    INFO((done ? std::string() : message(done.error())));
    REQUIRE(done);
  };
  at_every_call("restore", changed, restore_it, restore_again);
}

}  // namespace service_kill_test
