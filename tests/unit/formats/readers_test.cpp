// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"
#include "tests/support/linework_checks.hpp"

namespace readers_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

std::string svg(
    const std::string& inner,
    const std::string& head = R"x(width="100mm" height="100mm" viewBox="0 0 100 100")x") {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"i\" " + head + ">" + inner +
         "</svg>";
}

Result<SvgLines> parse_svg_path(std::string_view data, double tolerance, std::size_t most_points) {
  SvgLines lines;
  return read_svg_path(data, tolerance, most_points, lines).map([&] { return lines; });
}

LineWork read(const std::string& text, SvgProfile profile = SvgProfile::Popcut) {
  const auto work = linework_from_svg(text, profile);
  INFO((work ? "" : message(work.error())));
  REQUIRE(work);
  return *work;
}

std::string place_of(const std::string& text) {
  const auto work = linework_from_fold(text);
  REQUIRE_FALSE(work);
  return work.error().place;
}

}  // namespace

TEST_CASE("path data is read with all its commands", "[core][formats][svg]") {
  const auto lines = parse_svg_path("M0,0h10v10H0z m20 20 5 0 0 5 M1 1L.5.5-1-1", 0.01, 1000);
  REQUIRE(lines);
  REQUIRE(lines->size() == 3);
  CHECK((*lines)[0].size() == 5);
  CHECK((*lines)[0].front() == (*lines)[0].back());
  CHECK((*lines)[1][2] == PagePoint{25, 25});
  CHECK((*lines)[2][1] == PagePoint{0.5, 0.5});
  CHECK((*lines)[2][2] == PagePoint{-1, -1});
  for (const char* wrong : {"L1 1", "M", "M1", "M1 1L", "M1 1 x", "M1 1L1,,1", "M1 1A1 1 0 2 0 3 3",
                            "Z", "M1 1Z1 1", "Minf 1", "M1e999 1"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_svg_path(wrong, 0.01, 1000));
  }
  CHECK_FALSE(parse_svg_path("M0 0C0 1000 1000 1000 1000 0", 1e-9, 1000));
}

TEST_CASE("curves stay within tolerance of their chords", "[core][formats][svg]") {
  const double r = 50;
  const auto circle = parse_svg_path("M50 0A50 50 0 0 1 -50 0 50 50 0 01 50,0", 0.02, 100000);
  REQUIRE(circle);
  const auto& points = (*circle)[0];
  for (std::size_t i = 1; i < points.size(); ++i) {
    const PagePoint middle{(points[i - 1].x + points[i].x) / 2,
                           (points[i - 1].y + points[i].y) / 2};
    CHECK(std::hypot(points[i].x, points[i].y) == Approx(r));
    CHECK(r - std::hypot(middle.x, middle.y) <= 0.02 + 1e-9);
  }
  CHECK(length(points) == Approx(2 * M_PI * r).epsilon(1e-3));
  CHECK(turning(points) > 0);  // sweep 1: clockwise on a page with y down
  const auto bezier =
      parse_svg_path("M0 0C0 40 60 40 60 0S120-40 120 0Q140 40 160 0T200 0", 0.02, 100000);
  REQUIRE(bezier);
  CHECK((*bezier)[0].back() == PagePoint{200, 0});
  // The S part is the C part turned by half a turn about (60, 0).
  double low = 0, high = 0;
  for (const PagePoint& p : (*bezier)[0]) {
    if (p.x <= 60) high = std::max(high, p.y);
    if (p.x > 60 && p.x <= 120) low = std::min(low, p.y);
  }
  CHECK(high == Approx(30).epsilon(1e-3));
  CHECK(low == Approx(-30).epsilon(1e-3));
}

