// SPDX-License-Identifier: MIT
// Settings of a job for an operation, a colour or a layer.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/pens.hpp"
#include "core/plan/plan.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/svg_drafts.hpp"
#include "tests/support/value.hpp"

namespace pens_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

const Machine kCameo = *find_machine("cameo3");
const Material kPaper = *find_material("paper-220");

LineWork read_with(const std::string& text, const std::vector<std::string>& pens) {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("popcut");
  how.pens = pens;
  return value(linework_from_svg(text, how));
}

/// The pen of each line, in the order of the drawing.
std::vector<int> pens_of(const LineWork& work) {
  std::vector<int> out;
  for (const DrawnLine& line : work.lines) out.push_back(line.operation.pen);
  return out;
}

Plan planned(LineWork work, std::string_view pens, const PlanOptions& options = {}) {
  const auto material = value(with_pens(kPaper, pens));
  give_pens(work, material.pens);
  const auto made = plan(std::move(work), kCameo, material, options);
  INFO((made ? "" : message(made.error())));
  REQUIRE(made);
  return *made;
}

std::string dxf_line(const char* layer, int colour, int y) {
  return "0\nLINE\n8\n" + std::string(layer) + "\n62\n" + std::to_string(colour) + "\n10\n0\n20\n" +
         std::to_string(y) + "\n11\n50\n21\n" + std::to_string(y) + "\n";
}

}  // namespace

