// SPDX-License-Identifier: MIT
// A run that is killed in the middle of a cut, and files that lose their ends, or change, before
// the next one.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/store/intent_journal.hpp"
#include "tests/support/service_bench.hpp"

namespace intent_journal_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::TempFolder;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

constexpr int kStrokes = 40;
constexpr std::int64_t kCut = 29;  // strokes 0..29 have gone to the knife
constexpr std::size_t kFrame = 24 + 4096;
constexpr std::size_t kHead = 2048;  // of a journal and a witness
constexpr std::size_t kRecord = 64;
constexpr std::size_t kSlot = 4096;

std::string bytes_of(const std::string& path) {
  return read_whole(path, std::uint64_t{1} << 28).value_or("");
}

// A state folder as a killed run left it, and copies of it from before.
struct Scene {
  TempFolder scratch{TempFolder::Place::Memory};
  std::string killed{(scratch / "killed").string()};    ///< at the end
  std::string halfway{(scratch / "halfway").string()};  ///< in the middle of the cut
  std::string ready{(scratch / "ready").string()};      ///< before the sheet was armed
  std::string job, attempt;

  // @param again  the sheet was cut in part before, and goes on in a second attempt
  explicit Scene(bool again) {
    ServiceBench bench(false);
    bench.planner.sheets = 1;
    bench.planner.strokes = kStrokes;
    REQUIRE(bench.start() == "");
    const auto keep = [&](const std::string& as) {
      fs::copy(bench.folder(), as, fs::copy_options::recursive);
    };
    job = bench.ready_job().id;
    keep(ready);
    bench.started(job);
    for (std::int64_t last = 0; last <= kCut; last += 1 + last % 3) {
      REQUIRE(bench.cutters.intend(bench.device, last));
      bench.cutters.settle(bench.device, last - 2, last);
      if (last == 12) keep(halfway);
      if (again && last == 21) {
        bench.cutters.finish(
            bench.device,
            {.error = Error{ErrorKind::DeviceGone, "", "unplugged"}, .certain = 19, .doubt = 21});
        REQUIRE(bench.act(job, {.action = JobAction::ResumeFrom,
                                .from_path = 22,
                                .registration = "kept",
                                .skip_in_doubt = true}));
        bench.started(job);
      }
    }
    REQUIRE(bench.cutters.intend(bench.device, kCut));
    attempt = bench.cutters.knife().back().attempt;
    bench.crash();
    keep(killed);
  }
};

// What became of one damaged folder.
struct Tally {
  int tried{}, refused{}, went_on{}, all_in_doubt{}, doubled{}, untrue{}, fresh{};
};

// A person looks at what the next run says, and goes on with what it calls not sent, without a
// word about cutting anything twice.
void go_on(const Scene& scene, const std::string& folder, Tally& tally) {
  ++tally.tried;
  ServiceBench bench(false);
  bench.planner.sheets = 1;
  bench.planner.strokes = kStrokes;
  fs::remove_all(bench.folder());
  fs::rename(folder, bench.folder());
  if (!bench.start().empty()) {
    ++tally.refused;
    return;
  }
  auto found = bench.on([&](LiveService& s) { return s.jobs.find(scene.job); });
  if (!found) return;  // the log is from before it
  if (found->sheets_total == 0) found = bench.wait_for(scene.job, JobState::Ready);
  CHECK(found->state != JobState::Cutting);
  CHECK(found->state != JobState::Armed);
  if (found->state == JobState::Ready) {
    // Its plan came again; that a sheet of it was begun is not forgotten.
    const auto armed = bench.act(scene.job, JobAction::Arm);
    tally.fresh += armed ? 1 : 0;
    if (armed) (void)bench.act(scene.job, JobAction::Start);
  } else {
    const Ledger known = popcut::testing::ledger(bench, scene.job);
    for (const PathRange& run : known.not_sent) tally.untrue += run.first <= kCut ? 1 : 0;
    for (const PathRange& run : known.certain) tally.untrue += run.last > kCut ? 1 : 0;
    if (known.not_sent.empty()) {
      ++tally.all_in_doubt;
      return;
    }
    ActionRequest request{.action = JobAction::ResumeFrom,
                          .from_path = known.not_sent.front().first,
                          .registration = "re-registered",
                          .skip_in_doubt = true};
    if (bench.act(scene.job, request)) {
      const auto armed = bench.act(scene.job, JobAction::Arm);
      INFO((armed ? "" : armed.error().detail));
      CHECK(armed);
      const auto begun = bench.act(scene.job, JobAction::Start);
      INFO((begun ? "" : begun.error().detail));
      CHECK(begun);
    }
  }
  if (bench.cutters.busy().empty()) return;
  bench.cutters.complete(bench.device);
  ++tally.went_on;
  int twice = 0;
  for (const auto& cut : bench.cutters.knife()) twice += cut.stroke <= kCut ? 1 : 0;
  tally.doubled += twice > 0 ? 1 : 0;
}

