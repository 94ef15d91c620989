// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <jpeglib.h>
#include <catch2/catch.hpp>

#include "core/artwork/colour_mesh_reader.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "daemon/pictures/pdf_page.hpp"
#include "tests/support/growth.hpp"
#include "tests/support/painted_shell.hpp"
#include "tests/support/value.hpp"

namespace popcut {
namespace {

const std::string kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

ModelFiles files_of(std::map<std::string, std::string> texts) {
  return {[texts = std::move(texts)](const std::string& name) -> Result<std::string> {
            const auto found = texts.find(name);
            if (found == texts.end()) return fail(ErrorKind::Malformed, name, "is absent");
            return found->second;
          },
          [](const std::string& name, std::string_view bytes, std::size_t most) {
            return read_image(name, bytes, most);
          }};
}

std::string small_png() {
  ColourImage image(2, 2);  // red, green above blue, yellow
  image.set(0, 0, {255, 0, 0, 255}), image.set(1, 0, {0, 255, 0, 255});
  image.set(0, 1, {0, 0, 255, 255}), image.set(1, 1, {255, 255, 0, 255});
  return testing::value(png_of_image(image));
}

TEST_CASE("the mean colours of triangles are those of their pictures and materials", "[artwork]") {
  const auto mesh = testing::value(read_colour_mesh(
      "quad.obj",
      "mtllib a.mtl\n" + kQuad + "usemtl skin\nf 1/1 2/2 3/3 4/4\nusemtl blue\nf 1 3 4\n",
      files_of({{"a.mtl", "newmtl skin\nmap_Kd skin.png\nnewmtl blue\nKd 0 0.2 1\n"},
                {"skin.png", small_png()}})));
  const auto means = mean_colours(mesh, 3);
  REQUIRE(means.size() == 3);
  // Two pixels of four are red, two green; one is blue.
  for (std::size_t t = 0; t < 2; ++t) {
    INFO("triangle " << t);
    CHECK(std::abs(means[t][0] - 128) < 65);
    CHECK(std::abs(means[t][1] - 128) < 65);
    CHECK(std::abs(means[t][2] - 64) < 65);
  }
  CHECK(means[2] == std::array<std::uint8_t, 3>{0, 51, 255});
  CHECK(mean_colours(mesh, 4).empty());
  const auto clay = testing::value(read_colour_mesh("quad.obj", kQuad + "f 1 2 3\n", files_of({})));
  CHECK(mean_colours(clay, 1).empty());
}

TEST_CASE("an OBJ takes its colours from its MTL, with v upward in the picture", "[artwork]") {
  const auto mesh = testing::value(read_colour_mesh(
      "quad.obj", "mtllib a b.mtl\n" + kQuad + "usemtl skin\nf 1/1 2/2 3/3 4/4\n",
      files_of({{"a b.mtl", "newmtl skin\nKd 1 0.5 1\nmap_Kd -s 1 1 1 -clamp on the skin.png\n"},
                {"the skin.png", small_png()}})));
  REQUIRE(mesh.size() == 2);
  CHECK(mesh.coloured);
  // Near corner 1 of the quad: the picture's lower left pixel, times Kd.
  const Colour low_left = colour_of(mesh, 0, {0.75, 0, 0.25}, 1);
  CHECK(low_left.b == Approx(255).margin(1));
  CHECK(low_left.r == Approx(0).margin(1));
  // Near corner 2 is the lower right one: yellow, its green halved.
  const Colour low_right = colour_of(mesh, 0, {0.25, 0.5, 0.25}, 1);
  CHECK(low_right.r == Approx(255).margin(1));
  CHECK(low_right.g == Approx(127.5).margin(1));
}

TEST_CASE("an OBJ may name several MTL files, in quotes or not, and name one twice", "[artwork]") {
  int opened = 0;
  ModelFiles files = files_of(
      {{"a.mtl", "newmtl one\nKd 1 0 0\n"}, {"b c.mtl", "\xEF\xBB\xBFnewmtl two\nKd 0 1 0\n"}});
  files.open = [&opened, open = files.open](const std::string& name) {
    auto bytes = open(name);
    opened += bytes ? 1 : 0;
    return bytes;
  };
  const auto mesh =
      testing::value(read_colour_mesh("two.obj",
                                      "mtllib a.mtl \"b c.mtl\"\nmtllib .\\x\\..\\.//a.mtl\n" +
                                          kQuad + "usemtl one\nf 1 2 3\nusemtl two\nf 1 3 4\n",
                                      files));
  CHECK(colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1).r == Approx(255).margin(1));
  CHECK(colour_of(mesh, 1, {0.4, 0.3, 0.3}, 1).g == Approx(255).margin(1));
  CHECK(opened == 2);
}

TEST_CASE("colours of an MTL may go to 255", "[artwork]") {
  const auto red = [](const std::string& kd) {
    const auto mesh =
        testing::value(read_colour_mesh("m.obj", "mtllib a.mtl\n" + kQuad + "usemtl a\nf 1 2 3\n",
                                        files_of({{"a.mtl", "newmtl a\nKd " + kd + "\n"}})));
    return colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1).r;
  };
  CHECK(red("200 150 100") == Approx(200).margin(1));
  CHECK(red("0 0 255") == Approx(0).margin(1));
  CHECK(red("1.2 0 0") == Approx(255).margin(1));
}

