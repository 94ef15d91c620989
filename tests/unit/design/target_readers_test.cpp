// SPDX-License-Identifier: MIT
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/target/mesh_reader.hpp"
#include "tests/support/meshes.hpp"

namespace target_readers_test {

using namespace popcut;
using namespace popcut::tests;

namespace {

Error refused(const Result<TriangleMesh>& result) {
  if (result) FAIL("it was read");
  return result.error();
}

}  // namespace

TEST_CASE("STL of both kinds and OBJ give the same triangles", "[core][mesh]") {
  const TriangleMesh ball = icosphere(12.5, 2);
  const auto binary = read_mesh("ball.stl", binary_stl(ball));
  const auto text = read_mesh("a/BALL.STL", text_stl(ball));
  const auto object = read_mesh("ball.obj", obj(ball));
  REQUIRE(binary);
  REQUIRE(text);
  REQUIRE(object);
  CHECK(binary->corners == ball.corners);
  REQUIRE(text->size() == ball.size());
  REQUIRE(object->size() == ball.size());
  for (std::size_t k = 0; k < ball.corners.size(); ++k) {
    CHECK_THAT(text->corners[k], Catch::WithinAbs(ball.corners[k], 1e-5));
    CHECK_THAT(object->corners[k], Catch::WithinAbs(ball.corners[k], 1e-5));
  }
}

TEST_CASE("polygons and indices of every kind in an OBJ are read and its other lines are not",
          "[core][mesh]") {
  const auto mesh = read_mesh("quad.obj",
                              "mtllib /etc/passwd\nusemtl x\nv 0 0 0 1.0\nv 1 0 0\nv 1 1 0\n"
                              "vt 0 0\nvn 0 0 1\nv 0 1 0\r\nf 1/1/1 2//1 -2/1 -1\ncurv2 9 9\n");
  if (!mesh) FAIL(message(mesh.error()));
  CHECK(mesh->size() == 2);
}

TEST_CASE("an incomplete or invalid mesh file is refused with its place", "[core][mesh]") {
  const TriangleMesh ball = icosphere(1.0, 1);
  std::string stl = binary_stl(ball);
  CHECK(refused(read_mesh("m.stl", stl.substr(0, stl.size() - 20))).detail ==
        "announces 80 triangles and holds 79; is the file whole?");
  std::string lying = stl;
  std::memset(lying.data() + 80, 0xff, 4);
  CHECK(refused(read_mesh("m.stl", lying)).detail ==
        "announces 4294967295 triangles and holds 80; is the file whole?");
  std::memset(lying.data() + 80, 0, 4);
  CHECK(refused(read_mesh("m.stl", lying.substr(0, 84))).detail ==
        "has no triangles; a mesh needs faces");
  std::string nan = stl;
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan.data() + 84 + 50 * 3 + 12, &not_a_number, 4);
  const Error with_nan = refused(read_mesh("m.stl", nan));
  CHECK(with_nan.kind == ErrorKind::OutOfRange);
  CHECK(with_nan.place == "m.stl: triangle 3");

  CHECK(refused(read_mesh("m.ply", "ply")).kind == ErrorKind::Malformed);
  CHECK(refused(read_mesh("m.stl", "")).kind == ErrorKind::Malformed);
  CHECK(refused(read_mesh("m.stl", "solid x\nendsolid x\n")).detail ==
        "has no triangles; a mesh needs faces");
  CHECK(refused(read_mesh("m.stl", "solid x\nfacet\nvertex 1 2 3\n")).detail ==
        "ends inside a facet; is the file whole?");
  CHECK(refused(read_mesh("m.stl", "solid x\nfacet\nvertex 1 2 nan\n")).place == "m.stl: line 3");
  CHECK(refused(read_mesh("m.obj", "")).kind == ErrorKind::Malformed);
  CHECK(refused(read_mesh("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")).detail ==
        "has no faces; a mesh needs some");
  CHECK(refused(read_mesh("m.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\n")).kind == ErrorKind::OutOfRange);
  CHECK(refused(read_mesh("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1e99 0\n")).kind ==
        ErrorKind::OutOfRange);
  CHECK(refused(read_mesh("m.obj", "v 0 0 zero\n")).place == "m.obj: line 1");
  for (const char* face : {"f 1 2 4", "f 1 2", "f 0 1 2", "f 1 2 -4", "f 1 2 99999999999999999999",
                           "f 1 2 x", "f 1 2 3.5", "f 1 2 3/a"}) {
    CAPTURE(face);
    const Error error =
        refused(read_mesh("m.obj", fmt::format("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}\n", face)));
    CHECK(error.place == "m.obj: line 4");
    CHECK(error.kind == ErrorKind::Malformed);
  }
}