void say(const char* what, const Tally& tally) {
  WARN(what << ": " << tally.tried << " tried, " << tally.refused << " refused, "
            << tally.all_in_doubt << " all in doubt, " << tally.went_on << " went on, "
            << tally.doubled << " with strokes cut twice, " << tally.untrue << " untrue ledgers");
}

// The length of a preallocated list up to its last record.
std::size_t used(const std::string& list) {
  const std::size_t end = list.find_last_not_of('\0');
  return end == std::string::npos ? 0 : end + 1;
}

void cut_to(std::string& bytes, std::size_t length, bool zero) {
  const std::size_t whole = bytes.size();
  bytes.resize(std::min(length, whole));
  if (zero) bytes.resize(whole, '\0');
}

// How much of the whole that could be tried is tried: all with POPCUT_ALL_LOSSES.
std::size_t stride(std::size_t usual) {
  return std::getenv("POPCUT_ALL_LOSSES") == nullptr ? usual : 1;
}

}  // namespace

TEST_CASE("a database log that loses its end makes no stroke be cut twice", "[daemon][ledger]") {
  const bool again = GENERATE(false, true);
  CAPTURE(again);
  const Scene scene(again);
  const std::string log = bytes_of(scene.killed + "/popcut.db-wal");
  const std::size_t frames = (log.size() - 32) / kFrame;
  REQUIRE(frames > 50);
  Tally tally;
  TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "state").string();
  const std::size_t step = stride(9);
  for (std::size_t kept = frames % step; kept <= frames; kept += step)
    for (const bool zero : {false, true}) {
      // Without the witness of the events, too: a log that ends before the start is believed then.
      for (const bool events : {true, false}) {
        if (!events && kept % 2 == (zero ? 0U : 1U)) continue;
        CAPTURE(kept, frames, zero, events);
        fs::copy(scene.killed, folder, fs::copy_options::recursive);
        std::string cut = log;
        cut_to(cut, 32 + kept * kFrame + (kept % 3 == 0 ? kept * 7 % kFrame : 0), zero);
        write_text(folder + "/popcut.db-wal", cut);
        if (!events) fs::remove(folder + "/witness");
        go_on(scene, folder, tally);
      }
    }
  say(again ? "log cut, second attempt" : "log cut", tally);
  CHECK(tally.doubled == 0);
  CHECK(tally.untrue == 0);
  CHECK(tally.fresh == 0);
  CHECK(tally.went_on > 0);
}

TEST_CASE("a journal or a witness that loses its end makes no stroke be cut twice",
          "[daemon][ledger]") {
  const Scene scene(false);
  const std::string list = bytes_of(scene.killed + "/intents/" + scene.attempt);
  const std::string witness = bytes_of(scene.killed + "/witnesses/" + scene.attempt);
  const std::size_t end = used(list);
  REQUIRE(end == kHead + kRecord * ((end - kHead) / kRecord));
  TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "state").string();
  Tally tally;
  const auto with = [&](const char* inside, const std::optional<std::string>& bytes, bool log) {
    fs::copy(scene.killed, folder, fs::copy_options::recursive);
    const std::string path = folder + "/" + inside + "/" + scene.attempt;
    fs::remove(path);
    if (bytes) write_text(path, *bytes);
    // The end of the database's log is lost at the same time.
    if (log) {
      std::string cut = bytes_of(folder + "/popcut.db-wal");
      cut_to(cut, cut.size() - 12 * kFrame, false);
      write_text(folder + "/popcut.db-wal", cut);
    }
    go_on(scene, folder, tally);
  };
  for (const bool log : {false, true}) {
    with("intents", std::nullopt, log);
    with("witnesses", std::nullopt, log);
    for (const bool zero : {false, true}) {
      for (std::size_t at = 0; at < end; at += stride(23) * 17) {
        std::string cut = list;
        cut_to(cut, at, zero);
        with("intents", cut, log);
      }
      for (std::size_t at = 0; at < witness.size(); at += stride(23) * 61) {
        std::string cut = witness;
        cut_to(cut, at, zero);
        with("witnesses", cut, log);
      }
    }
    for (const std::size_t slot : {kSlot, 2 * kSlot}) {
      std::string torn = witness;
      torn.replace(slot + 20, 30, 30, '\0');
      with("witnesses", torn, log);
    }
    // An earlier state of either file is a whole one.
    with("intents", bytes_of(scene.halfway + "/intents/" + scene.attempt), log);
    if (!log) with("witnesses", bytes_of(scene.halfway + "/witnesses/" + scene.attempt), log);
  }
  say("journal or witness cut", tally);
  CHECK(tally.doubled == 0);
  CHECK(tally.untrue == 0);
  CHECK(tally.fresh == 0);
  CHECK(tally.went_on > 0);
  CHECK(tally.all_in_doubt > 0);
}

