// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"
#include "tests/support/meshes.hpp"

namespace target_readers_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// RFC 4648.
std::string base64(const std::string& bytes) {
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t three = 0;
    for (std::size_t i = 0; i < 3; ++i)
      three = three << 8 | (k + i < bytes.size() ? static_cast<unsigned char>(bytes[k + i]) : 0U);
    for (std::size_t i = 0; i < 4; ++i)
      out += k + i > bytes.size() ? '=' : kLetters[three >> (18 - 6 * i) & 63];
  }
  return out;
}

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

TEST_CASE("a glTF gives the triangles of its scene", "[core][mesh]") {
  const TriangleMesh ball = icosphere(12.5, 2);
  const auto plain = read_mesh("ball.glb", glb(ball));
  REQUIRE(plain);
  CHECK(plain->corners == ball.corners);
  // Turned by 90 degrees about x (y to z), twice as large, then moved.
  const char* const nodes = R"([{"translation": [1, 2, 3], "children": [1]},
      {"rotation": [0.70710678118654752, 0, 0, 0.70710678118654752], "scale": [2, 2, 2], "mesh": 0}])";
  const std::string bytes = glb(ball, nodes);
  for (const char* name : {"ball.glb", "sha256-0", "BALL.GLB"}) {
    const auto turned = read_mesh(name, bytes);
    REQUIRE(turned);
    REQUIRE(turned->size() == ball.size());
    for (std::size_t k = 0; k < ball.corners.size(); k += 3) {
      CHECK_THAT(turned->corners[k], Catch::WithinAbs(1 + 2 * ball.corners[k], 1e-4));
      CHECK_THAT(turned->corners[k + 1], Catch::WithinAbs(2 - 2 * ball.corners[k + 2], 1e-4));
      CHECK_THAT(turned->corners[k + 2], Catch::WithinAbs(3 + 2 * ball.corners[k + 1], 1e-4));
    }
  }
}

TEST_CASE("vertices of a glTF may be interleaved, and its indices of each size", "[core][mesh]") {
  // Four corners of a square, 16 bytes apart, then two triangles as indices.
  const auto [type, bytes_each] = GENERATE(table<int, int>({{5121, 1}, {5123, 2}, {5125, 4}}));
  CAPTURE(type);
  std::string buffer;
  for (const std::array<float, 4> corner :
       {std::array<float, 4>{0, 0, 0, 9}, {2, 0, 0, 9}, {2, 2, 0, 9}, {0, 2, 0, 9}})
    buffer.append(reinterpret_cast<const char*>(corner.data()), sizeof corner);
  for (const std::uint32_t index : {0, 1, 2, 0, 2, 3})
    buffer.append(reinterpret_cast<const char*>(&index), static_cast<std::size_t>(bytes_each));
  const std::string text = fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}},
                            {{"attributes": {{"POSITION": 0}}, "mode": 1}}]}}],
"buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}],
"bufferViews": [{{"buffer": 0, "byteLength": 64, "byteStride": 16}},
                {{"buffer": 0, "byteOffset": 64, "byteLength": {}}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
              {{"bufferView": 1, "componentType": {}, "count": 6, "type": "SCALAR"}}]}})",
      buffer.size(), base64(buffer), 6 * bytes_each, type);
  const auto mesh = read_mesh("square.gltf", text);
  if (!mesh) FAIL(message(mesh.error()));
  CHECK(mesh->corners == std::vector<float>{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 0, 0, 2, 2, 0, 0, 2, 0});
  // The last corner ends at byte 60, and no accessor reaches into the next view.
  std::string shorter = text;
  const std::size_t at = text.find("\"byteLength\": 64");
  CHECK(read_mesh("square.gltf", shorter.replace(at, 16, "\"byteLength\": 60")));
  CHECK_THAT(
      refused(read_mesh("square.gltf", shorter.replace(at, 16, "\"byteLength\": 59"))).detail,
      Catch::StartsWith("announces 4 values, more than its buffer view holds"));
}

