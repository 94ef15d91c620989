// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/order/order.hpp"
#include "tests/support/corpus.hpp"
#include "tests/support/order_checks.hpp"
#include "tests/support/value.hpp"

namespace toolpath_bench {

using namespace popcut;

namespace {

// What others need, mm: vpype 1.16a linesort, and a local search of 60 s that is within 0.5 % of
// LKH-3 up to 10 000 strokes (an upper bound only at 100 000). Raw strokes, fixed seams, the way
// begins and ends anywhere.
struct Reference {
  const char* name;
  double before, vpype, near_best;
  double most_excess;  // of best with a second, percent; 0: none is asked for
};
constexpr Reference kReferences[] = {
    {"popup_card", 4676, 1485, 1141, 2.0},      {"stencil_text", 11279, 6483, 5464, 2.0},
    {"nested_2k", 314652, 11501, 9559, 2.0},    {"miura_score_10k", 105240, 5730, 5651, 0.0},
    {"hilbert_4k", 611816, 507, 0, 0.0},        {"hilbert_65k", 9597403, 368, 0, 0.0},
    {"rand_1k", 147906, 6717, 4660, 2.0},       {"rand_10k", 1453333, 18852, 12906, 3.0},
    {"rand_100k", 14610531, 57081, 44119, 0.0}, {"kiri_10k", 49653, 17123, 14317, 2.0},
    {"kiri_100k", 163391, 51801, 46088, 0.0},
};

bool made_corpus() {
  if (!testing::corpus().empty()) return true;
  WARN("skipped: the corpus generator data/drawings/gen_corpus.py is not here, or does not run");
  return false;
}

// All strokes of a file as cuts, as they are drawn.
LineWork strokes_of(const std::string& name) {
  auto work = testing::value(linework_from_svg(
      testing::text_of(testing::corpus_folder() / (name + ".svg")), SvgProfile::Plain));
  for (DrawnLine& line : work.lines) line.operation = Operation::Cut;
  return work;
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Timed {
  Ordered ordered;
  double mm{}, wall_s{}, cpu_s{};
};

Timed timed(const LineWork& work, OrderOptions options, std::optional<double> most_s = {}) {
  const double wall = seconds_now(), cpu = cpu_now();
  if (most_s) options.keep_going = [=](double) { return seconds_now() - wall < *most_s; };
  Timed out{order(work, options), 0, seconds_now() - wall, cpu_now() - cpu};
  out.mm = travel_mm(work, out.ordered.visits);
  return out;
}

OrderOptions order_only(OrderMethod method) {
  OrderOptions options;
  options.method = method;
  options.start = options.end = std::nullopt;
  options.any_seam = options.inner_first = false;
  options.effort = 1e6;  // more than a second's worth: the clock ends it
  return options;
}

// Best with `most_s` seconds: the median of three seeds.
Timed median_best(const LineWork& work, OrderOptions options, double most_s) {
  std::vector<Timed> runs;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    options.seed = seed;
    runs.push_back(timed(work, options, most_s));
  }
  std::sort(runs.begin(), runs.end(), [](const Timed& a, const Timed& b) { return a.mm < b.mm; });
  return std::move(runs[1]);
}

LineWork random_strokes(std::uint32_t n) {
  std::mt19937_64 random(n);
  const auto chance = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  LineWork work;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = 10 + 280 * chance(), y = 10 + 280 * chance();
    const double a = 6.283185307179586 * chance(), l = 0.5 + 4.5 * chance();
    const PagePoint ends[] = {{x - l * std::cos(a), y - l * std::sin(a)},
                              {x + l * std::cos(a), y + l * std::sin(a)}};
    work.append(Operation::Cut, ends);
  }
  return work;
}

}  // namespace

