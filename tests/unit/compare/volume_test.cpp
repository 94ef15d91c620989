// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include "core/compare/placement.hpp"
#include "core/compare/volume.hpp"
#include "tests/support/boxes.hpp"

namespace volume_test {

using namespace popcut;
using namespace popcut::likeness;
using namespace popcut::testing;
using Catch::WithinAbs;
using Catch::WithinRel;

namespace {

constexpr int kPixels = 256;

/// By the divergence theorem.
double volume_of(const std::vector<float>& corners) {
  double six = 0.0;
  for (std::size_t k = 0; k + 8 < corners.size(); k += 9) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 9; ++i)
      p[i / 3][static_cast<Eigen::Index>(i % 3)] = static_cast<double>(corners[k + i]);
    six += dot(p[0], cross(p[1], p[2]));
  }
  return six / 6.0;
}

/// The first triangles turned inside out.
std::vector<float> turned(std::vector<float> corners, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < 3; ++i) std::swap(corners[9 * k + i], corners[9 * k + 3 + i]);
  return corners;
}

}  // namespace

TEST_CASE("the volume of a solid in the corner is that of its triangles", "[core][compare]") {
  const auto box = box_between(Vec3(2, 3, 4), Vec3(42, 63, 34));
  const Volume found = solid_volume(box, {}, kPixels);
  REQUIRE(found.ran);
  CHECK(found.by_winding);
  CHECK_THAT(found.mm3, WithinRel(40.0 * 60.0 * 30.0, 0.003));  // by 256^2 columns
  const auto ball = shifted(icosphere(30, 3).corners, Vec3(35, 0, 35));
  CHECK_THAT(solid_volume(ball, {}, kPixels).mm3, WithinRel(volume_of(ball), 0.003));
  // Inside out, or with some triangles inside out.
  CHECK_THAT(solid_volume(turned(box, 12), {}, kPixels).mm3, WithinRel(found.mm3, 1e-6));
  const Volume mixed = solid_volume(turned(box, 5), {}, kPixels);
  REQUIRE(mixed.ran);
  CHECK_FALSE(mixed.by_winding);
  CHECK_THAT(mixed.mm3, WithinRel(found.mm3, 0.003));
}

TEST_CASE("parts of a solid that lie in each other count once", "[core][compare]") {
  auto both = box_between(Vec3(0, 0, 0), Vec3(40, 40, 40));
  append(both, box_between(Vec3(20, 20, 20), Vec3(60, 60, 60)));
  const Volume found = solid_volume(both, {}, kPixels);
  REQUIRE(found.ran);
  CHECK_THAT(found.mm3, WithinRel(2 * 64000.0 - 8000.0, 0.005));
}

TEST_CASE("only what stands in front of the corner counts", "[core][compare]") {
  const auto ball = icosphere(30, 3).corners;  // about the origin: a quarter of it
  CHECK_THAT(solid_volume(ball, {}, kPixels).mm3, WithinRel(0.25 * volume_of(ball), 0.01));
  CHECK_THAT(solid_volume(ball, {std::numbers::pi / 3}, kPixels).mm3,
             WithinRel(volume_of(ball) / 6.0, 0.01));
  const Volume behind = solid_volume(shifted(ball, Vec3(-40, 0, -40)), {}, kPixels);
  CHECK_FALSE(behind.ran);
  CHECK_THAT(behind.why, Catch::Contains("does not stand in the corner"));
}

TEST_CASE("a mesh without an inside has no volume, and says why", "[core][compare]") {
  const auto open = box_mesh({0, 0, 0}, {40, 60, 30}, true).corners;
  const Volume found = solid_volume(open, {}, kPixels);
  CHECK_FALSE(found.ran);
  CHECK_THAT(found.why, Catch::Contains("not closed"));
  // A side whose hole is seen from none of the diagonal's rays.
  auto tube = box_between(Vec3(0, 0, 0), Vec3(40, 60, 30));
  std::vector<float> rest;
  for (std::size_t k = 0; k < tube.size(); k += 9)
    if (!(tube[k + 1] == tube[k + 4] && tube[k + 4] == tube[k + 7]))
      rest.insert(rest.end(), tube.begin() + static_cast<std::ptrdiff_t>(k),
                  tube.begin() + static_cast<std::ptrdiff_t>(k + 9));
  REQUIRE(rest.size() == 8 * 9);
  CHECK_FALSE(solid_volume(rest, {}, kPixels).ran);
  const std::vector<float> flat{0, 0, 10, 40, 0, 10, 0, 40, 10};
  CHECK_FALSE(solid_volume(flat, {}, kPixels).ran);
  CHECK_FALSE(solid_volume({}, {}, kPixels).ran);
  CHECK_FALSE(solid_volume(std::vector<float>(9, 1.0f), {}, kPixels).ran);
}

TEST_CASE("between a surface and the corner lies what it covers", "[core][compare]") {
  // A roof from (30, v, 0) to (0, v, 30): a triangle of 450 mm^2, 50 mm long.
  const std::vector<float> roof{30, 0, 0, 30, 50, 0, 0, 50, 30, 30, 0, 0, 0, 50, 30, 0, 0, 30};
  CHECK_THAT(volume_before(roof, {}, kPixels), WithinRel(450.0 * 50.0, 0.01));
  CHECK(volume_before({}, {}, kPixels) == 0.0);
}

TEST_CASE("turns are read back from their matrix", "[core][compare]") {
  std::mt19937 random(3);
  for (int k = 0; k < 50; ++k) {
    const std::array<double, 3> degrees{popcut::testing::uniform(random, -180, 180),
                                        popcut::testing::uniform(random, -90, 90),
                                        popcut::testing::uniform(random, -180, 180)};
    const Eigen::Matrix3d turn = ModelPlacement::turn_of(degrees);
    ModelPlacement placement;
    placement.turn = turn;
    CHECK((ModelPlacement::turn_of(placement.degrees()) - turn).norm() < 1e-9);
  }
  // R_z R_y R_x: x first.
  const Vec3 turned = ModelPlacement::turn_of({90, 0, 90}) * Vec3(0, 1, 0);
  CHECK(norm(turned - Vec3(0, 0, 1)) < 1e-12);
}

TEST_CASE("a model that was turned, moved and made larger is found", "[core][compare]") {
  // A stair without symmetry.
  std::vector<float> model = box_between(Vec3(0, 0, 0), Vec3(60, 30, 20));
  append(model, box_between(Vec3(0, 0, 0), Vec3(30, 100, 30)));
  append(model, box_between(Vec3(0, 40, 0), Vec3(15, 70, 60)));
  ModelPlacement lost;
  lost.scale_mm = 0.02;
  lost.turn = ModelPlacement::turn_of({90, 180, 0});
  lost.shift_mm = Vec3(300, -20, 70);
  const auto given = placed(model, lost);
  const FoundPlacement found = find_placement(given, model, {});
  CHECK(found.misfit < 0.1);  // its depths are those of a coarse model
  const auto back = placed(given, found.placement);
  double worst = 0.0;
  for (std::size_t k = 0; k < model.size(); ++k)
    worst = std::max(worst, std::abs(static_cast<double>(back[k] - model[k])));
  CHECK(worst < 0.02 * box_of(model).diagonal());
  // The same without the search for size and turn.
  ModelPlacement aside;
  aside.shift_mm = Vec3(0, 37, 0);
  const FoundPlacement along = find_shift_along_spine(model, aside, model, {});
  CHECK_THAT(along.placement.shift_mm.y(), WithinAbs(0.0, 0.5));
}

}  // namespace volume_test
