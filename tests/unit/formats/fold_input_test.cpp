// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/drawing/planar_graph.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/json_text.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace fold_input_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

const std::string kTriangle =
    R"("vertices_coords":[[0,0],[4,0],[4,4]],"edges_vertices":[[0,1],[1,2],[2,0]])";

std::string refused(const std::string& members) {
  const auto file = read_fold("{" + members + "}");
  return file ? "" : message(file.error());
}

CreaseLine crease(double x0, double y0, double x1, double y1, char letter) {
  return {{{x0, y0}, {x1, y1}}, letter};
}

}  // namespace

TEST_CASE("crease patterns of ORIPA and Oriedita are read", "[core][formats][fold]") {
  const std::string cp =
      "1 -200 -200 200 -200\r\n1 200 -200 200 200\r\n1 200 200 -200 200\r\n"
      "1 -200 200 -200 -200\r\n2 -200 -200 200 200\r\n3 -200.0 2e2 0 0\r\n4 0 0 0 100\r\n";
  REQUIRE(is_crease_pattern(cp));
  const auto work = value(linework_from_fold(*fold_of_crease_pattern(cp)));
  CHECK(total_mm(work, Operation::Outline) == Approx(1600));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(400 * std::sqrt(2)));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(200 * std::sqrt(2)));
  // x to the right, y down: the valley runs from the lower left corner.
  for (const DrawnLine& line : work.lines)
    if (line.operation == Operation::FoldValley) {
      const auto points = work.points_of(line);
      CHECK(std::min(points.front().x, points.back().x) == Approx(-200));
      CHECK(std::max(points.front().y, points.back().y) == Approx(200));
    }
  const std::string opx = R"x(<?xml version="1.0" encoding="UTF-8"?>
    <java version="1.5.0_05" class="java.beans.XMLDecoder"><object class="oripa.DataSet">
    <void property="lines"><array class="oripa.OriLineProxy" length="2"><void index="0">
    <object class="oripa.OriLineProxy"><void property="type"><int>1</int></void>
    <void property="x1"><double>30.0</double></void></object></void><void index="1">
    <object class="oripa.OriLineProxy"><void property="type"><int>2</int></void>
    <void property="y1"><double>-40.0</double></void></object></void></array></void></object></java>)x";
  REQUIRE(is_crease_pattern(opx));
  const auto lines = value(linework_from_fold(*fold_of_crease_pattern(opx)));
  CHECK(total_mm(lines, Operation::FoldMountain) == Approx(40));
  std::string comma = opx;
  comma.replace(comma.find("30.0"), 4, "30,5");
  CHECK(message(fold_of_crease_pattern(comma).error()) ==
        "has a line whose type or place is not a number");
  // Comments, and other signs between the numbers.
  const std::string commas = "// by hand\n% it\n1, 0, 0, 30, 0 # side\n2;0;0;0;40\n";
  REQUIRE(is_crease_pattern(commas));
  CHECK(total_mm(*linework_from_fold(*fold_of_crease_pattern(commas)), Operation::FoldMountain) ==
        Approx(40));
  const auto place = [](const std::string& text) {
    return fold_of_crease_pattern(text).error().place;
  };
  CHECK(place("1 0 0 1 1\n2 0 0 x 1\n") == "line 2, column 7");
  CHECK(place("1 0 0 1 1\n  1.5 0 0 1 1\n") == "line 2, column 3");
  CHECK(place("1 0 0 1 1\n1 0 0 1\n") == "line 2, column 8");
  CHECK(place("1 0 0 1 1 9\n") == "line 1, column 11");
  // The first line may be the wrong one.
  for (const std::string& first : {"one 0 0 9 0\n", "1 0 0 9\n", "crease pattern\n", "4\n"}) {
    CAPTURE(first);
    const std::string text = first + "1 0 0 9 0\n1 9 0 9 9\n1 9 9 0 0\n";
    CHECK(is_crease_pattern(text));
    CHECK(place(text).starts_with("line 1, column "));
  }
  std::string longer = opx;
  longer.replace(longer.find("length=\"2\""), 10, "length=\"4\"");
  CHECK(message(fold_of_crease_pattern(longer).error()) ==
        "announces 4 lines and has 2; is the file complete?");
  CHECK_FALSE(is_crease_pattern("0\nSECTION\n"));
  CHECK_FALSE(is_crease_pattern("<svg/>"));
}