namespace {

/// A .gltf with a square of two triangles in the plane z = 0, from (0,0) to (2,2), whose corners
/// are in accessor 0.
/// @param primitive   the rest of its primitive, with a comma before it
/// @param mesh        the rest of its mesh
/// @param nodes       of the scene: all
/// @param rest        more members of the file, with a comma before them
/// @param more        numbers after the corners, as accessors of three numbers each from 1 on: a
/// buffer view for each
struct Square {
  std::string indices = "[0, 1, 2, 0, 2, 3]", primitive, mesh, nodes = R"({"mesh": 0})", rest;
  std::vector<std::vector<float>> more;
  std::vector<std::string> types;  ///< of `more`

  [[nodiscard]] std::string text() const {
    std::string buffer;
    const std::array<float, 12> corners{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
    buffer.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
    std::string views = R"({"buffer": 0, "byteLength": 48})";
    std::string accessors =
        R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})";
    for (std::size_t k = 0; k < more.size(); ++k) {
      const std::size_t size = more[k].size() * sizeof(float);
      views += fmt::format(R"(, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}})",
                           buffer.size(), size);
      const std::size_t parts = types[k] == "VEC3"   ? 3
                                : types[k] == "VEC4" ? 4
                                : types[k] == "MAT4" ? 16
                                                     : 1;
      accessors +=
          fmt::format(R"(, {{"bufferView": {}, "componentType": 5126, "count": {}, "type": "{}"}})",
                      k + 1, more[k].size() / parts, types[k]);
      buffer.append(reinterpret_cast<const char*>(more[k].data()), size);
    }
    std::string all;
    for (std::size_t k = 0,
                     n = 1 + static_cast<std::size_t>(std::count(nodes.begin(), nodes.end(), '\n'));
         k < n; ++k)
      all += fmt::format("{}{}", k ? ", " : "", k);
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [{}]}}], "nodes": [{}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0{}}} {}}}] {}}}],
"buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}],
"bufferViews": [{}], "accessors": [{}] {}}})",
        all, nodes, attributes, primitive, mesh, buffer.size(), base64(buffer), views, accessors,
        rest);
  }
  std::string attributes;  ///< more of them, with a comma before them
};

/// The corners of triangles, as text that is easy to compare.
std::vector<float> corners_of(const Square& square) {
  const auto mesh = read_mesh("square.gltf", square.text());
  if (!mesh) FAIL(message(mesh.error()));
  return mesh->corners;
}

const std::vector<float> kTwoTriangles{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 0, 0, 2, 2, 0, 0, 2, 0};

}  // namespace

// Khronos, glTF 2.0 Specification, 3.7.2.1: strips turn every second triangle, fans share their
// first vertex.
TEST_CASE("strips and fans of a glTF are triangles", "[core][mesh]") {
  Square fan;
  fan.primitive = R"(, "mode": 6)";  // 1 2 0, then 2 3 0
  CHECK(corners_of(fan) ==
        std::vector<float>{2, 0, 0, 2, 2, 0, 0, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, 0});
  Square strip;  // its second triangle is turned: 1, 3, 2
  strip.primitive = R"(, "mode": 5)";
  CHECK(corners_of(strip) ==
        std::vector<float>{0, 0, 0, 2, 0, 0, 2, 2, 0, 2, 0, 0, 0, 2, 0, 2, 2, 0});
}

TEST_CASE("a node that is not to be seen is left out, with all below it", "[core][mesh]") {
  Square square;
  square.primitive = R"(, "mode": 6)";
  square.nodes = R"({"mesh": 0},
{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}})";
  CHECK(corners_of(square).size() == 18);
  square.nodes = R"({"mesh": 0},
{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}})";
  CHECK(corners_of(square).size() == 36);
}

TEST_CASE("a skin moves its vertices from the joints, and the place of the node does not count",
          "[core][mesh]") {
  Square square;
  square.primitive = R"(, "mode": 6)";
  square.attributes = R"(, "JOINTS_0": 1, "WEIGHTS_0": 2)";
  // All hang on joint 0, but the third vertex to three quarters on joint 1.
  square.types = {"VEC4", "VEC4", "MAT4"};
  square.more = {{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0},
                 {1, 0, 0, 0, 1, 0, 0, 0, 0.25F, 0.75F, 0, 0, 1, 0, 0, 0},
                 {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1,
                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -8, 1}};
  square.rest = R"(, "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}])";
  square.nodes = R"({"mesh": 0, "skin": 0, "translation": [500, 0, 0]},
{"translation": [10, 0, 0]},
{"translation": [10, 0, 16]})";
  CHECK(corners_of(square) ==
        std::vector<float>{12, 0, 0, 12, 2, 6, 10, 0, 0, 12, 2, 6, 10, 2, 0, 10, 0, 0});
  square.rest = R"(, "skins": [{"joints": [1], "inverseBindMatrices": 3}])";
  CHECK_THAT(refused(read_mesh("a.gltf", square.text())).detail,
             Catch::Contains("a joint that does not exist"));
}