TEST_CASE("whatever is lost of the three records of a cut no stroke is cut twice",
          "[daemon][ledger]") {
  const Scene scene(false);
  const std::string log = bytes_of(scene.killed + "/popcut.db-wal");
  const std::string list = bytes_of(scene.killed + "/intents/" + scene.attempt);
  const std::string witness = bytes_of(scene.killed + "/witnesses/" + scene.attempt);
  std::mt19937 random(20261123);
  TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "state").string();
  Tally tally;
  const int rounds = std::getenv("POPCUT_ALL_LOSSES") == nullptr ? 40 : 3000;
  for (int round = 0; round < rounds; ++round) {
    fs::copy(scene.killed, folder, fs::copy_options::recursive);
    const bool zero = random() % 2 == 0;
    const auto damage = [&](std::string bytes, std::size_t end, std::size_t least) {
      if (random() % 3 == 0) {
        bytes[least + random() % (end - least)] ^= static_cast<char>(1U << random() % 8);
        return bytes;
      }
      cut_to(bytes, least + random() % (end - least), zero);
      return bytes;
    };
    const unsigned what = 1 + random() % 7;
    CAPTURE(round, what, zero);
    if ((what & 1U) != 0) {
      std::string cut = log;
      cut_to(cut, 32 + random() % (log.size() - 32), zero);
      write_text(folder + "/popcut.db-wal", cut);
      if (random() % 2 == 0) fs::remove(folder + "/witness");
    }
    // At least one of the two heads stays whole: without both nothing says whose strokes they were.
    const bool listed = random() % 2 == 0;
    if ((what & 2U) != 0)
      write_text(folder + "/intents/" + scene.attempt,
                 damage(list, used(list), listed ? kHead : 0));
    if ((what & 4U) != 0)
      write_text(folder + "/witnesses/" + scene.attempt,
                 damage(witness, witness.size(), listed ? 0 : kHead));
    go_on(scene, folder, tally);
  }
  say("anything cut", tally);
  CHECK(tally.doubled == 0);
  CHECK(tally.untrue == 0);
  CHECK(tally.fresh == 0);
}

TEST_CASE("an older copy of the database does not start a sheet again that was begun",
          "[daemon][ledger]") {
  const Scene scene(false);
  TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "state").string();
  for (const std::string& older : {scene.ready, scene.halfway}) {
    CAPTURE(older);
    fs::copy(scene.killed, folder, fs::copy_options::recursive);
    for (const char* name : {"popcut.db", "popcut.db-wal"})
      fs::copy_file(older + "/" + name, folder + "/" + name, fs::copy_options::overwrite_existing);
    // As the manual says of restoring a copy.
    fs::remove(folder + "/database-state");
    fs::remove(folder + "/witness");
    ServiceBench bench(false);
    fs::remove_all(bench.folder());
    fs::rename(folder, bench.folder());
    REQUIRE(bench.start() == "");
    const Job job = bench.job(scene.job);
    CHECK(job.state == JobState::Interrupted);
    CHECK(job.attention->kind == "in_doubt");
    CHECK(job.attention->text.find("the database") != std::string::npos);
    const Ledger known = popcut::testing::ledger(bench, scene.job);
    CHECK(known.not_sent.front().first == kCut + 1);
    CHECK(known.last_status.find("the database") != std::string::npos);
    const auto events =
        bench.on([](LiveService& s) { return s.operations.events(0, 1000, "").value(); });
    CHECK(std::any_of(events.begin(), events.end(), [](const Event& event) {
      return event.kind == "notice" && event.data.find("records disagree") != std::string::npos;
    }));
    // The new blank is a fresh one.
    CHECK(bench.act(scene.job, JobAction::RetrySheet)->blank == 2);
    bench.started(scene.job);
    CHECK(bench.cutters.first_stroke(bench.device) == 0);
    bench.cutters.complete(bench.device);
    CHECK(bench.job(scene.job).state == JobState::Done);
    // The next start knows all of this already.
    bench.crash();
    REQUIRE(bench.start() == "");
    CHECK(bench.job(scene.job).state == JobState::Done);
  }
}

