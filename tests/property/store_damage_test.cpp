// SPDX-License-Identifier: MIT
#include <filesystem>
#include <random>

#include <catch2/catch.hpp>

#include "tests/support/rounds.hpp"
#include "tests/support/service_bench.hpp"

namespace store_damage_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

// Flips, holes, swaps, cuts: what disks and people do to files.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto somewhere = [&] { return static_cast<std::size_t>(random()) % bytes.size(); };
  if (bytes.empty()) return bytes;
  switch (random() % 6) {
    case 0:
      for (unsigned i = 1 + random() % 8; i-- > 0;)
        bytes[somewhere()] ^= static_cast<char>(1u << random() % 8);
      break;
    case 1: {
      const std::size_t at = somewhere();
      const std::size_t count = std::min<std::size_t>(bytes.size() - at, 1 + random() % 9000);
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, '\0');
      break;
    }
    case 2: {
      const std::size_t a = somewhere() / 4096 * 4096, b = somewhere() / 4096 * 4096;
      for (std::size_t i = 0; i < 4096 && std::max(a, b) + i < bytes.size(); ++i)
        std::swap(bytes[a + i], bytes[b + i]);
      break;
    }
    case 3:
      bytes.resize(somewhere());
      break;
    case 4:
      bytes.append(1 + random() % 10'000, '\x7F');
      break;
    default:
      for (std::size_t i = 0, at = somewhere(); i < 64 && at + i < bytes.size(); ++i)
        bytes[at + i] = static_cast<char>(random());
      break;
  }
  return bytes;
}

// Reads everything that can be asked for. Throws only what callers are told to expect.
std::size_t read_all(ServiceBench& bench) {
  return bench.on([&](LiveService& service) {
    std::size_t count = 0;
    try {
      const auto page = service.jobs.list({}, {.limit = 200});
      if (!page) return std::size_t{9999};  // told, not silent
      count = page->items.size();
      for (const Job& job : page->items) {
        (void)service.jobs.sheets(job.id);
        for (int k = 1; k <= 2; ++k) (void)service.jobs.ledger(job.id, k);
        (void)service.plans.find(job.plan);
      }
      (void)service.operations.events(0, 1000, "");
      service.operations.usage({}, {}, "owner", [](const auto&) {});
      (void)service.jobs.queue("", {});
      (void)service.access.tokens();
      (void)service.materials.list();
      (void)service.devices.list();
      (void)service.designs.list({}, {});
      (void)service.operations.metrics();
      service.tick();
    } catch (const std::exception&) {
      return std::size_t{9999};
    }
    return count;
  });
}

}  // namespace

TEST_CASE("a damaged database is refused with a reason or read without harm", "[daemon][store]") {
  constexpr std::size_t kJobs = 40;
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  std::string last;
  for (std::size_t i = 0; i < kJobs; ++i) last = bench.create(design.id)->id;
  bench.wait_for(last, JobState::Ready);
  bench.started(last);
  REQUIRE(bench.cutters.intend(bench.device, 2));
  const std::string state = bench.folder();
  // Two states of rest: ended in order, and killed with changes in the log only.
  bench.crash();
  const std::string killed = state + "-killed", ended = state + "-ended";
  fs::copy(state, killed, fs::copy_options::recursive);
  REQUIRE(bench.start() == "");
  bench.stop();
  fs::copy(state, ended, fs::copy_options::recursive);

  std::mt19937 random(20261121);
  int refused = 0, opened = 0, lost = 0;
  const int all = testing::rounds(500);
  for (int round = 0; round < all; ++round) {
    CAPTURE(round);
    fs::remove_all(state);
    const bool from_killed = round % 2 == 0;
    fs::copy(from_killed ? killed : ended, state, fs::copy_options::recursive);
    const bool log = from_killed && random() % 2 == 0;
    const std::string victim = state + (log ? "/popcut.db-wal" : "/popcut.db");
    const std::string bytes = mutated(read_whole(victim, 1u << 26).value(), random);
    if (random() % 40 == 0)
      fs::remove(victim);
    else
      write_text(victim, bytes);
    const std::string trouble = bench.start();
    if (!trouble.empty()) {
      ++refused;
      CHECK(trouble.find("popcut.db") != std::string::npos);
      const bool same = !fs::exists(victim) || read_whole(victim, 1u << 26).value() == bytes;
      CHECK(same);
      bench.stop();
      continue;
    }
    ++opened;
    // A flipped bit within a text is nothing that SQLite can see, but no job may go missing.
    if (read_all(bench) < kJobs) {
      ++lost;
      WARN("round " << round << ": fewer jobs after damage to the " << (log ? "log" : "file"));
    }
    CHECK(bench.cutters.cuts() == 1);
    bench.crash();
  }
  WARN("refused " << refused << ", opened " << opened << ", of these with fewer jobs " << lost);
  CHECK(lost == 0);
  CHECK(refused > all / 5 * 2);
  fs::remove_all(killed);
  fs::remove_all(ended);
}

}  // namespace store_damage_test
