// SPDX-License-Identifier: MIT
#include <algorithm>
#include <random>

#include <catch2/catch.hpp>

#include "core/machines/machine.hpp"
#include "core/plan/order/order.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/order_checks.hpp"
#include "tests/support/rounds.hpp"

namespace order_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

std::uint32_t below(std::mt19937& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(std::uint64_t{random()} * n >> 32);
}

void ring(LineWork& work, Operation operation, const PagePoint& at, double r, std::uint32_t corners,
          double turn) {
  std::vector<PagePoint> loop;
  for (std::uint32_t k = 0; k < corners; ++k) {
    const double a = turn + 6.283185307179586 * k / corners;
    loop.push_back({at.x + r * std::cos(a), at.y + r * std::sin(a)});
  }
  loop.push_back(loop.front());
  draw(work, operation, loop);
}

// Loops in loops, lines in them and beside them, points that coincide, everything at random.
LineWork random_drawing(std::mt19937& random, std::uint32_t n) {
  LineWork work;
  const bool coarse = below(random, 3) == 0;  // on a grid: many points and costs are the same
  const bool only_cuts = below(random, 2) == 0;
  while (work.lines.size() < n) {
    const auto operation = only_cuts ? Operation::Cut : static_cast<Operation>(below(random, 6));
    PagePoint at{uniform(random, 0, 200), uniform(random, 0, 200)};
    if (coarse) at = {10.0 * std::floor(at.x / 10), 10.0 * std::floor(at.y / 10)};
    switch (below(random, 4)) {
      case 0: {
        const std::uint32_t depth = 1 + below(random, 4);
        for (std::uint32_t d = 0; d < depth; ++d)
          ring(work, operation, at, 16.0 - 4.0 * d, 3 + below(random, 40), uniform(random, 0, 6));
        break;
      }
      case 1:
        draw(work, operation, {at, {at.x + 10, at.y}});
        break;
      default:
        draw(
            work, operation,
            {at, {at.x + uniform(random, -9, 9), at.y + uniform(random, -9, 9)}, {at.x, at.y + 5}});
        break;
    }
  }
  return work;
}

OrderOptions random_options(std::mt19937& random, OrderMethod method) {
  OrderOptions options;
  options.method = method;
  options.effort = 0.05;
  options.seed = random();
  if (below(random, 2) == 0) options.cost = TravelCost::seconds(find_machine("cameo3")->motion);
  if (below(random, 3) == 0) options.start = std::nullopt;
  if (below(random, 3) == 0) options.end = std::nullopt;
  options.any_seam = below(random, 4) != 0;
  if (below(random, 4) == 0) options.band_mm = 30.0;
  return options;
}

bool same(const std::vector<Visit>& p, const std::vector<Visit>& q) {
  return std::equal(p.begin(), p.end(), q.begin(), q.end(), [](const Visit& a, const Visit& b) {
    return a.line == b.line && a.reversed == b.reversed && a.start == b.start;
  });
}

void check_permutation(const LineWork& work, const std::vector<Visit>& visits) {
  REQUIRE(visits.size() == work.lines.size());
  std::vector<int> seen(work.lines.size(), 0);
  for (const Visit& visit : visits) {
    ++seen[visit.line];
    const auto points = work.points_of(work.lines[visit.line]);
    CHECK(visit.start < points.size());
    if (!closed(points)) CHECK(visit.start == 0);
  }
  CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

}  // namespace

TEST_CASE("an order is a permutation with reversals and obeys all bounds", "[core][plan][order]") {
  std::mt19937 random(17);
  for (const OrderMethod method : {OrderMethod::Quick, OrderMethod::Best})
    for (int round = 0, all = testing::rounds(30); round < all; ++round) {
      CAPTURE(round);
      const LineWork work = random_drawing(random, 1 + below(random, 150));
      const OrderOptions options = random_options(random, method);
      const Ordered done = order(work, options);
      check_permutation(work, done.visits);
      CHECK(outer_before_inner_by_hand(work, done.visits) == 0);
      CHECK(outer_before_inner(work, done.visits) == 0);
      CHECK(done.cost <= done.own_cost + 1e-9);
      CHECK(done.cost == Approx(travel_cost(work, done.visits, options)));
      CHECK(done.finished);
      CHECK(done.moves <= done.moves_wanted);
      const auto groups = cutting_groups(work);
      for (std::size_t i = 1; i < done.visits.size() && options.band_mm == 0.0; ++i)
        CHECK(groups[done.visits[i - 1].line] <= groups[done.visits[i].line]);
      CHECK(same(order(work, options).visits, done.visits));
    }
}

