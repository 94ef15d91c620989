// SPDX-License-Identifier: MIT
// The small parts that the simulated cutter and its checks are made of.
#include <cmath>

#include <catch2/catch.hpp>

#include "core/machines/motion.hpp"
#include "device/compare/fold_chains.hpp"
#include "device/compare/fold_check.hpp"
#include "device/compare/run_along.hpp"
#include "device/sim/ride.hpp"
#include "device/sim/window.hpp"
#include "tests/support/value.hpp"

namespace device_parts_test {

using namespace popcut;

namespace {

std::optional<FoldFault::Kind> fault(FoldState fold, int passes = 1) {
  const auto found = check_fold(fold, DashShape{1.5, 1.0, 0.5, 0.5}, passes, 0.07);
  if (!found) return std::nullopt;
  return found->kind;
}

FoldState dashed(std::vector<Stretch> dashes) {
  return {10, std::move(dashes), {{-1, 1}, {9, 11}}, {}};
}

}  // namespace

TEST_CASE("a leg is ridden as a trapezoid of speed", "[device][motion]") {
  // 100 mm/s^2: 50 mm/s after 0.5 s and 12.5 mm; 2 x 0.5 s and 75 mm at 50 mm/s.
  const Leg far{100, 50, 0};
  CHECK(ride_first(std::span(&far, 1), 0, 100).seconds == Approx(2.5));
  const Leg near{4, 50, 0};
  CHECK(ride_first(std::span(&near, 1), 0, 100).seconds == Approx(0.4));
  const Leg legs[] = {{50, 50, 0}, {50, 50, 1000}};
  const Ride first = ride_first(legs, 0, 100);
  CHECK(first.exit_mm_s == Approx(50));
  CHECK(first.seconds + ride_first(std::span(legs).subspan(1), first.exit_mm_s, 100).seconds ==
        Approx(2.5));
  const Leg corner[] = {{50, 50, 0}, {50, 50, 10}};
  CHECK(ride_first(corner, 0, 100).exit_mm_s == Approx(10));
  const Leg nothing{0, 50, 0};
  CHECK(ride_first(std::span(&nothing, 1), 0, 100).seconds == 0);
}

TEST_CASE("sharper corners are slower", "[device][motion]") {
  Motion motion;
  motion.accel_mm_s2 = 1000;
  motion.corner_mm = 0.05;
  CHECK(std::isinf(corner_speed(1, motion)));
  const double right = corner_speed(0, motion);
  CHECK(right == Approx(std::sqrt(50 * 0.70710678 / 0.29289322)));
  CHECK(corner_speed(-0.5, motion) < right);
  CHECK(corner_speed(-1, motion) == Approx(0).margin(1e-6));
}

TEST_CASE("a segment is clipped to the window with its edges", "[device][window]") {
  const Window window{0, 0, 10, 20};
  const auto whole = testing::value(clip(window, {1, 1}, {9, 19}));
  CHECK(whole.from == 0);
  CHECK(whole.to == 1);
  const auto part = testing::value(clip(window, {-5, 10}, {15, 10}));
  CHECK(part.from == Approx(0.25));
  CHECK(part.to == Approx(0.75));
  CHECK(clip(window, {0, 0}, {0, 20}));     // along an edge
  CHECK(clip(window, {10, 20}, {10, 20}));  // a dot in a corner
  CHECK_FALSE(clip(window, {11, 0}, {11, 20}));
  CHECK_FALSE(clip(window, {-1, 1}, {1, -1}));  // touches a corner from outside
  CHECK_FALSE(clip(window, {-3, 5}, {-3, 5}));
}

TEST_CASE("segments that overlap are distinguished from those that cross", "[device][expect]") {
  const Segment a{{0, 0}, {10, 0}};
  const double reach = 0.025;
  const auto part = testing::value(run_along(a, {{8, 0.02}, {2, -0.02}}, reach));
  CHECK(part.a.from == Approx(2));
  CHECK(part.a.to == Approx(8));
  CHECK(part.b.from == Approx(0).margin(0.01));
  CHECK_FALSE(run_along(a, {{5, -5}, {5, 5}}, reach));
  CHECK_FALSE(run_along(a, {{0, -0.5}, {10, 0.5}}, reach));   // crosses at a slant
  CHECK_FALSE(run_along(a, {{10, 0}, {20, 0}}, reach));       // goes on
  CHECK_FALSE(run_along(a, {{0, 0.03}, {10, 0.03}}, reach));  // beside it
  CHECK_FALSE(run_along({{5, 5}, {5, 5}}, a, reach));
}

TEST_CASE("parts of a fold are chained where they continue straight", "[device][expect]") {
  const std::vector<FoldPart> parts{{{{0, 0}, {10, 0}}, 1},
                                    {{{20, 0}, {10, 0}}, 1},
                                    {{{20, 0}, {30, 0}}, 2},
                                    {{{10, 0}, {10, 10}}, 1},
                                    {{{30, 0}, {40, 0}}, 2}};
  const auto chains = chain_folds(parts);
  REQUIRE(chains.size() == 3);
  CHECK(chains[0].parts == std::vector<std::uint32_t>{0, 1});
  CHECK(chains[0].turned == std::vector<bool>{false, true});
  CHECK(chains[1].parts == std::vector<std::uint32_t>{2, 4});
  CHECK(chains[2].parts == std::vector<std::uint32_t>{3});
}

TEST_CASE("dashes are checked along their fold", "[device][expect]") {
  using Kind = FoldFault::Kind;
  CHECK_FALSE(fault(dashed({{0.5, 2}, {3, 4.5}, {5.5, 7}, {8, 9.5}})));
  CHECK(fault(dashed({{0.5, 2}, {5.5, 7}, {8, 9.5}})) == Kind::NotDashed);
  CHECK(fault(dashed({})) == Kind::NotDashed);
  CHECK(fault(dashed({{0.5, 2}, {2, 4.5}, {5.5, 7}, {8, 9.5}})) == Kind::Solid);
  CHECK(fault(dashed({{0.5, 2}, {0.5, 2}, {3, 4.5}, {5.5, 7}, {8, 9.5}})) == Kind::TooOften);
  CHECK_FALSE(fault(dashed({{0.5, 2}, {0.5, 2}, {3, 4.5}, {5.5, 7}, {8, 9.5}}), 2));
  CHECK(fault(dashed({{0, 2}, {3, 4.5}, {5.5, 7}, {8, 9.5}})) == Kind::ToItsEnd);
  CHECK(fault(dashed({{0.5, 2}, {3, 4.5}, {5.5, 7}, {8, 10}})) == Kind::ToItsEnd);
  // A cut runs along the last three millimetres.
  FoldState under = dashed({{0.5, 2}, {3, 4.5}, {7, 10}});
  under.bare.insert(under.bare.end() - 1, {5, 10});
  CHECK(fault(under) == Kind::ToItsEnd);
  under.cut = {{6.9, 10}};
  CHECK_FALSE(fault(under));
}

}  // namespace device_parts_test