TEST_CASE("morph targets move vertices by the weights of the node, else by those of the mesh",
          "[core][mesh]") {
  Square square;
  square.primitive = R"(, "mode": 6, "targets": [{"POSITION": 1}])";
  square.types = {"VEC3"};
  square.more = {{0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0, 4}};
  CHECK(corners_of(square)[2] == 0.0F);
  square.mesh = R"(, "weights": [0.5])";
  CHECK(corners_of(square)[2] == 2.0F);
  square.nodes = R"({"mesh": 0, "weights": [0.25, 0]})";
  CHECK(corners_of(square)[2] == 1.0F);
  square.nodes = R"({"mesh": 0, "weights": [0.25, 1]})";
  CHECK(refused(read_mesh("a.gltf", square.text())).detail ==
        "has 2 weights for 1 morph targets; repair the model");
}

TEST_CASE("corners of a glTF that make no whole triangle are told", "[core][mesh]") {
  Square square;  // four corners, as triangles
  std::vector<std::string> notes;
  REQUIRE(read_mesh("a.gltf", square.text(), &notes));
  CHECK(notes ==
        std::vector<std::string>{
            "corners of the model that make no whole triangle, 1: popcut leaves them out"});
}

TEST_CASE("each instance of a node is there", "[core][mesh]") {
  Square square;
  square.primitive = R"(, "mode": 6)";
  square.types = {"VEC3", "VEC3"};
  square.more = {{0, 0, 0, 0, 0, 7}, {1, 1, 1, 2, 2, 2}};
  square.nodes =
      R"({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1, "SCALE": 2}}}})";
  const auto corners = corners_of(square);
  REQUIRE(corners.size() == 36);
  CHECK(corners[0] == 2.0F);
  CHECK(corners[18] == 4.0F);
  CHECK(corners[20] == 7.0F);
  square.more[1] = {1, 1, 1};
  CHECK_THAT(refused(read_mesh("a.gltf", square.text())).detail,
             Catch::StartsWith("has instances whose lists are not as long as each other"));
}

namespace {

/// A .gltf whose buffer has, at 0 the corners of the square, at 48 two points (2,2,5) and (0,2,5),
/// at 72 the bytes 2 and 3, at 74 the shorts 0 1 2 0 0 0, at 86 the byte 3, 4, at 88 the shorts
/// 2 3.
std::string sparse_gltf(const std::string& accessors, const std::string& primitive,
                        const std::string& mesh = "") {
  std::string buffer;
  const std::array<float, 18> points{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 2, 2, 5, 0, 2, 5};
  const std::array<std::uint8_t, 2> which{2, 3}, last{4, 5};
  const std::array<std::uint16_t, 6> corners{0, 1, 2, 0, 0, 0};
  const std::array<std::uint16_t, 2> ends{2, 3};
  const auto put = [&](const auto& all) {
    buffer.append(reinterpret_cast<const char*>(all.data()), sizeof all);
  };
  put(points), put(which), put(corners), put(last), put(ends);
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{{}}}] {}}}], "accessors": [{}],
"bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 44}}],
"buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}]}})",
      primitive, mesh, accessors, buffer.size(), base64(buffer));
}

constexpr const char* kCorners =
    R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3")";
constexpr const char* kLifted =
    R"("sparse": {"count": 2, "indices": {"bufferView": 1, "byteOffset": 24, "componentType": 5121},
"values": {"bufferView": 1}}})";

}  // namespace

