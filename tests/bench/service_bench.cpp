// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "daemon/store/intent_journal.hpp"
#include "tests/support/service_bench.hpp"

namespace service_bench {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;

namespace {

double milliseconds(const std::function<void()>& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun)
      .count();
}

double resident_mb() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line))
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

}  // namespace

TEST_CASE("ten thousand jobs", "[daemon]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  const auto first = bench.create(design.id).value();
  bench.wait_for(first.id, JobState::Ready);
  const double made = milliseconds([&] {
    for (int i = 1; i < 10'000; ++i) bench.create(design.id, 5).value();
  });
  std::printf("create: %.3f ms a job\n", made / 9999);
  bench.stop();
  {
    auto store = Store::open({.folder = bench.folder()}).value();
    Database& db = store->database();
    for (const char* check : {"PRAGMA quick_check(1)", "PRAGMA integrity_check(1)"})
      std::printf("%s: %.1f ms\n", check, milliseconds([&] { (void)db.rows(check).next(); }));
    std::printf("database: %.1f MB\n",
                static_cast<double>(db.number("PRAGMA page_count")) * 4096 / 1e6);
  }
  std::printf("before start: %.1f MB resident\n", resident_mb());
  std::printf("start after an orderly end: %.1f ms\n", milliseconds([&] { bench.start(); }));
  std::printf("after start: %.1f MB resident\n", resident_mb());
  bench.create(design.id).value();
  bench.crash();
  std::printf("start after a kill: %.1f ms\n", milliseconds([&] { bench.start(); }));
  std::vector<double> pages;
  std::string cursor;
  for (int i = 0; i < 200; ++i)
    pages.push_back(milliseconds([&] {
      const auto page = bench.on([&](LiveService& s) {
        return s.jobs.list({.states = {JobState::Ready, JobState::Queued}}, {200, cursor}).value();
      });
      cursor = page.next_cursor;
    }));
  std::sort(pages.begin(), pages.end());
  std::printf("a page of 200: p50 %.2f ms, p99 %.2f ms\n", pages[100], pages[198]);
  std::printf("metrics: %.2f ms\n", milliseconds([&] {
                bench.on([](LiveService& s) { return s.operations.metrics(); });
              }));
  std::printf("queue: %.2f ms\n", milliseconds([&] {
                bench.on([&](LiveService& s) {
                  return s.jobs.queue(bench.device, {200, ""})->items.size();
                });
              }));
  const Job job = bench.started(first.id);
  const double intents = milliseconds([&] {
    for (int i = 0; i < 1000; ++i) (void)bench.cutters.intend(bench.device, 3);
  });
  std::printf("intent: %.3f ms\n", intents / 1000);
  std::printf("at the end: %.1f MB resident\n", resident_mb());
  bench.cutters.complete(bench.device);
  CHECK(bench.job(job.id).sheet == 2);
}

TEST_CASE("what an intent costs on a disk", "[daemon]") {
  // Not in memory, as other tests: here the syncs are what is measured.
  std::string place = (std::filesystem::temp_directory_path() / "popcut-XXXXXX").string();
  if (mkdtemp(place.data()) == nullptr) throw std::runtime_error("no scratch folder");
  {
    auto store = Store::open({.folder = place + "/state"}).value();
    Database& db = store->database();
    IntentJournal journal(store->folder(), {.attempt = "01J00000000000000000000000",
                                            .job = "01J00000000000000000000001",
                                            .sheet = 1,
                                            .strokes = 2000});
    std::vector<double> in_database, beside;
    for (int i = 0; i < 500; ++i) {
      in_database.push_back(milliseconds([&] {
        Transaction all(db);
        db.run(
            "INSERT OR REPLACE INTO audit(seq, time, principal, action, subject, detail) "
            "VALUES(1, ?, '', '', '', '')",
            i);
        all.commit();
      }));
      beside.push_back(milliseconds([&] { journal.intend(i); }));
    }
    for (auto* times : {&in_database, &beside}) std::sort(times->begin(), times->end());
    std::printf(
        "intent in the database: p50 %.2f ms, p99 %.2f ms; beside it: p50 %.2f ms, "
        "p99 %.2f ms\n",
        in_database[250], in_database[495], beside[250], beside[495]);
  }
  std::filesystem::remove_all(place);
}

}  // namespace service_bench
