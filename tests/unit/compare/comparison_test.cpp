// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/compare/comparison.hpp"
#include "core/compare/printed.hpp"
#include "tests/support/boxes.hpp"

namespace comparison_test {

using namespace popcut;
using namespace popcut::likeness;
using namespace popcut::testing;
using Catch::WithinAbs;
using Catch::WithinRel;

namespace {

const Vec3 kLow(0, 0, 0), kHigh(60, 80, 50);

/// The nearest depth of a box at a place of the image, by slabs; none where the ray misses it.
std::optional<double> depth_of_box(const Frame& frame, double right, double up, const Vec3& low,
                                   const Vec3& high) {
  const Vec3 from = frame.centre + right * frame.view.right + up * frame.view.up;
  double enter = -INFINITY, leave = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const double way = frame.view.toward[k];
    if (std::abs(way) < 1e-12) {
      if (from[k] < low[k] || from[k] > high[k]) return std::nullopt;
      continue;
    }
    const double a = (low[k] - from[k]) / way, b = (high[k] - from[k]) / way;
    enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
  }
  if (!(enter < leave)) return std::nullopt;
  return leave;
}

}  // namespace

TEST_CASE("views of a card lie in the cone, with square axes", "[core][compare]") {
  const auto views = cone_views();
  REQUIRE(views.size() == 9);
  const Vec3 diagonal = unit(Vec3(1, 0, 1));
  CHECK(norm(views[0].toward - diagonal) < 1e-12);
  for (const View& view : views) {
    CHECK(dot(view.toward, diagonal) >= std::cos(std::numbers::pi / 6) - 1e-12);
    CHECK(view.toward.x() > 0);
    CHECK(view.toward.z() > 0);
    CHECK(norm(cross(view.right, view.up) - view.toward) < 1e-12);
    CHECK(view.up.z() > 0);
  }
  // The first neighbour is aside along the spine, the third is higher.
  CHECK(views[1].toward.y() > 0.49);
  CHECK(views[3].toward.z() > views[0].toward.z());
  // The wall of a narrow card rises steeply, and no view comes from behind it.
  const Corner narrow{std::numbers::pi / 4};
  for (const View& view : cone_views(narrow.opening_rad))
    CHECK(narrow.clearance(100.0 * view.toward) > 0);
}

TEST_CASE("a box that is 1 mm nearer to the eye is 1 mm off", "[core][compare]") {
  const auto box = box_between(kLow, kHigh);
  for (std::size_t k = 0; k < 9; ++k) {
    const View view = cone_views()[k];
    const Target target(box, {{view}, 256, std::nullopt});
    const Figures same = target.measure(box);
    CHECK(same.error() == 0.0);
    const Figures off = target.measure(shifted(box, view.toward));
    CHECK_THAT(off.mean_mm, WithinRel(1.0, 0.001));
    CHECK_THAT(off.p95_mm, WithinRel(1.0, 0.001));
    CHECK(off.contour_mm == 0.0);  // its outline is the same
    CHECK(off.cover == 1.0);
  }
}

TEST_CASE("a box that stands 1 mm aside is as far off as rays find", "[core][compare]") {
  const Vec3 aside = unit(Vec3(1, 0.5, 0.25));
  const auto box = box_between(kLow, kHigh);
  const Target target(box, {cone_views(), 128, std::nullopt});
  const Figures found = target.measure(shifted(box, aside));
  double sum = 0.0;
  std::size_t common = 0, seen = 0, covered = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    const Frame frame = target.frame(k);
    for (int row = 0; row < frame.pixels; ++row)
      for (int column = 0; column < frame.pixels; ++column) {
        const double right = frame.pitch_mm() * (column + 0.5) - 0.5 * frame.side_mm;
        const double up = frame.pitch_mm() * (row + 0.5) - 0.5 * frame.side_mm;
        const auto a = depth_of_box(frame, right, up, kLow, kHigh);
        const auto b = depth_of_box(frame, right, up, kLow + aside, kHigh + aside);
        seen += a ? 1 : 0;
        if (!a || !b) continue;
        sum += std::abs(*a - *b), ++common;
        covered += std::abs(*a - *b) <= kWithin * found.diagonal_mm ? 1 : 0;
      }
  }
  CHECK_THAT(found.mean_mm, WithinRel(sum / static_cast<double>(common), 0.002));
  CHECK_THAT(found.cover,
             WithinRel(static_cast<double>(covered) / static_cast<double>(seen), 0.002));
  CHECK(found.contour_mm > 0.2);
  CHECK(found.contour_mm < 1.0);
}