TEST_CASE("an order never costs more than the drawing's own within the same bounds",
          "[core][plan][order]") {
  std::mt19937 random(29);
  for (int round = 0, all = testing::rounds(40); round < all; ++round) {
    CAPTURE(round);
    const LineWork work = random_drawing(random, 1 + below(random, 100));
    OrderOptions options = random_options(random, OrderMethod::Quick);
    options.band_mm = 0.0;
    options.inner_first = false;
    const auto groups = cutting_groups(work);
    std::vector<Visit> own(work.lines.size());
    for (std::uint32_t i = 0; i < own.size(); ++i) own[i].line = i;
    std::stable_sort(own.begin(), own.end(), [&](const Visit& a, const Visit& b) {
      return groups[a.line] < groups[b.line];
    });
    CHECK(order(work, options).cost <= travel_cost(work, own, options) + 1e-9);
  }
}

TEST_CASE("a good order stays good", "[core][plan][order]") {
  std::mt19937 random(31);
  for (int round = 0, all = testing::rounds(12, 4); round < all; ++round) {
    CAPTURE(round);
    const LineWork work = random_drawing(random, 120);
    OrderOptions options;
    options.method = OrderMethod::Best;
    options.effort = 0.05;
    const Ordered once = order(work, options);
    LineWork again;
    for (const Visit& visit : once.visits) {
      const auto points = work.points_of(work.lines[visit.line]);
      std::vector<PagePoint> line(points.begin(), points.end());
      if (visit.reversed) std::reverse(line.begin(), line.end());
      if (visit.start > 0) {
        line.pop_back();
        std::rotate(line.begin(), line.begin() + visit.start, line.end());
        line.push_back(line.front());
      }
      again.append(work.lines[visit.line].operation, line);
    }
    options.method = OrderMethod::Quick;
    const Ordered twice = order(again, options);
    CHECK(twice.cost <= once.cost + 1e-9);
  }
}

TEST_CASE("fixed strokes keep their order", "[core][plan][order]") {
  std::mt19937 random(37);
  const LineWork work = random_drawing(random, 80);
  const Ordered kept = order(work, {.method = OrderMethod::Keep});
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    CHECK(kept.visits[i].line == i);
    CHECK_FALSE(kept.visits[i].reversed);
    CHECK(kept.visits[i].start == 0);
  }
  CHECK(outer_before_inner(work, kept.visits) >= outer_before_inner_by_hand(work, kept.visits));
}

TEST_CASE("a search that ends early reports it and still gives a valid order",
          "[core][plan][order]") {
  std::mt19937 random(41);
  for (int most : {0, 1, 2, 5, 20}) {
    CAPTURE(most);
    const LineWork work = random_drawing(random, testing::fewer_rounds() ? 200 : 400);
    OrderOptions options;
    options.method = OrderMethod::Best;
    options.effort = 0.2;
    int asked = 0;
    double last = -1.0;
    options.keep_going = [&](double done) {
      CHECK(done >= last);
      CHECK(done <= 1.0);
      last = done;
      return ++asked <= most;
    };
    const Ordered done = order(work, options);
    CHECK_FALSE(done.finished);
    CHECK(done.moves < done.moves_wanted);
    CHECK(done.cost <= done.own_cost + 1e-9);
    check_permutation(work, done.visits);
    CHECK(outer_before_inner_by_hand(work, done.visits) == 0);
  }
}

