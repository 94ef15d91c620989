// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "core/machines/motion.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/plan.hpp"
#include "device/session/session.hpp"
#include "tests/support/sim_bench.hpp"

namespace marks_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

std::string shown(std::string text) {
  for (char& c : text)
    if (c == '\x03') c = ';';
  return text;
}

Toolpath one_line(PagePoint a, PagePoint b) {
  const Material paper = value(find_material("paper-220"));
  Toolpath path;
  path.points = {a, b};
  Stroke stroke;
  stroke.count = 2;
  stroke.force_gf = paper.cut.force_gf;
  stroke.speed_mm_s = paper.cut.speed_mm_s;
  path.strokes.push_back(stroke);
  return path;
}

struct PrintedSheet {
  Machine machine = testing::machine("cameo3");
  MarkLayout marks = value(marks_for({304.8, 304.8}));
  Toolpath path = one_line({50, 40}, {70, 90});
  EncodedProgram program;

  PrintedSheet() {
    JobOptions job;
    job.marks = marks;
    program = value(encode(path, machine, value(find_material("paper-220")), job));
  }
};

}  // namespace

TEST_CASE("the search for marks precedes the geometry and coordinates count from them",
          "[protocol][marks]") {
  const PrintedSheet sheet;
  const std::string search = shown(sheet.program.bytes.substr(
      sheet.program.search.begin, sheet.program.search.end - sheet.program.search.begin));
  CHECK(search == "TB50,0;TB99;TB52,2;TB51,400;TB53,10;TB55,1;TB123,5296,5696,0,0;");
  CHECK(sheet.program.search.end == sheet.program.geometry.begin);
  CHECK(sheet.program.search.begin == sheet.program.setup.back().end);
  CHECK(shown(sheet.program.bytes.substr(sheet.program.geometry.begin, 8)) == "M600,800");
}

TEST_CASE("the search for marks counts in the machine's own steps", "[protocol][marks]") {
  PrintedSheet sheet;
  sheet.machine.built_in = false;  // a row of one's own
  sheet.machine.scale_carriage = 1.01;
  sheet.machine.scale_feed = 0.99;
  sheet.machine.margin_left_mm = 4.04;
  JobOptions job;
  job.marks = sheet.marks;
  sheet.program = value(encode(sheet.path, sheet.machine, value(find_material("paper-220")), job));
  const std::string search = shown(sheet.program.bytes.substr(
      sheet.program.search.begin, sheet.program.search.end - sheet.program.search.begin));
  // 264.8 mm / 0.99, 284.8 mm / 1.01 and 4.04 mm / 1.01, in steps of 0.05 mm
  CHECK_THAT(search, Catch::EndsWith("TB123,5349,5640,0,80;"));
  const Trace trace =
      value(simulate(std::as_bytes(std::span(sheet.program.bytes)), sheet.machine, SimOptions{}));
  REQUIRE(trace.points.size() == 2);
  CHECK(trace.points[0].x == Approx(50).margin(0.026));
  CHECK(trace.points[0].y == Approx(40).margin(0.026));
  CHECK(trace.points[1].x == Approx(70).margin(0.026));
  CHECK(trace.points[1].y == Approx(90).margin(0.026));
}

TEST_CASE("the meaning of TB51 and TB53 can be swapped", "[protocol][marks]") {
  MarkLayout marks = value(marks_for({304.8, 304.8}));
  marks.arm_first = false;
  CHECK_THAT(shown(mark_search(marks, machine("cameo3"))),
             Catch::Contains("TB51,10;TB53,400;TB54,0,0;TB55,1;TB123,"));
  marks.four_corners = true;
  CHECK_THAT(shown(mark_search(marks, machine("cameo5-alpha"))), Catch::Contains("TB124,"));
}

