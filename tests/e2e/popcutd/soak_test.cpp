// SPDX-License-Identifier: MIT
// popcutd under work for hours: './run soak daemon'. The suite has a few seconds of it.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/raw_http.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/steady.hpp"
#include "tests/support/timing.hpp"

namespace soak_test {

using namespace popcut;
using namespace popcut::testing;
using Json = nlohmann::json;
using std::chrono::steady_clock;

namespace {

/// How long; a soak says it, in seconds.
double wanted_s() {
  const char* const text = std::getenv("POPCUT_SOAK_S");
  return text == nullptr ? 2.5 : std::atof(text);
}

/// One person's round: a design that none was before, its job cut, all of it taken away again; and
/// what goes wrong in between.
void round(RunningDaemon& popcutd, int number) {
  const std::string design = popcutd.design(RunningDaemon::lines_svg(4 + number % 9, 5));
  const std::string id = popcutd.ready_job(design);
  popcutd.cut(id);
  popcutd.await_state(id, "done");
  (void)popcutd.get("/v1/jobs?limit=20");
  (void)popcutd.get("/v1/jobs/" + id);
  (void)popcutd.ask("GET", "/metrics");
  (void)popcutd.ask("GET", "/v1/jobs/NONE");
  (void)popcutd.ask("POST", "/v1/jobs", "{\"design\": [[[[");
  (void)popcutd.ask("POST", "/v1/designs?name=broken", "<svg", "image/svg+xml");
  (void)popcutd.ask("DELETE", "/v1/jobs/" + id);
  (void)popcutd.ask("DELETE", "/v1/designs/" + design);
}

/// A page that looks at the events for a moment and goes without a word.
void glance(const std::string& socket) {
  daemon::RawConnection connection(socket);
  connection.send("GET /v1/events HTTP/1.1\r\nHost: a\r\nAccept: text/event-stream\r\n\r\n");
}

}  // namespace

TEST_CASE("popcutd that works keeps its memory and its descriptors", "[popcutd][soak]") {
  RunningDaemon popcutd;
  popcutd.open();
  const pid_t process = popcutd.daemon().pid();
  const auto begun = steady_clock::now();
  const double until_s = wanted_s(), step_s = std::max(0.02, until_s / 1500);
  std::vector<Held> looks;
  std::atomic<bool> over{false};
  std::thread looking([&] {
    while (!over) {
      looks.push_back(held_by(process, seconds_since(begun)));
      std::this_thread::sleep_for(std::chrono::duration<double>(step_s));
    }
  });
  int rounds = 0;
  std::string fault;
  try {
    for (; seconds_since(begun) < until_s; ++rounds) {
      round(popcutd, rounds);
      glance(popcutd.daemon().socket());
      std::error_code ignored;  // a cutter's trace is not what is looked at here
      for (const auto& entry :
           std::filesystem::directory_iterator(popcutd.daemon().folder() / "trace", ignored))
        if (entry.path().extension() == ".json") std::filesystem::remove(entry.path(), ignored);
    }
  } catch (const std::exception& wrong) {
    fault = wrong.what();
  }
  over = true;
  looking.join();
  REQUIRE(fault.empty());
  if (const char* const folder = std::getenv("POPCUT_SOAK_FOLDER")) {
    write_file(std::filesystem::path(folder) / "soak.csv", looks_csv(looks));
    write_file(std::filesystem::path(folder) / "soak.svg", looks_svg(looks));
  }
  const double hours = until_s / 3600;
  fmt::print(
      "{} rounds in {:.0f} s: memory {:.1f} MiB ({:+.2f} MiB an hour), {:.0f} descriptors "
      "({:+.2f} an hour), {} looks\n",
      rounds, until_s, looks.back().rss_mib, slope_per_h(looks, &Held::rss_mib), looks.back().files,
      slope_per_h(looks, &Held::files), looks.size());
  // In seconds the allocator still finds its size, and a request more or less counts; in hours not.
  const bool brief = hours < 0.25;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const double most_mib = 1e6;  // a sanitizer keeps what was freed
#else
  const double most_mib = brief ? 8 : 4;
#endif
  CHECK(why_not_steady(looks, most_mib, brief ? 4 : 0.5).empty());
  CHECK(rounds > 0);
  CHECK(popcutd.daemon().log().find("ThreadSanitizer") == std::string::npos);
  CHECK(happens([&] { return popcutd.get("/readyz")["ready"] == true; }));
}

TEST_CASE("a process that loses memory or descriptors is not steady", "[soak]") {
  std::vector<Held> looks;
  for (int k = 0; k < 400; ++k) {
    const double warmed = std::min(k, 50) / 5.0;  // it grows at first
    looks.push_back({18.0 * k, 20 + warmed + 0.5 * std::sin(k), 24.0 + k % 3});
  }
  CHECK(why_not_steady(looks, 4, 0.5).empty());
  CHECK(std::abs(slope_per_h(looks, &Held::rss_mib)) < 0.1);
  auto leaking = looks;
  for (Held& look : leaking) look.rss_mib += 3 * look.s / 3600;
  CHECK(slope_per_h(leaking, &Held::rss_mib) == Approx(3).margin(0.1));
  CHECK(why_not_steady(leaking, 4, 0.5).find("memory grew") != std::string::npos);
  auto keeping = looks;
  for (Held& look : keeping) look.files += std::floor(look.s / 3600);
  CHECK(why_not_steady(keeping, 4, 0.5).find("descriptors more") != std::string::npos);
  looks[390].rss_mib = 0;
  CHECK_FALSE(why_not_steady(looks, 4, 0.5).empty());
  CHECK_FALSE(why_not_steady({}, 4, 0.5).empty());
  CHECK(looks_svg(leaking).find("open descriptors") != std::string::npos);
  CHECK(looks_csv(leaking).substr(0, 16) == "s,rss_mib,files\n");
}

}  // namespace soak_test