TEST_CASE("an ordinary crash loses nothing and leaves in doubt only what was to be sent",
          "[daemon][ledger]") {
  const Scene scene(false);
  TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "state").string();
  fs::copy(scene.killed, folder, fs::copy_options::recursive);
  ServiceBench bench(false);
  fs::remove_all(bench.folder());
  fs::rename(folder, bench.folder());
  REQUIRE(bench.start() == "");
  const Ledger known = popcut::testing::ledger(bench, scene.job);
  CHECK(known.certain_upto > 20);
  CHECK(known.not_sent.front().first == kCut + 1);
  CHECK(known.last_status.empty());
  CHECK(bench.job(scene.job).attention->text == "popcutd ended during the cut; 'popcut jobs " +
                                                    scene.job + "' shows which paths are in doubt");
}

TEST_CASE("the journal of an attempt is kept until its end is in the database for good",
          "[daemon][ledger]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const auto files = [&](const char* inside) {
    return std::distance(fs::directory_iterator(bench.folder() + "/" + inside),
                         fs::directory_iterator());
  };
  const Job ready = bench.ready_job();
  CHECK(files("intents") == 0);
  bench.started(ready.id);
  CHECK(files("intents") == 1);
  CHECK(files("witnesses") == 1);
  bench.cutters.complete(bench.device);
  CHECK(files("intents") == 1);
  // Its end is in the log only. What loses it leaves the whole sheet in doubt, not to be cut.
  bench.crash();
  REQUIRE(bench.start() == "");
  CHECK(files("intents") == 1);
  for (int i = 0; i < 600 && files("intents") + files("witnesses") > 0; ++i) {
    bench.on([&](LiveService& service) {
      (void)service.jobs.hold(bench.tutor, "none", true);
      bench.store().database().run(
          "INSERT INTO audit(time, principal, action, subject, detail) "
          "VALUES(0, '', '', '', hex(zeroblob(4000)))");
      service.tick();
    });
  }
  CHECK(files("intents") == 0);
  CHECK(files("witnesses") == 0);
  // A start that was refused leaves nothing.
  bench.cutters.refuses = true;
  const Job other = bench.ready_job("{\"card\":2}");
  bench.act(other.id, JobAction::Arm).value();
  (void)bench.act(other.id, JobAction::Start);
  bench.crash();
  REQUIRE(bench.start() == "");
  CHECK(bench.job(other.id).state == JobState::Ready);
}

TEST_CASE("the end of a cut that its log lost leaves the sheet in doubt", "[daemon][ledger]") {
  ServiceBench bench;
  bench.planner.sheets = 1;
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  REQUIRE(bench.cutters.intend(bench.device, 2));
  const std::string before = bytes_of(bench.folder() + "/popcut.db-wal");
  bench.cutters.complete(bench.device);
  REQUIRE(bench.job(ready.id).state == JobState::Done);
  bench.crash();
  write_text(bench.folder() + "/popcut.db-wal", before);
  fs::remove(bench.folder() + "/witness");
  REQUIRE(bench.start() == "");
  CHECK(bench.job(ready.id).state == JobState::Interrupted);
  CHECK(popcut::testing::ledger(bench, ready.id).not_sent.empty());
}

TEST_CASE("a start that was never committed leaves no doubt", "[daemon][ledger]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.stop();
  {
    auto folder = StateFolder::open(bench.folder()).value();
    IntentJournal journal(
        *folder,
        {.attempt = "01J00000000000000000000000", .job = ready.id, .sheet = 1, .strokes = 5});
    journal.keep();
  }
  REQUIRE(bench.start() == "");
  CHECK(bench.job(ready.id).state == JobState::Ready);
  CHECK(fs::is_empty(bench.folder() + "/intents"));
  CHECK(fs::is_empty(bench.folder() + "/witnesses"));
}

TEST_CASE("a job that lost its plan and was begun is not armed", "[daemon][ledger]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  bench.stop();
  for (const int sheet : {2, 7}) {
    auto folder = StateFolder::open(bench.folder()).value();
    IntentJournal journal(*folder, {.attempt = sheet == 2 ? "01J00000000000000000000002"
                                                          : "01J00000000000000000000007",
                                    .job = ready.id,
                                    .sheet = sheet,
                                    .strokes = 5,
                                    .device = bench.device});
    journal.intend(3);
    journal.keep();
  }
  REQUIRE(bench.start() == "");
  // Of the first sheet nothing is known, and the second is in doubt; there is no seventh.
  CHECK(bench.job(ready.id).state == JobState::Interrupted);
  CHECK(popcut::testing::ledger(bench, ready.id, 1).not_sent.empty());
  CHECK(popcut::testing::ledger(bench, ready.id, 2).not_sent.front().first == 4);
  bench.act(ready.id, JobAction::RetrySheet).value();
  const auto refused = bench.act(ready.id, JobAction::Arm);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().detail.find("sheet 7") != std::string::npos);
}

}  // namespace intent_journal_test