TEST_CASE("a black material of an MTL shows what it gives off itself", "[artwork]") {
  const auto colour = [](const std::string& lines) {
    const auto mesh =
        testing::value(read_colour_mesh("m.obj", "mtllib a.mtl\n" + kQuad + "usemtl a\nf 1 2 3\n",
                                        files_of({{"a.mtl", "newmtl a\n" + lines}})));
    const Colour c = colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1);
    return fmt::format("{:.0f} {:.0f} {:.0f}", c.r, c.g, c.b);
  };
  CHECK(colour("Kd 0 0 0\nKe 1 0 0\n") == "255 0 0");
  CHECK(colour("Ke 9 0 0\nKd 0 0 0\n") == "255 0 0");
  CHECK(colour("Kd 0 1 0\nKe 1 0 0\n") == "0 255 0");
  CHECK(colour("Kd 0 0 0\nKe 0 0 0\n") == "0 0 0");
  CHECK(colour("Kd 0 0 0\nKe much\n") == "0 0 0");
}

TEST_CASE("comments, keys of either case and options of an MTL are read", "[artwork]") {
  const std::map<std::string, std::string> files{
      {"a.mtl",
       "\xEF\xBB\xBFnewmtl one # red\nkd 1 0 0 # red\nNewmtl two\nmap_kd -s 2 1 -o 0.5 0.25 "
       "skin.png # "
       "it\nnewmtl low\nmap_Kd -clamp on -o 0 -1 skin.png\nnewmtl clear\nd 0\n"},
      {"skin.png", small_png()}};
  const auto mesh =
      testing::value(read_colour_mesh("q.obj",
                                      "mtllib a.mtl # colours\n" + kQuad +
                                          "usemtl one # it\nf 1 2 3\nUsemtl two\nf 1/1 1/1 1/1\n"
                                          "usemtl low\nf 1/1 1/1 1/1\nusemtl clear\nf 1 3 4\n",
                                      files_of(files)));
  REQUIRE(mesh.size() == 3);  // nothing is seen of the last one
  const auto at = [&](std::size_t t) { return colour_of(mesh, t, {0.4, 0.3, 0.3}, 1); };
  CHECK(at(0).r == Approx(255).margin(1));
  CHECK(at(0).g == Approx(0).margin(1));
  // (0, 0) is moved to (0.5, 0.25): between the lower pixels, blue and yellow.
  CHECK(at(1).r == Approx(127.5).margin(1));
  CHECK(at(1).b == Approx(127.5).margin(1));
  // Below its lower border a picture that ends there is blue.
  CHECK(at(2).b == Approx(255).margin(1));
  CHECK(at(2).r == Approx(0).margin(1));
}

TEST_CASE("colours of vertices may have a weight before them, or alpha behind them", "[artwork]") {
  const auto red = [](const std::string& colour) {
    const auto mesh = testing::value(read_colour_mesh(
        "tri.obj",
        "v 0 0 0 " + colour + "\nv 1 0 0 " + colour + "\nv 0 1 0 " + colour + "\nf 1 2 3\n",
        files_of({})));
    return colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1).r;
  };
  CHECK(red("0.2 0.4 0.6 1") == Approx(51).margin(1));
  CHECK(red("51 102 153 255") == Approx(51).margin(1));
  CHECK(red("0.2 0.4 0.6 0.5") == Approx(51).margin(1));
  CHECK(red("1 0.2 0.4 0.6") == Approx(51).margin(1));
}

TEST_CASE("a picture is mirrored or ends beyond its borders, in each direction", "[artwork]") {
  Texture texture(ColourImage(2, 1));
  ColourImage image(2, 2);
  image.set(0, 0, {255, 0, 0, 255}), image.set(1, 0, {0, 255, 0, 255});
  image.set(0, 1, {0, 0, 255, 255}), image.set(1, 1, {255, 255, 0, 255});
  texture = Texture(image);
  CHECK(texture.at(1.25, 0.25, 1).r == Approx(255));
  texture.wraps = {PictureWrap::Mirror, PictureWrap::Clamp};
  CHECK(texture.at(1.25, 0.25, 1).g == Approx(255));
  CHECK(texture.at(0.25, 1.25, 1).b == Approx(255));
}

TEST_CASE("colours of vertices from 0 to 255 are read as such", "[artwork]") {
  const auto mesh = testing::value(read_colour_mesh(
      "tri.obj", "v 0 0 0 200 150 100\nv 1 0 0 200 150 100\nv 0 1 0 200 150 100\nf 1 2 3\n",
      files_of({})));
  const Colour colour = colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1);
  CHECK(colour.r == Approx(200).margin(1));
  CHECK(colour.g == Approx(150).margin(1));
  CHECK(colour.b == Approx(100).margin(1));
}