TEST_CASE("order only beside the peers", "[.][bench][toolpath]") {
  if (!made_corpus()) return;
  std::string table = fmt::format(
      "raw strokes, fixed seams, mm, free start and end; load {}\n{:<16}{:>8}{:>10}{:>8}{:>8}{:>9}"
      "{:>9}{:>8}{:>10}{:>9}{:>9}\n",
      testing::load(), "file", "strokes", "before", "vpype", "quick", "wall s", "cpu s", "best",
      "wall s", "near-opt", "excess");
  for (const Reference& reference : kReferences) {
    CAPTURE(reference.name);
    const LineWork work = strokes_of(reference.name);
    const Timed quick = timed(work, order_only(OrderMethod::Quick));
    const Timed best = median_best(work, order_only(OrderMethod::Best), 1.0);
    const double excess =
        reference.near_best > 0.0 ? 100.0 * (best.mm / reference.near_best - 1.0) : 0.0;
    table += fmt::format(
        "{:<16}{:>8}{:>10.0f}{:>8.0f}{:>8.0f}{:>9.3f}{:>9.3f}{:>8.0f}{:>10.2f}{:>9.0f}{:>8.1f}%\n",
        reference.name, work.lines.size(), reference.before, reference.vpype, quick.mm,
        quick.wall_s, quick.cpu_s, best.mm, best.wall_s, reference.near_best, excess);
    if (reference.most_excess > 0.0) CHECK(excess <= reference.most_excess);
    CHECK(quick.mm <= reference.before + 1.0);
  }
  WARN(table);
}

TEST_CASE("a hundred thousand strokes", "[.][bench][toolpath]") {
  if (!made_corpus()) return;
  const LineWork work = strokes_of("rand_100k");
  const Timed quick = timed(work, order_only(OrderMethod::Quick));
  const Timed best = timed(work, order_only(OrderMethod::Best), 4.0);
  WARN(fmt::format(
      "rand_100k, load {}: quick {:.0f} mm in {:.2f} s ({:.2f} s of CPU), best {:.0f} mm in {:.2f} "
      "s ({:.2f} s of CPU)",
      testing::load(), quick.mm, quick.wall_s, quick.cpu_s, best.mm, best.wall_s, best.cpu_s));
  CHECK(quick.cpu_s < 0.8);
  CHECK(quick.mm < 51000);
  CHECK(best.mm < 45000);
}

TEST_CASE("free seams and inner before outer", "[.][bench][toolpath]") {
  if (!made_corpus()) return;
  std::string table = fmt::format(
      "any seam, inner before outer, mm, free start and end; load {}\n{:<16}{:>8}{:>8}{:>9}{:>9}"
      "{:>8}{:>9}{:>11}\n",
      testing::load(), "file", "strokes", "quick", "wall s", "cpu s", "best", "wall s",
      "violations");
  const std::pair<const char*, double> files[] = {
      {"nested_2k", 8000}, {"stencil_text", 5500}, {"popup_card", 1e9}};
  for (const auto& [name, most_mm] : files) {
    CAPTURE(name);
    const LineWork work = strokes_of(name);
    OrderOptions options = order_only(OrderMethod::Quick);
    options.any_seam = options.inner_first = true;
    const Timed quick = timed(work, options);
    options.method = OrderMethod::Best;
    const Timed best = median_best(work, options, 1.0);
    const std::size_t violations = testing::outer_before_inner_by_hand(work, quick.ordered.visits) +
                                   testing::outer_before_inner_by_hand(work, best.ordered.visits);
    table += fmt::format("{:<16}{:>8}{:>8.0f}{:>9.3f}{:>9.3f}{:>8.0f}{:>9.2f}{:>11}\n", name,
                         work.lines.size(), quick.mm, quick.wall_s, quick.cpu_s, best.mm,
                         best.wall_s, violations);
    CHECK(violations == 0);
    CHECK(best.mm < most_mm);
  }
  WARN(table);
}

TEST_CASE("planning time grows as n log n", "[.][bench][toolpath]") {
  std::string table = fmt::format("quick on random strokes; load {}\n", testing::load());
  double least = 1e9, most = 0.0;
  for (const std::uint32_t n : {10'000u, 100'000u, 1'000'000u}) {
    const LineWork work = random_strokes(n);
    const Timed quick = timed(work, order_only(OrderMethod::Quick));
    const double each = 1e9 * quick.cpu_s / (n * std::log2(n));
    least = std::min(least, each);
    most = std::max(most, each);
    table += fmt::format(
        "{:>8} strokes: {:>8.0f} mm, {:.2f} s ({:.2f} s of CPU), {:.0f} ns / (n "
        "log2 n)\n",
        n, quick.mm, quick.wall_s, quick.cpu_s, each);
  }
  WARN(table);
  CHECK(most < 4.0 * least);  // caches cost something
}

}  // namespace toolpath_bench