TEST_CASE("how a surface is cut into triangles changes no figure", "[core][compare]") {
  const auto ball = icosphere(40, 2).corners;
  auto split_ball = split(split(ball));
  const auto box = box_between(Vec3(-30, -30, -30), Vec3(30, 35, 28));
  const Scene scene{cone_views(), 256, std::nullopt};
  const Figures one = Target(ball, scene).measure(box),
                other = Target(split_ball, scene).measure(box);
  const Figures fine = Target(ball, scene).measure(split(split(box)));
  for (const Figures* two : {&other, &fine}) {
    CHECK_THAT(two->mean_mm, WithinRel(one.mean_mm, 0.01));
    CHECK_THAT(two->p95_mm, WithinRel(one.p95_mm, 0.01));
    CHECK_THAT(two->contour_mm, WithinRel(one.contour_mm, 0.01));
    CHECK_THAT(two->cover, WithinRel(one.cover, 0.01));
  }
  CHECK(one.error() > 0.02);
}

TEST_CASE("the card itself is no part of what is compared", "[core][compare]") {
  const Corner corner;
  const auto box = box_between(Vec3(0, 20, 0), Vec3(40, 70, 30));
  // A card of wall and ground, without thickness, and the box on it.
  std::vector<float> card = box;
  append(card, box_between(Vec3(0, -20, 0), Vec3(0, 110, 90)));
  append(card, box_between(Vec3(0, -20, 0), Vec3(90, 110, 0)));
  const Target target(box, {cone_views(), 256, corner});
  const Figures same = target.measure(card);
  CHECK(same.error() == 0.0);
  // With nothing behind, its wall and ground are seen around the box.
  const Target apart(box, {cone_views(), 256, std::nullopt});
  CHECK(apart.measure(card).contour_mm > 5.0);
  CHECK(without_card(card, corner, 1e-3).size() == box.size() - 36);  // two sides lie on the card
}

TEST_CASE("what only one of both shows is as bad as it can be", "[core][compare]") {
  const auto box = box_between(Vec3(0, 0, 0), Vec3(40, 50, 30));
  const Target target(box, {cone_views(), 128, Corner{}});
  const Figures none = target.measure({});
  CHECK(none.cover == 0.0);
  CHECK(none.surface() == 1.0);
  CHECK(none.contour() == 1.0);
  CHECK(none.error() == 3.0);
  const auto far = shifted(box, Vec3(0, 300, 0));
  CHECK(target.measure(far).error() == 3.0);
  // Behind the wall nothing is seen.
  CHECK(Target(shifted(box, Vec3(-100, 0, 0)), {cone_views(), 64, Corner{}}).is_unseen());
  CHECK(Target({}, {cone_views(), 64, Corner{}}).is_unseen());
}

TEST_CASE("a steep slope is no contour, and a step is one", "[core][compare]") {
  const int size = 32;
  DepthImage image{size, std::vector<float>(size * size)};
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      image.depth[static_cast<std::size_t>(row * size + column)] =
          5.0f * static_cast<float>(column);
  ContourPixels contours;
  find_contours(image, 1.0f, contours);
  CHECK(contours.pixels.empty());
  for (int row = 0; row < size; ++row)
    for (int column = 20; column < size; ++column)
      image.depth[static_cast<std::size_t>(row * size + column)] += 30.0f;
  find_contours(image, 1.0f, contours);
  REQUIRE(contours.pixels.size() == static_cast<std::size_t>(size));
  for (const std::uint32_t pixel : contours.pixels) CHECK(pixel % size == 20);  // the nearer side
}