TEST_CASE("files of other kinds are named with what to do", "[core][text]") {
  const auto says = [](std::string_view bytes, std::string_view name, const char* what) {
    CAPTURE(name, what);
    CHECK(foreign_advice(bytes, name).find(what) != std::string::npos);
  };
  says("%PDF-1.7", "a", "is a PDF document; make an SVG of it: pdftocairo -svg");
  says("%PDF-1.7", "A.AI", "is an Illustrator file");
  says("%!PS-Adobe-3.0 EPSF", "a.eps", "inkscape --export-type=svg");
  says("AC1032", "a.bin", "save it as DXF");
  says("ISO-10303-21;", "a", "is a STEP model");
  says("PK\x03\x04", "a.3mf", "is a 3MF model");
  says("PK\x03\x04", "a.zip", "unpack it");
  says("<?xml version='1.0'?><COLLADA>", "", "is a COLLADA model");
  says("\xEF\xBB\xBF<?xml version='1.0'?><amf unit='mm'>", "", "is an AMF model");
  says("OFF\n8 6 0\n", "", "is an OFF model");
  says("#VRML V2.0", "a", "is a VRML model");
  says("\x89PNG\r\n", "a.svg", "is a PNG picture");
  says("gimp xcf v011", "a.svg", "is a GIMP picture");
  says("8BPS", "a", "is a Photoshop picture");
  says("PK\x03\x04", "a.odg", "in LibreOffice Draw, export it as SVG");
  says("IN;PU;", "a.plt", "popcut send FILE");
  CHECK(foreign_advice("<svg/>", "a.svg").empty());
  CHECK(foreign_advice("0\nSECTION", "a.dxf").empty());
  CHECK(foreign_advice("\x1F\x8B\x08", "a.svgz").empty());
}

TEST_CASE("FOLD frames may inherit from later ones but not from themselves",
          "[core][formats][fold]") {
  const auto file = read_fold("{" + kTriangle +
                              R"(,"file_frames":[{"frame_parent":2,"frame_inherit":true},)"
                              R"({"frame_parent":0,"frame_inherit":true,"frame_title":"b",)"
                              R"("edges_assignment":["M","V","B"]}]})");
  INFO((file ? "" : message(file.error())));
  REQUIRE(file);
  REQUIRE(file->frames.size() == 3);
  CHECK(file->frames[1].assignments == std::vector<char>{'M', 'V', 'B'});
  CHECK(file->frames[1].title == "b");
  CHECK(file->frames[0].assignments == std::vector<char>(3, 'U'));
  CHECK(refused(kTriangle + R"(,"file_frames":[{"frame_parent":2,"frame_inherit":true},)"
                            R"({"frame_parent":1,"frame_inherit":true}])")
            .find("frame_parent: the frame inherits from itself") != std::string::npos);
  CHECK(refused(kTriangle + R"(,"file_frames":[{"frame_inherit":true}])") ==
        "/file_frames/0/frame_parent: must be the number of another frame, 0 to 1, because "
        "this frame inherits");
  CHECK(refused(kTriangle + R"(,"file_frames":[{"frame_parent":0,"frame_inherit":true,)"
                            R"("vertices_coords":[[0,0]]}])") ==
        "/file_frames/0/vertices_coords: has 1 vertices, but the inherited edges or faces use "
        "vertex 2");
}

TEST_CASE("FOLD members that are null count as absent and unknown ones are ignored",
          "[core][formats][fold]") {
  CHECK(refused(kTriangle + R"(,"faces_vertices":null,"edges_assignment":null,"frame_unit":null,)"
                            R"("edges_faces":[[0,null]],"own:thing":{"a":[1]},"faceOrders":7)")
            .empty());
}

