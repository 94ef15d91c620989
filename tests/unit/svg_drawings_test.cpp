// SPDX-License-Identifier: MIT
// What drawings of other programs do that readers are known to get wrong.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/svg_colour.hpp"
#include "core/formats/svg_dash.hpp"
#include "core/formats/svg_profile.hpp"
#include "core/formats/svg_reader.hpp"
#include "core/plan/micro_cut.hpp"
#include "tests/support/linework_checks.hpp"

using namespace popcut;
using namespace popcut::test;

namespace {

constexpr const char* kPage = R"x(width="100mm" height="100mm" viewBox="0 0 100 100")x";

std::string svg(const std::string& inner, const std::string& head = kPage) {
  return R"x(<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="l" xmlns:inkscape="i" )x" + head +
         ">" + inner + "</svg>";
}

LineWork read(const std::string& text, const char* profile = "popcut") {
  SvgReadOptions how;
  const auto found = find_stroke_profile(profile);
  INFO((found ? "" : message(found.error())));
  REQUIRE(found);
  how.profile = *found;
  const auto work = linework_from_svg(text, how);
  INFO((work ? "" : message(work.error())));
  REQUIRE(work);
  return *work;
}

Error error_of(const std::string& text, SvgLimits limits = {}) {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("popcut");
  how.limits = limits;
  const auto work = linework_from_svg(text, how);
  REQUIRE_FALSE(work);
  CHECK(work.error().detail.find('\n') == std::string::npos);
  return work.error();
}

bool is_told(const LineWork& work, const std::string& part) {
  return std::any_of(work.warnings.begin(), work.warnings.end(), [&](const std::string& warning) {
    return warning.find(part) != std::string::npos;
  });
}

// The x of both ends of each line.
std::vector<double> spans(const LineWork& work) {
  std::vector<double> out;
  for (const DrawnLine& line : work.lines) {
    out.push_back(work.points_of(line).front().x);
    out.push_back(work.points_of(line).back().x);
  }
  return out;
}

void check_spans(const LineWork& work, const std::vector<double>& expected) {
  const std::vector<double> got = spans(work);
  CAPTURE(got);
  REQUIRE(got.size() == expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) CHECK(got[i] == Approx(expected[i]).margin(1e-9));
}

}  // namespace

TEST_CASE("dashes are cut whatever way they are written", "[core][formats][svg][dashes]") {
  const std::string line = R"x(<path d="M0 0H10" stroke="red" )x";
  const std::vector<double> four_two{0, 4, 6, 10};
  for (const std::string& text : {
           line + R"x(stroke-dasharray="4,2"/>)x",
           line + R"x(stroke-dasharray="4 2"/>)x",
           line + R"x(stroke-dasharray=" 4 , 2 "/>)x",
           // 96 units to the inch, whatever the page makes of them
           line + R"x(stroke-dasharray="1.0583333333mm 0.0529166667cm"/>)x",
           line + R"x(stroke-dasharray="3pt 0.02083333333in"/>)x",
           line + R"x(stroke-dasharray="0.25em .125em"/>)x",
           line + R"x(stroke-dasharray="4% 2%"/>)x",
           line + R"x(style="stroke-dasharray:4,2"/>)x",
           line + R"x(style="stroke-dasharray: 4 2 ; fill:none"/>)x",
           line + R"x(style="stroke-dasharray:4/* gap */2"/>)x",
           line + R"x(class="d"/><style>.d{stroke-dasharray:4px 2px}</style>)x",
           line + R"x(stroke-dasharray="inherit"/>)x",
           line + R"x(stroke-dasharray="4,-2"/>)x",  // not lawful: what is inherited stays
           line + "/>",
       }) {
    CAPTURE(text);
    check_spans(read(svg(R"x(<g stroke-dasharray="4 2">)x" + text + "</g>")), four_two);
    check_spans(read(svg(R"x(<g style="stroke-dasharray:4,2">)x" + text + "</g>"), "plain"),
                four_two);
  }
}