TEST_CASE("a measured scale holds for the marks as for the lines", "[protocol][marks]") {
  MarkLayout marks = value(marks_for({304.8, 304.8}));
  marks.top_mm = marks.left_mm = 110;
  Machine measured = machine("cameo3");
  measured.scale_carriage = 1.004;
  measured.scale_feed = 0.9965;
  // 264.8 mm along the feed are 5296 / 0.9965 of its units, 284.8 mm across it 5696 / 1.004; the
  // search begins 100 mm from the corner, 2000 units of 0.05 mm.
  CHECK_THAT(shown(mark_search(marks, measured)), Catch::Contains("TB123,5315,5673,2007,1992;"));
}

TEST_CASE("strokes outside the marks are refused", "[core][marks]") {
  const MarkLayout marks = value(marks_for({304.8, 304.8}));
  CHECK(check_marks(marks, one_line({50, 40}, {70, 90})));
  const auto outside = check_marks(marks, one_line({50, 40}, {70, 290}));
  REQUIRE_FALSE(outside);
  CHECK(outside.error().kind == ErrorKind::Infeasible);
  CHECK(outside.error().detail.find("outside the registration marks") != std::string::npos);
  const auto over = check_marks(marks, one_line({12, 12}, {70, 90}));
  REQUIRE_FALSE(over);
  CHECK(over.error().detail.find("on a registration mark") != std::string::npos);
  CHECK_FALSE(marks_for({60, 60}));
  MarkLayout bad = marks;
  bad.width_mm = 30;
  CHECK_FALSE(check_marks(bad, {}));
  JobOptions job;
  job.marks = marks;
  const auto hpgl = encode(one_line({50, 40}, {70, 90}), machine("hpgl-generic"),
                           value(find_material("paper-220")), job);
  REQUIRE_FALSE(hpgl);
  CHECK(hpgl.error().detail.find("registration marks") != std::string::npos);
}

TEST_CASE("a shifted sheet is cut where it was printed", "[device][marks]") {
  const PrintedSheet sheet;
  for (const PagePoint shift : {PagePoint{0, 0}, PagePoint{1.2, -0.7}, PagePoint{-4, 5}}) {
    SimOptions around;
    around.marks_at = PagePoint{10 + shift.x, 10 + shift.y};
    SimTransport cable(cutter(sheet.machine, around));
    const SessionEnd end = run_session(cable, sheet.machine, sheet.program);
    INFO((end.error ? message(*end.error) : std::string()));
    REQUIRE_FALSE(end.error);
    const Trace& trace = cable.cutter().trace();
    REQUIRE(trace.strokes.size() == 1);
    CHECK(trace.points[0].x == Approx(50 + shift.x));
    CHECK(trace.points[0].y == Approx(40 + shift.y));
    CHECK(trace.points[1].x == Approx(70 + shift.x));
    CHECK(trace.points[1].y == Approx(90 + shift.y));
    CHECK(end.fates[0] == StrokeFate::Certain);
  }
}

TEST_CASE("after a miss the search begins lower, as the machine's row says", "[device][marks]") {
  PrintedSheet sheet;
  const auto cut_at = [&](PagePoint corner) {
    JobOptions job;
    job.marks = sheet.marks;
    sheet.program =
        value(encode(sheet.path, sheet.machine, value(find_material("paper-220")), job));
    SimOptions around;
    around.marks_at = corner;
    SimTransport cable(cutter(sheet.machine, around));
    const SessionEnd end = run_session(cable, sheet.machine, sheet.program);
    if (!end.error) {
      CHECK(cable.cutter().trace().points.at(0).x == Approx(40 + corner.x));
      CHECK(cable.cutter().trace().points.at(0).y == Approx(30 + corner.y));
    }
    return std::pair(!end.error, end.remarks);
  };
  // The first search reaches from 0 to 20 mm along the feed.
  CHECK(cut_at({10, 20}) == std::pair(true, std::vector<std::string>{}));
  const auto [found, remarks] = cut_at({10, 22});
  CHECK(found);
  REQUIRE(remarks.size() == 1);
  CHECK_THAT(remarks.front(), Catch::Contains("found in search 2"));
  CHECK_FALSE(cut_at({10, 24}).first);
  sheet.machine.marks.again_mm = {3, 6};
  CHECK(cut_at({10, 24}).first);
  sheet.machine.marks.again_mm.clear();
  CHECK_FALSE(cut_at({10, 22}).first);
  sheet.machine.marks = {.before_left_mm = 0, .before_top_mm = -12, .again_mm = {-30}};
  CHECK(cut_at({10, 25}).first);
  CHECK(cut_at({10, 5}).first);
}