TEST_CASE("a FOLD error says where and what would be right", "[core][formats][fold]") {
  CHECK(refused(kTriangle + "," + kTriangle) ==
        "/vertices_coords: the member occurs twice; remove one");
  CHECK(refused(R"("vertices_coords":[[0,0]],"edges_vertices":[[0,1.5]])") ==
        "/edges_vertices/0/1: is 1.5; give the number of a vertex, 0 to 0");
  CHECK(refused(R"("vertices_coords":[],"edges_vertices":[[0,1]])") ==
        "/edges_vertices/0/0: is 0; there are no vertices");
  CHECK(refused(R"("vertices_coords":[[0,0,0,0]])") ==
        "/vertices_coords/0: has 4 numbers; give two or three coordinates");
  CHECK(refused(kTriangle + R"(,"edges_vertices":[[0]])").find("occurs twice") !=
        std::string::npos);
  CHECK(refused(R"("vertices_coords":[[0,0]],"edges_vertices":[[0]])") ==
        "/edges_vertices/0: has 1 entries; an edge needs two vertices");
  CHECK(refused(kTriangle + R"(,"faces_vertices":[[0,1,9]])") ==
        "/faces_vertices/0/2: is 9; give the number of a vertex, 0 to 2");
  CHECK(refused(kTriangle + R"(,"edges_foldAngle":[0,0,999])").find("/edges_foldAngle/2") == 0);
  CHECK(refused(kTriangle + R"(,"edges_foldAngles":[0])").find("has 1 entries") !=
        std::string::npos);
  CHECK(refused(R"("vertices_coords":[[0,1e999]])").find("line 1") == 0);
  CHECK(refused(R"("vertices_coords":[[0,{}]])").find("/vertices_coords/0/1") == 0);
}

