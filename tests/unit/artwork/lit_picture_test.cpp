// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/artwork/lit_picture.hpp"
#include "core/artwork/standing_print.hpp"
#include "core/design/patches.hpp"
#include "tests/support/painted_shell.hpp"
#include "tests/support/value.hpp"

namespace lit_picture_test {

using namespace popcut;
using testing::PaintedShell;

namespace {

constexpr Colour kRed{200, 20, 20, 255}, kBlue{20, 40, 200, 255}, kFloor{240, 240, 240, 255};

/// A square in the plane x = `x`, its middle at (y, z), that looks to growing x.
void add_square(ColourMesh& to, const Colour& colour, double x, double y, double z, double half) {
  const auto k = static_cast<std::uint32_t>(to.surfacings.size());
  to.surfacings.push_back({colour});
  to.soup.add(Vec3{x, y - half, z - half}, Vec3{x, y + half, z - half}, Vec3{x, y + half, z + half},
              Vec3{x, y - half, z + half});
  to.surfacing_of.insert(to.surfacing_of.end(), 2, k);
}

PictureLook from_x(double shade) {
  PictureLook look;
  look.toward = {1, 0, 0};
  look.width_px = look.height_px = 100;
  look.shade = shade;
  return look;
}

bool is(const ColourImage& image, std::size_t i, std::size_t j, const Colour& want) {
  const Colour got = image.colour(i, j);
  CAPTURE(i, j, got.r, got.g, got.b, want.r, want.g, want.b);
  return std::abs(got.r - want.r) < 2 && std::abs(got.g - want.g) < 2 &&
         std::abs(got.b - want.b) < 2;
}

std::size_t sum(const ColourImage& image, std::size_t i, std::size_t j) {
  const std::uint8_t* p = image.at(i, j);
  return std::size_t{p[0]} + p[1] + p[2];
}

}  // namespace

TEST_CASE("a lit picture shows what is nearest, right side up, and white around it", "[artwork]") {
  ColourMesh scene;
  add_square(scene, kFloor, 0, 0, 0, 50);
  add_square(scene, kRed, 10, 25, 25, 10);    // to the right and up
  add_square(scene, kBlue, 5, 25, 25, 20);    // behind the red one
  add_square(scene, kBlue, -5, -25, -25, 9);  // behind the floor
  const ColourImage image = lit_picture(scene, from_x(0));
  // 100 mm and 3 % on each side: 0.94 pixels a mm, the middle at 50.
  CHECK(is(image, 73, 26, kRed));
  CHECK(is(image, 59, 26, kBlue));
  CHECK(is(image, 30, 70, kFloor));
  CHECK(is(image, 73, 74, kFloor));
  CHECK(is(image, 0, 50, {255, 255, 255, 255}));
  for (std::size_t k = 3; k < image.rgba.size(); k += 4) REQUIRE(image.rgba[k] == 255);
  CHECK(is(lit_picture({}, from_x(0.5)), 50, 50, {255, 255, 255, 255}));
}

TEST_CASE("in a lit picture things throw shadows on what is behind them, away from the lamp",
          "[artwork]") {
  ColourMesh scene;
  add_square(scene, kFloor, 0, 0, 0, 50);
  const ColourImage bare = lit_picture(scene, from_x(0.5));
  add_square(scene, kRed, 30, 0, 0, 8);
  const ColourImage image = lit_picture(scene, from_x(0.5));
  // The lamp is above and to the left: 30 mm in front throw it 15 mm to the right, 10.5 mm down.
  CHECK(is(image, 50 + 18, 50 + 13, {120, 120, 120, 255}));
  CHECK(sum(image, 50 + 18, 50 + 13) + 100 < sum(bare, 50 + 18, 50 + 13));
  CHECK(sum(image, 50 - 18, 50 - 13) == sum(bare, 50 - 18, 50 - 13));
  // A plane does not shade itself.
  for (std::size_t at = 6; at < 94; ++at) REQUIRE(sum(bare, at, at) == sum(bare, 50, 50));
}

TEST_CASE("a lit picture shows backs in their own colour where one is given", "[artwork]") {
  ColourMesh scene;
  add_square(scene, kRed, 0, 0, 0, 50);
  PictureLook look = from_x(0);
  look.back = kBlue;
  CHECK(is(lit_picture(scene, look), 50, 50, kRed));
  look.toward = {-1, 0, 0};
  CHECK(is(lit_picture(scene, look), 50, 50, kBlue));
  look.back.reset();
  CHECK(is(lit_picture(scene, look), 50, 50, kRed));
}

namespace {

struct Printed {
  PatchAssembly made;
  std::vector<ColourMesh> models;
  Artwork artwork;