TEST_CASE("a lower search differs in its start alone", "[protocol][marks]") {
  const PrintedSheet sheet;
  CHECK(sheet.program.search_again == std::vector<std::int64_t>{60});
  CHECK(shown(search_lower(sheet.program, 60)) ==
        "TB50,0;TB99;TB52,2;TB51,400;TB53,10;TB55,1;TB123,5296,5696,60,0;");
  CHECK(value(rest_of(sheet.program, 0)).search_again == sheet.program.search_again);
  CHECK(search_lower(EncodedProgram{}, 60).empty());
  const MarkLayout marks = value(marks_for({304.8, 304.8}));
  CHECK_THAT(shown(mark_search(marks, machine("cameo4"))),
             Catch::EndsWith("TB123,5296,5696,120,0;"));
}

TEST_CASE("missing marks are reported before anything is cut", "[device][marks]") {
  const PrintedSheet sheet;
  SimOptions bare;
  bare.marks = false;
  SimOptions far;
  far.marks_at = PagePoint{25, 10};
  for (const SimOptions& around : {bare, far}) {
    SimTransport cable(cutter(sheet.machine, around));
    const SessionEnd end = run_session(cable, sheet.machine, sheet.program);
    REQUIRE(end.error);
    CHECK(end.error->kind == ErrorKind::Refused);
    CHECK(end.error->detail.find("nothing was cut") != std::string::npos);
    CHECK(end.fates[0] == StrokeFate::NotSent);
    cable.cutter().run_dry();
    CHECK(cable.cutter().trace().strokes.empty());
    // And queries, and one search more.
    CHECK(cable.cutter().accepted_bytes() < sheet.program.geometry.begin + 130);
  }
}

TEST_CASE("a search for marks without an answer times out", "[device][marks]") {
  const PrintedSheet sheet;
  // Replies are lost from the end of the settings on.
  SimFault deaf{
      .at_byte = sheet.program.search.end, .kind = SimFault::Kind::Silence, .seconds = 1000};
  SimTransport cable(cutter(sheet.machine), {deaf});
  const SessionEnd end = run_session(cable, sheet.machine, sheet.program);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::Timeout);
  CHECK(end.seconds < 70);
  cable.cutter().run_dry();
  CHECK(cable.cutter().trace().strokes.empty());
}

TEST_CASE("the marks are drawn as a page at true size", "[core][marks]") {
  const MarkLayout marks = value(marks_for({304.8, 304.8}));
  const std::string svg = marks_svg(marks, {304.8, 304.8}, "a <sheet>");
  CHECK_THAT(svg, Catch::Contains("width=\"304.8mm\""));
  CHECK_THAT(svg, Catch::Contains("<rect x=\"10\" y=\"10\" width=\"5\" height=\"5\"/>"));
  CHECK_THAT(svg, Catch::Contains("<title>a &lt;sheet&gt;</title>"));
}

TEST_CASE("the test shape is small and has a fold and two closed cuts", "[core][plan]") {
  const LineWork shape = test_shape();
  REQUIRE(shape.lines.size() == 3);
  CHECK(bounds(shape).width() == Approx(14));
  CHECK(bounds(shape).height() == Approx(10));
  CHECK_FALSE(closed(shape.points_of(shape.lines[0])));
  CHECK(closed(shape.points_of(shape.lines[1])));
  CHECK(closed(shape.points_of(shape.lines[2])));
}

}  // namespace marks_test
