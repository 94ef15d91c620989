// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "core/search/draws.hpp"
#include "core/search/halving.hpp"

namespace halving_test {

using namespace popcut;
using Indices = std::vector<std::size_t>;

namespace {

bool has(const Indices& all, std::size_t one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

/// Candidates of which nobody knows anything.
std::vector<Judged> random_candidates(std::size_t count, std::uint64_t seed) {
  Draws draws(seed, 0);
  std::vector<Judged> out(count);
  for (Judged& one : out) one.error = draws.next(), one.cost = 1000.0 * draws.next();
  return out;
}

}  // namespace

TEST_CASE("draws are even, and follow from their place alone", "[search]") {
  Draws draws(7, 3);
  double sum = 0.0;
  constexpr int kCount = 20000;
  for (int k = 0; k < kCount; ++k) {
    const double one = draws.next();
    REQUIRE((one >= 0.0 && one < 1.0));
    REQUIRE(one == draw(7, 3, static_cast<std::uint64_t>(k)));
    sum += one;
  }
  // The mean of 20000 numbers strays by 0.002 (one sigma).
  CHECK(std::abs(sum / kCount - 0.5) < 0.01);
  CHECK(draw(7, 3, 0) != draw(7, 4, 0));
  CHECK(draw(7, 3, 0) != draw(8, 3, 0));
}

TEST_CASE("the front holds whom nobody undercuts in error and cost, by growing cost", "[search]") {
  const std::vector<Judged> all{{0.5, 300}, {0.4, 400},        {0.6, 200}, {0.45, 500},
                                {0.4, 400}, {0.9, 100, false}, {0.1, 2000}};
  CHECK(pareto_front(all) == Indices{2, 0, 1, 6});
  CHECK(pareto_front(all, 900) == Indices{2, 0, 1});
  CHECK(pareto_front({}).empty());
  const std::vector<Judged> many = random_candidates(500, 1);
  const Indices front = pareto_front(many);
  REQUIRE(front.size() > 1);
  for (std::size_t n = 1; n < front.size(); ++n) {
    CHECK(many[front[n]].cost > many[front[n - 1]].cost);
    CHECK(many[front[n]].error < many[front[n - 1]].error);
  }
  for (std::size_t k = 0; k < many.size(); ++k) {
    const bool undercut = std::any_of(many.begin(), many.end(), [&](const Judged& other) {
      return other.error < many[k].error && other.cost < many[k].cost;
    });
    CHECK_FALSE((undercut && has(front, k)));
  }
}

TEST_CASE("halving keeps the best, the cheap ones that nobody undercuts, and some at random",
          "[search]") {
  const std::vector<Judged> all = random_candidates(200, 2);
  Halving step;
  step.keep = 40, step.seed = 5;
  const Indices kept = survivors(all, step);
  CHECK(kept.size() == 40);
  CHECK(std::is_sorted(kept.begin(), kept.end()));
  for (const std::size_t k : pareto_front(all)) CHECK(has(kept, k));
  Indices by_error(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) by_error[k] = k;
  std::sort(by_error.begin(), by_error.end(),
            [&](std::size_t a, std::size_t b) { return all[a].error < all[b].error; });
  for (std::size_t n = 0; n < 19; ++n) CHECK(has(kept, by_error[n]));

  // Two of forty are taken at random, so another seed takes others.
  Halving other = step;
  other.seed = 6;
  const Indices again = survivors(all, other);
  Indices common;
  std::set_intersection(kept.begin(), kept.end(), again.begin(), again.end(),
                        std::back_inserter(common));
  CHECK(common.size() >= 38);
  CHECK(common.size() < 40);
  CHECK(survivors(all, step) == kept);
}

TEST_CASE("who stays goes on besides, who was not made never, and who is too dear last",
          "[search]") {
  std::vector<Judged> all = random_candidates(30, 3);
  all[4] = {9.0, 9000.0, true, true};
  all[5] = {0.0, 0.0, false, true};
  all[6] = {0.0, 0.0, false, false};
  for (std::size_t k = 10; k < 20; ++k) all[k].cost = 5000.0, all[k].error = 0.001;
  Halving step;
  step.keep = 6, step.most_cost = 1000.0, step.random_share = 0.0;
  const Indices kept = survivors(all, step);
  CHECK(kept.size() == 7);
  CHECK(has(kept, 4));
  CHECK_FALSE(has(kept, 5));
  CHECK_FALSE(has(kept, 6));
  for (std::size_t k = 10; k < 20; ++k) CHECK_FALSE(has(kept, k));
  step.keep = 100;
  CHECK(survivors(all, step).size() == 28);
}

TEST_CASE("a search by halving finds the best of a noisy race", "[search]") {
  // Candidate k has the true error k / 1000; the coarse judge errs by up to 0.04, the fine one by
  // up to 0.004. What halving ends with is among the few best.
  constexpr std::size_t kCount = 400;
  const auto judged = [](const Indices& who, double noise, std::uint64_t stream) {
    std::vector<Judged> out;
    for (const std::size_t k : who)
      out.push_back({static_cast<double>(k) / 1000.0 + noise * draw(9, stream, k), 1.0});
    return out;
  };
  Indices who(kCount);
  for (std::size_t k = 0; k < kCount; ++k) who[k] = (k * 171) % kCount;  // in no order
  std::uint64_t stream = 0;
  for (const auto& [keep, noise] : {std::pair(60, 0.04), std::pair(12, 0.004)}) {
    Halving step;
    step.keep = static_cast<std::size_t>(keep), step.step = stream;
    Indices next;
    for (const std::size_t n : survivors(judged(who, noise, stream), step)) next.push_back(who[n]);
    who = std::move(next), ++stream;
  }
  CHECK(who.size() == 12);
  CHECK(*std::min_element(who.begin(), who.end()) <= 3);
}

TEST_CASE("what is shown is a page of the front, and more candidates never show less", "[search]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::vector<Judged> all = random_candidates(600, seed);
    // Many cards of a front as long as it can be.
    for (Judged& one : all) one.error = 200.0 / (20.0 + one.cost) + 0.02 * one.error;
    const std::span<const Judged> known(all);
    Indices shorter;
    for (const std::size_t count : {20U, 60U, 200U, 600U}) {
      const Indices shown = shown_front(known.first(count), shorter);
      const Indices front = pareto_front(known.first(count));
      CHECK(shown.size() <= 9 + shorter.size());
      CHECK(std::is_sorted(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) {
        return all[a].cost < all[b].cost;
      }));
      CHECK(shown.back() == front.back());
      for (const std::size_t k : shown) CHECK(has(front, k));
      for (const std::size_t before : shorter)
        CHECK(std::any_of(shown.begin(), shown.end(), [&](std::size_t now) {
          return all[now].error <= all[before].error && all[now].cost <= all[before].cost;
        }));
      shorter = shown;
    }
  }
  CHECK(shown_front({}, {}).empty());
}

}  // namespace halving_test