  explicit Printed(const std::string& spec_text) {
    const PaintedShell shell = testing::painted_shells()[0];
    const auto spec = testing::value(parse_design_spec(spec_text));
    auto assembly = testing::value(design_assembly(spec, {{"shell.obj", shell.obj()}}));
    made = std::move(assembly);
    const auto mesh = testing::value(read_colour_mesh("shell.obj", shell.obj(), shell.files()));
    for (const Design& part : made.parts)
      models.push_back(model_on_sheet(mesh, spec.placement, part));
    ArtworkOptions options;
    options.pixel_mm = 0.25;
    auto drawn = testing::value(design_artwork(parts(), models, nullptr, options));
    artwork = std::move(drawn);
  }

  [[nodiscard]] std::vector<const Pattern*> parts() const {
    std::vector<const Pattern*> out;
    for (const Design& part : made.parts) out.push_back(&part.pattern);
    return out;
  }
};

}  // namespace

TEST_CASE("a printed card that stands opened looks like its model from the diagonal", "[artwork]") {
  const Printed card(PaintedShell::spec(5, 9, 40));
  const auto parts = card.parts();
  const auto print = testing::value(standing_print(parts, PartsStand::InRow, card.artwork));
  // Both in one picture of the same frame: the card's box has the model in it.
  PictureLook look;
  look.shade = 0;
  look.width_px = look.height_px = 200;
  ColourMesh model = standing_models(parts, PartsStand::InRow, card.models);
  REQUIRE(model.size() == card.models[0].size());
  ColourMesh wall = print;
  for (std::size_t k = 0; k < wall.soup.corners.size(); k += 3) {
    // All of it along the diagonal into a plane behind the model: the same frame, and no card.
    const double across = 0.5 * (wall.soup.corners[k] - wall.soup.corners[k + 2]);
    wall.soup.corners[k] = across - 500, wall.soup.corners[k + 2] = -across - 500;
  }
  const std::size_t before = wall.size();
  const auto own = static_cast<std::uint32_t>(wall.surfacings.size());
  wall.surfacings[0] = {Colour{255, 255, 255, 255}};
  wall.surfacings.insert(wall.surfacings.end(), model.surfacings.begin(), model.surfacings.end());
  wall.textures = model.textures;
  wall.soup.corners.insert(wall.soup.corners.end(), model.soup.corners.begin(),
                           model.soup.corners.end());
  wall.st.resize(3 * before);
  wall.st.insert(wall.st.end(), model.st.begin(), model.st.end());
  for (const std::uint32_t k : model.surfacing_of) wall.surfacing_of.push_back(k + own);
  const ColourImage of_card = lit_picture(print, look), of_model = lit_picture(wall, look);
  double squares = 0;
  int seen = 0;
  for (std::size_t j = 1; j + 1 < 200; ++j)
    for (std::size_t i = 1; i + 1 < 200; ++i) {
      const auto plain = [&](std::size_t x, std::size_t y) { return sum(of_model, x, y) > 740; };
      if (plain(i, j) || plain(i - 1, j) || plain(i + 1, j) || plain(i, j - 1) || plain(i, j + 1))
        continue;
      ++seen;
      for (std::size_t c = 0; c < 3; ++c)
        squares += std::pow(double{0} + of_card.at(i, j)[c] - of_model.at(i, j)[c], 2) / 3;
    }
  REQUIRE(seen > 4000);
  // Rims of panels are darker than the paint; all else is the same.
  CHECK(std::sqrt(squares / seen) < 25);
}

TEST_CASE("the cards of a printed book stand around the spine, each in its own quarter",
          "[artwork]") {
  const Printed book(R"({"popcut": 1, "name": "b", "surface": {"type": "mesh", "file": "shell.obj"},
      "scale_mm": 40, "rotate_deg": [0, 0, 0], "units_per_slice": 4, "slices": 8, "widths_mm": 8,
      "book": {"cards": 4}})");
  const auto parts = book.parts();
  REQUIRE(parts.size() == 4);
  const auto print = testing::value(standing_print(parts, PartsStand::Around, book.artwork));
  constexpr std::array<std::array<double, 2>, 4> kSigns{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  std::size_t t = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t corners = 0;
    for (std::size_t f = 0; f < parts[k]->faces(); ++f) corners += parts[k]->face(f).size();
    double farthest = 0;
    const std::size_t first = t;
    // A card's triangles come one after the other: all that lie in its quarter.
    for (; t < print.size(); ++t) {
      const Vec3 middle =
          (print.soup.corner(t, 0) + print.soup.corner(t, 1) + print.soup.corner(t, 2)) / 3;
      if (kSigns[k][0] * middle[0] < -1e-9 || kSigns[k][1] * middle[2] < -1e-9) break;
      farthest = std::max(farthest, std::hypot(middle[0], middle[2]));
    }
    CAPTURE(k, corners);
    CHECK(t - first >= 4);  // a plain card is two pages
    CHECK(t - first <= corners);
    CHECK(farthest > 20);
  }
  CHECK(t == print.size());
}

}  // namespace lit_picture_test