TEST_CASE("a border drawn a hundred thousand times becomes one slit", "[core][formats][fold]") {
  std::string edges = "[0,1]", letters = "\"B\"";
  for (int i = 0; i < 100'000; ++i) edges += ",[0,1]", letters += ",\"B\"";
  const auto work = value(linework_from_fold(
      R"({"frame_unit":"mm","vertices_coords":[[0,0],[0,9]],"edges_vertices":[)" + edges +
      R"(],"edges_assignment":[)" + letters + "]}"));
  CHECK(work.lines.size() == 1);
  CHECK(total_mm(work, Operation::Cut) == Approx(9));
}

TEST_CASE("JSON nested a million deep gets one clear error from every reader",
          "[core][formats][json]") {
  const std::string deep(1'000'000, '['), object = "{\"a\":" + deep;
  for (const std::string& text : {deep, object, object + std::string(1'000'000, ']') + "}"}) {
    CHECK(message(parse_json(text).error()).find("more than 64 deep") != std::string::npos);
    CHECK(message(parse_json_data(text).error()).find("more than 64 deep") != std::string::npos);
    CHECK_FALSE(linework_from_fold(text));
  }
  for (const auto& text : {std::string("{}\0", 3), std::string("[1\0]", 4)}) {
    CHECK(message(parse_json(text).error()).find("a zero byte") != std::string::npos);
    CHECK(message(parse_json_data(text).error()).find("a zero byte") != std::string::npos);
  }
  CHECK(message(parse_json("[" + std::string(3'000'000, ',') + "]").error()).find("more than") !=
        std::string::npos);
}

TEST_CASE("a plane graph has a vertex at each crossing and no edge twice",
          "[core][formats][graph]") {
  const std::vector<CreaseLine> lines{crease(0, 0, 10, 0, 'B'),   crease(10, 0, 10, 10, 'B'),
                                      crease(10, 10, 0, 10, 'B'), crease(0, 10, 0, 0, 'B'),
                                      crease(0, 0, 10, 10, 'M'),  crease(10, 0, 0, 10, 'V'),
                                      crease(2, 0, 8, 0, 'F')};
  const auto graph = value(planar_graph(lines, 1e-6));
  CHECK(graph.vertices.size() == 7);
  CHECK(graph.edges.size() == 10);
  CHECK(graph.faces.size() == 4);
  CHECK(graph.joined("MV") == 1);
  CHECK(graph.joined("M") == 2);
  CHECK(std::count(graph.assignments.begin(), graph.assignments.end(), 'F') == 0);
  CHECK_FALSE(planar_graph(std::vector<CreaseLine>{crease(0, 0, 1e9, 0, 'C')}, 1e-6));
  CHECK(planar_graph({}, 1e-6)->faces.empty());
}

TEST_CASE("a slit that ends inside a face is opened and keeps its tip", "[core][formats][graph]") {
  std::vector<CreaseLine> lines{crease(0, 0, 10, 0, 'B'), crease(10, 0, 10, 10, 'B'),
                                crease(10, 10, 0, 10, 'B'), crease(0, 10, 0, 0, 'B'),
                                crease(0, 5, 6, 5, 'C')};
  const auto graph = value(planar_graph(lines, 1e-6));
  CHECK(graph.faces.size() == 1);
  CHECK(graph.faces[0].size() == 7);  // the slit is walked on both sides
  const PlanarGraph split = split_cuts(graph);
  CHECK(split.faces.size() == 1);
  CHECK(split.edges.size() == 7);
  CHECK(split.vertices.size() == 7);  // its mouth is two vertices, its tip one
  CHECK(std::count(split.assignments.begin(), split.assignments.end(), 'B') == 7);
}

TEST_CASE("a FOLD pattern is read in whatever plane it lies, from the side of its faces",
          "[core][formats][fold]") {
  // A kite: lengths of its border and folds are all different, and it has no mirror symmetry.
  const std::vector<std::array<double, 2>> flat{{0, 0}, {40, 0}, {50, 30}, {5, 45}};
  const std::string rest =
      R"("edges_vertices":[[0,1],[1,2],[2,3],[3,0],[0,2]],"edges_assignment":["B","B","B","B","M"])";
  const std::string faces = R"(,"faces_vertices":[[0,1,2],[0,2,3]])";
  const auto read = [&](auto&& place, bool with_faces) {
    std::string vertices;
    for (const auto& [x, y] : flat) {
      const std::array<double, 3> v = place(x, y);
      vertices +=
          fmt::format("{}[{:.12g},{:.12g},{:.12g}]", vertices.empty() ? "" : ",", v[0], v[1], v[2]);
    }
    const auto work = linework_from_fold(R"({"frame_unit":"mm","vertices_coords":[)" + vertices +
                                         "]," + rest + (with_faces ? faces : "") + "}");
    INFO((work ? "" : message(work.error())));
    REQUIRE(work);
    return *work;
  };
  using P = std::array<double, 3>;
  const LineWork meant = read([](double x, double y) { return P{x, y, 0}; }, true);
  // The side after the longest one, going round with the area at the same hand: a mirror image has
  // another one there.
  const auto after_longest = [](const LineWork& work) {
    for (const DrawnLine& line : work.lines) {
      if (line.operation != Operation::Outline) continue;
      const auto p = work.points_of(line);
      const std::size_t n = p.size() - 1;
      double area = 0;
      std::vector<double> sides;
      for (std::size_t k = 0; k < n; ++k) {
        area += p[k].x * p[k + 1].y - p[k + 1].x * p[k].y;
        sides.push_back(distance(p[k], p[k + 1]));
      }
      const auto longest =
          static_cast<std::size_t>(std::max_element(sides.begin(), sides.end()) - sides.begin());
      return sides[(longest + (area > 0 ? 1 : n - 1)) % n];
    }
    return 0.0;
  };
  const auto same = [&](const LineWork& work) {
    CHECK(total_mm(work, Operation::Outline) == Approx(total_mm(meant, Operation::Outline)));
    CHECK(total_mm(work, Operation::FoldMountain) ==
          Approx(total_mm(meant, Operation::FoldMountain)));
    CHECK(count(work, Operation::FoldValley) == 0);
    CHECK(after_longest(work) == Approx(after_longest(meant)));
  };
  same(meant);
  CHECK(after_longest(read(
            [](double x, double y) {
              return P{-x, y, 0};
            },
            false)) != Approx(after_longest(meant)));  // the check sees a mirror image
  // Origami Simulator: y up, the pattern in x and z; seen from +y, z runs down.
  same(read([](double x, double y) { return P{x, 0, -y}; }, false));
  same(read([](double x, double y) { return P{x, 7, -y}; }, true));
  same(read([](double x, double y) { return P{-3, x, y}; }, false));
  same(read([](double x, double y) { return P{x, y, 12}; }, false));
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  for (int round = 0; round < 50; ++round) {
    // A random rotation: two orthogonal unit vectors; the faces say which side is the front.
    P u{number(random), number(random), number(random)},
        v{number(random), number(random), number(random)};
    const auto dot = [](const P& a, const P& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const auto unit = [&](P& a) {
      const double l = std::sqrt(dot(a, a));
      for (double& c : a) c /= l;
    };
    unit(u);
    const double along = dot(u, v);
    for (std::size_t c = 0; c < 3; ++c) v[c] -= along * u[c];
    unit(v);
    same(read(
        [&](double x, double y) {
          return P{x * u[0] + y * v[0], x * u[1] + y * v[1] + 3, x * u[2] + y * v[2]};
        },
        true));
  }
}

// flat-folder, Oriedita, Rabbit Ear and others write a square of 1 x 1 units.
TEST_CASE("a FOLD file may be UTF-16, have its frames in a list, and name units in words",
          "[core][formats][fold]") {
  const auto file = [](const std::string& unit) {
    return R"({"file_spec":1.1,"file_frames":[{"frame_unit":")" + unit +
           R"(","vertices_coords":[[0,0],[2,0],[2,1],[0,1]],"edges_vertices":[[0,1],[1,2],[2,3],[3,0],[0,2]],"edges_assignment":["B","B","B","B","V"]}]})";
  };
  for (const auto& [unit, mm] : {std::pair("Inch", 25.4), {"MM", 1.0}, {"feet", 304.8}}) {
    CAPTURE(unit);
    const auto work = value(linework_from_fold(file(unit)));
    CHECK(total_mm(work, Operation::Outline) == Approx(6 * mm));
    CHECK(total_mm(work, Operation::FoldValley) == Approx(std::sqrt(5.0) * mm));
  }
  std::string wide = "\xFE\xFF";
  for (const char c : file("cm")) (wide += '\0') += c;
  const auto work = value(linework_from_fold(wide));
  CHECK(total_mm(work, Operation::Outline) == Approx(60));
}

