// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numeric>
#include <random>

#include <catch2/catch.hpp>

#include "core/drawing/nesting.hpp"
#include "core/geometry/point_tree.hpp"
#include "core/machines/machine.hpp"
#include "core/machines/motion.hpp"
#include "core/plan/order/order.hpp"
#include "core/plan/order/tour_array.hpp"
#include "core/plan/order/tour_blocks.hpp"
#include "core/plan/order/tour_improve.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/order_checks.hpp"

namespace order_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

void square(LineWork& work, Operation operation, double x, double y, double side) {
  draw(work, operation, {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}, {x, y}});
}

std::vector<std::uint32_t> lines_of(const Ordered& ordered) {
  std::vector<std::uint32_t> lines;
  for (const Visit& visit : ordered.visits) lines.push_back(visit.line);
  return lines;
}

// A tour that does what the real ones do in the plainest way.
struct PlainTour {
  std::vector<std::uint32_t> at;
  std::vector<std::uint8_t> flipped;
  void reverse(std::uint32_t first, std::uint32_t last) {
    std::rotate(at.begin(), std::find(at.begin(), at.end(), first), at.end());
    const auto end = std::find(at.begin(), at.end(), last) + 1;
    for (auto i = at.begin(); i != end; ++i) flipped[*i] ^= 1u;
    std::reverse(at.begin(), end);
  }
};

// The same round tour, seen from stop 0 as it is not flipped.
template <typename Tour>
std::vector<std::uint32_t> round_of(const Tour& tour) {
  std::vector<std::uint32_t> out;
  std::uint32_t s = 0;
  const bool forward = !tour.flipped(0);
  do {
    out.push_back(2 * s + (tour.flipped(s) == forward ? 1 : 0));
    s = forward ? tour.next(s) : tour.prev(s);
  } while (s != 0 && out.size() <= tour.size());
  return out;
}

std::vector<std::uint32_t> round_of(const PlainTour& tour) {
  const auto n = tour.at.size();
  const auto zero =
      static_cast<std::size_t>(std::find(tour.at.begin(), tour.at.end(), 0u) - tour.at.begin());
  const bool forward = tour.flipped[0] == 0;
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t s = tour.at[forward ? (zero + i) % n : (zero + n - i) % n];
    out.push_back(2 * s + ((tour.flipped[s] != 0) == forward ? 1 : 0));
  }
  return out;
}

template <typename Tour>
void check_against_plain(std::uint32_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> sequence(n);
  std::iota(sequence.begin(), sequence.end(), 0u);
  std::shuffle(sequence.begin(), sequence.end(), random);
  std::vector<std::uint8_t> flipped(n);
  for (auto& f : flipped) f = random() % 2;
  PlainTour plain{sequence, flipped};
  Tour tour(sequence, flipped);
  for (int round = 0; round < 400; ++round) {
    CAPTURE(n, seed, round);
    const std::uint32_t first = random() % n;
    std::uint32_t last = random() % n;
    if (round % 3 == 0) {  // a short part
      last = first;
      for (std::uint32_t k = random() % 5; k > 0; --k) last = tour.next(last);
    }
    // The plain tour may be the other way round by now.
    const bool along = plain.flipped[first] == (tour.flipped(first) ? 1 : 0);
    const bool part = tour.reverse(first, last);
    if (along)
      plain.reverse(first, last);
    else
      plain.reverse(last, first);
    REQUIRE(round_of(tour) == round_of(plain));
    for (std::uint32_t s = 0; s < n; ++s) {
      REQUIRE(tour.prev(tour.next(s)) == s);
      REQUIRE(tour.position(tour.next(s)) == (tour.position(s) + 1) % n);
    }
    if (round % 4 != 0) continue;
    const auto before = round_of(tour);
    const bool again = tour.reverse(first, last);
    if (again)
      tour.reverse(last, first);
    else
      tour.reverse(first, last);
    REQUIRE(round_of(tour) == before);
    static_cast<void>(part);
  }
}

}  // namespace

TEST_CASE("a tour in blocks and one in an array turn parts as the plainest one does",
          "[core][plan][order]") {
  for (const std::uint32_t n : {1u, 2u, 3u, 5u, 8u, 17u, 60u, 300u}) {
    check_against_plain<ArrayTour>(n, n);
    check_against_plain<BlockTour>(n, n + 1);
  }
}