// Khronos, glTF 2.0 Specification, 3.6.2.3.
TEST_CASE("sparse values of a glTF replace those of its buffer or zeros", "[core][mesh]") {
  const auto corners = [](const std::string& text) {
    const auto mesh = read_mesh("a.gltf", text);
    if (!mesh) FAIL(message(mesh.error()));
    return mesh->corners;
  };
  const std::string fan = R"("mode": 6, "attributes": {"POSITION": 0})";
  const std::string lifted = std::string(kCorners) + ", " + kLifted;
  CHECK(corners(sparse_gltf(lifted, fan)) ==
        std::vector<float>{2, 0, 0, 2, 2, 5, 0, 0, 0, 2, 2, 5, 0, 2, 5, 0, 0, 0});
  const std::string from_zeros =
      std::string(R"({"componentType": 5126, "count": 4, "type": "VEC3", )") + kLifted;
  CHECK(corners(sparse_gltf(from_zeros, fan)) ==
        std::vector<float>{0, 0, 0, 2, 2, 5, 0, 0, 0, 2, 2, 5, 0, 2, 5, 0, 0, 0});
  // Indices 0 1 2 0 0 0, of which the last two become 2 and 3.
  const std::string indices = std::string(kCorners) + R"(}, {"bufferView": 1, "byteOffset": 26,
"componentType": 5123, "count": 6, "type": "SCALAR", "sparse": {"count": 2,
"indices": {"bufferView": 1, "byteOffset": 38, "componentType": 5121},
"values": {"bufferView": 1, "byteOffset": 40}}})";
  CHECK(corners(sparse_gltf(indices, R"("attributes": {"POSITION": 0}, "indices": 1)")) ==
        kTwoTriangles);
  // A morph target that moves two of four, and one without values, which moves none.
  const std::string morph = std::string(kCorners) + "}, " + from_zeros +
                            R"(, {"componentType": 5126, "count": 4, "type": "VEC3"})";
  CHECK(corners(sparse_gltf(morph, fan + R"(, "targets": [{"POSITION": 1}, {"POSITION": 2}])",
                            R"(, "weights": [1, 1])")) ==
        std::vector<float>{2, 0, 0, 4, 4, 5, 0, 0, 0, 4, 4, 5, 0, 4, 5, 0, 0, 0});
  // Colours.
  ModelOptions options;
  options.colours = true;
  const auto painted =
      read_model("a.gltf",
                 sparse_gltf(std::string(kCorners) + "}, " + from_zeros,
                             R"("mode": 6, "attributes": {"POSITION": 0, "COLOR_0": 1})"),
                 options);
  REQUIRE(painted);
  CHECK(painted->corner_colours[0] == ModelColour{0, 0, 0});
  CHECK(painted->corner_colours[1] == ModelColour{1, 1, 1});
}

TEST_CASE("sparse values of a glTF that are not there or out of order are refused",
          "[core][mesh]") {
  const auto said = [](const std::string& count, const std::string& sparse) {
    const auto accessor =
        fmt::format(R"({{"componentType": 5126, "count": {}, "type": "VEC3", "sparse": {{{}}}}})",
                    count, sparse);
    return message(refused(
        read_mesh("a.gltf", sparse_gltf(accessor, R"("mode": 6, "attributes": {"POSITION": 0})"))));
  };
  const auto with = [](const std::string& count, const std::string& indices,
                       const std::string& values) {
    return fmt::format(R"("count": {}, "indices": {{{}}}, "values": {{{}}})", count, indices,
                       values);
  };
  const std::string good = R"("bufferView": 1, "byteOffset": 24, "componentType": 5121)";
  const std::string values = R"("bufferView": 1)";
  CHECK_THAT(said("4", with("5", good, values)), Catch::Contains("replaces 5 of 4 values"));
  CHECK_THAT(said("4", with("-1", good, values)), Catch::Contains("replaces -1 of 4"));
  CHECK_THAT(said("2", with("2", good, values)),
             Catch::Contains("sparse indices that do not rise"));
  CHECK_THAT(
      said("4", with("2", R"("bufferView": 1, "byteOffset": 26, "componentType": 5121)", values)),
      Catch::Contains("sparse indices that do not rise"));
  CHECK_THAT(said("4", with("2", R"("bufferView": 1, "componentType": 5126)", values)),
             Catch::Contains("component type that glTF does not allow"));
  CHECK_THAT(said("900000000", with("90000000", good, values)),
             Catch::Contains("announces 90000000 values"));
  CHECK_THAT(said("4", with("2", R"("bufferView": 9, "componentType": 5121)", values)),
             Catch::Contains("buffer view that does not exist"));
  CHECK_THAT(said("4", with("2", good, R"("bufferView": 1, "byteOffset": -4)")),
             Catch::Contains("before the begin"));
  CHECK_THAT(said("4", with("2", good, R"("bufferView": 1, "byteOffset": 32)")),
             Catch::Contains("announces 2 values"));
  CHECK_THAT(said("900000000", with("2", good, values)),
             Catch::Contains("announces 900000000 values and gives 2 of them"));
}