// Khronos, KHR_texture_transform: a place is scaled, turned, then moved.
TEST_CASE("KHR_texture_transform moves the places of a texture", "[artwork]") {
  const std::string head =
      R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
"textures": [{"source": 0}], "images": [{"uri": "skin.png"}], "buffers": [{"byteLength": 60, "uri": "q.bin"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
              {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0)";
  // All corners are at (0.25, 0.25): red, the upper left pixel.
  const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25};
  const std::string buffer(reinterpret_cast<const char*>(numbers.data()), 60);
  const auto colour = [&](const std::string& transform) {
    const auto mesh =
        testing::value(read_colour_mesh("q.gltf", head + transform + "}}}]}",
                                        files_of({{"q.bin", buffer}, {"skin.png", small_png()}})));
    return colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1);
  };
  const auto moved = [&](const std::string& by) {
    return colour(R"(, "extensions": {"KHR_texture_transform": {)" + by + "}}");
  };
  CHECK(colour("").r == Approx(255).margin(1));
  CHECK(moved(R"("offset": [0, 0.5])").b == Approx(255).margin(1));
  CHECK(moved(R"("scale": [3, 1])").g == Approx(255).margin(1));
  // A quarter turn takes (0.25, 0.25) to (0.25, -0.25), which repeats as (0.25, 0.75): blue.
  CHECK(moved(R"("rotation": 1.5707963)").b == Approx(255).margin(1));
}

TEST_CASE("a glTF material shows what it gives off itself", "[artwork]") {
  const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25};
  const std::string buffer(reinterpret_cast<const char*>(numbers.data()), 60);
  const auto colour = [&](const std::string& material) {
    const auto mesh = read_colour_mesh(
        "q.gltf",
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
"textures": [{"source": 0}], "images": [{"uri": "skin.png"}],
"buffers": [{"byteLength": 60, "uri": "q.bin"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
              {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
"materials": [{)" +
            material + "}]}",
        files_of({{"q.bin", buffer}, {"skin.png", small_png()}}));
    if (!mesh) FAIL(message(mesh.error()));
    const Colour c = colour_of(*mesh, 0, {0.4, 0.3, 0.3}, 1);
    return fmt::format("{:.0f} {:.0f} {:.0f}", c.r, c.g, c.b);
  };
  const std::string black = R"("pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]})",
                    red = R"("pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]})";
  CHECK(colour(black) == "0 0 0");
  CHECK(colour(black + R"(, "emissiveFactor": [0, 1, 0])") == "0 255 0");
  CHECK(colour(red + R"(, "emissiveFactor": [0, 1, 0])") == "255 255 0");
  CHECK(colour(black + R"(, "emissiveFactor": [0.1, 0, 0], "extensions": {)"
                       R"("KHR_materials_emissive_strength": {"emissiveStrength": 10}})") ==
        "255 0 0");
  // The picture that glows: its upper left pixel is red.
  CHECK(colour(black + R"(, "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0})") ==
        "255 0 0");
  CHECK(colour(black + R"(, "emissiveTexture": {"index": 0})") == "0 0 0");
}

TEST_CASE("faces of an OBJ that have no place in a picture have the colour of their material",
          "[artwork]") {
  const auto colour = [](const std::string& face) {
    const auto mesh = testing::value(read_colour_mesh(
        "q.obj", "mtllib m.mtl\n" + kQuad + "usemtl skin\n" + face + "\nf 1/1 2/2 3/3\n",
        files_of({{"m.mtl", "newmtl skin\nKd 1 1 0\nmap_Kd t.png\n"}, {"t.png", small_png()}})));
    CHECK(colour_of(mesh, 1, {0.75, 0, 0.25}, 1).r == Approx(0).margin(1));  // in the picture
    return colour_of(mesh, 0, {0.4, 0.3, 0.3}, 1);
  };
  for (const char* face : {"f 1 2 3", "f 1//1 2//1 3//1", "f 1/1 2/2 3"}) {
    CAPTURE(face);
    CHECK(colour(face).r == Approx(255).margin(1));
    CHECK(colour(face).g == Approx(255).margin(1));
    CHECK(colour(face).b == Approx(0).margin(1));
  }
}

