// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/plan/drawing_transform.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "tests/support/value.hpp"

namespace drawing_transform_test {

using namespace popcut;

namespace {

/// A square corner from (20, 0) over (0, 0) to (0, 10), and a mountain fold.
LineWork drawing() {
  LineWork work;
  work.append(Operation::Cut, std::array<PagePoint, 3>{{{20, 0}, {0, 0}, {0, 10}}});
  work.append(Operation::FoldMountain, std::array<PagePoint, 2>{{{2, 1}, {12, 1}}});
  work.has_page = true;
  return work;
}

LineWork with(const PlanOptions& options) {
  return transformed(drawing(), drawing_transform(drawing(), options));
}

void check(PagePoint is, PagePoint should) {
  CHECK(is.x == Approx(should.x).margin(1e-12));
  CHECK(is.y == Approx(should.y).margin(1e-12));
}

}  // namespace

TEST_CASE("a drawing is left as it is unless its size or direction is changed", "[core][plan]") {
  CHECK(is_identity(drawing_transform(drawing(), {})));
  const LineWork same = with({});
  CHECK(same.points == drawing().points);
  CHECK(same.has_page);
}

TEST_CASE("rotate turns clockwise on the page", "[core][plan]") {
  PlanOptions options;
  options.rotate_deg = 90;
  const LineWork turned = with(options);
  CHECK(turned.points[0] == PagePoint{0, 20});  // right becomes down, exactly
  CHECK(turned.points[2] == PagePoint{-10, 0});
  CHECK_FALSE(turned.has_page);
  CHECK(turned.lines[1].operation == Operation::FoldMountain);
  options.rotate_deg = -30;
  check(with(options).points[0], {20 * std::cos(M_PI / 6), -20 * std::sin(M_PI / 6)});
}

TEST_CASE("a mirror image exchanges left and right, and mountains and valleys", "[core][plan]") {
  PlanOptions options;
  options.mirror = true;
  LineWork back = with(options);
  CHECK(back.points[0] == PagePoint{-20, 0});
  CHECK(back.points[2] == PagePoint{0, 10});
  CHECK(back.lines[0].operation == Operation::Cut);
  CHECK(back.lines[1].operation == Operation::FoldValley);
  options.rotate_deg = 90;  // the turn comes after
  back = with(options);
  CHECK(back.points[0] == PagePoint{0, -20});
  CHECK(back.points[2] == PagePoint{-10, 0});
}

TEST_CASE("scale and width give the size of the drawing on the sheet", "[core][plan]") {
  PlanOptions options;
  options.scale = 2.5;
  CHECK(with(options).points[0] == PagePoint{50, 0});
  options.scale = 1;
  options.width_mm = 100;
  CHECK(bounds(with(options)).width() == Approx(100));
  CHECK(bounds(with(options)).height() == Approx(50));
  options.rotate_deg = 90;  // the width is that of the result
  CHECK(bounds(with(options)).width() == Approx(100));
  CHECK(bounds(with(options)).height() == Approx(200));
  options.scale = 3;
  CHECK(check_plan_options(options).error().place == "/options/width");
  options.scale = 1;
  options.marks = true;
  CHECK(check_plan_options(options).error().place == "/options/marks");
}

TEST_CASE("the dashes of a scaled fold keep the material's size", "[core][plan]") {
  PlanOptions options;
  options.scale = 4;
  const Material paper = *find_material("paper-220");
  const auto planned = testing::value(plan(drawing(), *find_machine("cameo3"), paper, options));
  CHECK(planned.drawing_transform.xx == 4);
  double longest = 0;
  const Toolpath& path = planned.sheets.at(0).path;
  for (const Stroke& stroke : path.strokes)
    if (is_fold(stroke.operation)) {
      const auto points = path.points_of(stroke);
      longest = std::max(longest, std::hypot(points.back().x - points.front().x,
                                             points.back().y - points.front().y));
    }
  CHECK(longest > 0.5);
  CHECK(longest < 2 * paper.dashes.dash_mm);
}

TEST_CASE("copies lie in rows without touching, and no more than fit", "[core][plan]") {
  const LineWork one = drawing();  // 20 x 10 mm
  const auto places = testing::value(copies_at(one, 5, {70, 40}, 3));
  CHECK(places == std::vector<PagePoint>{{0, 0}, {23, 0}, {46, 0}, {0, 13}, {23, 13}});
  const LineWork many = copied(one, places);
  CHECK(many.lines.size() == 5 * one.lines.size());
  CHECK(bounds(many).width() == Approx(66));
  CHECK(bounds(many).height() == Approx(23));
  CHECK(copies_at(one, 9, {66, 36}, 3));  // exactly
  const auto error = copies_at(one, 10, {66, 36}, 3).error();
  CHECK(error.place == "/options/per-sheet");
  CHECK_THAT(error.detail, Catch::Contains("9 fit") && Catch::Contains("use at most 9"));
  CHECK_THAT(copies_at(one, 2, {19, 36}, 3).error().detail, Catch::Contains("none fit"));
  PlanOptions options;
  options.per_sheet = 2;
  options.marks = true;
  CHECK(check_plan_options(options).error().place == "/options/per-sheet");
}

TEST_CASE("a part without room beside its box is named in a bay of its outline", "[core][plan]") {
  const std::vector<PartOnSheet> parts{
      {"x7-2",
       {0, 0, 60, 60},
       {{{0, 0}, {60, 0}, {60, 20}, {20, 20}}, {{20, 20}, {20, 60}, {0, 60}, {0, 0}}}}};
  std::vector<std::string> without;
  const std::string svg = part_labels_svg(parts, {0, 0, 60, 60}, {}, &without);
  CHECK(without.empty());
  std::size_t places = 0;
  for (std::size_t at = svg.find_first_of("ML"); at != std::string::npos;
       at = svg.find_first_of("ML", at + 1)) {
    double x = 0, y = 0;
    if (std::sscanf(svg.c_str() + at + 1, "%lf %lf", &x, &y) != 2) continue;
    ++places;
    CHECK((x > 21.0 && y > 21.0 && x < 60.0 && y < 60.0));
  }
  CHECK(places > 8);
  const std::vector<PartOnSheet> whole{
      {"x7", {0, 0, 60, 60}, {{{0, 0}, {60, 0}, {60, 60}, {0, 60}, {0, 0}}}}};
  CHECK(part_labels_svg(whole, {0, 0, 60, 60}, {}, &without).empty());
  CHECK(without == std::vector<std::string>{"x7"});
}

TEST_CASE("each part of a drawing is named beside it, or reported as without room",
          "[core][plan]") {
  const std::vector<PartOnSheet> parts{{"card 1", {20, 20, 60, 80}, {}},
                                       {"card 2", {65, 20, 105, 80}, {}}};
  std::vector<std::string> without;
  const std::string svg = part_labels_svg(parts, {0, 0, 120, 100}, {}, &without);
  CHECK(without.empty());
  CHECK(part_names(parts) == "card 1, card 2");
  // No stroke comes within a millimetre of a part.
  Box all;
  for (std::size_t at = svg.find("d=\"M"); at != std::string::npos;
       at = svg.find("d=\"M", at + 1)) {
    PagePoint p;
    REQUIRE(std::sscanf(svg.c_str() + at + 4, "%lf %lf", &p.x, &p.y) == 2);
    all.add(p);
    for (const PartOnSheet& part : parts) {
      const Box& b = part.box;
      const bool beside = p.x < b.x0 - 1 || p.x > b.x1 + 1 || p.y < b.y0 - 1 || p.y > b.y1 + 1;
      CHECK(beside);
    }
  }
  CHECK(all.x0 >= 0);
  CHECK(all.y1 <= 100);
  // What is kept clear stays so; without any room the parts are told.
  std::vector<std::string> both;
  CHECK(part_labels_svg(parts, {20, 20, 63, 80}, {}, &both).empty());
  CHECK(both == std::vector<std::string>{"card 1", "card 2"});
  const std::string moved = part_labels_svg(parts, {0, 0, 120, 100}, {{0, 80, 120, 100}});
  CHECK(moved != svg);
  CHECK_FALSE(moved.empty());
}

}  // namespace drawing_transform_test