TEST_CASE("numbers of a type that glTF does not define are refused", "[core][mesh]") {
  for (const char* type : {"5124", "5130"}) {
    const auto accessor = fmt::format(
        R"({{"bufferView": 0, "componentType": {}, "count": 1, "type": "VEC3"}})", type);
    CHECK_THAT(
        message(refused(read_mesh(
            "a.gltf", sparse_gltf(accessor, R"("mode": 6, "attributes": {"POSITION": 0})")))),
        Catch::Contains("component type that glTF does not define"));
  }
}

TEST_CASE("a glTF that needs what popcut does not know is refused by name", "[core][mesh]") {
  const auto needs = [](const std::string& extension) {
    Square square;
    square.primitive = R"(, "mode": 6)";
    square.rest = fmt::format(R"(, "extensionsRequired": ["{}"])", extension);
    return read_mesh("a.gltf", square.text());
  };
  CHECK(needs("KHR_mesh_quantization"));
  CHECK(needs("KHR_materials_unlit"));
  CHECK_THAT(message(refused(needs("VENDOR_voxels"))),
             Catch::Contains("a.gltf: /extensionsRequired/0: needs the extension VENDOR_voxels"));
  CHECK_THAT(refused(needs("EXT_meshopt_compression")).detail,
             Catch::Contains("is compressed (EXT_meshopt_compression)"));
  // Some programs do not say that they need it, and leave out the numbers.
  const std::string draco =
      R"({"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"extensions": {"KHR_draco_mesh_compression": {}},
    "attributes": {"POSITION": 0}, "indices": 0}]}], "accessors": [{"bufferView": 7, "componentType": 5126, "count": 4, "type": "VEC3"}]})";
  CHECK_THAT(refused(read_mesh("a.gltf", draco)).detail,
             Catch::Contains("is compressed (KHR_draco_mesh_compression)"));
}

TEST_CASE("the first version of glTF, and one after 2.0, are refused by name", "[core][mesh]") {
  Square square;
  square.primitive = R"(, "mode": 6)";
  std::string later = square.text();
  CHECK(read_mesh("a.gltf", later));
  const std::string old_version = R"("version": "2.0")";
  later.replace(later.find(old_version), old_version.size(),
                R"("version": "2.1", "minVersion": "2.1")");
  CHECK_THAT(message(refused(read_mesh("a.gltf", later))),
             Catch::Contains("a.gltf: /asset/minVersion: asks for glTF 2.1"));
  for (const std::string& old :
       {std::string(R"({"asset": {"version": "1.0"}, "meshes": {"box": {}}})"),
        std::string("glTF\1\0\0\0\x18\0\0\0\4\0\0\0\0\0\0\0{}  ", 24)})
    CHECK_THAT(refused(read_mesh("a.glb", old)).detail, Catch::Contains("is glTF 1.0"));
}

TEST_CASE("a few bytes of glTF take neither the stack nor minutes", "[core][mesh]") {
  Square deep;
  deep.rest = R"(, "extras": )" + std::string(100'000, '[') + std::string(100'000, ']');
  CHECK_THAT(refused(read_mesh("a.gltf", deep.text())).detail,
             Catch::Contains("nests its JSON deeper"));
  Square quoted;  // brackets in texts do not nest
  quoted.primitive = R"(, "mode": 6)";
  quoted.rest = R"(, "extras": ")" + std::string(100'000, '[') + R"(\"[")";
  CHECK(read_mesh("a.gltf", quoted.text()));
  std::string many = "[{}";
  for (int k = 0; k < 1'100'000; ++k) many += ",{}";
  Square nodes;
  nodes.rest = ", \"extras\": " + many + "]";
  CHECK_THAT(refused(read_mesh("a.gltf", nodes.text())).detail, Catch::Contains("2000000 values"));
  // 2,000 nodes that draw 1,000 parts without a triangle.
  Square parts;
  parts.primitive = R"(, "mode": 0})";
  for (int k = 0; k < 999; ++k)
    parts.primitive += R"(, {"attributes": {"POSITION": 0}, "mode": 0})";
  parts.primitive.pop_back();
  for (int k = 0; k < 1999; ++k) parts.nodes += ",\n{\"mesh\": 0}";
  CHECK_THAT(refused(read_mesh("a.gltf", parts.text())).detail,
             Catch::Contains("draws more than 250000 parts"));
}