TEST_CASE("colours of a glTF that its meshes or samplers do not give are refused", "[artwork]") {
  const auto read = [](const std::string& attributes, const std::string& texture,
                       const std::string& more = "") {
    const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25};
    const std::string buffer(reinterpret_cast<const char*>(numbers.data()), 60);
    const auto mesh = read_colour_mesh(
        "q.gltf",
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, )" +
            attributes + R"(}, "material": 0}]}], "textures": [{"source": 0, "sampler": 0}],
"images": [{"uri": "skin.png"}], "buffers": [{"byteLength": 60, "uri": "q.bin"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
              {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
              {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC2"},
              {"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"}],
"materials": [{"pbrMetallicRoughness": {)" +
            texture + "}}]" + (more.empty() ? R"(, "samplers": [{}])" : more) + "}",
        files_of({{"q.bin", buffer}, {"skin.png", small_png()}}));
    return mesh ? "" : message(mesh.error());
  };
  const std::string textured = R"("baseColorTexture": {"index": 0})",
                    second = R"("baseColorTexture": {"index": 0, "texCoord": 1})";
  CHECK(read(R"("TEXCOORD_0": 1)", textured) == "");
  CHECK(read(R"("TEXCOORD_1": 1)", second) == "");
  CHECK(read(R"("COLOR_1": 3)", "") == "");  // glTF 2.0 colours by COLOR_0 alone
  CHECK(read(R"("COLOR_0": 0)", textured) ==
        "q.gltf: /materials/0: has a picture whose places are TEXCOORD_0, and a mesh lacks them; "
        "save the model with them, or without the picture");
  CHECK_THAT(read(R"("TEXCOORD_0": 1)", second), Catch::Contains("whose places are TEXCOORD_1"));
  CHECK_THAT(read(R"("TEXCOORD_0": 2)", textured),
             Catch::Contains("has 2 values of TEXCOORD_0 for 3 vertices"));
  CHECK_THAT(read(R"("COLOR_0": 3)", ""), Catch::Contains("has 2 values of COLOR_0 for 3"));
  CHECK_THAT(read(R"("TEXCOORD_0": 1)", textured, R"(, "samplers": [])"),
             Catch::Contains("q.gltf: /samplers/0: does not exist"));
  CHECK_THAT(read(R"("TEXCOORD_0": 1)", textured, R"(, "samplers": [{"wrapT": 33070}])"),
             Catch::Contains("has a wrapS or wrapT that glTF does not define"));
}

TEST_CASE("colours after the vertices of an OBJ are read", "[artwork]") {
  const auto mesh = testing::value(read_colour_mesh(
      "tri.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n", files_of({})));
  CHECK(mesh.coloured);
  const Colour middle = colour_of(mesh, 0, {1 / 3.0, 1 / 3.0, 1 / 3.0}, 0);
  CHECK(middle.r == Approx(85).margin(0.5));
  CHECK(middle.g == Approx(85).margin(0.5));
}

TEST_CASE("a model without colours is clay, and so is one of which they are not wanted",
          "[artwork]") {
  const auto plain =
      testing::value(read_colour_mesh("quad.obj", kQuad + "f 1 2 3 4\n", files_of({})));
  CHECK_FALSE(plain.coloured);
  const auto unwanted = testing::value(read_colour_mesh(
      "quad.obj", "mtllib absent.mtl\n" + kQuad + "usemtl x\nf 1 2 3 4\n", files_of({}), false));
  CHECK_FALSE(unwanted.coloured);
}

TEST_CASE("what a model names and cannot be read is one error with its place", "[artwork]") {
  const auto error_of = [](const std::string& name, const std::string& text,
                           std::map<std::string, std::string> beside) {
    const auto mesh = read_colour_mesh(name, text, files_of(std::move(beside)));
    REQUIRE(!mesh);
    CHECK(message(mesh.error()).find('\n') == std::string::npos);
    return message(mesh.error());
  };
  const std::string named = "mtllib m.mtl\n" + kQuad + "usemtl skin\nf 1/1 2/2 3/3 4/4\n";
  CHECK_THAT(error_of("q.obj", named, {}), Catch::Contains("q.obj: line 1: the materials m.mtl"));
  CHECK_THAT(error_of("q.obj", named, {{"m.mtl", "newmtl skin\nmap_Kd gone.png\n"}}),
             Catch::Contains("m.mtl: line 2: the picture gone.png cannot be read"));
  CHECK_THAT(
      error_of("q.obj", named, {{"m.mtl", "newmtl skin\nmap_Kd t.png\n"}, {"t.png", "GIF"}}),
      Catch::Contains("m.mtl: line 2: t.png: is a picture that cannot be read: it is neither"));
  CHECK_THAT(
      error_of("q.obj", named,
               {{"m.mtl", "newmtl skin\nmap_Kd t.png\n"}, {"t.png", small_png().substr(0, 50)}}),
      Catch::Contains("t.png: is a picture that cannot be read"));
  CHECK_THAT(error_of("q.obj", named, {{"m.mtl", "newmtl other\n"}}),
             Catch::Contains("names the material skin"));
  CHECK_THAT(error_of("q.obj", kQuad + "f 1/9 2/2 3/3\n", {}),
             Catch::Contains("names place 9 of the texture"));
  CHECK_THAT(error_of("q.obj", named, {{"m.mtl", "newmtl skin\nKd red\n"}}),
             Catch::Contains("m.mtl: line 2: is not a colour"));
  CHECK_THAT(error_of("q.obj", named, {{"m.mtl", "newmtl skin\nKd nan 0 0\n"}}),
             Catch::Contains("m.mtl: line 2: is not a colour"));
  CHECK_THAT(error_of("q.obj", kQuad + "vt inf 0\nf 1 2 3\n", {}),
             Catch::Contains("is not a place in a texture"));
  const auto gltf = [&](const std::string& mesh, int node) {
    return error_of("q.gltf",
                    fmt::format(R"({{"asset": {{"version": "2.0"}},
        "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": {}}}], "meshes": [{{"primitives": [{}]}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}], "accessors": [{{"bufferView": 0,
        "componentType": 5126, "count": 3, "type": "VEC3"}}]}})",
                                node, mesh, std::string(48, 'A')),
                    {});
  };
  CHECK_THAT(gltf(R"({"attributes": {"POSITION": 0}})", 3), Catch::Contains("q.gltf: /meshes/3"));
  CHECK_THAT(gltf(R"({"attributes": {"POSITION": 0}, "material": 7})", 0),
             Catch::Contains("q.gltf: /materials/7"));
  CHECK_THAT(error_of("q.glb", "glTF nonsense", {}),
             Catch::Contains("q.glb: cannot be read as glTF"));
  CHECK_THAT(error_of("q.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
                        "nodes": [{"children": [0]}]})",
                      {}),
             Catch::Contains("q.gltf"));
}

