// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_bench {

using namespace popcut;
using namespace popcut::daemon;
using popcut::test::ServiceBench;

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

}  // namespace service_bench
