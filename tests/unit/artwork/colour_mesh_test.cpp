// SPDX-License-Identifier: MIT
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
#include "tests/support/painted_shell.hpp"

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
  const auto png = png_of_image(image);
  REQUIRE(png);
  return *png;
}

TEST_CASE("an OBJ takes its colours from its MTL, with v upward in the picture", "[artwork]") {
  const auto mesh = read_colour_mesh(
      "quad.obj", "mtllib a b.mtl\n" + kQuad + "usemtl skin\nf 1/1 2/2 3/3 4/4\n",
      files_of({{"a b.mtl", "newmtl skin\nKd 1 0.5 1\nmap_Kd -s 1 1 1 -clamp on the skin.png\n"},
                {"the skin.png", small_png()}}));
  if (!mesh) FAIL(message(mesh.error()));
  REQUIRE(mesh->size() == 2);
  CHECK(mesh->coloured);
  // Near corner 1 of the quad: the picture's lower left pixel, times Kd.
  const Colour low_left = colour_of(*mesh, 0, {0.75, 0, 0.25}, 1);
  CHECK(low_left.b == Approx(255).margin(1));
  CHECK(low_left.r == Approx(0).margin(1));
  // Near corner 2 is the lower right one: yellow, its green halved.
  const Colour low_right = colour_of(*mesh, 0, {0.25, 0.5, 0.25}, 1);
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
  const auto mesh = read_colour_mesh("two.obj",
                                     "mtllib a.mtl \"b c.mtl\"\nmtllib .\\x\\..\\.//a.mtl\n" +
                                         kQuad + "usemtl one\nf 1 2 3\nusemtl two\nf 1 3 4\n",
                                     files);
  if (!mesh) FAIL(message(mesh.error()));
  CHECK(colour_of(*mesh, 0, {0.4, 0.3, 0.3}, 1).r == Approx(255).margin(1));
  CHECK(colour_of(*mesh, 1, {0.4, 0.3, 0.3}, 1).g == Approx(255).margin(1));
  CHECK(opened == 2);
}

TEST_CASE("comments, keys of either case and options of an MTL are read", "[artwork]") {
  const std::map<std::string, std::string> files{
      {"a.mtl",
       "\xEF\xBB\xBFnewmtl one # red\nkd 1 0 0 # red\nNewmtl two\nmap_kd -s 2 1 -o 0.5 0.25 "
       "skin.png # "
       "it\nnewmtl low\nmap_Kd -clamp on -o 0 -1 skin.png\nnewmtl clear\nd 0\n"},
      {"skin.png", small_png()}};
  const auto mesh = read_colour_mesh("q.obj",
                                     "mtllib a.mtl # colours\n" + kQuad +
                                         "usemtl one # it\nf 1 2 3\nUsemtl two\nf 1/1 1/1 1/1\n"
                                         "usemtl low\nf 1/1 1/1 1/1\nusemtl clear\nf 1 3 4\n",
                                     files_of(files));
  if (!mesh) FAIL(message(mesh.error()));
  REQUIRE(mesh->size() == 3);  // nothing is seen of the last one
  const auto at = [&](std::size_t t) { return colour_of(*mesh, t, {0.4, 0.3, 0.3}, 1); };
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
    const auto mesh = read_colour_mesh(
        "tri.obj",
        "v 0 0 0 " + colour + "\nv 1 0 0 " + colour + "\nv 0 1 0 " + colour + "\nf 1 2 3\n",
        files_of({}));
    if (!mesh) FAIL(message(mesh.error()));
    return colour_of(*mesh, 0, {0.4, 0.3, 0.3}, 1).r;
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
  const auto mesh = read_colour_mesh(
      "tri.obj", "v 0 0 0 200 150 100\nv 1 0 0 200 150 100\nv 0 1 0 200 150 100\nf 1 2 3\n",
      files_of({}));
  if (!mesh) FAIL(message(mesh.error()));
  const Colour colour = colour_of(*mesh, 0, {0.4, 0.3, 0.3}, 1);
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
    const auto mesh = read_colour_mesh("q.gltf", head + transform + "}}}]}",
                                       files_of({{"q.bin", buffer}, {"skin.png", small_png()}}));
    if (!mesh) FAIL(message(mesh.error()));
    return colour_of(*mesh, 0, {0.4, 0.3, 0.3}, 1);
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

TEST_CASE("colours after the vertices of an OBJ are read", "[artwork]") {
  const auto mesh = read_colour_mesh(
      "tri.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n", files_of({}));
  REQUIRE(mesh);
  CHECK(mesh->coloured);
  const Colour middle = colour_of(*mesh, 0, {1 / 3.0, 1 / 3.0, 1 / 3.0}, 0);
  CHECK(middle.r == Approx(85).margin(0.5));
  CHECK(middle.g == Approx(85).margin(0.5));
}

TEST_CASE("a model without colours is clay, and so is one of which they are not wanted",
          "[artwork]") {
  const auto plain = read_colour_mesh("quad.obj", kQuad + "f 1 2 3 4\n", files_of({}));
  REQUIRE(plain);
  CHECK_FALSE(plain->coloured);
  const auto unwanted = read_colour_mesh(
      "quad.obj", "mtllib absent.mtl\n" + kQuad + "usemtl x\nf 1 2 3 4\n", files_of({}), false);
  REQUIRE(unwanted);
  CHECK_FALSE(unwanted->coloured);
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
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
        "textures": [{{"source": 0}}], "images": [{{"bufferView": 1, "mimeType": "image/png"}}],
        "buffers": [{{"byteLength": {0}, "uri": "b.bin"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}},
                        {{"buffer": 0, "byteOffset": 36, "byteLength": {1}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}})",
                    36 + png.size(), picture_bytes),
        files_of({{"b.bin", places + png}}));
  };
  const auto whole = read(png.size());
  if (!whole) FAIL(message(whole.error()));
  CHECK(whole->textures.size() == 1);
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

}  // namespace
}  // namespace popcut