TEST_CASE("distances from contours are those of the nearest pixel", "[core][compare]") {
  std::mt19937 random(7);
  const int size = 40;
  for (int round = 0; round < 10; ++round) {
    ContourPixels contours;
    for (int k = 0; k < 1 + round * 3; ++k)
      contours.pixels.push_back(
          static_cast<std::uint32_t>(popcut::testing::whole(random, 0, size * size - 1)));
    DistanceImage image;
    image.measure(size, contours);
    for (int p = 0; p < size * size; ++p) {
      double least = INFINITY;
      for (const std::uint32_t q : contours.pixels)
        least = std::min(least, std::hypot(p % size - static_cast<int>(q) % size,
                                           p / size - static_cast<int>(q) / size));
      REQUIRE_THAT(image[static_cast<std::uint32_t>(p)], WithinAbs(least, 1e-4));  // floats
    }
  }
}

/// A card that stands around nothing: a board at x = 10, in front of the wall.
std::vector<float> board(double height_mm) {
  return box_between(Vec3(10, 0, 0), Vec3(10.2, 80, height_mm));
}

TEST_CASE("nothing looks more like a model than the model itself, printed", "[core][compare]") {
  Scene scene;
  scene.views = cone_views(), scene.pixels = 128, scene.corner = Corner{};
  std::mt19937 random(5);
  for (int k = 0; k < 4; ++k) {
    const std::vector<float> model = shifted(random_boxes(random, 4), Vec3(1, 0, 0.5));
    const PrintedTarget target(model, {}, scene);
    REQUIRE_FALSE(target.is_unseen());
    const PrintedFigures same = target.measure(model);
    CHECK_THAT(same.cover, WithinAbs(1.0, 1e-12));
    // What the diagonal does not see has the colour before it, and print lies on the card beyond.
    CHECK(same.error() < 0.2);
    for (const Vec3& by : {Vec3(4, 0, 4), Vec3(0, 4, 0), Vec3(8, 0, 0)})
      CHECK(target.measure(shifted(model, by)).error() > same.error());
  }
}

TEST_CASE("the same picture on flat paper looks worse from the side, and bare paper worse still",
          "[core][compare]") {
  Scene scene;
  scene.views = cone_views(), scene.pixels = 128, scene.corner = Corner{};
  const std::vector<float> model = box_between(Vec3(5, 10, 0), Vec3(45, 70, 40));
  const PrintedTarget target(model, {}, scene);
  const double own = target.measure(model).error(), flat = target.measure({}).error(),
               standing = target.measure(board(60)).error();
  CHECK(own < standing);
  CHECK(standing < flat);
  // Seen along the diagonal alone, any paper shows the model: parallax makes the difference.
  scene.views = {view_from(Vec3(1, 0, 1))};
  const PrintedTarget ahead(model, {}, scene);
  CHECK(ahead.measure({}).error() < 0.01);
  CHECK(ahead.measure(board(30)).error() < 0.03);
}

TEST_CASE("parallax shows where colours meet", "[core][compare]") {
  Scene scene;
  scene.views = cone_views(), scene.pixels = 128, scene.corner = Corner{};
  std::vector<float> model = box_between(Vec3(5, 10, 0), Vec3(45, 40, 40));
  const std::size_t first = model.size() / 9;
  append(model, box_between(Vec3(5, 40, 0), Vec3(45, 70, 40)));
  const std::vector<Rgb> red(model.size() / 9, Rgb{255, 0, 0});
  std::vector<Rgb> both = red;
  std::fill(both.begin() + static_cast<std::ptrdiff_t>(first), both.end(), Rgb{0, 0, 255});
  const double one = PrintedTarget(model, red, scene).measure(board(60)).colour,
               two = PrintedTarget(model, both, scene).measure(board(60)).colour;
  INFO(one << " in one colour, " << two << " in two");
  CHECK(two > 1.2 * one);
}

