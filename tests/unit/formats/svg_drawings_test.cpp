// SPDX-License-Identifier: MIT
// What drawings of other programs do that readers are known to get wrong: dashes, styles,
// structure.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/formats/svg/svg_dash.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/svg_drafts.hpp"

namespace svg_drawings_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("dashes are cut in every notation", "[core][formats][svg][dashes]") {
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
  CHECK(is_told(dots, "1 line consists of dots"));
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

TEST_CASE("dashes that cannot be cut are refused", "[core][formats][svg][dashes]") {
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

TEST_CASE("folds and scores stay whole so that the material dashes them",
          "[core][formats][svg][dashes]") {
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
  CHECK(is_told(work, "1 selector of a style sheet is unknown and ignored; at \"path + path\""));
  CHECK(is_told(work, "1 block of a style sheet"));
  CHECK(is_told(work, "1 style sheet in another file is not read"));
  CHECK(is_told(work, "\"var(--c)\""));
  CHECK(is_told(work, "1 style sets a shape or a transform"));
  CHECK(is_told(read("<?xml version='1.0'?><?xml-stylesheet href='a.css'?>" + svg("")),
                "1 style sheet in another file"));
}

TEST_CASE("style sheets for other media do not count", "[core][formats][svg][css]") {
  const auto hides = [](const std::string& sheet) {
    const LineWork work = read(svg(sheet + "<path class='h' stroke='red' d='M0 0H5'/>"
                                           "<path stroke='red' d='M0 9H5'/>"));
    CHECK(work.warnings.size() == 1);
    return work.lines.size() == 1;
  };
  for (const char* screens :
       {"screen", "all", "SCREEN, print", "print,screen", "only screen", "not print", " screen "}) {
    CAPTURE(screens);
    CHECK(hides("<style media='" + std::string(screens) + "'>.h{display:none}</style>"));
    CHECK(hides("<style>@media " + std::string(screens) + "{.h{display:none}}</style>"));
  }
  for (const char* others : {"print", "handheld", "(prefers-color-scheme: dark)", "not all",
                             "not screen", "screen and (max-width: 9px)"}) {
    CAPTURE(others);
    CHECK_FALSE(hides("<style media='" + std::string(others) + "'>.h{display:none}</style>"));
    CHECK_FALSE(hides("<style>@media " + std::string(others) + "{.h{display:none}}</style>"));
  }
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
  CHECK(is_told(other, "1 <use> of a missing element is left out; at line 2 (id \"u\")"));
}

TEST_CASE("a frame keeps its own place and transform where it is used",
          "[core][formats][svg][use]") {
  using Points = std::vector<PagePoint>;
  const auto drawn = [](const std::string& name, const std::string& attributes) {
    const LineWork work = read(svg("<defs><" + name + " id='n' width='20' height='20' " +
                                   attributes + "><path stroke='red' d='M0 5H10'/></" + name +
                                   "></defs><use href='#n' x='50' y='60'/>"));
    return Points(work.points.begin(), work.points.end());
  };
  for (const char* name : {"svg", "symbol"}) {
    CAPTURE(name);
    CHECK(drawn(name, "") == Points{{50, 65}, {60, 65}});
    CHECK(drawn(name, "x='10' y='20'") == Points{{60, 85}, {70, 85}});
    CHECK(drawn(name, "transform='scale(2)'") == Points{{50, 70}, {70, 70}});
  }
  const LineWork root =
      read(svg("<path stroke='red' d='M0 5H10'/>", std::string(kPage) + " transform='scale(2)'"));
  CHECK(length(root.points) == Approx(20));
}

TEST_CASE("a warning names styles that give an svg another size or place", "[core][formats][svg]") {
  const auto told = [](const std::string& style) {
    return is_told(read(svg("<path stroke='red' d='M0 5H10'/>",
                            std::string(kPage) + " style='" + style + "'")),
                   "1 style sets a shape or a transform");
  };
  for (const char* other :
       {"width:50mm", "height:90mm", "width:100px", "transform:scale(2)", "zoom:2", "rotate:9deg"})
    CHECK(told(other));
  for (const char* same : {"width:100mm", "height:10cm", "width:100%", "height:auto", "width:1em",
                           "transform:none", "x:9px"})
    CHECK_FALSE(told(same));
  CHECK(is_told(read(svg("<svg width='9' height='9' style='width:5px'><path stroke='red' "
                         "d='M0 5H8'/></svg>")),
                "1 style sets a shape"));
}

TEST_CASE("em and rem follow the font size however it is said", "[core][formats][svg]") {
  const auto cut_mm = [](const std::string& to, const std::string& style,
                         const std::string& root = "") {
    return total_mm(read(svg("<g style='" + style + "'><line stroke='red' x2='" + to + "'/></g>",
                             std::string(kPage) + root)),
                    Operation::Cut);
  };
  CHECK(cut_mm("2em", "font-size:10px") == Approx(20));
  CHECK(cut_mm("2em", "font:italic 700 10px/1.5 serif") == Approx(20));
  CHECK(cut_mm("2em", "font-size:large") == Approx(36));
  CHECK(cut_mm("2em", "font-size:larger", " font-size='10'") == Approx(24));
  CHECK(cut_mm("2rem", "font-size:30px") == Approx(32));
  CHECK(cut_mm("2rem", "font-size:30px", " font-size='10'") == Approx(20));
  CHECK(cut_mm("2em", "font-size:3rem", " style='font-size:10px'") == Approx(60));
}

TEST_CASE("a use of itself and a use bomb are refused", "[core][formats][svg][use]") {
  const Error circle =
      error_of(svg("\n<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>"));
  CHECK(circle.kind == ErrorKind::Malformed);
  CHECK(circle.place.rfind("line 2, column", 0) == 0);
  CHECK(circle.detail.find("refers to itself") != std::string::npos);
  CHECK(error_of(svg("<use id='u' href='#u'/>")).detail.find("refers to itself") !=
        std::string::npos);
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
  CHECK(error_of(bomb("<path/>"), small).detail.find("repeats or compares too much") !=
        std::string::npos);
  CHECK(error_of(bomb(""), small).kind == ErrorKind::OutOfRange);
  CHECK(error_of(bomb(""), small).reason == ErrorReason::TooMuch);
  CHECK(circle.reason == ErrorReason::None);
  small.steps = 10'000'000, small.points = 1000;
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
  REQUIRE(out.lines.size() == 2);
  CHECK(Points(out.points.begin(), out.points.end()) == Points{{0, 0}, {5, 5}, {0, 0}, {10, 10}});
}

TEST_CASE("lines are clipped exactly at the border of their frame", "[core][formats][svg]") {
  using Points = std::vector<PagePoint>;
  const auto points = [](const std::string& inner) {
    const LineWork work = read(svg(inner));
    return Points(work.points.begin(), work.points.end());
  };
  // Out and in again, in a frame that is turned by a quarter; the frame is 10 x 10 at 50,50.
  CHECK(points("<g transform='matrix(0 1 -1 0 50 50)'><svg width='10' height='10'>"
               "<path stroke='red' d='M-5 2H15V8H-5' fill='none'/></svg></g>") ==
        Points{{48, 50}, {48, 60}, {42, 60}, {42, 50}});
  // A closed line is cut open and goes on through its seam.
  const LineWork ring =
      read(svg("<svg width='10' height='10'><rect stroke='red' fill='none' x='2' "
               "y='2' width='20' height='4'/></svg>"));
  REQUIRE(ring.lines.size() == 1);
  CHECK(ring.points == Points{{10, 6}, {2, 6}, {2, 2}, {10, 2}});
  // The frame around the frame hides too, and what lies outside altogether is not cut.
  CHECK(points("<svg width='4' height='40'><svg width='10' height='10'><path stroke='red' "
               "d='M1 1H20M0 30H9'/></svg></svg>") == Points{{1, 1}, {4, 1}});
}

TEST_CASE("transforms turn about their origin", "[core][formats][svg]") {
  using Points = std::vector<PagePoint>;
  const auto drawn = [](const std::string& attributes, const std::string& head = kPage) {
    const LineWork work =
        read(svg("<g " + attributes + "><path d='M10 0V4' stroke='red'/></g>", head));
    REQUIRE(work.lines.size() == 1);
    Points points(work.points.begin(), work.points.end());
    for (PagePoint& p : points) p = {std::round(p.x * 1e6) / 1e6, std::round(p.y * 1e6) / 1e6};
    return points;
  };
  // A quarter turn about (cx, cy) maps (x, y) to (cx - (y - cy), cy + (x - cx)).
  const auto turned = [&](const std::string& origin) {
    const Points points = drawn("transform='rotate(90)' transform-origin='" + origin + "'");
    CHECK(drawn("transform='rotate(90)' style='transform-origin:" + origin + "'") == points);
    return points;
  };
  CHECK(drawn("transform='rotate(90)'") == Points{{0, 10}, {-4, 10}});
  CHECK(turned("10 0") == Points{{10, 0}, {6, 0}});
  CHECK(turned("10px 20px") == Points{{30, 20}, {26, 20}});
  CHECK(turned("10% 20%") == Points{{30, 20}, {26, 20}});
  CHECK(turned("10 20 5px") == Points{{30, 20}, {26, 20}});
  CHECK(turned("center") == Points{{100, 10}, {96, 10}});
  CHECK(turned("10") == Points{{60, 50}, {56, 50}});  // the other is the centre
  CHECK(turned("top") == Points{{50, -40}, {46, -40}});
  CHECK(turned("right bottom") == Points{{200, 10}, {196, 10}});
  CHECK(turned("bottom right") == Points{{200, 10}, {196, 10}});
  CHECK(turned("1em 0") == Points{{16, -6}, {12, -6}});
  CHECK(drawn("transform='scale(2)' transform-origin='5 1'") == Points{{15, -1}, {15, 7}});
  // Percentages are of the view box, whose least x and y do not move the origin.
  CHECK(drawn("transform='scale(2)' transform-origin='50% 50%'",
              "width='20mm' height='20mm' viewBox='-5 -5 20 20'") == Points{{15, -5}, {15, 3}});
  CHECK(drawn("transform-origin='50 50'") == Points{{10, 0}, {10, 4}});
  CHECK(is_told(read(svg("<g transform='rotate(9)' transform-origin='top 5px'/>")),
                "1 style cannot be read and is ignored"));
  CHECK(is_told(read(svg("<g transform='rotate(9)' style='transform-box:fill-box'/>")),
                "1 transform has a transform-box"));
}

TEST_CASE("dashes are parts of the length that a shape is said to have",
          "[core][formats][svg][dashes]") {
  const auto dashes = [](const std::string& shape, const std::string& more = "") {
    return read(svg(shape + " stroke='red' fill='none' stroke-dasharray='4 2' " + more + "/>"));
  };
  // 20 mm that count as 10: a dash of 4 is 8 mm, a gap of 2 is 4 mm.
  check_spans(dashes("<path d='M0 0H20' pathLength='10'"), {0, 8, 12, 20});
  check_spans(dashes("<line x2='20' pathLength='10'"), {0, 8, 12, 20});
  check_spans(dashes("<polyline points='0 0 20 0' pathLength='10'"), {0, 8, 12, 20});
  check_spans(dashes("<path d='M0 0H20' pathLength='10'", "stroke-dashoffset='1'"), {0, 6, 10, 18});
  // All parts count together: 20 mm are 10.
  check_spans(dashes("<path d='M0 0H10M0 5H10' pathLength='10'"), {0, 8, 0, 8});
  // A circle in 4 quarters has its dashes at them, whatever its size.
  const LineWork ring =
      read(svg("<circle r='10' cx='50' cy='50' pathLength='4' stroke='red' fill='none' "
               "stroke-dasharray='1'/>"));
  REQUIRE(ring.lines.size() == 2);
  CHECK(ring.points_of(ring.lines[0]).front() == PagePoint{60, 50});
  CHECK(ring.points_of(ring.lines[0]).back().x == Approx(50).margin(1e-6));
  CHECK(ring.points_of(ring.lines[1]).front().x == Approx(40).margin(1e-6));
  // 20 mm around count as 10: from 0 to 8 mm and from 12 to 20 mm.
  check_spans(dashes("<rect width='5' height='5' pathLength='10'"), {0, 5, 3, 0});
  check_spans(dashes("<path d='M0 0H20' pathLength='10' vector-effect='non-scaling-stroke'"),
              {0, 8, 12, 20});
  // Zero makes every dash endless; what is no length counts for nothing.
  check_spans(dashes("<path d='M0 0H20' pathLength='0'"), {0, 20});
  check_spans(dashes("<path d='M0 0H5' pathLength='-1'"), {0, 4});
}

TEST_CASE("elements belong to SVG by their namespace, not by the prefix of the root",
          "[core][formats][svg]") {
  const std::string box = "width='9mm' height='9mm' viewBox='0 0 9 9'";
  const std::string ns = "'http://www.w3.org/2000/svg'";
  // As Inkscape declares it: one namespace, with and without a prefix.
  const LineWork both = read("<svg xmlns=" + ns + " xmlns:svg=" + ns + " " + box +
                             "><style>g path{stroke:red}</style><svg:g><svg:path d='M0 0H4'/>"
                             "<path d='M0 1H3'/></svg:g></svg>");
  check_spans(both, {0, 4, 0, 3});
  // Declared at the element itself, beside another default namespace.
  check_spans(read("<svg xmlns=" + ns + " " + box + "><svg:path xmlns:svg=" + ns +
                   " d='M0 0H4' stroke='red'/></svg>"),
              {0, 4});
  const LineWork other =
      read("<s:svg xmlns:s=" + ns + " xmlns='http://www.w3.org/1999/xhtml' " + box +
           "><path d='M0 0H9' stroke='red'/><s:path d='M0 0H4' stroke='red'/>"
           "<g xmlns=" +
           ns +
           "><path d='M0 0H3' stroke='red'/></g>"
           "<t:path xmlns:t='urn:t' d='M0 0H9' stroke='red'/></s:svg>");
  check_spans(other, {0, 4, 0, 3});
  // A foreign group inside, and what it contains.
  check_spans(read(svg("<g xmlns='urn:other'><path d='M0 0H9' stroke='red'/></g>"
                       "<path d='M0 0H4' stroke='red'/>")),
              {0, 4});
  // `use` finds prefixed symbols.
  check_spans(read("<svg xmlns=" + ns + " xmlns:v=" + ns + " " + box +
                   "><v:symbol id='s'><v:path d='M0 0H4' stroke='red'/></v:symbol>"
                   "<v:use href='#s'/></svg>"),
              {0, 4});
}

// The area that the closed lines of a drawing enclose, holes taken off, and that all are closed.
double closed_area(const LineWork& work) {
  double twice = 0.0;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    CHECK(points.front() == points.back());
    twice += turning(points);
  }
  return std::abs(twice) / 2;
}

TEST_CASE("strokes are cut only inside clip paths", "[core][formats][svg][clip]") {
  const std::string box =
      "<clipPath id='c'><rect x='10' y='10' width='20' height='20'/></clipPath>";
  const auto clipped = [](const std::string& clip, const std::string& drawn) {
    const LineWork work = read(svg("<defs>" + clip + "</defs>" + drawn));
    return work;
  };
  const std::string line = "<path d='M0 20H50' stroke='red' fill='none' ";
  check_spans(clipped(box, line + "clip-path='url(#c)'/>"), {10, 30});
  check_spans(clipped(box, line + "style='clip-path:url(\"#c\")'/>"), {10, 30});
  check_spans(clipped(box, "<g clip-path='url(#c)'>" + line + "/></g>"), {10, 30});
  CHECK(is_told(clipped(box, line + "clip-path='url(#c)'/>"),
                "1 line is cut only inside its clip path"));
  // What is inside, also along the border of the clip path, stays as it is, and nothing is said.
  const LineWork along =
      clipped(box,
              "<rect x='10' y='10' width='20' height='20' stroke='red' fill='none' "
              "clip-path='url(#c)'/>");
  CHECK(total_mm(along, Operation::Cut) == Approx(80));
  CHECK(along.lines.size() == 1);
  CHECK(along.warnings.empty());
  CHECK(clipped(box, "<path d='M0 0H5' stroke='red' clip-path='url(#c)'/>").lines.empty());
  // The clip path moves with the user units of what it clips, and with its own transform.
  check_spans(clipped(box, "<g transform='translate(5 0)'>" + line + "clip-path='url(#c)'/></g>"),
              {15, 35});
  check_spans(clipped(box, line + "transform='translate(5 0)' clip-path='url(#c)'/>"), {15, 35});
  check_spans(clipped("<clipPath id='c' transform='translate(1 0)'><rect x='10' y='10' width='20' "
                      "height='20'/></clipPath>",
                      line + "clip-path='url(#c)'/>"),
              {11, 31});
  // Of several shapes: what any of them shows; with holes by clip-rule.
  check_spans(clipped("<clipPath id='c'><rect width='10' height='40'/><circle cx='30' cy='20' "
                      "r='10' /></clipPath>",
                      line + "clip-path='url(#c)'/>"),
              {0, 10, 20, 40});
  const std::string two = "d='M0 0H40V40H0ZM10 10H30V30H10Z'/></clipPath>";
  check_spans(clipped("<clipPath id='c'><path " + two, line + "clip-path='url(#c)'/>"), {0, 40});
  check_spans(
      clipped("<clipPath id='c'><path clip-rule='evenodd' " + two, line + "clip-path='url(#c)'/>"),
      {0, 10, 30, 40});
  check_spans(
      clipped("<clipPath id='c' clip-rule='evenodd'><path " + two, line + "clip-path='url(#c)'/>"),
      {0, 10, 30, 40});
  // Through <use>, as Illustrator writes it, and with an offset.
  check_spans(clipped("<rect id='r' x='10' y='10' width='20' height='20'/><clipPath id='c'>"
                      "<use xlink:href='#r' x='2' style='overflow:visible'/></clipPath>",
                      line + "clip-path='url(#c)'/>"),
              {12, 32});
  // In groups in groups, in clip paths, and of shapes in clip paths.
  const std::string other =
      "<clipPath id='d'><rect x='20' y='0' width='50' height='50'/></clipPath>";
  check_spans(
      clipped(box + other, "<g clip-path='url(#c)'><g clip-path='url(#d)'>" + line + "/></g></g>"),
      {20, 30});
  check_spans(clipped(box + "<clipPath id='d' clip-path='url(#c)'><rect x='20' width='50' "
                            "height='50'/></clipPath>",
                      line + "clip-path='url(#d)'/>"),
              {20, 30});
  check_spans(clipped(box + "<clipPath id='d'><rect x='20' width='50' height='50' "
                            "clip-path='url(#c)'/><rect width='5' height='50'/></clipPath>",
                      line + "clip-path='url(#d)'/>"),
              {0, 5, 20, 30});
  // Of the bounding box: 0.25 to 0.75 of x = 0 .. 50; of a group: of all in it.
  const std::string part =
      "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect x='.25' width='.5' height='1'/>"
      "</clipPath>";
  check_spans(clipped(part, "<path d='M0 0H50V4H0' stroke='red' fill='none' clip-path='url(#c)'/>"),
              {12.5, 37.5, 37.5, 12.5});
  check_spans(clipped(part,
                      "<g clip-path='url(#c)' transform='translate(1 0)'><g "
                      "transform='translate(2 3)'>" +
                          line + "/></g><path d='M0 0V9' fill='none'/></g>"),
              {1 + 13, 1 + 39});  // the box is 0 .. 52
  // Dashes end at the clip path.
  check_spans(clipped(box, line + "stroke-dasharray='8' clip-path='url(#c)'/>"), {16, 24});
  // A ring that is cut open goes on through its seam.
  const LineWork ring =
      clipped(box,
              "<rect x='15' y='15' width='30' height='5' stroke='red' fill='none' "
              "clip-path='url(#c)'/>");
  REQUIRE(ring.lines.size() == 1);
  CHECK(ring.points == std::vector<PagePoint>{{30, 20}, {15, 20}, {15, 15}, {30, 15}});
  // An empty clip path hides all.
  CHECK(clipped("<clipPath id='c'/>", line + "clip-path='url(#c)'/>").lines.empty());
  // A clip path that is not made of shapes gets a warning, and nothing is clipped.
  const LineWork text =
      clipped("<clipPath id='c'><text>A</text></clipPath>", line + "clip-path='url(#c)'/>");
  check_spans(text, {0, 50});
  CHECK(is_told(text, "1 clip path is not made of shapes"));
  CHECK(is_told(clipped("", line + "clip-path='circle(9px)'/>"), "is not made of shapes"));
  CHECK(is_told(clipped("", line + "clip-path='url(#no)'/>"), "1 clip path is missing"));
  CHECK(
      error_of(svg("<clipPath id='c' clip-path='url(#c)'><rect width='9' height='9'/></clipPath>" +
                   line + "clip-path='url(#c)'/>"))
          .detail.find("refers to itself") != std::string::npos);
}

TEST_CASE("fills that a clip path or frame cuts are closed along it",
          "[core][formats][svg][clip]") {
  const auto filled = [](const std::string& clip, const std::string& d, const char* more = "") {
    return read(svg("<clipPath id='c'>" + clip + "</clipPath><path clip-path='url(#c)' d='" + d +
                    "' " + more + "/>"));
  };
  const std::string box = "<rect x='10' y='10' width='20' height='20'/>";
  // A square of 20 from 20, 20: the corner of 10 x 10 is left, closed.
  const LineWork corner = filled(box, "M20 20H40V40H20Z");
  REQUIRE(corner.lines.size() == 1);
  CHECK(closed_area(corner) == Approx(100));
  CHECK(total_mm(corner, Operation::Cut) == Approx(40));
  CHECK(is_told(corner, "1 line is cut only inside its clip path"));
  // A fill that covers the clip path becomes the clip path; one inside stays.
  CHECK(closed_area(filled(box, "M0 0H50V50H0Z")) == Approx(400));
  CHECK(closed_area(filled(box, "M0 0H100V100H0Z")) == Approx(400));  // no background any more
  CHECK(closed_area(filled(box, "M12 12H14V14H12Z")) == Approx(4));
  CHECK(filled(box, "M0 0H5V5H0Z").lines.empty());
  CHECK(filled(box, "M0 10H10V30H0Z").lines.empty());                  // they touch along an edge
  CHECK(closed_area(filled(box, "M10 10H30V30H10Z")) == Approx(400));  // the same
  CHECK(closed_area(filled(box, "M10 0H30V20H10Z")) == Approx(200));   // edges in common
  // A bar across two shapes of a clip path falls into two; a hole stays a hole.
  const LineWork bar = filled("<rect width='10' height='40'/><rect x='20' width='10' height='40'/>",
                              "M-5 10H60V15H-5Z");
  CHECK(bar.lines.size() == 2);
  CHECK(closed_area(bar) == Approx(100));
  const std::string frame = "M0 0H40V40H0ZM15 15H25V25H15Z";
  CHECK(closed_area(filled(box, frame, "fill-rule='evenodd'")) == Approx(400 - 100));
  CHECK(closed_area(filled(box, frame)) == Approx(400));
  // A clip path with a hole inside the fill.
  CHECK(closed_area(filled("<path clip-rule='evenodd' d='" + frame + "'/>", "M10 10H30V30H10Z")) ==
        Approx(400 - 100));
  // A half disc of radius 10, by chords of at most 0.02 mm.
  const LineWork half =
      read(svg("<clipPath id='c'><rect width='50' height='20'/></clipPath>"
               "<circle cx='20' cy='20' r='10' clip-path='url(#c)'/>"));
  REQUIRE(half.lines.size() == 1);
  CHECK(closed_area(half) == Approx(50 * M_PI).margin(0.5));
  // A frame, turned by a quarter and moved.
  const LineWork framed =
      read(svg("<g transform='matrix(0 1 -1 0 50 50)'><svg width='10' "
               "height='10'><path d='M5 5H20V8H5Z'/></svg></g>"));
  REQUIRE(framed.lines.size() == 1);
  CHECK(closed_area(framed) == Approx(15));
  CHECK(is_told(framed, "1 line leaves the frame"));
}

}  // namespace svg_drawings_test