TEST_CASE("transforms are applied from the inside out", "[core][formats][svg]") {
  const auto t = parse_svg_transform("translate(10,20) rotate(90) scale(2 3)");
  REQUIRE(t);
  const PagePoint p = (*t)({1, 1});
  CHECK(p.x == Approx(7));
  CHECK(p.y == Approx(22));
  const PagePoint q = (*parse_svg_transform("rotate(90 5 5)"))({6, 5});
  CHECK(q.x == Approx(5));
  CHECK(q.y == Approx(6));
  CHECK(t->largest_scale() == Approx(3));
  CHECK_FALSE(parse_svg_transform("rotate(90"));
  CHECK_FALSE(parse_svg_transform("scale(1 2 3)"));
  CHECK_FALSE(parse_svg_transform("sqew(1)"));
}

TEST_CASE("shapes are converted to millimetres", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<g stroke="black" transform="translate(5 5)">
      <rect x="0" y="0" width="10" height="20"/><circle cx="50" cy="50" r="10"/>
      <line x1="0" y1="0" x2="3" y2="4"/><polyline points="0,0 1,0 1,1"/>
      <polygon points="0 0 4 0 4 3"/><ellipse cx="9" cy="9" rx="3" ry="2"/></g>)x"));
  REQUIRE(work.lines.size() == 6);
  CHECK(length(work.points_of(work.lines[0])) == Approx(60));
  CHECK(work.points_of(work.lines[0])[0] == PagePoint{5, 5});
  CHECK(length(work.points_of(work.lines[1])) == Approx(20 * M_PI).epsilon(2e-3));
  CHECK(length(work.points_of(work.lines[2])) == Approx(5));
  CHECK(length(work.points_of(work.lines[3])) == Approx(2));
  CHECK(length(work.points_of(work.lines[4])) == Approx(12));
  CHECK(work.warnings.empty());
  CHECK(work.points_of(work.lines[1]).front() == work.points_of(work.lines[1]).back());
  const LineWork pixels = read(svg("<path stroke='red' d='M0 0H96'/>", "width='200' height='100'"));
  CHECK(length(pixels.points) == Approx(25.4));
  CHECK(pixels.warnings.size() == 1);
  const LineWork inches =
      read(svg("<path stroke='red' d='M0 0H10'/>", "width='2in' height='1in' viewBox='0 0 20 10'"));
  CHECK(length(inches.points) == Approx(25.4));
  const LineWork round = read(svg("<rect stroke='red' width='20' height='10' rx='2'/>"));
  CHECK(length(round.points) == Approx(60 - 16 + 4 * M_PI).epsilon(2e-3));
}

TEST_CASE("assignments and layers and profiles give a line its meaning", "[core][formats][svg]") {
  const std::string text =
      svg(R"x(<g inkscape:groupmode="layer" inkscape:label="fold-valley" stroke="#000">
      <path d="M0 0H1"/><path d="M0 1H2" data-assignment="M"/><path d="M0 1H2" data-assignment="F"/></g>
      <g stroke="red"><path d="M0 2H4"/><path d="M0 3H5" style="stroke: rgb(0,0,255); fill:none"/>
      <path d="M0 4H6" stroke="#0f0"/><path d="M0 5H7" stroke="none"/><path d="M0 5H7" display="none"/></g>)x");
  const LineWork own = read(text);
  CHECK(total_mm(own, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(own, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(own, Operation::Cut) == Approx(15));
  const LineWork simulator = read(text, SvgProfile::OrigamiSim);
  CHECK(total_mm(simulator, Operation::FoldMountain) == Approx(2 + 4));
  CHECK(total_mm(simulator, Operation::FoldValley) == Approx(1 + 5));
  CHECK(total_mm(simulator, Operation::Cut) == Approx(6));
  const LineWork plain = read(text, SvgProfile::Plain);
  CHECK(total_mm(plain, Operation::Cut) == Approx(1 + 2 + 2 + 4 + 5 + 6));
}

TEST_CASE("lines dashed by their style are cut as those dashes", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="2"/>
      <path d="M0 5H10" stroke="red" style="stroke-dasharray:3,1;stroke-dashoffset:1"/>)x"));
  REQUIRE(work.lines.size() == 3 + 3);
  CHECK(total_mm(work, Operation::Cut) == Approx(6 + 2 + 3 + 3));
  CHECK(work.warnings.size() == 1);
  const LineWork fold =
      read(svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="2" data-assignment="M"/>)x"));
  CHECK(total_mm(fold, Operation::FoldMountain) == Approx(10));
  CHECK_FALSE(linework_from_svg(
      svg(R"x(<path d="M0 0H10" stroke="red" stroke-dasharray="1e-9"/>)x"), SvgProfile::Plain));
}

TEST_CASE("elements that cannot be cut are named with their number and place",
          "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<text id="t">hello</text>
      <image/><image/><use href="#a"/><defs><path d="M0 0H9" stroke="red"/></defs>)x"));
  CHECK(work.lines.empty());
  std::string all;
  for (const Warning& warning : work.warnings) all += warning.message + "\n";
  CAPTURE(all);
  CHECK(all.find("1 <text> cannot be read and is left out; at line 1 (id \"t\")") !=
        std::string::npos);
  CHECK(all.find("2 <image> cannot be read and are left out; the first at line 2") !=
        std::string::npos);
  CHECK(all.find("1 <use> of a missing element") != std::string::npos);
}

