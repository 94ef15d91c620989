// SPDX-License-Identifier: MIT
#include <algorithm>

#include <catch2/catch.hpp>

#include "core/drawing/planar_graph.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/text/json_text.hpp"
#include "tests/support/linework_checks.hpp"

namespace fold_input_test {

using namespace popcut;
using namespace popcut::test;

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
  const auto work = linework_from_fold(
      R"({"frame_unit":"mm","vertices_coords":[[0,0],[0,9]],"edges_vertices":[)" + edges +
      R"(],"edges_assignment":[)" + letters + "]}");
  REQUIRE(work);
  CHECK(work->lines.size() == 1);
  CHECK(total_mm(*work, Operation::Cut) == Approx(9));
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
  const auto graph = planar_graph(lines, 1e-6);
  REQUIRE(graph);
  CHECK(graph->vertices.size() == 7);
  CHECK(graph->edges.size() == 10);
  CHECK(graph->faces.size() == 4);
  CHECK(graph->joined("MV") == 1);
  CHECK(graph->joined("M") == 2);
  CHECK(std::count(graph->assignments.begin(), graph->assignments.end(), 'F') == 0);
  CHECK_FALSE(planar_graph(std::vector<CreaseLine>{crease(0, 0, 1e9, 0, 'C')}, 1e-6));
  CHECK(planar_graph({}, 1e-6)->faces.empty());
}

TEST_CASE("a slit that ends inside a face is opened and keeps its tip", "[core][formats][graph]") {
  std::vector<CreaseLine> lines{crease(0, 0, 10, 0, 'B'), crease(10, 0, 10, 10, 'B'),
                                crease(10, 10, 0, 10, 'B'), crease(0, 10, 0, 0, 'B'),
                                crease(0, 5, 6, 5, 'C')};
  const auto graph = planar_graph(lines, 1e-6);
  REQUIRE(graph);
  CHECK(graph->faces.size() == 1);
  CHECK(graph->faces[0].size() == 7);  // the slit is walked on both sides
  const PlanarGraph split = split_cuts(*graph);
  CHECK(split.faces.size() == 1);
  CHECK(split.edges.size() == 7);
  CHECK(split.vertices.size() == 7);  // its mouth is two vertices, its tip one
  CHECK(std::count(split.assignments.begin(), split.assignments.end(), 'B') == 7);
}

}  // namespace fold_input_test