TEST_CASE("a picture of a glTF that reaches beyond its buffer is refused", "[artwork]") {
  const std::string png = small_png(), places(36, '\0');
  const auto read = [&](std::size_t picture_bytes) {
    return read_colour_mesh(
        "q.gltf",
        fmt::format(R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 0}},
                                     "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
        "textures": [{{"source": 0}}], "images": [{{"bufferView": 1, "mimeType": "image/png"}}],
        "buffers": [{{"byteLength": {0}, "uri": "b.bin"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}},
                        {{"buffer": 0, "byteOffset": 36, "byteLength": {1}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}})",
                    36 + png.size(), picture_bytes),
        files_of({{"b.bin", places + png}}));
  };
  const auto whole = testing::value(read(png.size()));
  CHECK(whole.textures.size() == 1);
  const auto beyond = read(png.size() + 1);
  REQUIRE(!beyond);
  CHECK(message(beyond.error()) ==
        "q.gltf: /images/0: reaches beyond its buffer; is the file whole?");
}

TEST_CASE("all pictures of a model have a limit together and one by two names is decoded once",
          "[artwork]") {
  std::vector<std::size_t> limits;
  ModelFiles files =
      files_of({{"a.mtl",
                 "newmtl one\nmap_Kd big.png\nnewmtl two\nmap_Kd ./big.png\n"
                 "newmtl three\nmap_Kd x/../big.png\nnewmtl four\nmap_Kd other.png\n"},
                {"big.png", "1"},
                {"other.png", "2"}});
  files.decode = [&](const std::string& name, std::string_view, std::size_t most) {
    limits.push_back(most);
    return Result<ColourImage>(name == "big.png"
                                   ? Result<ColourImage>(ColourImage(20, 10))
                                   : fail(ErrorKind::OutOfRange, name, "has too many pixels"));
  };
  const auto mesh = read_colour_mesh("q.obj", "mtllib a.mtl\n" + kQuad + "f 1/1 2/2 3/3\n", files);
  REQUIRE_FALSE(mesh);
  CHECK(limits == std::vector<std::size_t>{kMaxPixels, kMaxPixels - 200});
  CHECK(mesh.error().detail == "has too many pixels; all pictures of a model count together");
}

/// A JPEG of noise.
std::string noisy_jpeg(unsigned side, bool in_scans = false) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = info.image_height = side;
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  if (in_scans) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<unsigned char> row(3 * std::size_t{side});
  for (unsigned j = 0; j < side; ++j) {
    for (std::size_t k = 0; k < row.size(); ++k)
      row[k] = static_cast<unsigned char>(97 * k + 31 * j + k * j);
    unsigned char* at = row.data();
    jpeg_write_scanlines(&info, &at, 1);
  }
  jpeg_finish_compress(&info);
  std::string out(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&info);
  std::free(bytes);
  return out;
}

TEST_CASE("a JPEG that is broken off or is none is an error, and no crash", "[artwork]") {
  const std::string whole = noisy_jpeg(40);
  REQUIRE(read_image("photo.jpg", whole));
  for (const std::string& bytes :
       {std::string("\xFF\xD8\xFF\xE0"), std::string("\xFF\xD8"),
        whole.substr(0, whole.size() * 6 / 10), whole.substr(0, whole.size() * 9 / 10),
        std::string("\xFF\xD8\xFF\xC0\x00\x11\x08\xFF\xFF\xFF\xFF\x03", 12), std::string()}) {
    const auto image = read_image("photo.jpg", bytes);
    REQUIRE(!image);
    CHECK_THAT(message(image.error()), Catch::StartsWith("photo.jpg: is a picture that cannot"));
  }
}

