// SPDX-License-Identifier: MIT
// How panels on parallel folds can move.
#include <cstdint>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "core/rigid/mobility.hpp"

namespace rigid_test {

using namespace popcut;

namespace {

using Fold = std::pair<std::uint32_t, std::uint32_t>;

rigid::Section section(std::vector<std::uint8_t> upright, std::vector<double> offset,
                       const std::vector<Fold>& folds) {
  const std::size_t panels = upright.size();
  return {std::move(upright), std::move(offset), Buckets<std::uint32_t>(panels, [&](auto&& put) {
            for (const auto& [a, b] : folds) put(a, b), put(b, a);
          })};
}

// A wall, a ground, and a box on them: its top (z = 30) and its front (x = 20).
constexpr std::uint32_t kWall = 0, kGround = 1, kTop = 2, kFront = 3;
const std::vector<Fold> kBox{{kWall, kGround}, {kWall, kTop}, {kTop, kFront}, {kFront, kGround}};

rigid::Section box(const std::vector<Fold>& folds) {
  return section({1, 0, 0, 1}, {0, 0, 30, 20}, folds);
}

}  // namespace

TEST_CASE("a box on a card has one freedom, and nothing of it is loose", "[rigid]") {
  const rigid::Mobility motion = rigid::mobility(box(kBox));
  CHECK(motion.degrees_of_freedom == 1);
  CHECK(motion.pieces == 1);
  CHECK(motion.loose == std::vector<std::uint8_t>{0, 0, 0, 0});
}

TEST_CASE("each fold that a box lacks gives it one freedom more", "[rigid]") {
  for (std::size_t k = 1; k < kBox.size(); ++k) {
    INFO("without fold " << k);
    std::vector<Fold> folds = kBox;
    folds.erase(folds.begin() + static_cast<std::ptrdiff_t>(k));
    const rigid::Mobility motion = rigid::mobility(box(folds));
    CHECK(motion.degrees_of_freedom == 3);  // a chain of four panels
    CHECK(motion.pieces == 1);
    CHECK(motion.loose[kTop] + motion.loose[kFront] > 0);
  }
}

TEST_CASE("a panel on no fold is a piece with three freedoms of its own", "[rigid]") {
  const rigid::Mobility motion = rigid::mobility(section({1, 0, 0, 1, 1}, {0, 0, 30, 20, 7}, kBox));
  CHECK(motion.degrees_of_freedom == 1 + 3);
  CHECK(motion.pieces == 2);
  CHECK(motion.loose == std::vector<std::uint8_t>{0, 0, 0, 0, 1});
}

TEST_CASE("two folds at different places hold a panel, two at one place do not", "[rigid]") {
  for (const double level : {0.0, 30.0}) {
    // Two level panels on the wall, at z = 0 and at `level`, and an upright one on both.
    const rigid::Section made =
        section({1, 0, 0, 1}, {0, 0, level, 20}, {{0, 1}, {0, 2}, {1, 3}, {2, 3}});
    rigid::Propagation from_wall(made);
    from_wall.hold(0);
    CHECK(from_wall.is_held(1));
    CHECK(from_wall.is_held(2));
    CHECK(from_wall.is_held(3) == (level != 0.0));
    CHECK(from_wall.pin(3) == (level != 0.0 ? 0 : 1));
    CHECK(from_wall.is_held(3));
  }
}

}  // namespace rigid_test