TEST_CASE("a grid of heights becomes two triangles a cell", "[core][grid]") {
  for (const char* text : {",0,10,20\n0,40,35,0\n10,42,36,0\n",
                           "\xEF\xBB\xBF;0;10;20\r\n0;40;35;0\r\n10;42;36;0\r\n\r\n",
                           "y\\x\t0\t10\t 20\n0\t40\t35\t+0\n10\t42\t3.6e1\t0"}) {
    CAPTURE(text);
    const auto mesh = read_height_grid("h.csv", text);
    if (!mesh) FAIL(message(mesh.error()));
    CHECK(mesh->size() == 4);
    CHECK(mesh->corners[2] == 40.0F);
    CHECK(mesh->corners[9 + 5] == 36.0F);
  }
}

TEST_CASE("a grid with gaps or text is refused with line and column", "[core][grid]") {
  struct Row {
    const char* text;
    const char* place;
  };
  for (const Row& row :
       {Row{",0,10\n0,1,\n10,1,1\n", "h.csv: line 2, column 3"},
        Row{",0,10\n0,1,1\n10,high,1\n", "h.csv: line 3, column 2"},
        Row{",0,10\n0,1\n10,1,1\n", "h.csv: line 2, column 3"},
        Row{",0,10\n0,1,1,1\n10,1,1\n", "h.csv: line 2, column 4"},
        Row{",0,10\n0,1,1\n\n10,1,1\n", "h.csv: line 3, column 1"},
        Row{",0,10\n0,1,1\n0,1,1\n", "h.csv: line 3, column 1"},
        Row{",10,0\n0,1,1\n1,1,1\n", "h.csv: line 1, column 3"},
        Row{",0,x\n0,1,1\n1,1,1\n", "h.csv: line 1, column 3"},
        Row{",0,10\n0,1,nan\n1,1,1\n", "h.csv: line 2, column 3"},
        Row{",0,10\n0,1,1e999\n1,1,1\n", "h.csv: line 2, column 3"},
        Row{",0,10\n0,1,1\n", "h.csv: line 2, column 1"},
        Row{",0\n0,1\n1,1\n", "h.csv: line 1, column 2"}, Row{"hello\n", "h.csv: line 1, column 1"},
        Row{"", "h.csv: line 1, column 1"}}) {
    CAPTURE(row.text);
    const Error error = refused(read_height_grid("h.csv", row.text));
    CHECK(error.place == row.place);
    CHECK(error.kind == ErrorKind::Malformed);
  }
}

TEST_CASE("truncated or changed files are read or refused and never crash", "[core][mesh][grid]") {
  const TriangleMesh ball = icosphere(1.0, 1);
  const std::string grid = ",0,10,20\n0,40,35,0\n10,42,36,0\n";
  std::mt19937 random(20261121);
  for (const auto& [name, whole] : {std::pair<std::string, std::string>{"m.stl", binary_stl(ball)},
                                    {"m.stl", text_stl(ball)},
                                    {"m.obj", obj(ball)},
                                    {"h.csv", grid}}) {
    for (int k = 0; k < 300; ++k) {
      CAPTURE(name, k);
      std::string bytes = whole;
      if (k % 2 == 0) bytes.resize(random() % (bytes.size() + 1));
      for (int change = 0; change < k % 7 && !bytes.empty(); ++change) {
        const std::size_t at = random() % bytes.size();
        if (k % 3 == 0)
          bytes[at] = static_cast<char>(random());
        else
          bytes.insert(at, 1, "0123456789-+./ \nfveE,nai"[random() % 24]);
      }
      const auto mesh = name == "h.csv" ? read_height_grid(name, bytes) : read_mesh(name, bytes);
      if (mesh) {
        for (const float value : mesh->corners) REQUIRE(std::isfinite(value));
      } else {
        CHECK_FALSE(mesh.error().detail.empty());
      }
    }
  }
}

}  // namespace target_readers_test