TEST_CASE("a drawing that cannot be read is refused with line and column", "[core][formats][svg]") {
  const auto wrong =
      linework_from_svg(svg("\n  <path stroke='red' d='M0 0 L5'/>"), SvgProfile::Plain);
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().kind == ErrorKind::Malformed);
  CHECK(wrong.error().place.rfind("line 2, column", 0) == 0);
  for (const std::string& text :
       {std::string(), std::string("hello"), std::string("<svg"), std::string("<html/>"),
        svg("<path stroke='red' d='M0 0H1' transform='scale(1e300)'/>"),
        svg("<rect stroke='red' width='a'/>"), svg("", "viewBox='0 0 0 0'")}) {
    CAPTURE(text);
    CHECK_FALSE(linework_from_svg(text, SvgProfile::Plain));
  }
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<g>";
  for (int i = 0; i < 5000; ++i) deep += "</g>";
  CHECK_FALSE(linework_from_svg(svg(deep), SvgProfile::Plain));
}

TEST_CASE("FOLD vertices are turned onto the page and never mirrored", "[core][formats][fold]") {
  const auto work = linework_from_fold(R"x({"frame_unit": "cm",
    "vertices_coords": [[0,0],[3,0],[3,1],[0,1],[1,0],[1,1]],
    "edges_vertices": [[0,4],[4,1],[1,2],[2,5],[5,3],[3,0],[4,5]],
    "edges_assignment": ["B","B","B","B","B","B","M"]})x");
  REQUIRE(work);
  CHECK(work->warnings.empty());
  CHECK(count(*work, Operation::Outline) == 1);
  CHECK(total_mm(*work, Operation::Outline) == Approx(80));
  REQUIRE(count(*work, Operation::FoldMountain) == 1);
  const auto fold = work->points_of(work->lines[0]);
  CHECK(fold[0] == PagePoint{0, 10});
  CHECK(fold[1] == PagePoint{10, 10});
}

TEST_CASE("two borders on one line become a slit that is cut once", "[core][formats][fold]") {
  // A 4 x 2 sheet with a slit from (1,1) to (3,1): its sides have vertices 6 and 7 of their own and
  // are divided differently.
  const auto work = linework_from_fold(R"x({"frame_unit": "mm",
    "vertices_coords": [[0,0],[40,0],[40,20],[0,20],[10,10],[30,10],[20,10],[25,10]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,6],[6,5],[4,7],[7,5]],
    "edges_assignment": ["B","B","B","B","B","B","B","B"]})x");
  REQUIRE(work);
  CHECK(total_mm(*work, Operation::Outline) == Approx(120));
  CHECK(total_mm(*work, Operation::Cut) >= 20.0 - 1e-9);
  // A hole is a cut and no outline.
  const auto hole = linework_from_fold(R"x({"frame_unit": "mm",
    "vertices_coords": [[0,0],[40,0],[40,20],[0,20],[10,5],[30,5],[30,15],[10,15]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,7],[7,4]],
    "edges_assignment": ["B","B","B","B","B","B","B","B"]})x");
  REQUIRE(hole);
  CHECK(total_mm(*hole, Operation::Outline) == Approx(120));
  CHECK(total_mm(*hole, Operation::Cut) == Approx(60));
}