TEST_CASE("a glTF that is broken, or keeps its mesh in another file, says so", "[core][mesh]") {
  const TriangleMesh ball = icosphere(1.0, 1);
  const auto broken = [](const std::string& name, const std::string& bytes,
                         const std::string& part) {
    const Error error = refused(read_mesh(name, bytes));
    CHECK(error.place.starts_with(name));
    CHECK_THAT(error.detail, Catch::Contains(part));
  };
  broken("a.gltf", gltf(ball, "ball.bin"), "keeps its mesh in ball.bin beside it; save the model");
  broken("a.glb", glb(ball).substr(0, 500), "save the model again");
  broken("a.glb", glb(ball, R"([{"children": [0], "mesh": 0}])"), "lies in");
  // Each node lies twice in the one above: 2^40 of them.
  std::string nodes = "[";
  for (int k = 1; k <= 40; ++k) nodes += fmt::format(R"({{"children": [{0}, {0}]}}, )", k);
  broken("a.glb", glb(ball, nodes + R"({"mesh": 0}])"), "lies in two nodes");
  broken("a.glb", glb(ball, R"([{"mesh": 7}])"), "does not exist");
  broken("a.glb", glb(ball, "[{}]"), "has no triangles");
  std::string lying = glb(ball);
  lying.replace(lying.find("\"count\": 240"), 12, "\"count\": 999");
  broken("a.glb", lying, "announces 999 values");
  broken("a.gltf", "{}", "");
  broken("a.gltf", "no JSON", "");
}

TEST_CASE("polygons and indices of every kind in an OBJ are read and its other lines are not",
          "[core][mesh]") {
  const auto mesh = read_mesh("quad.obj",
                              "mtllib /etc/passwd\nusemtl x\nv 0 0 0 1.0\nv 1 0 0\nv 1 1 0\n"
                              "vt 0 0\nvn 0 0 1\nv 0 1 0\r\nf 1/1/1 2//1 -2/1 -1\ncurv2 9 9\n");
  if (!mesh) FAIL(message(mesh.error()));
  CHECK(mesh->size() == 2);
}

TEST_CASE("vertices and faces of an OBJ may be written in capital letters", "[core][mesh]") {
  const auto mesh =
      read_mesh("c.obj", "V 0 0 0\nv 1 0 0\nV 1 1 0\nv 0 1 0\nF 1 2 \\\n3\nf 1 3 4\n");
  if (!mesh) FAIL(message(mesh.error()));
  CHECK(mesh->size() == 2);
}

TEST_CASE("an OBJ with surfaces that are no polygons is refused", "[core][mesh]") {
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  for (const char* surface : {"surf 0 1 0 1 1 2 3 4", "bzp 1 2 3 4", "surf 0 1 0 1 1 2 \\\n3 4"}) {
    const Error error = refused(read_mesh("s.obj", faces + surface + "\n"));
    CHECK(error.place == "s.obj: line 5");
    CHECK_THAT(error.detail, Catch::StartsWith("is a free-form surface"));
  }
  CHECK(read_mesh("s.obj", faces + "curv 0 1 1 2\no surface\ng surf\n"));
}