TEST_CASE("the detail of a picture is the length of its outline and of the borders of its colours",
          "[core][compare]") {
  // Two squares of 20 mm side by side, seen straight on: the diagonal is 20 sqrt(5) mm.
  const std::vector<float> plate{0, -20, 0, 0, 0,  0, 0, 0,  20, 0, -20, 0, 0, 0,  20, 0, -20, 20,
                                 0, 0,   0, 0, 20, 0, 0, 20, 20, 0, 0,   0, 0, 20, 20, 0, 0,   20};
  const std::vector<Rgb> two{{200, 60, 50}, {200, 60, 50}, {60, 120, 70}, {60, 120, 70}};
  Scene scene;
  scene.views = {view_from(Vec3(1, 0, 0))}, scene.pixels = 256;
  const double diagonal = 20.0 * std::sqrt(5.0);
  CHECK_THAT(PrintedTarget(plate, {}, scene).detail(), WithinAbs(120.0 / diagonal, 0.05));
  CHECK_THAT(PrintedTarget(plate, two, scene).detail(), WithinAbs(140.0 / diagonal, 0.05));
}

TEST_CASE("each layer is printed with what lies in its own depths", "[core][compare]") {
  const auto plate = [](float x, float high) {
    return std::vector<float>{x, -20, 0, x, 20, 0,    x, 20,  high,
                              x, -20, 0, x, 20, high, x, -20, high};
  };
  const std::vector<float> front = plate(0, 15), back = plate(-25, 40);
  std::vector<float> model = front;
  append(model, back);
  const std::vector<Rgb> colours{{255, 0, 0}, {255, 0, 0}, {0, 160, 0}, {0, 160, 0}};
  Scene scene;
  scene.views = page_views(), scene.pixels = 128;
  const PrintedTarget target(model, colours, scene);
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<PrintedLayer> layers{{front, -12.0, inf}, {back, -inf, -12.0}};
  const PrintedFigures right = target.measure_layers(layers);
  CHECK(right.cover == Approx(1.0));
  CHECK(right.contour == Approx(0.0));
  CHECK(right.colour < 0.02);
  // Both printed as the nearest of all: what shows above the front plate is right, the rest is not.
  const std::vector<PrintedLayer> alike{{front, -12.0, inf}, {back, -12.0, inf}};
  CHECK(target.measure_layers(alike).colour > right.colour + 0.05);
  CHECK(target.measure_layers(std::span(layers).first(1)).cover < 0.7);
  // Printed as it is seen from 45 degrees above: what lies 25 mm behind is 25 mm higher.
  const std::vector<float> raised = plate(0, 65);
  const PrintedLayer straight{raised, -inf, inf, 0.0}, fallen{raised, -inf, inf, 1.0};
  Scene above;
  above.views = {view_from(Vec3(1, 0, 1))}, above.pixels = 128;
  const PrintedTarget from_above(model, colours, above);
  CHECK(from_above.measure_layers(std::span(&fallen, 1)).colour < 0.02);
  CHECK(from_above.measure_layers(std::span(&straight, 1)).colour > 0.1);
  CHECK(from_above.measure_layers(std::span(&fallen, 1)).cover == Approx(1.0).margin(0.01));
  CHECK(page_views().size() == 9);
}

TEST_CASE("words for looks follow the error", "[core][compare]") {
  CHECK(looks({0.05, 0.02, 0.95}) == Looks::Good);
  CHECK(looks({0.08, 0.04, 0.90}) == Looks::Fair);
  CHECK(looks({0.2, 0.1, 0.6}) == Looks::Poor);
  CHECK(name_of(Looks::Fair) == std::string("fair"));
}

}  // namespace comparison_test