TEST_CASE("a warning names folds whose angle is that of the other side", "[core][formats][fold]") {
  const auto told = [](const std::string& letters, const std::string& angles) {
    const auto work =
        linework_from_fold("{" + kTriangle + R"(,"frame_unit":"mm",)" + R"("edges_assignment":[)" +
                           letters + R"(],"edges_foldAngle":[)" + angles + "]}");
    REQUIRE(work);
    for (const Warning& warning : work->warnings)
      if (warning.message.find("1 folds have a fold angle of the other side") == 0) return true;
    return false;
  };
  CHECK(told(R"("B","B","M")", "0,0,90"));
  CHECK(told(R"("B","B","V")", "0,0,-1"));
  CHECK_FALSE(told(R"("B","B","M")", "0,0,-90"));
  CHECK_FALSE(told(R"("B","B","V")", "0,0,0"));
}

TEST_CASE("an edge without length does not make a crease pattern larger", "[core][formats][fold]") {
  const auto work = value(linework_from_fold(*fold_of_crease_pattern("1 0 0 9 0\n2 99 0 99 0\n")));
  CHECK(bounds(work).width() == Approx(9));
  CHECK(std::any_of(work.warnings.begin(), work.warnings.end(),
                    [](const Warning& one) { return one.code == "no_size"; }));
}