TEST_CASE("a file that is no mesh is called what it is, whatever its name says", "[core][mesh]") {
  using namespace std::string_view_literals;
  const auto [bytes, kind] = GENERATE(
      table<std::string_view, const char*>({{"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"sv, "a PNG picture"},
                                            {"\xFF\xD8\xFF\xE0\0\x10JFIF"sv, "a JPEG picture"},
                                            {"RIFF\x24\0\0\0WEBPVP8 "sv, "a WebP picture"},
                                            {"%PDF-1.7\n"sv, "a PDF document"},
                                            {"PK\x03\x04\x14\0"sv, "3MF"},
                                            {"ply\nformat ascii 1.0\n"sv, "a PLY model"},
                                            {"ISO-10303-21;\nHEADER;"sv, "a STEP model"},
                                            {"<?xml version=\"1.0\"?>\n<svg/>"sv, "an SVG drawing"},
                                            {"\n<!DOCTYPE html>\n<html>"sv, "a web page"}}));
  CAPTURE(kind);
  const std::string file = std::string(bytes) + std::string(2000, '\0');
  for (const char* name : {"model.stl", "model.obj", "model", "picture.png"}) {
    const Error error = refused(read_mesh(name, file));
    CHECK(error.kind == ErrorKind::Malformed);
    CHECK(error.place == name);
    CHECK_THAT(error.detail, Catch::StartsWith("is ") && Catch::Contains(kind) &&
                                 Catch::Contains("; give a 3D model as an STL"));
    CHECK_THAT(refused(read_mesh(name, bytes)).detail, Catch::Contains(kind));
  }
}

TEST_CASE("text models are read as other programs write them", "[core][mesh]") {
  const TriangleMesh ball = icosphere(2.0, 0);
  const auto same = [&](const std::string& name, const std::string& bytes) {
    CAPTURE(name, bytes.substr(0, 80));
    const auto read = read_mesh(name, bytes);
    const auto right = read_mesh("right.obj", obj(ball));
    REQUIRE(right);
    if (!read) FAIL(message(read.error()));
    REQUIRE(read->size() == right->size());
    for (std::size_t k = 0; k < right->corners.size(); ++k)
      CHECK_THAT(read->corners[k], Catch::WithinAbs(right->corners[k], 1e-4));
  };
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  };
  const auto utf16 = [](const std::string& text, bool big, bool mark) {
    std::string out = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : text) big ? (out += '\0') += c : (out += c) += '\0';
    return out;
  };
  // The backslash of a folder in a comment joins no lines.
  same("comments.obj", "# C:\\models\\\n" + changed(obj(ball), "\nf ", " # C:\\\nf "));
  std::string upper = text_stl(ball);
  for (char& c : upper) c = c >= 'a' && c <= 'z' && c != 'e' ? static_cast<char>(c - 32) : c;
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>{"m.obj", obj(ball)}, {"m.stl", text_stl(ball)}}) {
    same(name, "\xEF\xBB\xBF" + text);
    same(name, utf16(text, false, true));
    same(name, utf16(text, true, true));
    same(name, utf16(text, false, false));
    same(name, utf16(text, true, false));
    same(name, changed(text, "\n", "\r"));
    same(name, changed(text, "\n", "\r\n"));
    same(name, "\n \t\n" + text);
  }
  same("m.stl", upper);
  same("m.stl", " " + text_stl(ball));
  same("m.stl", changed(text_stl(ball), "\n", " "));
  same("m.stl", "# written by hand\n" + text_stl(ball));
  same("m.stl",
       "solid a vertex of a facet\n" + text_stl(ball).substr(text_stl(ball).find('\n') + 1));
  const std::string text = obj(ball);
  same("m.obj", changed(text, "\n", " # a comment\n"));
  same("m.obj", changed(changed(text, "v ", "v \\\n"), "f ", "f \\\r\n\t"));
  const std::size_t faces = text.find("f ");
  REQUIRE(faces != std::string::npos);
  same("m.obj", text.substr(faces) + text.substr(0, faces));
  // Names may end with a backslash, too.
  for (const char* name : {"g C:\\models\\\n", "usemtl \x95\\\n", "mtllib a.mtl \\\n b.mtl\n"}) {
    // A vertex that no face names hides that one is missing.
    same("m.obj", name + text.substr(0, faces) + "v 0 0 0\n" + name +
                      changed(text.substr(faces), "f ", "fo "));
  }
  // Files that were put together, and blanks of other kinds.
  same("m.obj", text.substr(0, faces) + "\xEF\xBB\xBF" + text.substr(faces));
  same("m.obj", changed(text, " ", "\xC2\xA0"));
  same("m.obj", changed(text, " ", "\xA0"));
  same("m.stl", changed(text_stl(ball), " ", "\xC2\xA0"));
}