TEST_CASE("the best order never costs more than the quick one even if it ends early",
          "[core][plan][order]") {
  std::mt19937 random(42);
  const int many = testing::fewer_rounds() ? 800 : 2500;
  for (int most : {0, 1, 3, 10, 1'000'000}) {
    CAPTURE(most);
    const LineWork work = random_drawing(random, most == 0 ? many : 300);
    OrderOptions options;
    options.effort = 0.1;
    const Ordered quick = order(work, options);
    int asked = 0;
    options.method = OrderMethod::Best;
    options.keep_going = [&](double) { return ++asked <= most; };
    const Ordered best = order(work, options);
    CHECK(best.cost <= quick.cost + 1e-9);
    CHECK(best.cost == Approx(travel_cost(work, best.visits, options)));
    CHECK(best.finished == (most == 1'000'000));
    check_permutation(work, best.visits);
    CHECK(outer_before_inner_by_hand(work, best.visits) == 0);
  }
}

TEST_CASE("without a mat the sheet only goes forward from band to band", "[core][plan][order]") {
  std::mt19937 random(43);
  const LineWork work = random_drawing(random, 200);
  OrderOptions options;
  options.band_mm = 25.0;
  const Ordered done = order(work, options);
  const double top = bounds(work).y0;
  double band = 0.0;
  bool outlines = false;
  for (const Visit& visit : done.visits) {
    const DrawnLine& line = work.lines[visit.line];
    if (line.operation == Operation::Outline) {
      outlines = true;
      continue;
    }
    CHECK_FALSE(outlines);
    double last = top;
    for (const PagePoint& p : work.points_of(line)) last = std::max(last, p.y);
    const double now = std::floor((last - top) / 25.0);
    CHECK(now >= band);
    band = now;
  }
  CHECK(band > 3.0);
}

TEST_CASE("without a mat no cut turns a sharp corner and none is lost", "[core][plan][order]") {
  std::mt19937 random(47);
  for (int round = 0; round < 12; ++round) {
    CAPTURE(round);
    const LineWork work = random_drawing(random, 100);
    OrderOptions options;
    options.band_mm = 25.0;
    options.corner_deg = 60.0;
    const Ordered done = order(work, options);
    CHECK(done.cost <= done.own_cost + 1e-9);
    std::vector<double> made(work.lines.size(), 0.0);
    std::vector<std::size_t> last_piece(work.lines.size(), 0), first_piece(work.lines.size(), 9999);
    std::vector<PagePoint> points;
    for (std::size_t i = 0; i < done.visits.size(); ++i) {
      const Visit& visit = done.visits[i];
      const DrawnLine& line = work.lines[visit.line];
      points_of_visit(work, visit, points);
      made[visit.line] += length(points);
      CHECK(points.front() == entry(work, visit));
      CHECK(points.back() == leave(work, visit));
      last_piece[visit.line] = i;
      first_piece[visit.line] = std::min(first_piece[visit.line], i);
      if (!is_cut(line.operation)) continue;
      for (std::size_t k = 1; k + 1 < points.size(); ++k) {
        const double ux = points[k].x - points[k - 1].x, uy = points[k].y - points[k - 1].y;
        const double wx = points[k + 1].x - points[k].x, wy = points[k + 1].y - points[k].y;
        CHECK(ux * wx + uy * wy >= 0.499 * std::hypot(ux, uy) * std::hypot(wx, wy));
      }
    }
    for (std::uint32_t i = 0; i < work.lines.size(); ++i)
      CHECK(made[i] == Approx(length(work.points_of(work.lines[i]))));
    // Each piece of what is around comes after all pieces of what is inside.
    std::vector<Visit> whole(work.lines.size());
    for (std::uint32_t i = 0; i < whole.size(); ++i) whole[i].line = i;
    for (const std::vector<std::size_t>* key : {&first_piece, &last_piece}) {
      std::sort(whole.begin(), whole.end(),
                [&](const Visit& a, const Visit& b) { return (*key)[a.line] < (*key)[b.line]; });
      CHECK(outer_before_inner_by_hand(work, whole) == 0);
    }
  }
}

}  // namespace order_property_test