TEST_CASE("near points are the same as by brute force", "[core][plan][order]") {
  std::mt19937 random(5);
  for (const int kind : {0, 1, 2, 3}) {
    std::vector<PagePoint> points;
    std::vector<std::uint32_t> tags;
    for (std::uint32_t i = 0; i < 300; ++i) {
      const double x = static_cast<double>(random() % 1000),
                   y = static_cast<double>(random() % 1000);
      points.push_back(kind == 0   ? PagePoint{x, y}
                       : kind == 1 ? PagePoint{x, 7.0}
                       : kind == 2 ? PagePoint{std::floor(x / 300), std::floor(y / 300)}
                                   : PagePoint{x * 1e-9 + (i == 0 ? 1e5 : 0.0), y * 1e-9});
      tags.push_back(i / 2);
    }
    const PointTree tree(points, tags);
    constexpr std::size_t kNear = 7;
    PointTree::NearList found(kNear);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      CAPTURE(kind, i);
      tree.nearest(i, found, [&](std::uint32_t tag) { return tag != tags[i]; });
      const auto near = found.all();
      REQUIRE(near.size() == kNear);
      std::vector<double> all(150, 1e300);
      for (std::uint32_t k = 0; k < points.size(); ++k) {
        const double dx = points[k].x - points[i].x, dy = points[k].y - points[i].y;
        all[tags[k]] = std::min(all[tags[k]], dx * dx + dy * dy);
      }
      all[tags[i]] = 1e300;
      for (std::size_t k = 0; k < kNear; ++k) CHECK(all[near[k].tag] == near[k].squared);
      std::sort(all.begin(), all.end());
      for (std::size_t k = 0; k < kNear; ++k) CHECK(near[k].squared == all[k]);
    }
  }
}

TEST_CASE("a short hop costs more seconds a millimetre than a long one", "[core][plan][order]") {
  const Motion motion = find_machine("cameo3")->motion;
  const TravelCost cost = TravelCost::seconds(motion);
  for (const double mm : {0.0, 0.01, 1.0, 5.0, 9.679, 9.681, 10.0, 100.0, 1000.0})
    CHECK(cost(mm) == Approx(travel_seconds(mm, motion)));
  CHECK(cost(1.0) > 3 * cost(10.0) / 10);
  CHECK(TravelCost::millimetres()(12.5) == 12.5);
}

TEST_CASE("two hops cost more seconds than one of their length", "[core][plan][order]") {
  const TravelCost cost = TravelCost::seconds(find_machine("cameo3")->motion);
  CHECK(cost(4) + cost(4) > 1.4 * cost(8));
  CHECK(cost(4) + cost(4) > cost(7.9) + cost(0.1));
}

TEST_CASE("the loops around a line are listed from the innermost", "[core][plan][order]") {
  LineWork work;
  square(work, Operation::Cut, 0, 0, 100);           // 0
  square(work, Operation::Cut, 10, 10, 50);          // 1, in 0
  draw(work, Operation::Cut, {{20, 20}, {30, 25}});  // 2, in 1
  square(work, Operation::Cut, 50, 50, 30);          // 3, in 0, crosses 1
  draw(work, Operation::Cut, {{52, 52}, {56, 58}});  // 4, in 1 and 3
  draw(work, Operation::Cut, {{200, 0}, {210, 0}});  // 5
  const Nesting found = nesting(work, std::vector<std::uint8_t>(work.lines.size(), 1));
  const auto around = [&](std::uint32_t line) {
    const auto span = found.around(line);
    return std::vector<std::uint32_t>(span.begin(), span.end());
  };
  using Lines = std::vector<std::uint32_t>;
  CHECK(around(0).empty());
  CHECK(around(1) == Lines{0});
  CHECK(around(2) == Lines{1});
  CHECK(around(3) == Lines{0});
  CHECK(around(4) == Lines{3, 1});
  CHECK(around(5).empty());
  const auto depth = nesting_depth(work, std::vector<std::uint8_t>(work.lines.size(), 1));
  CHECK(depth == Lines{0, 1, 2, 1, 3, 0});
}

TEST_CASE("a long loop finds the strokes inside it", "[core][plan][order]") {
  // A comb with 500 teeth: points between the teeth are outside.
  LineWork work;
  std::vector<PagePoint> comb{{0, 0}};
  for (int i = 0; i < 500; ++i) {
    const double x = i;
    comb.insert(comb.end(), {{x + 0.25, 100.0}, {x + 0.75, 100.0}, {x + 1.0, 10.0}});
  }
  comb.insert(comb.end(), {{500, 0}, {0, 0}});
  draw(work, Operation::Cut, comb);
  draw(work, Operation::Cut, {{7.4, 50}, {7.6, 52}});  // in a tooth
  draw(work, Operation::Cut, {{7.9, 90}, {8.1, 90}});  // between two
  draw(work, Operation::Cut, {{3, 5}, {490, 5}});      // in the back
  const auto depth = nesting_depth(work, {1, 1, 1, 1});
  CHECK(depth == std::vector<std::uint32_t>{0, 1, 0, 1});
}