TEST_CASE("dashes repeat and begin as SVG says", "[core][formats][svg][dashes]") {
  const auto dashes = [](const std::string& attributes) {
    return read(svg(R"x(<path d="M0 0H10" stroke="red" )x" + attributes + "/>"));
  };
  check_spans(dashes(R"x(stroke-dasharray="3")x"), {0, 3, 6, 9});
  check_spans(dashes(R"x(stroke-dasharray="3 1 1")x"), {0, 3, 4, 5, 8, 9});  // taken twice
  check_spans(dashes(R"x(stroke-dasharray="none")x"), {0, 10});
  check_spans(dashes(R"x(stroke-dasharray="0 0")x"), {0, 10});
  check_spans(dashes(R"x(stroke-dasharray="0")x"), {0, 10});
  check_spans(dashes(R"x(stroke-dasharray="4 2" stroke-dashoffset="1")x"), {0, 3, 5, 9});
  check_spans(dashes(R"x(stroke-dasharray="4 2" stroke-dashoffset="-1")x"), {1, 5, 7, 10});
  check_spans(dashes(R"x(stroke-dasharray="4 2" stroke-dashoffset="0.75pt")x"), {0, 3, 5, 9});
  check_spans(dashes(R"x(stroke-dasharray="4 2" style="stroke-dashoffset:1%")x"), {0, 3, 5, 9});
  check_spans(dashes(R"x(stroke-dasharray="4 2" stroke-dashoffset="600001")x"), {0, 3, 5, 9});
  check_spans(dashes(R"x(stroke-dasharray="20")x"), {0, 10});
  const LineWork dots = dashes(R"x(stroke-dasharray="0 2" stroke-linecap="round")x");
  CHECK(dots.lines.empty());
  CHECK(is_told(dots, "1 line is dashed into dots"));
  // Each part of a path begins anew, and curves and closed lines are dashed along their length.
  const LineWork parts =
      read(svg(R"x(<path d="M0 0H5M0 5H5" stroke="red" stroke-dasharray="4 2"/>)x"));
  check_spans(parts, {0, 4, 0, 4});
  const LineWork ring =
      read(svg(R"x(<circle cx="50" cy="50" r="10" stroke="red" stroke-dasharray="1"/>)x"));
  CHECK(ring.lines.size() == 32);
  CHECK(total_mm(ring, Operation::Cut) == Approx(10 * M_PI).margin(1.0));
  // A dash is as long on the page as its transform makes it.
  check_spans(read(svg(R"x(<g transform="scale(2 1)"><path d="M0 0H10" stroke="red"
      stroke-dasharray="4 2"/></g>)x")),
              {0, 8, 12, 20});
  check_spans(read(svg(R"x(<g transform="scale(2 1)"><path d="M0 0H10" stroke="red"
      vector-effect="non-scaling-stroke" stroke-dasharray="30.2362204724"/></g>)x")),
              {0, 8, 16, 20});
}

TEST_CASE("dashes that nobody could cut are refused", "[core][formats][svg][dashes]") {
  const auto dashed = [](const std::string& list) {
    return svg("\n<path id='p' d='M0 0H10' stroke='red' stroke-dasharray='" + list + "'/>");
  };
  for (const char* list : {"1e-9", "1e-320", "1e-300 1e-300"}) {
    CAPTURE(list);
    const Error error = error_of(dashed(list));
    CHECK(error.kind == ErrorKind::OutOfRange);
    CHECK(error.place == "line 2, column 1, id \"p\"");
  }
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "1 ";
  CHECK(error_of(dashed(many)).detail.find("more than 1000 numbers") != std::string::npos);
  CHECK(read(dashed("1e300")).lines.size() == 1);
}

TEST_CASE("folds and scores stay whole for the material to dash", "[core][formats][svg][dashes]") {
  const LineWork work = read(svg(R"x(<g stroke="red" stroke-dasharray="2 1">
      <path d="M0 0H10" data-assignment="M"/><path d="M0 1H20" data-assignment="score"/></g>)x"));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(10));
  CHECK(total_mm(work, Operation::Score) == Approx(20));
  CHECK(work.warnings.empty());
}

TEST_CASE("style sheets are read with their order of precedence", "[core][formats][svg][css]") {
  const auto cut_mm = [](const std::string& sheet, const std::string& attributes) {
    return total_mm(
        read(svg("<style>" + sheet + R"x(</style><g class="out" id="G"><path d="M0 0H5" )x" +
                 attributes + "/></g>"),
             "origami-sim"),
        Operation::FoldMountain);
  };
  const std::string cls = R"x(class="a b" id="p")x";
  CHECK(cut_mm(".a{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("path{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("*{stroke:#f00}", cls) == Approx(5));
  CHECK(cut_mm("#p{stroke:rgb(255,0,0)}", cls) == Approx(5));
  CHECK(cut_mm("path.a.b#p{stroke:RED}", cls) == Approx(5));
  CHECK(cut_mm(".x, .b{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("g path{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("#G > .a{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("svg > .a{stroke:red}", cls) == 0);
  CHECK(cut_mm("svg .out > path{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("[id=\"p\"]{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm("svg|path{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm(".out{stroke:red}", cls) == Approx(5));  // inherited
  CHECK(cut_mm(".c\\6C s{stroke:red}", "class='cls'") == Approx(5));
  CHECK(cut_mm("<![CDATA[<!-- .a{stroke:red} -->]]>", cls) == Approx(5));
  CHECK(
      cut_mm("/* .a{} */ @charset 'x'; @media screen{.a{stroke:red}} @media print{.a{stroke:blue}}",
             cls) == Approx(5));
  CHECK(cut_mm(".a:hover{stroke:blue} .a{stroke:red}", cls) == Approx(5));
  // id over class over type, later over earlier, style over sheets, !important over all.
  CHECK(cut_mm("#p{stroke:red} .a{stroke:blue} path{stroke:blue}", cls) == Approx(5));
  CHECK(cut_mm(".a.b{stroke:red} .b{stroke:blue}", cls) == Approx(5));
  CHECK(cut_mm(".a{stroke:blue} .b{stroke:red}", cls) == Approx(5));
  CHECK(cut_mm(".a{stroke:red}", cls + " stroke='blue'") == Approx(5));
  CHECK(cut_mm("#p{stroke:blue}", cls + " style='stroke:red'") == Approx(5));
  CHECK(cut_mm("path{stroke:red!important}", cls + " style='stroke:blue'") == Approx(5));
  CHECK(cut_mm("path{stroke:blue !important}", cls + " style='stroke:red ! important'") ==
        Approx(5));
  CHECK(cut_mm(".a{stroke:currentColor;color:red}", cls) == Approx(5));
  // A sheet counts wherever it stands, in CDATA too.
  const LineWork late = read(svg(R"x(<path d="M0 0H5" class="q"/>
      <g><style type="text/css"><![CDATA[ .q { fill:none; stroke:#F00 } ]]></style></g>)x"),
                             "origami-sim");
  CHECK(total_mm(late, Operation::FoldMountain) == Approx(5));
}

TEST_CASE("style sheets that are not understood are named", "[core][formats][svg][css]") {
  const LineWork work = read(svg(R"x(<style>path + path{stroke:blue} @import url(http://a/b.css);
      @supports (x:y){path{stroke:red}} path{stroke:var(--c);transform:scale(2)}</style>
      <path d="M0 0H5" stroke="red"/>)x"));
  CHECK(work.lines.size() == 1);
  CHECK(is_told(work,
                "1 selector of a style sheet is not known and is passed over; at \"path + path\""));
  CHECK(is_told(work, "1 block of a style sheet"));
  CHECK(is_told(work, "1 style sheet of another file is not read"));
  CHECK(is_told(work, "\"var(--c)\""));
  CHECK(is_told(work, "1 style sets a shape or a transform"));
  CHECK(is_told(read("<?xml version='1.0'?><?xml-stylesheet href='a.css'?>" + svg("")),
                "1 style sheet of another file"));
}

TEST_CASE("hidden layers are left out and named", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<g stroke="red" fill="none">
      <g inkscape:groupmode="layer" style="display:none"><path d="M0 0H5"/></g>
      <g visibility="hidden"><path d="M0 0H7"/><path d="M0 0H9" visibility="visible"/></g>
      <path d="M0 0H11" opacity="0"/><path d="M0 0H11" style="stroke-opacity:0%"/></g>)x"));
  CHECK(total_mm(work, Operation::Cut) == Approx(9));
  CHECK(is_told(work, "2 hidden layers, groups or shapes are left out; the first at line 2"));
  CHECK(is_told(work, "2 shapes have neither stroke nor fill"));
}

TEST_CASE("rectangles are as round as they are drawn", "[core][formats][svg]") {
  const auto around = [](const std::string& radii) {
    const LineWork work =
        read(svg("<rect x='5' y='5' stroke='red' width='20' height='10' " + radii + "/>"));
    REQUIRE(work.lines.size() == 1);
    CHECK(closed(work.points));
    return length(work.points);
  };
  const double two = 60 - 16 + 4 * M_PI;
  CHECK(around("") == Approx(60));
  CHECK(around("rx='2'") == Approx(two).epsilon(2e-3));
  CHECK(around("ry='2'") == Approx(two).epsilon(2e-3));
  CHECK(around("rx='2px' ry='auto'") == Approx(two).epsilon(2e-3));
  CHECK(around("rx='2%'") == Approx(two).epsilon(2e-3));
  CHECK(around("rx='0' ry='3'") == Approx(60));
  CHECK(around("rx='50' ry='5'") == Approx(48.442).epsilon(2e-3));  // an ellipse of 20 by 10
  const LineWork pill = read(svg("<rect stroke='red' width='20' height='10' rx='5'/>"));
  for (const PagePoint& p : pill.points) CHECK((p.y >= -1e-9 && p.y <= 10 + 1e-9));
}

TEST_CASE("use draws what it names where it says", "[core][formats][svg][use]") {
  const LineWork work = read(svg(R"x(<defs><path id="p" d="M0 0H10"/>
      <symbol id="s" viewBox="0 0 10 10"><path d="M0 0L10 10"/></symbol></defs>
      <g stroke="red"><use href="#p" x="5" y="6"/>
      <use xlink:href="#p" transform="translate(0 50) scale(2)" x="1"/>
      <use href="#s" x="40" y="10" width="20" height="40"/>
      <use href="#s" x="0" y="90" width="10%" height="10%" data-assignment="V"/></g>)x"));
  REQUIRE(work.lines.size() == 4);
  CHECK(work.points_of(work.lines[0])[0] == PagePoint{5, 6});
  CHECK(work.points_of(work.lines[1])[0] == PagePoint{2, 50});
  CHECK(work.points_of(work.lines[1])[1] == PagePoint{22, 50});
  CHECK(work.points_of(work.lines[2])[0] == PagePoint{40, 20});  // in the middle of 20 by 40
  CHECK(work.points_of(work.lines[2])[1] == PagePoint{60, 40});
  CHECK(work.lines[3].operation == Operation::FoldValley);
  CHECK(work.points_of(work.lines[3])[1] == PagePoint{10, 100});
  const LineWork other = read(svg(R"x(<use href="http://a/b.svg#c"/><use href="b.svg#c"/>
      <use href="#nowhere" id="u"/>)x"));
  CHECK(is_told(other, "2 <use> of other files are left out"));
  CHECK(is_told(other, "1 <use> of something that is not there is left out; at line 2 (id \"u\")"));
}

TEST_CASE("a use of itself and a use bomb are refused", "[core][formats][svg][use]") {
  const Error circle =
      error_of(svg("\n<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>"));
  CHECK(circle.kind == ErrorKind::Malformed);
  CHECK(circle.place.rfind("line 2, column", 0) == 0);
  CHECK(circle.detail.find("uses itself") != std::string::npos);
  CHECK(error_of(svg("<use id='u' href='#u'/>")).detail.find("uses itself") != std::string::npos);
  const auto bomb = [](const std::string& core) {
    std::string text = "<defs><g id='g0'>" + core + "</g>";
    for (int i = 1; i <= 40; ++i) {
      const std::string inner = "<use href='#g" + std::to_string(i - 1) + "'/>";
      text += "<g id='g" + std::to_string(i) + "'>" + inner + inner + "</g>";
    }
    return svg(text + "</defs><use href='#g40'/>");
  };
  SvgLimits small;
  small.steps = 1'000'000;
  CHECK(error_of(bomb("<path/>"), small).detail.find("too much work") != std::string::npos);
  CHECK(error_of(bomb(""), small).kind == ErrorKind::OutOfRange);
  small.points = 1000;
  CHECK(error_of(bomb("<path stroke='red' d='M0 0H1'/>"), small).detail.find("1000 points") !=
        std::string::npos);
}

TEST_CASE("frames in frames are scaled and placed", "[core][formats][svg]") {
  const auto first = [](const std::string& inner, const std::string& head = kPage) {
    const LineWork work = read(svg(inner, head));
    REQUIRE(work.lines.size() == 1);
    return std::vector<PagePoint>(work.points.begin(), work.points.end());
  };
  const std::string line = "<path stroke='red' d='M0 0L10 10'/>";
  using Points = std::vector<PagePoint>;
  CHECK(first("<svg x='10' y='20' width='20' height='20' viewBox='0 0 10 10'>" + line + "</svg>") ==
        Points{{10, 20}, {30, 40}});
  CHECK(first("<svg x='10' width='50%' height='10%' viewBox='0 0 10 10' "
              "preserveAspectRatio='xMinYMax meet'>" +
              line + "</svg>") == Points{{10, 0}, {20, 10}});
  CHECK(first("<svg width='20' height='10' viewBox='0 0 10 10' preserveAspectRatio='none'>" + line +
              "</svg>") == Points{{0, 0}, {20, 10}});
  const std::string wide = "width='20mm' height='10mm' viewBox='0 0 10 10' preserveAspectRatio=";
  CHECK(first(line, wide + "'xMidYMid meet'") == Points{{5, 0}, {15, 10}});
  CHECK(first(line, wide + "'xMaxYMid'") == Points{{10, 0}, {20, 10}});
  CHECK(first(line, wide + "'xMidYMin slice'") == Points{{0, 0}, {20, 20}});
  CHECK(first(line, wide + "'none'") == Points{{0, 0}, {20, 10}});
  CHECK(first(line, "width='20mm' viewBox='5 5 10 10'") == Points{{-10, -10}, {10, 10}});
  const LineWork out = read(svg("<svg width='5' height='5'>" + line +
                                "</svg><svg width='5' "
                                "height='5' overflow='visible'>" +
                                line + "</svg>"));
  CHECK(is_told(out, "1 line leaves the frame"));
}

TEST_CASE("units are those of CSS at 96 to the inch", "[core][formats][svg]") {
  const auto mm = [](const std::string& length, double dpi) {
    SvgReadOptions how;
    how.profile = *find_stroke_profile("popcut");
    how.dpi = dpi;
    const auto work = linework_from_svg(
        svg("<line stroke='red' x2='" + length + "'/>", "width='200mm' height='100mm'"), how);
    REQUIRE(work);
    return popcut::length(work->points);
  };
  CHECK(mm("96", 96) == Approx(25.4));
  CHECK(mm("96px", 96) == Approx(25.4));
  CHECK(mm("72pt", 96) == Approx(25.4));
  CHECK(mm("6pc", 96) == Approx(25.4));
  CHECK(mm("1in", 96) == Approx(25.4));
  CHECK(mm("2.54cm", 96) == Approx(25.4));
  CHECK(mm("25.4mm", 96) == Approx(25.4));
  CHECK(mm("25.4MM", 96) == Approx(25.4));
  CHECK(mm("10%", 96) == Approx(20));
  CHECK(mm("6em", 96) == Approx(25.4));
  CHECK(mm("72", 72) == Approx(25.4));
  CHECK(mm("25.4mm", 72) == Approx(25.4));
}

TEST_CASE("what is filled and not stroked is cut along its outline", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(<rect width="100%" height="100%" fill="#eee"/>
      <path id="f" d="M0 0H10V10"/><path d="M0 0H10V10" fill="white"/><path d="M0 0H10" />
      <path d="M0 0H10V10" fill="none"/>)x"));
  CHECK(total_mm(work, Operation::Cut) == Approx(20 + std::sqrt(200.0)));  // closed
  CHECK(is_told(
      work, "1 shape has a fill but no stroke and is cut along its outline; at line 2 (id \"f\")"));
  CHECK(is_told(work, "2 shapes filled white or as large as the page are taken for background"));
  CHECK(is_told(work, "2 shapes have neither stroke nor fill"));
  // Where lines have names, what has none is no cut; named fills are what they are called.
  const LineWork named = read(svg(R"x(<path d="M0 0H10V10"/><path d="M0 0H7" stroke="red"/>
      <g inkscape:groupmode="layer" inkscape:label="Outline"><path d="M0 0H3V4Z"/></g>)x"));
  CHECK(total_mm(named, Operation::Cut) == Approx(7));
  CHECK(total_mm(named, Operation::Outline) == Approx(12));
  CHECK(is_told(named, "1 shape with a fill but no stroke and no name is left out"));
  CHECK(read(svg("<path d='M0 0H10V10'/>"), "lightburn").lines.empty());
}

TEST_CASE("without names every solid stroke is a cut and every dashed one its dashes",
          "[core][formats][svg][profile]") {
  const std::string text =
      svg(R"x(<g fill="none"><path d="M0 0H6" stroke="red"/><path d="M0 1H6" stroke="#00f"/>
      <path d="M0 2H6" stroke="yellow" stroke-dasharray="2 1"/><path d="M0 3H6" stroke="white"/></g>)x");
  for (const char* profile : {"popcut", "plain", "cricut"}) {
    CAPTURE(profile);
    const LineWork work = read(text, profile);
    CHECK(work.lines.size() == 5);
    CHECK(total_mm(work, Operation::Cut) == Approx(6 + 6 + 4 + 6));
  }
  CHECK(is_told(read(text), "strokes have 4 colours (#ff0000, #0000ff, #ffff00, #ffffff)"));
}

TEST_CASE("profiles give colours and classes and lines their meaning",
          "[core][formats][svg][profile]") {
  const std::string text =
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#000"/><path d="M0 1H2" stroke="red"/>
      <path d="M0 2H4" stroke="blue"/><path d="M0 3H8" stroke="#0f0"/><path d="M0 3H16" stroke="#ff0"/>
      <path d="M0 3H32" stroke="#f00001"/></g>)x");
  const auto sums = [&](const char* profile) {
    const LineWork work = read(text, profile);
    std::vector<int> out;
    for (const Operation operation :
         {Operation::Outline, Operation::Cut, Operation::Score, Operation::FoldMountain,
          Operation::FoldValley, Operation::Draw})
      out.push_back(static_cast<int>(std::lround(total_mm(work, operation))));
    return out;
  };
  using Sums = std::vector<int>;
  CHECK(sums("origami-sim") == Sums{1, 8, 0, 2, 4, 0});
  CHECK(sums("rabbit-ear") == Sums{1, 8, 0, 2 + 32, 4, 0});
  CHECK(sums("flat-folder") == Sums{1, 0, 0, 2, 4, 0});
  CHECK(sums("lightburn") == Sums{0, 1 + 8 + 16, 0, 2 + 32, 4, 0});
  CHECK(sums("boxes-py") == Sums{1, 4 + 16 + 32, 8, 0, 0, 0});
  CHECK(sums("fablab") == Sums{2 + 16 + 32, 4 + 8, 0, 0, 0, 1});
  const LineWork model =
      read(svg(R"x(<style>path{fill:none;stroke:#000} .convex{stroke-dasharray:1 2}</style>
      <path class="outer" d="M0 0H1"/><path class="convex" d="M0 0H2"/><path class="concave x" d="M0 0H4"/>)x"),
           "paper-model");
  CHECK(total_mm(model, Operation::Outline) == Approx(1));
  CHECK(total_mm(model, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(model, Operation::FoldValley) == Approx(4));
  const LineWork layers =
      read(svg(R"x(<g stroke="#000" inkscape:groupmode="layer" inkscape:label="Fold">
      <path d="M0 0H1"/><g inkscape:groupmode="layer" inkscape:label="Mountain"><path d="M0 0H2"/></g></g>
      <g stroke="#000" inkscape:groupmode="layer" inkscape:label="Text"><path d="M0 0H9"/></g>)x"),
           "papercraft");
  CHECK(total_mm(layers, Operation::FoldValley) == Approx(1));
  CHECK(total_mm(layers, Operation::FoldMountain) == Approx(2));
  CHECK(is_told(layers, "1 stroke is for nothing"));
}

TEST_CASE("users add profiles of their own", "[core][formats][svg][profile]") {
  const std::vector<std::string> tables{R"j({"popcut": 1, "svg_profiles": [
    {"name": "mine", "like": "popcut", "colours": "nearest", "labels": {"Kiss Cut": "score"},
     "rules": [{"colour": ["red", "#f80"], "line": "dashed", "use": "fold-mountain"},
               {"colour": "#00f", "use": "ignore"}], "otherwise": "outline", "fills": "ignore"}]})j"};
  const auto mine = find_stroke_profile("mine", tables);
  REQUIRE(mine);
  SvgReadOptions how;
  how.profile = *mine;
  const auto work = linework_from_svg(
      svg(R"x(<g fill="none"><path d="M0 0H1" stroke="#e00000" stroke-dasharray="1"/>
      <path d="M0 0H2" stroke="#e00000"/><path d="M0 0H4" stroke="navy"/>
      <g inkscape:groupmode="layer" inkscape:label=" kiss_CUT "><path d="M0 0H8" stroke="red"/></g></g>)x"),
      how);
  REQUIRE(work);
  CHECK(total_mm(*work, Operation::FoldMountain) == Approx(1));
  CHECK(total_mm(*work, Operation::Outline) == Approx(2));
  CHECK(total_mm(*work, Operation::Score) == Approx(8));
  CHECK(find_stroke_profile("mint", tables).error().detail.find("did you mean mine") !=
        std::string::npos);
  for (
      const auto& [table, place] : std::vector<std::pair<std::string, std::string>>{
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "rules": [{"colour": "rot", "use": "cut"}]}]})j",
           "table 1: /svg_profiles/0/rules/0/colour"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "rules": [{"colour": "red"}]}]})j",
           "table 1: /svg_profiles/0/rules/0/use"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "otherwise": "fold"}]})j",
           "table 1: /svg_profiles/0/otherwise"},
          {R"j({"popcut": 1, "svg_profiles": [{"name": "a", "labels": {"x": "burn"}}]})j",
           "table 1: /svg_profiles/0/labels/x"}}) {
    CAPTURE(table);
    const auto wrong = find_stroke_profile("a", {table});
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().place == place);
  }
}

TEST_CASE("colours are read in all their spellings", "[core][formats][svg]") {
  const auto rgb = [](const char* text) {
    const auto paint = parse_svg_paint(text);
    CAPTURE(text);
    REQUIRE(paint);
    CHECK(paint->kind == SvgPaint::Kind::Colour);
    return paint->rgb;
  };
  for (const char* red :
       {"red", "RED", "#f00", "#FF0000", "#f00f", "#ff0000ff", "rgb(255,0,0)", "rgb(100%, 0%, 0%)",
        "rgb(255 0 0 / 50%)", "rgba(255,0,0,.5)", "hsl(0,100%,50%)", "hsl(360deg 100% 50%)"})
    CHECK(rgb(red) == 0xFF0000);
  CHECK(rgb("rebeccapurple") == 0x663399);
  CHECK(rgb("hsl(120,100%,25%)") == 0x008000);
  for (const char* none : {"none", "transparent", "#ff000000", "rgba(1,2,3,0)"})
    CHECK(parse_svg_paint(none)->kind == SvgPaint::Kind::None);
  CHECK(parse_svg_paint("url(#g) #0f0") == SvgPaint{SvgPaint::Kind::Server, 0x00FF00});
  for (const char* wrong : {"", "rot", "#12", "#12345g", "rgb(1,2)", "rgb(1,2,3", "url(#a"})
    CHECK_FALSE(parse_svg_paint(wrong));
}

TEST_CASE("what is not applied is named with its place", "[core][formats][svg]") {
  const LineWork work = read(svg(R"x(
      <g clip-path="url(#c)"><path d="M0 0H1" stroke="url(#grad)" mask="url(#m)"/></g>
      <path id="f" d="M0 0H1" stroke="red" style="filter:url(#b)" marker-end="url(#arrow)"/>
      <path d="M0 0H1" stroke="red" transform="scale(0 1)"/><rect stroke="red" width="0" height="2"/>
      <path d="M0 0H1" stroke="red" data-assignment="Q"/>
      <foreignObject/><script/><text display="none">x</text>)x"));
  CHECK(
      is_told(work, "1 element has a clip path, which is not applied: it is cut whole; at line 2"));
  CHECK(is_told(work, "1 element has a mask"));
  CHECK(is_told(work, "1 element has a filter, which is not applied; at line 3 (id \"f\")"));
  CHECK(is_told(work, "1 line has markers"));
  CHECK(is_told(work, "1 stroke is painted with a gradient"));
  CHECK(is_told(work, "1 shape or group is squashed to nothing"));
  CHECK(is_told(work, "1 shape has no size"));
  CHECK(is_told(work, "1 data-assignment is not known and is passed over; at line 5: \"Q\""));
  CHECK(is_told(work, "1 <foreignObject>"));
  CHECK(is_told(work, "1 <script>"));
  CHECK_FALSE(is_told(work, "<text>"));
  CHECK(work.lines.size() == 3);
}

TEST_CASE("a document type is never fetched and only plain entities are put in place",
          "[core][formats][svg][bad]") {
  const std::string drawing = svg("<path stroke='red' d='M0 0H&w;'/>");
  const auto with = [&](const std::string& doctype) {
    return "\xEF\xBB\xBF<?xml version='1.0'?>\n<!-- <!DOCTYPE --> " + doctype + "\n" + drawing;
  };
  CHECK(length(read(with("<!DOCTYPE svg [<!ENTITY w '12'> <!-- > ] --> <!ENTITY ns \"a'b>\">]>"))
                   .points) == Approx(12));
  CHECK(read("<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"http://a/svg11.dtd\">" +
             svg("<path stroke='red' d='M0 0H1'/>"))
            .lines.size() == 1);
  for (const char* subset :
       {"<!ENTITY a 'x'><!ENTITY w '&a;&a;'>", "<!ENTITY % w '1'>",
        "<!ENTITY w SYSTEM 'file:///etc/passwd'>", "<!ENTITY w PUBLIC 'a' 'http://a'>",
        "<!ELEMENT svg ANY>", "<!ATTLIST svg w CDATA '1'>", "%w;", "<!ENTITY w '<g/>'>",
        "<!ENTITY w '1' NDATA x>", "<!NOTATION n SYSTEM 'x'>", "<?pi?>", "<!ENTITY w '1"}) {
    CAPTURE(subset);
    const Error error = error_of(with(std::string("<!DOCTYPE svg [") + subset + "]>"));
    CHECK(error.kind == ErrorKind::Malformed);
    CHECK(error.place.rfind("line ", 0) == 0);
  }
  std::string many;
  for (int i = 0; i < 65; ++i) many += "<!ENTITY e" + std::to_string(i) + " 'x'>";
  CHECK(error_of(with("<!DOCTYPE svg [" + many + "]>")).kind == ErrorKind::OutOfRange);
  const auto of_size = [](std::size_t n) {
    return "<!DOCTYPE svg [<!ENTITY w '1'><!ENTITY a '" + std::string(n, 'x') + "'>]>";
  };
  CHECK(error_of(with(of_size(257))).detail.find("257 bytes; at most 256") != std::string::npos);
  CHECK(read(with(of_size(256))).lines.size() == 1);
  SvgLimits small;
  small.bytes = 100'000;
  std::string refs;
  for (int i = 0; i < 1000; ++i) refs += "&a;";
  CHECK(error_of(of_size(256) + svg("<title>" + refs + "</title>"), small).kind ==
        ErrorKind::OutOfRange);
}

TEST_CASE("a drawing in UTF-16 is read and a compressed one is refused",
          "[core][formats][svg][bad]") {
  const std::string plain = svg("<title>\xC3\xA9</title><path stroke='red' d='M0 0H3'/>");
  for (const bool big : {true, false}) {
    std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char32_t c : std::u32string(plain.begin(), plain.end())) {
      if ((c & 0xFF) == 0xC3) continue;
      const char low = static_cast<char>((c & 0xFF) == 0xA9 ? 0xE9 : c);
      wide += big ? std::string{'\0', low} : std::string{low, '\0'};
    }
    const LineWork work = read(wide);
    CHECK(work.name == "\xC3\xA9");
    CHECK(length(work.points) == Approx(3));
  }
  CHECK(error_of("\x1F\x8B\x08").detail.find("gunzip") != std::string::npos);
  CHECK(error_of(svg(std::string(1, '\0'))).detail.find("is zero") != std::string::npos);
}

TEST_CASE("numbers that are no numbers are refused in one line with the element",
          "[core][formats][svg][bad]") {
  for (const char* inner :
       {"<path id='p' stroke='red' d='M0 0L1e308 1e308'/>",
        "<path id='p' stroke='red' d='M0 0Lnan 1'/>",
        "<path id='p' stroke='red' d='M0 0L1e999 1'/>",
        "<rect id='p' stroke='red' width='inf' height='1'/>",
        "<circle id='p' stroke='red' r='1e308'/>",
        "<path id='p' stroke='red' d='M0 0C1e308 0 0 1e308 9 9'/>",
        "<path id='p' stroke='red' d='M0 0A1e308 1e308 0 0 0 1e300 1'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='scale(1e308)'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='rotate(nan)'/>",
        "<path id='p' stroke='red' d='M0 0H1' transform='matrix(1 2 3)'/>",
        "<polygon id='p' stroke='red' points='0 0 1'/>",
        "<polygon id='p' stroke='red' points='0 0 a 1'/>", "<svg id='p' viewBox='0 0 nan 1'/>",
        "<svg id='p' viewBox='0 0 -1 1'/>", "<line id='p' stroke='red' x1='1 2'/>"}) {
    CAPTURE(inner);
    const Error error = error_of(svg(std::string("\n") + inner));
    CHECK(error.place.rfind("line 2, column ", 0) == 0);
    CHECK(error.place.find("id \"p\"") != std::string::npos);
    CHECK(error.detail.size() < 300);
  }
  for (const char* head :
       {"viewBox='0 0 0 100'", "viewBox='0 0 1'", "viewBox='a'", "width='0' height='5'",
        "width='-5mm' height='5mm'", "viewBox='0 0 1e999 1'"}) {
    CAPTURE(head);
    error_of(svg("<path stroke='red' d='M0 0H1'/>", head));
  }
}

TEST_CASE("sizes are checked before memory is taken", "[core][formats][svg][bad]") {
  SvgLimits limits;
  limits.bytes = 1000;
  CHECK(error_of(std::string(1001, ' '), limits).detail.find("at most 1000") != std::string::npos);
  std::string nodes;
  for (int i = 0; i < 1000; ++i) nodes += "<a/>";
  limits = {};
  limits.tree_bytes = 10'000;
  CHECK(error_of(svg(nodes), limits).kind == ErrorKind::OutOfRange);
  limits = {};
  limits.points = 50;
  std::string path = "<path id='big' stroke='red' d='M0 0";
  for (int i = 0; i < 60; ++i) path += "l1 1";
  const Error many = error_of(svg(path + "'/>"), limits);
  CHECK(many.kind == ErrorKind::OutOfRange);
  CHECK(many.place.find("id \"big\"") != std::string::npos);
  std::string deep;
  for (int i = 0; i < 300; ++i) deep += "<g>";
  for (int i = 0; i < 300; ++i) deep += "</g>";
  CHECK(error_of(svg(deep)).detail.find("200 deep") != std::string::npos);
  // Every selector against every element: too much work, and told so.
  std::string rules, paths;
  for (int i = 0; i < 2000; ++i) rules += "* * * * *{stroke:red}", paths += "<g/>";
  limits = {};
  limits.steps = 2'000'000;
  CHECK(error_of(svg("<style>" + rules + "</style>" + paths), limits).kind ==
        ErrorKind::OutOfRange);
  CHECK(SvgLimits{}.raised(4).points == 16'000'000);
}

TEST_CASE("curves follow the tolerance that is asked for", "[core][formats][svg]") {
  SvgReadOptions how;
  how.profile = *find_stroke_profile("plain");
  std::size_t last = 0;
  for (const double tolerance : {0.5, 0.1, 0.02, 0.005}) {
    how.tolerance_mm = tolerance;
    const auto work = linework_from_svg(
        svg("<circle r='1' transform='translate(50 50) scale(40)' stroke='red' fill='none'/>"),
        how);
    REQUIRE(work);
    CAPTURE(tolerance, work->points.size());
    CHECK(work->points.size() > last);
    last = work->points.size();
    for (std::size_t i = 1; i < work->points.size(); ++i) {
      const PagePoint &a = work->points[i - 1], &b = work->points[i];
      CHECK(40 - std::hypot((a.x + b.x) / 2 - 50, (a.y + b.y) / 2 - 50) <= tolerance * (1 + 1e-9));
    }
  }
}

TEST_CASE("a prefix for SVG and elements of editors do not matter", "[core][formats][svg]") {
  const LineWork work =
      read(R"x(<s:svg xmlns:s="http://www.w3.org/2000/svg" xmlns:sodipodi="x" width="9mm"
      height="9mm" viewBox="0 0 9 9"><s:title>T</s:title><sodipodi:namedview><g/></sodipodi:namedview>
      <s:style>.a{stroke:red}</s:style><s:path class="a" d="M0 0H4"/></s:svg>)x");
  CHECK(work.name == "T");
  CHECK(length(work.points) == Approx(4));
  CHECK(work.warnings.empty());
  const LineWork choice =
      read(svg(R"x(<switch><foreignObject requiredExtensions="http://ns.adobe.com"/>
      <g><path d="M0 0H4" stroke="red"/></g><g><path d="M0 0H9" stroke="red"/></g></switch>)x"));
  CHECK(length(choice.points) == Approx(4));
  CHECK(choice.warnings.empty());
}