TEST_CASE("a JPEG of more scans than any program writes is refused", "[artwork]") {
  const std::string whole = noisy_jpeg(16, true);
  REQUIRE(read_image("photo.jpg", whole));
  // Its first scan again and again: each is a pass over all pixels.
  const auto first = whole.find("\xFF\xDA");
  auto end = first + 2;
  while (whole[end] != '\xFF' || whole[end + 1] == 0) ++end;
  std::string many = whole.substr(0, end);
  for (int k = 0; k < 1000; ++k) many += whole.substr(first, end - first);
  const auto image = read_image("photo.jpg", many + whole.substr(end));
  REQUIRE_FALSE(image);
  CHECK(image.error().detail.find("more than 200 scans") != std::string::npos);
}

TEST_CASE("a picture in the colours of a printer says so", "[artwork]") {
  const std::string_view hex =
      "FFD8FFEE000E41646F626500640000000000FFDB004300FFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFF"
      "FFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFFF"
      "FFFFFFFFC000140800010001044311004D11005911004B1100FFC4001600010101000000000000000000"
      "00000000020103FFC40014100100000000000000000000000000000000FFDA000E0443004D0059004B00"
      "003F002D14DFFFD9";
  std::string cmyk;
  for (std::size_t k = 0; k < hex.size(); k += 2)
    cmyk += static_cast<char>(std::stoi(std::string(hex.substr(k, 2)), nullptr, 16));
  const auto image = read_image("photo.jpg", cmyk);
  REQUIRE(!image);
  CHECK(image.error().detail ==
        "is a picture that cannot be read: its colours are CMYK and must be RGB; save it again as "
        "PNG or JPEG");
}

// ---- files that are dear to read

using testing::check_growth;
using testing::DearFile;
using testing::times;

constexpr std::string_view kMtlBegins = "#mtl\n";

/// An OBJ; what follows the mark is each file that it names.
void read_dear_obj(const std::string& text) {
  const std::size_t end = std::min(text.find(kMtlBegins), text.size());
  const std::string rest = text.substr(std::min(end + kMtlBegins.size(), text.size()));
  ModelFiles files = files_of({});
  files.open = [&](const std::string&) -> Result<std::string> { return rest; };
  (void)read_colour_mesh("q.obj", std::string_view(text).substr(0, end), files);
}
void read_dear_gltf(const std::string& text) {
  (void)read_colour_mesh("q.gltf", text, files_of({}));
}
void read_dear_stl(const std::string& text) { (void)read_colour_mesh("q.stl", text, files_of({})); }
void read_dear_picture(const std::string& bytes) {
  constexpr std::size_t kMost = 1u << 20;
  (void)read_image("q.png", bytes, kMost);
}