TEST_CASE("a model far from its origin is moved there before it is rounded", "[core][mesh]") {
  const auto at = [](double x, double y) {
    std::string text;
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {10.0, 0.0}, {0.0, 10.03}})
      text += fmt::format("v {} {} 5\n", x + u, y + v);
    return text + "f 1 2 3\n";
  };
  std::vector<std::string> notes;
  const auto far = read_mesh("far.obj", at(85000.5, 4460000.25), &notes);
  if (!far) FAIL(message(far.error()));
  CHECK(far->corners[7] == Approx(10.03F));
  CHECK(far->corners[8] == 5.0F);
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], Catch::Contains("lies far from its origin and is moved there"));
  notes.clear();
  const auto near = read_mesh("near.obj", at(500, 0), &notes);
  REQUIRE(near);
  CHECK(near->corners[0] == 500.0F);
  CHECK(notes.empty());
}

TEST_CASE("numbers of an OBJ may count backward from the face that names them", "[core][mesh]") {
  const auto read =
      read_mesh("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 9 9 9\nf -3 -2 -1\n");
  if (!read) FAIL(message(read.error()));
  CHECK(read->corners == std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 0, 1, 1, 0, 9, 9, 9});
  CHECK_THAT(refused(read_mesh("m.obj", "v 0 0 0\nv 1 0 0\nf -3 -2 -1\nv 9 9 9\n")).detail,
             Catch::Contains("names vertex \"-3\""));
}

TEST_CASE("faces of very many corners are refused before they take minutes", "[core][mesh]") {
  const auto star = [](int corners, int faces) {
    std::string text, face = "f";
    for (int k = 0; k < corners; ++k) {
      const double at = 6.283185307 * k / corners, r = k % 2 == 0 ? 1 : 2;
      text += fmt::format("v {:.7f} {:.7f} 0\n", r * std::cos(at), r * std::sin(at));
      face += fmt::format(" {}", k + 1);
    }
    for (int k = 0; k < faces; ++k) text += face + "\n";
    return text;
  };
  const auto read = read_mesh("m.obj", star(2000, 1));
  if (!read) FAIL(message(read.error()));
  CHECK(read->size() == 1998);
  const Error error = refused(read_mesh("m.obj", star(11'000, 4)));
  CHECK(error.kind == ErrorKind::OutOfRange);
  CHECK(error.place == "m.obj: line 11004");
  CHECK_THAT(error.detail, Catch::Contains("11000 corners") && Catch::Contains("as triangles"));
}

TEST_CASE("a binary STL whose count is too small is read whole", "[core][mesh]") {
  const TriangleMesh ball = icosphere(2.0, 0);
  for (const char count : {0, 1, 19}) {
    std::string stl = binary_stl(ball);
    stl[80] = count;
    const auto read = read_mesh("m.stl", stl);
    if (!read) FAIL(message(read.error()));
    CHECK(read->size() == 20);
  }
}

TEST_CASE("bytes behind a binary STL are left out if they cannot be triangles", "[core][mesh]") {
  const TriangleMesh ball = icosphere(2.0, 0);
  const std::string stl = binary_stl(ball);
  for (const std::string& rest : {std::string("\x81x\xFF"), std::string(100, '\0'),
                                  std::string(333, '\0'), std::string(90, 'x')}) {
    const auto read = read_mesh("m.stl", stl + rest);
    REQUIRE(read);
    CHECK(read->size() == 20);
  }
  std::string small = stl + "xyz";
  small[80] = 3;
  CHECK_THAT(refused(read_mesh("m.stl", small)).detail,
             Catch::Contains("announces 3 triangles, and 853 bytes follow them"));
}

TEST_CASE("a binary STL may begin with any bytes", "[core][mesh]") {
  const TriangleMesh ball = icosphere(1.0, 1);
  for (const std::string head : {"\x89PNG\r\n", "PK\x03\x04", "ply\n", "<svg"}) {
    std::string stl = binary_stl(ball);
    stl.replace(0, head.size(), head);
    const auto read = read_mesh("ball.stl", stl);
    REQUIRE(read);
    CHECK(read->corners == ball.corners);
  }
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

  // Fewer bytes than a head, whose text is longer than one.
  std::string wide("\x24\0\x02\0", 4);
  while (wide.size() < 60) wide += "\x85\x85";
  CHECK_THAT(refused(read_mesh("m.stl", wide)).detail, Catch::Contains("is not an STL file"));

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
        Row{",0,10\n0,1,1\n1e108,1,1\n", "h.csv: line 3, column 1"},
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