TEST_CASE("FOLD edges keep their meaning", "[core][formats][fold]") {
  const auto work = linework_from_fold(
      R"x({"frame_unit": "mm", "vertices_coords": [[0,0],[0,1],[0,3],[0,6],[0,10],[0,15]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5]],
    "edges_assignment": ["C","F","U","U",null], "edges_foldAngles": [0,0,-90,null,45]})x");
  REQUIRE(work);
  CHECK(total_mm(*work, Operation::Cut) == Approx(1));
  CHECK(total_mm(*work, Operation::FoldMountain) == Approx(3));
  CHECK(total_mm(*work, Operation::FoldValley) == Approx(5));
  CHECK(work->warnings.size() == 3);
}

TEST_CASE("an invalid FOLD file is refused with its place", "[core][formats][fold]") {
  CHECK(place_of("{") == "line 1, column 1");
  CHECK(place_of("[]") == "/");
  CHECK(place_of(R"x({"vertices_coord": []})x") == "/vertices_coords");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1]]})x") == "/vertices_coords/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,"a"]]})x") == "/vertices_coords/1/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,2]]})x") ==
        "/edges_vertices/0/1");
  CHECK(place_of(R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,-1]]})x") ==
        "/edges_vertices/0/1");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]], "edges_assignment": ["Q"]})x") ==
      "/edges_assignment/0");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]], "edges_assignment": []})x") ==
      "/edges_assignment");
  CHECK(place_of(R"x({"vertices_coords": [[0,0,1],[1,1,2]], "edges_vertices": [[0,1]]})x") ==
        "/vertices_coords");
  CHECK(
      place_of(
          R"x({"vertices_coords": [[0,0]], "file_frames": [{"frame_inherit": true, "frame_parent": 7}]})x") ==
      "/file_frames/0/frame_parent");
  CHECK(
      place_of(
          R"x({"frame_unit": "ell", "vertices_coords": [[0,0],[1,1]], "edges_vertices": [[0,1]]})x") ==
      "/frame_unit");
  CHECK_FALSE(linework_from_fold(std::string(1'000'000, '[')));
}

TEST_CASE("sample drawings of other programs are read or refused as expected", "[core][formats]") {
  if (sample("fold/fold_simple.fold").empty()) {
    WARN("skipped: the sample drawings are not here");
    return;
  }
  for (const char* name : {"fold_simple", "fold_box", "fold_diagonal-cp", "re_no-faces",
                           "re_panels-6x2-90deg", "re_windmill"}) {
    CAPTURE(name);
    const auto file = read_fold(sample(std::string("fold/") + name + ".fold"));
    INFO((file ? "" : message(file.error())));
    CHECK(file);
  }
  for (const char* name : {"re_invalid-key-names", "re_invalid-mismatch-length"}) {
    CAPTURE(name);
    const auto file = read_fold(sample(std::string("fold/") + name + ".fold"));
    REQUIRE_FALSE(file);
    CHECK_FALSE(file.error().detail.empty());
    CHECK_FALSE(file.error().place.empty());
  }
  const auto panels = linework_from_fold(sample("fold/re_panels-6x2-90deg.fold"));
  REQUIRE(panels);
  CHECK(count(*panels, Operation::Outline) == 1);
  for (const char* name : {"os_popupSimple", "os_housePopup", "os_miura-ori", "re_hex-box"}) {
    CAPTURE(name);
    const auto work =
        linework_from_svg(sample(std::string("fold/") + name + ".svg"), SvgProfile::OrigamiSim);
    INFO((work ? "" : message(work.error())));
    REQUIRE(work);
    CHECK(work->lines.size() > 10);
    CHECK(total_mm(*work, Operation::FoldValley) > 0);
  }
}

}  // namespace readers_test