/// A .gltf with a square in its buffer, and what the members say.
std::string gltf_of(const std::string& nodes, const std::string& primitives,
                    const std::string& more = "", const std::string& accessors = "") {
  return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [)" + nodes +
         R"({}], "meshes": [{"primitives": [)" + primitives +
         R"({"attributes": {"POSITION": 0}, "mode": 6}]}],
"buffers": [{"byteLength": 48, "uri": "data:application/octet-stream;base64,)"
         "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAAEAAAAAAAAAAAAAAAEAAAAAA\"}],\n"
         R"("bufferViews": [{"buffer": 0, "byteLength": 48}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})" +
         accessors + "]" + more + "}";
}
const std::string kMeshNode = R"({"mesh": 0}, )";

std::string numbers(std::size_t from, std::size_t n) {
  return times(n, [&](std::size_t k) { return fmt::format("{}{}", k ? ", " : "", from + k); });
}

/// A PDF of one page; its table of objects is left to the reader.
std::string pdf_of(const std::string& content, const std::string& objects = "") {
  return "%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n"
         "2 0 obj<</Type/Pages/Kids[3 0 R]/Count 1>>endobj\n"
         "3 0 obj<</Type/Page/Parent 2 0 R/MediaBox[0 0 200 200]/Contents 4 0 R>>endobj\n" +
         objects +
         fmt::format("4 0 obj<</Length {}>>stream\n{}\nendstream endobj\n", content.size(),
                     content) +
         "trailer<</Root 1 0 R>>\n";
}
void read_dear_pdf(const std::string& bytes) { (void)pictures::pdf_page(bytes, 1); }

std::string png_with(const std::string& chunks) {
  const std::string png = small_png();
  constexpr std::size_t kHead = 8 + 25;  // the signature and IHDR
  return png.substr(0, kHead) + chunks + png.substr(kHead);
}

TEST_CASE("no model or picture takes work or memory out of proportion to its size",
          "[artwork][dear]") {
  // clang-format off
  const std::vector<DearFile> obj{
      {"obj: corners of a face", 2000, [](std::size_t n) { return times(n, [n](std::size_t k) { const double a = 0.05 * static_cast<double>(k), r = 1 + 9 * static_cast<double>(k) / static_cast<double>(n); return fmt::format("v {} {} 0\n", r * std::cos(a), r * std::sin(a)); }) + "f" + times(n, [](std::size_t k) { return fmt::format(" {}", k + 1); }) + "\n"; }, read_dear_obj},
      {"obj: faces of many corners", 20, [](std::size_t n) { return kQuad + times(n, "f" + times(200, " 1 2 3 4") + "\n"); }, read_dear_obj},
      {"obj: faces of one corner", 5000, [](std::size_t n) { return kQuad + times(n, "f 1 1 1\n") + "f 1 2 3\n"; }, read_dear_obj},
      {"obj: materials", 1000, [](std::size_t n) { return "mtllib a\n" + kQuad + times(n, [](std::size_t k) { return fmt::format("usemtl m{}\nf 1 2 3\n", k); }) + std::string(kMtlBegins) + times(n, [](std::size_t k) { return fmt::format("newmtl m{}\nKd 1 0 0\n", k); }); }, read_dear_obj},
      {"obj: one material often", 3000, [](std::size_t n) { return "mtllib a\n" + kQuad + "usemtl m\nf 1 2 3\n" + std::string(kMtlBegins) + times(n, "newmtl m\nKd 1 0 0\n"); }, read_dear_obj},
      {"obj: one mtllib often", 300, [](std::size_t n) { return times(n, "mtllib a\n") + kQuad + "f 1 2 3\n" + std::string(kMtlBegins) + times(n, "newmtl m\n"); }, read_dear_obj},
      {"obj: mtllib of many names", 300, [](std::size_t n) { return "mtllib " + times(n, [](std::size_t k) { return fmt::format("a{} ", k); }) + "\n" + kQuad + "f 1 2 3\n" + std::string(kMtlBegins) + times(n, "newmtl m\n"); }, read_dear_obj},
      {"obj: options of a picture", 5000, [](std::size_t n) { return "mtllib a\n" + kQuad + "usemtl m\nf 1 2 3\n" + std::string(kMtlBegins) + "newmtl m\nmap_Kd " + times(n, "-s 1 1 1 ") + "a.png\n"; }, read_dear_obj},
      {"obj: groups", 10000, [](std::size_t n) { return kQuad + times(n, [](std::size_t k) { return fmt::format("g a{}\no b{}\ns {}\n", k, k, k); }) + "f 1 2 3\n"; }, read_dear_obj},
      {"obj: lines that go on", 20000, [](std::size_t n) { return kQuad + "f 1 2 3" + times(n, " \\\n"); }, read_dear_obj},
      {"obj: a long word", 200000, [](std::size_t n) { return kQuad + "f 1 2 " + std::string(n, '3') + "\n"; }, read_dear_obj},
      {"obj: empty lines", 50000, [](std::size_t n) { return kQuad + std::string(n, '\n') + "f 1 2 3\n"; }, read_dear_obj},
      {"obj: points that are far away", 5000, [](std::size_t n) { return times(n, [](std::size_t k) { return fmt::format("v 1e9 {} 0\n", k); }) + "f 1 2 3\n"; }, read_dear_obj},
      {"stl: facets", 1000, [](std::size_t n) { return "solid a\n" + times(n, "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n") + "endsolid\n"; }, read_dear_stl},
      {"stl: the word solid", 10000, [](std::size_t n) { return times(n, "solid a\n"); }, read_dear_stl},
      {"stl: one long line", 50000, [](std::size_t n) { return "solid " + times(n, "a "); }, read_dear_stl},
      {"stl: a false count", 50000, [](std::size_t n) { return std::string(80, 'x') + std::string(4, '\xFF') + std::string(n, 'x'); }, read_dear_stl},
  };
  check_growth(obj);
  const std::vector<DearFile> gltf{
      {"gltf: nodes of one mesh", 3000, [](std::size_t n) { return gltf_of(R"({"children": [)" + numbers(1, n) + "]}, " + times(n, kMeshNode), ""); }, read_dear_gltf},
      {"gltf: nodes of many parts", 200, [](std::size_t n) { return gltf_of(R"({"children": [)" + numbers(1, n) + "]}, " + times(n, kMeshNode), times(n, R"({"attributes": {"POSITION": 0}, "mode": 6}, )")); }, read_dear_gltf},
      {"gltf: nodes in nodes", 60, [](std::size_t n) { return gltf_of(times(n, [](std::size_t k) { return fmt::format(R"({{"children": [{}]}}, )", k + 1); }), ""); }, read_dear_gltf},
      {"gltf: nodes without a mesh", 5000, [](std::size_t n) { return gltf_of(kMeshNode + times(n, "{}, "), ""); }, read_dear_gltf},
      {"gltf: brackets", 20000, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "extras": )" + std::string(n, '[') + std::string(n, ']')); }, read_dear_gltf},
      {"gltf: extras", 20000, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "extras": [)" + numbers(0, n) + "]"); }, read_dear_gltf},
      {"gltf: a long name", 200000, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "extras": ")" + std::string(n, 'x') + "\""); }, read_dear_gltf},
      {"gltf: accessors", 2000, [](std::size_t n) { return gltf_of(kMeshNode, times(n, [](std::size_t k) { return fmt::format(R"({{"attributes": {{"POSITION": {}}}, "mode": 6}}, )", k); }), "", times(n, R"(, {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})")); }, read_dear_gltf},
      {"gltf: sparse accessors of one buffer", 500, [](std::size_t n) { return gltf_of(kMeshNode, times(n, [](std::size_t k) { return fmt::format(R"({{"attributes": {{"POSITION": {}}}, "mode": 6}}, )", k + 1); }), "", times(n, R"(, {"componentType": 5126, "count": 255, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}}})")); }, read_dear_gltf},
      {"gltf: a count of zeros", 250000, [](std::size_t n) { return gltf_of(kMeshNode, R"({"attributes": {"POSITION": 1}}, )", "", fmt::format(R"(, {{"componentType": 5126, "count": {}, "type": "VEC3", "sparse": {{"count": 1, "indices": {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 0}}}}}})", 3 * n)); }, read_dear_gltf},
      {"gltf: instances", 250000, [](std::size_t n) { return gltf_of(R"({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}, )", "", "", fmt::format(R"(, {{"componentType": 5126, "count": {}, "type": "VEC3", "sparse": {{"count": 0, "indices": {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 0}}}}}})", n)); }, read_dear_gltf},
      {"gltf: morph targets", 1000, [](std::size_t n) { return gltf_of(kMeshNode, R"({"attributes": {"POSITION": 0}, "mode": 6, "targets": [)" + times(n, R"({"POSITION": 0}, )") + R"({"POSITION": 0}]}, )", ""); }, read_dear_gltf},
      {"gltf: pictures of one view", 500, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "materials": [)" + times(n, [](std::size_t k) { return fmt::format(R"({{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": {}}}}}}}, )", k); }) + R"({}], "textures": [)" + times(n, [](std::size_t k) { return fmt::format(R"({{"source": {}}}, )", k); }) + R"({"source": 0}], "images": [)" + times(n, R"({"bufferView": 0, "mimeType": "image/png"}, )") + R"({"bufferView": 0, "mimeType": "image/png"}])"); }, read_dear_gltf},
      {"gltf: materials", 3000, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "materials": [)" + times(n, "{}, ") + "{}]"); }, read_dear_gltf},
      {"gltf: buffers", 1000, [](std::size_t n) { std::string text = gltf_of(kMeshNode, ""); const std::string mark = R"("buffers": [)"; return text.insert(text.find(mark) + mark.size(), times(n, R"({"byteLength": 3, "uri": "data:application/octet-stream;base64,AAAA"}, )")); }, read_dear_gltf},
      {"gltf: required extensions", 5000, [](std::size_t n) { return gltf_of(kMeshNode, "", R"(, "extensionsRequired": [)" + times(n, R"("KHR_lights_punctual", )") + R"("KHR_lights_punctual"])"); }, read_dear_gltf},
  };
  check_growth(gltf);
  const std::string jpeg = noisy_jpeg(64, true);
  const auto scan = jpeg.find("\xFF\xDA");
  const std::vector<DearFile> pictures{
      {"png: chunks that nobody knows", 5000, [](std::size_t n) { return png_with(times(n, std::string("\0\0\0\0abCd\x9E\x10\xA9\xB2", 12))); }, read_dear_picture},
      {"png: a size that is not there", 100, [](std::size_t n) { std::string png = small_png(); png[16 + 1] = png[20 + 1] = static_cast<char>(n / 4); return png + std::string(n, ' '); }, read_dear_picture},
      {"jpeg: scans", 40, [&](std::size_t n) { return jpeg.substr(0, scan) + times(n, jpeg.substr(scan, 200)); }, read_dear_picture},
      {"jpeg: a size that is not there", 100, [&](std::size_t n) { std::string large = jpeg; const auto frame = large.find("\xFF\xC2"); large[frame + 5] = large[frame + 7] = static_cast<char>(n / 4); return large + std::string(n, ' '); }, read_dear_picture},
      {"jpeg: comments", 5000, [&](std::size_t n) { return jpeg.substr(0, 2) + times(n, std::string("\xFF\xFE\0\x04" "ab", 6)) + jpeg.substr(2); }, read_dear_picture},
  };
  check_growth(pictures);
  const std::string line = "0 0 m 9 9 l S\n";
  const std::vector<DearFile> pdf{
      {"pdf: lines", 500, [&](std::size_t n) { return pdf_of(times(n, line)); }, read_dear_pdf},
      {"pdf: states in states", 1000, [&](std::size_t n) { return pdf_of(times(n, "q ") + line + times(n, "Q ")); }, read_dear_pdf},
      {"pdf: objects", 1000, [&](std::size_t n) { return pdf_of(line, times(n, [](std::size_t k) { return fmt::format("{} 0 obj<</A {} 0 R>>endobj\n", k + 5, k + 6); })); }, read_dear_pdf},
      {"pdf: brackets", 5000, [&](std::size_t n) { return pdf_of(line, "5 0 obj" + std::string(n, '[') + "endobj\n"); }, read_dear_pdf},
  };
  REQUIRE(pictures::load_pdf_reader());
  REQUIRE(pictures::pdf_page(pdf_of(line), 1));
  check_growth(pdf);
  // clang-format on
}

}  // namespace
}  // namespace popcut