TEST_CASE("inner strokes are cut first and depths may mix", "[core][plan][order]") {
  LineWork work;
  for (const double x : {0.0, 150.0}) {
    square(work, Operation::Cut, x, 0, 60);
    square(work, Operation::Cut, x + 10, 10, 40);
    square(work, Operation::Cut, x + 20, 20, 20);
  }
  const Ordered done = order(work, {});
  // One nest is finished in between: depth by depth it would be five long ways, 500 mm and more.
  CHECK(lines_of(done) == std::vector<std::uint32_t>{2, 5, 4, 3, 1, 0});
  CHECK(done.cost < 400.0);
  CHECK(outer_before_inner_by_hand(work, done.visits) == 0);
}

TEST_CASE("strokes inside the loop of an open stroke are cut before it", "[core][plan][order]") {
  using Points = std::vector<PagePoint>;
  // A lollipop whose loop ends at a vertex, one whose loop ends on a straight line, one that
  // crosses itself, and a long one, whose pairs are found by place.
  Points long_one{{0, 0}, {0, 50}};
  for (int i = 1; i <= 60; ++i)
    long_one.push_back({static_cast<double>(i), i % 2 == 0 ? 50.0 : 51.0});
  long_one.insert(long_one.end(), {{60, 10}, {-9, 10}});
  const std::vector<Points> strokes{
      {{-40, 0}, {0, 0}, {50, 0}, {50, 50}, {0, 50}, {0, 0}},
      {{-40, 0}, {50, 0}, {50, 50}, {0, 50}, {0, 0}},
      {{-40, 0}, {50, 0}, {50, 50}, {0, 50}, {0, -40}},
      long_one,
  };
  for (const Points& stroke : strokes) {
    CAPTURE(stroke.size());
    LineWork work;
    draw(work, Operation::Cut, stroke);
    draw(work, Operation::Cut, {{20, 20}, {24, 25}});  // inside
    draw(work, Operation::Cut, {{70, 0}, {75, 2}});    // outside
    const Nesting found = nesting(work, {1, 1, 1});
    CHECK(found.around(0).empty());
    REQUIRE(found.around(1).size() == 1);
    CHECK(found.around(1)[0] == 0);
    CHECK(found.around(2).empty());
    const std::vector<std::uint32_t> lines = lines_of(order(work, {}));
    CHECK(std::find(lines.begin(), lines.end(), 1u) < std::find(lines.begin(), lines.end(), 0u));
  }
}

TEST_CASE("one stroke and no stroke can be ordered", "[core][plan][order]") {
  CHECK(order({}, {}).visits.empty());
  LineWork work;
  draw(work, Operation::Cut, {{50, 0}, {10, 0}});
  const Ordered one = order(work, {});
  REQUIRE(one.visits.size() == 1);
  CHECK(one.cost == Approx(60.0));
  const Ordered free = order(work, {.start = std::nullopt, .end = std::nullopt});
  CHECK(free.cost == 0.0);
  const Ordered from = order(work, {.start = PagePoint{0, 0}, .end = std::nullopt});
  CHECK(from.visits[0].reversed);
  CHECK(from.cost == Approx(10.0));
  square(work, Operation::Outline, 10, 10, 80);
  const Ordered two = order(work, {.method = OrderMethod::Best});
  CHECK(two.visits.back().line == 1);
  CHECK(two.visits.back().start == 0);
}

TEST_CASE("coinciding and collinear strokes are ordered quickly", "[core][plan][order]") {
  LineWork same, row, rings;
  for (int i = 0; i < 3000; ++i) {
    draw(same, Operation::Cut, {{5, 5}, {5, 5}});
    draw(row, Operation::Cut, {{3.0 * ((i * 7) % 3000), 0}, {3.0 * ((i * 7) % 3000) + 2, 0}});
  }
  CHECK(order(same, {.start = PagePoint{5, 5}, .end = PagePoint{5, 5}}).cost == 0.0);
  CHECK(order(row, {}).cost < 1.01 * 2 * 9000);
  CHECK(order(row, {.start = PagePoint{}, .end = std::nullopt}).cost == Approx(2999.0));
  for (int i = 0; i < 300; ++i) square(rings, Operation::Cut, 0.1 * i, 0.1 * i, 100 - 0.2 * i);
  const Ordered nested = order(rings, {});
  for (std::uint32_t i = 0; i < 300; ++i) CHECK(nested.visits[i].line == 299 - i);
}

TEST_CASE("the number of moves grows with the effort and the root of the size",
          "[core][plan][order]") {
  CHECK(order_moves(10'000, 1.0) == 200'000);
  CHECK(order_moves(10'000, 2.0) == 400'000);
  CHECK(order_moves(1'000'000, 1.0) == 2'000'000);
  CHECK(order_moves(0, 1.0) == 0);
}

}  // namespace order_test