TEST_CASE("a pen is found by colour, group, layer and element, and the nearest name wins",
          "[core][formats][pens]") {
  const LineWork work = read_with(svg(R"x(<path d="M0 0H1" stroke="#F00"/>
      <path d="M0 0H2" stroke="rgb(255,0,0)" style="stroke:blue"/>
      <g inkscape:groupmode="layer" inkscape:label="Light Etch" stroke="red" id="g1">
        <path d="M0 0H3"/><path id="own" d="M0 0H4"/></g>
      <g color="red"><path d="M0 0H5" stroke="currentColor"/></g>
      <g id="red"><path d="M0 0H6" stroke="black"/></g>
      <path d="M0 0H7" stroke="black"/>)x"),
                                  {"red", "light_etch", "own", "layer red", "#0000FF"});
  CHECK(pens_of(work) == std::vector<int>{1, 5, 2, 3, 1, 4, 0});
  CHECK(std::count(work.looks.begin(), work.looks.end(), "layer Light Etch") == 1);
  CHECK(std::count(work.looks.begin(), work.looks.end(), "#ff0000") == 1);
  CHECK(pens_of(read_with(svg(R"x(<path d="M0 0H1" stroke="#F00"/>)x"), {})) ==
        std::vector<int>{0});
  // Nobody asked: nothing is gathered.
  CHECK(read(svg(R"x(<path d="M0 0H1" stroke="#F00"/>)x")).looks.empty());
}

TEST_CASE("pens of a DXF drawing are found by layer, AutoCAD index and true colour",
          "[core][formats][pens]") {
  DxfOptions how;
  how.pens = {"Etch", "red", "colour 30", "green", "layer 0"};
  const auto work =
      linework_from_dxf("0\nSECTION\n2\nENTITIES\n" + dxf_line("etch", 1, 0) + dxf_line("A", 1, 1) +
                            dxf_line("A", 30, 2) + dxf_line("A", 3, 3) + dxf_line("0", 5, 4) +
                            dxf_line("A", 5, 5) + "0\nENDSEC\n0\nEOF\n",
                        how);
  REQUIRE(work);
  CHECK(pens_of(*work) == std::vector<int>{1, 2, 3, 4, 5, 0});
}

TEST_CASE("each pen's strokes have its settings and come together", "[core][plan][pens]") {
  // Two rows of squares, red and blue in turn; and a blue square inside a red one.
  LineWork work;
  const auto square = [&](double x, double y, double side, std::uint8_t pen) {
    const std::vector<PagePoint> points{
        {x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}, {x, y}};
    work.append({Operation::Cut, pen}, points);
  };
  for (int i = 0; i < 10; ++i) square(20.0 * i, 0, 10, static_cast<std::uint8_t>(i % 3));
  square(0, 40, 30, 1);
  square(10, 50, 10, 2);
  const Plan made = planned(work, "red: force=70 passes=3; blue: speed=50; cut: force=140");
  const Toolpath& path = made.sheets[0].path;
  REQUIRE(path.strokes.size() == 12);
  std::size_t changes = 0;
  for (std::size_t i = 0; i < path.strokes.size(); ++i) {
    const Stroke& stroke = path.strokes[i];
    CHECK(stroke.force_gf == (stroke.pen == 1 ? 70 : 140));
    CHECK(stroke.speed_mm_s == (stroke.pen == 2 ? 50 : kPaper.cut.speed_mm_s));
    CHECK(stroke.rounds == (stroke.pen == 1 ? 3 : kPaper.cut.passes));
    changes += i > 0 && stroke.pen != path.strokes[i - 1].pen ? 1 : 0;
  }
  // The red square around the blue one waits for it.
  CHECK(path.strokes.back().pen == 1);
  CHECK(changes == 3);
}

TEST_CASE("an overcut is measured on one round of each pen", "[core][plan][pens]") {
  LineWork work;
  const auto triangle = [&](double x, std::uint8_t pen) {
    work.append({Operation::Cut, pen},
                std::vector<PagePoint>{{x, 0}, {x + 0.3, 0}, {x, 0.4}, {x, 0}});
  };
  triangle(0, 0);
  triangle(5, 1);
  const Plan made = planned(work, "red: passes=4");
  const PlannedSheet& sheet = made.sheets[0];
  REQUIRE(sheet.sent);
  for (std::size_t i = 0; i < 2; ++i) {
    const Stroke& stroke = sheet.sent->strokes[i];
    // 1.2 mm around: the overcut of 0.5 mm at both ends is held to a quarter of that.
    CHECK(length(sheet.sent->points_of(stroke)) ==
          Approx(stroke.pen == 1 ? 4 * 1.2 + 0.6 : 1.2 + 0.6));
  }
}

TEST_CASE("lines of two pens are neither joined nor cut twice", "[core][plan][pens]") {
  LineWork work;
  work.append({Operation::Cut, 1}, std::vector<PagePoint>{{0, 0}, {10, 0}});
  work.append({Operation::Cut, 2}, std::vector<PagePoint>{{10, 0}, {20, 0}});
  work.append({Operation::Cut, 2}, std::vector<PagePoint>{{0, 5}, {10, 5}});
  work.append({Operation::Cut, 1}, std::vector<PagePoint>{{2, 5}, {8, 5}});
  const Plan made = planned(work, "red: force=70; blue: force=140");
  const Toolpath& path = made.sheets[0].path;
  double mm = 0;
  for (const Stroke& stroke : path.strokes) mm += length(path.points_of(stroke));
  CHECK(path.strokes.size() == 3);
  CHECK(mm == Approx(30));
}

TEST_CASE("pens of operations leave lines of other pens and scored folds alone",
          "[core][plan][pens]") {
  LineWork work;
  work.append(Operation::FoldMountain, std::vector<PagePoint>{{10, 10}, {60, 10}});
  work.append({Operation::FoldMountain, 1}, std::vector<PagePoint>{{10, 20}, {60, 20}});
  work.append(Operation::FoldValley, std::vector<PagePoint>{{10, 30}, {60, 30}});
  // Too short for a dash: half cut, whatever force a pen has.
  work.append(Operation::FoldMountain, std::vector<PagePoint>{{10, 40}, {10.6, 40}});
  const Plan made = planned(work, "red: force=70; mountain: force=210 speed=20");
  std::array<std::size_t, 3> strokes{};
  for (const Stroke& stroke : made.sheets[0].path.strokes) {
    ++strokes.at(stroke.pen);
    if (stroke.operation == Operation::FoldValley) CHECK(stroke.pen == 0);
    if (stroke.pen == 1) CHECK(stroke.force_gf == 70);
    if (stroke.pen == 2) CHECK(stroke.force_gf == 210);
    if (stroke.pen == 0) CHECK(stroke.force_gf < 210);
  }
  CHECK(made.sheets[0].scored.size() == 1);
  CHECK(strokes[1] > 5);
  CHECK(strokes[2] == strokes[1]);
}

TEST_CASE("a pen without a line is refused with what the drawing has", "[core][plan][pens]") {
  const auto error = [](const LineWork& work, std::string_view pens) {
    LineWork given = work;
    const auto material = value(with_pens(kPaper, pens));
    give_pens(given, material.pens);
    const auto checked = check_pens(given, material.pens);
    return checked ? std::string("accepted") : message(checked.error());
  };
  const LineWork drawn =
      read_with(svg(R"x(<path d="M0 0H1" stroke="#F00"/><g id="Etch"><path d="M0 0H1"
      stroke="blue"/></g>)x"),
                {"gold"});
  CHECK_THAT(error(drawn, "gold: force=3"),
             Catch::Contains("--pen") || Catch::Contains("/options/pen"));
  CHECK_THAT(error(drawn, "gold: force=3"),
             Catch::Contains("the drawing has #ff0000, layer Etch, #0000ff"));
  CHECK_THAT(error(test_shape(), "gold: force=3"),
             Catch::Contains("this drawing has none; name cut"));
  CHECK_THAT(error(drawn, "cuts: force=3"), Catch::Contains("did you mean cut?"));
  CHECK_THAT(error(drawn, "mountain: force=3"), Catch::Contains("no mountain fold"));
  CHECK(error(test_shape(), "valley: force=3; outline: speed=9; cut: force=5") == "accepted");
  std::string many;
  for (int i = 0; i < 65; ++i) many += "l" + std::to_string(i) + ": force=3;";
  CHECK_THAT(message(with_pens(kPaper, many).error()), Catch::Contains("at most 64"));
}

}  // namespace pens_test