TEST_CASE("crease patterns of a FOLD file that are not read are counted", "[core][formats][fold]") {
  const std::string pattern =
      R"("vertices_coords":[[0,0],[2,0],[2,1],[0,1]],"edges_vertices":[[0,1],[1,2],[2,3],[3,0]])";
  const std::string triangle =
      R"("vertices_coords":[[0,0],[2,0],[2,1]],"edges_vertices":[[0,1],[1,2],[2,0]])";
  const auto told = [&](const std::string& frames) {
    const auto work = value(linework_from_fold(
        "{" + pattern + R"(,"edges_assignment":["B","B","B","B"],"file_frames":[)" + frames +
        "]}"));
    return std::any_of(work.warnings.begin(), work.warnings.end(), [](const Warning& warning) {
      return warning.message.find("1 more crease pattern;") != std::string::npos;
    });
  };
  CHECK(told("{" + triangle + "}"));
  CHECK_FALSE(told(R"({"frame_classes":["foldedForm"],)" + triangle + "}"));
  CHECK_FALSE(told(R"({"frame_parent":0,"frame_inherit":true})"));
}

TEST_CASE("a FOLD file of one unit is read at the size that it is cut", "[core][formats][fold]") {
  // Corners of 3 mm at 300 mm: cut off by a side of 0.01 units each; and a slot 0.008 units wide.
  const std::string text =
      R"({"vertices_coords":[[0,0.01],[0.01,0],[1,0],[1,1],[0.508,1],[0.508,0.5],[0.5,0.5],[0.5,1],[0,1]],)"
      R"("edges_vertices":[[0,1],[1,2],[2,3],[3,4],[4,5],[5,6],[6,7],[7,8],[8,0]],)"
      R"("edges_assignment":["B","B","B","B","B","B","B","B","B"]})";
  const double whole = std::hypot(0.01, 0.01) + 0.99 + 1 + 0.492 + 0.5 + 0.008 + 0.5 + 0.5 + 0.99;
  for (const double enlarged : {100.0, 300.0, 3000.0}) {
    const auto work = value(linework_from_fold(text, {}, {}, enlarged));
    CHECK(work.lines.size() == 1);
    CHECK(total_mm(work, Operation::Outline) == Approx(whole).epsilon(1e-9));
  }
  // Of 1000 units on 100 mm, ends that are 0.1 units apart meet.
  const auto large = value(linework_from_fold(
      R"({"vertices_coords":[[0,0],[1000,0],[1000,1000],[0,1000],[0.05,0.1]],)"
      R"("edges_vertices":[[0,1],[1,2],[2,3],[3,4]],"edges_assignment":["B","B","B","B"]})",
      {}, {}, 0.1));
  CHECK(large.lines.size() == 1);
  CHECK(large.points_of(large.lines[0]).front() == large.points_of(large.lines[0]).back());
}

TEST_CASE("faces of a FOLD file stand for edges and border where no list gives them",
          "[core][formats][fold]") {
  const std::string square = R"("vertices_coords":[[0,0],[10,0],[10,10],[0,10]],)"
                             R"("faces_vertices":[[0,1,2],[0,2,3]])";
  const auto alone = value(linework_from_fold(R"({"frame_unit":"mm",)" + square + "}"));
  CHECK(total_mm(alone, Operation::Outline) == Approx(40));
  CHECK(alone.lines.size() == 1);
  REQUIRE(alone.warnings.size() == 1);  // the diagonal: nothing says that it is a fold
  CHECK(alone.warnings[0].spoils);
  // Only the fold is listed: the outline still comes from the faces.
  const auto fold_only =
      value(linework_from_fold(R"({"frame_unit":"mm",)" + square +
                               R"(,"edges_vertices":[[0,2]],"edges_assignment":["V"]})"));
  CHECK(total_mm(fold_only, Operation::FoldValley) == Approx(std::hypot(10, 10)));
  CHECK(total_mm(fold_only, Operation::Outline) == Approx(40));
  CHECK(fold_only.warnings.empty());
  const auto no_faces = value(linework_from_fold(
      R"({"frame_unit":"mm","vertices_coords":[[0,0],[10,0]],"edges_vertices":[[0,1]],)"
      R"("edges_assignment":["V"]})"));
  REQUIRE(no_faces.warnings.size() == 1);
  CHECK_THAT(no_faces.warnings[0].message, Catch::Contains("not cut out"));
  const auto angled = value(linework_from_fold(
      R"({"frame_unit":"mm",)" + square +
      R"(,"edges_vertices":[[2,0],[0,1],[1,2],[2,3],[3,0]],"edges_foldAngle":[90,0,0,0,0]})"));
  CHECK(total_mm(angled, Operation::FoldValley) == Approx(std::hypot(10, 10)));
  CHECK(total_mm(angled, Operation::Outline) == Approx(40));
}

TEST_CASE("a model folded flat is refused, and a crease pattern under its name is read",
          "[core][formats][fold][bad]") {
  const auto file = [](const char* corners, const char* more) {
    return fmt::format(
        R"({{"file_spec":1.1,"frame_unit":"mm","frame_classes":["foldedForm"],"vertices_coords":{},
            "edges_vertices":[[0,1],[1,2],[2,3],[3,0],[3,1]],"edges_assignment":["B","B","B","B","V"]{}}})",
        corners, more);
  };
  const char *folded = "[[0,0],[20,0],[0,0],[0,20]]", *flat = "[[0,0],[20,0],[20,20],[0,20]]",
             *faces = R"(,"faces_vertices":[[0,1,3],[1,2,3]])";
  for (const char* more : {"", faces}) {
    const auto read = linework_from_fold(file(folded, more));
    REQUIRE_FALSE(read);
    CHECK_THAT(read.error().detail, Catch::Contains("folded flat"));
    CHECK(linework_from_fold(file(flat, more)));
  }
  // Its corners lie in places of their own, and one face looks down.
  const auto aside = linework_from_fold(file("[[0,0],[20,0],[3,1],[0,20]]", faces));
  REQUIRE_FALSE(aside);
  CHECK(aside.error().place == "/vertices_coords");
}

TEST_CASE("a FOLD file without a flat pattern or a size says what to give",
          "[core][formats][fold]") {
  const auto why = [](const std::string& members) {
    const auto work = linework_from_fold("{" + members + "}");
    return work ? std::string("accepted") : message(work.error());
  };
  CHECK_THAT(why(R"("vertices_coords":[[0,0,0],[1,0,1],[1,1,0],[0,1,1]],)"
                 R"("edges_vertices":[[0,1],[1,2],[2,3],[3,0]])"),
             Catch::Contains("folded model") && Catch::Contains("flat crease pattern"));
  CHECK_THAT(why(R"("vertices_coords":[[0,0],[1,0],[1,1]])"), Catch::Contains("neither"));
  CHECK_THAT(why(R"("vertices_coords":[[0,0],[0,0],[0,0]],"edges_vertices":[[0,1]])"),
             !Catch::Contains("folded"));
  CHECK_THAT(
      why(R"("frame_unit":"furlong","vertices_coords":[[0,0],[1,0]],"edges_vertices":[[0,1]])"),
      Catch::Contains("/frame_unit") && Catch::Contains("use mm, cm"));
  const auto tiny =
      linework_from_fold(R"({"vertices_coords":[[0,0],[1,0],[1,2]],)"
                         R"("edges_vertices":[[0,1],[1,2]],"edges_assignment":["b","v"]})");
  REQUIRE(tiny);
  CHECK(count(*tiny, Operation::FoldValley) == 1);
  CHECK_THAT(tiny->warnings.at(0).message,
             Catch::Contains("2 x 1 mm") && Catch::Contains("`width`"));
  for (const auto& [unit, mm] : std::vector<std::pair<std::string, double>>{
           {"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"pt", 25.4 / 72}, {"um", 0.001}}) {
    const auto work =
        value(linework_from_fold(R"({"frame_unit":")" + unit +
                                 R"(","vertices_coords":[[0,0],[3,0]],)"
                                 R"("edges_vertices":[[0,1]],"edges_assignment":["C"]})"));
    CHECK(total_mm(work, Operation::Cut) == Approx(3 * mm));
    CHECK(work.warnings.empty());
  }
}

}  // namespace fold_input_test
