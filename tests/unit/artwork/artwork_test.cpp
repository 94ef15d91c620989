// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/artwork/boxes_artwork.hpp"
#include "core/artwork/colour_mesh_reader.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/artwork/layers_artwork.hpp"
#include "core/artwork/printed_sheet.hpp"
#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/design/boxes/boxed_card.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/design/patches.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/plan.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "tests/support/painted_shell.hpp"
#include "tests/support/value.hpp"

namespace popcut {
namespace {

using testing::painted_shells;
using testing::PaintedShell;

/// A shell, its design, and the shell where the opened card shows it.
struct Painted {
  PaintedShell shell;
  PatchAssembly made;
  ColourMesh model;

  [[nodiscard]] const Pattern& pattern() const { return made.parts.front().pattern; }
};

Painted painted(const PaintedShell& shell, bool facets = false) {
  const auto spec =
      parse_design_spec(facets ? PaintedShell::facet_spec(40) : PaintedShell::spec(5, 9, 40));
  REQUIRE(spec);
  auto made = testing::value(design_assembly(*spec, {{"shell.obj", shell.obj()}}));
  auto mesh = testing::value(read_colour_mesh("shell.obj", shell.obj(), shell.files()));
  REQUIRE(mesh.coloured);
  ColourMesh model = model_on_sheet(std::move(mesh), spec->placement, made.parts.front());
  return {shell, std::move(made), std::move(model)};
}

Artwork artwork_of(const Painted& painted, const ArtworkOptions& options) {
  const Pattern* const part = &painted.pattern();
  return testing::value(design_artwork({&part, 1}, {&painted.model, 1}, nullptr, options));
}

/// The texel at (s, t) of an image that repeats, between pixels; written apart from what is tested.
std::array<double, 3> texel(const ColourImage& image, double s, double t) {
  const double w = static_cast<double>(image.width), h = static_cast<double>(image.height);
  const double x = s * w - 0.5, y = t * h - 0.5;
  const auto whole = [](double at, std::size_t size) {
    const long n = static_cast<long>(size), i = static_cast<long>(std::floor(at));
    return static_cast<std::size_t>(((i % n) + n) % n);
  };
  const std::size_t i = whole(x, image.width), j = whole(y, image.height);
  const std::size_t right = (i + 1) % image.width, down = (j + 1) % image.height;
  const double a = x - std::floor(x), b = y - std::floor(y);
  std::array<double, 3> out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = (1 - b) * ((1 - a) * image.at(i, j)[c] + a * image.at(right, j)[c]) +
             b * ((1 - a) * image.at(i, down)[c] + a * image.at(right, down)[c]);
  return out;
}

std::array<double, 3> colour_in(const ColourMesh& mesh, const ColourImage& image, std::size_t t,
                                const std::array<double, 3>& w) {
  double s = 0, down = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    s += w[k] * static_cast<double>(mesh.st[3 * t + k][0]);
    down += w[k] * static_cast<double>(mesh.st[3 * t + k][1]);
  }
  return texel(image, s, down);
}

/// What a ray along -(1, 0, 1) meets first: (x - z, v) name the ray, and every triangle is asked.
struct Eye {
  const ColourMesh& mesh;
  const ColourImage& image;
  std::vector<std::size_t> row{};  ///< triangles with a texture that reach to this v

  void stand_at(double v) {
    row.clear();
    for (std::size_t t = 0; t < mesh.size(); ++t) {
      if (mesh.surfacings[mesh.surfacing_of[t]].texture < 0) continue;
      const double a = mesh.soup.corner(t, 0)[1], b = mesh.soup.corner(t, 1)[1],
                   c = mesh.soup.corner(t, 2)[1];
      if (v >= std::min({a, b, c}) && v <= std::max({a, b, c})) row.push_back(t);
    }
  }

  /// False if there is none.
  bool look(double x_less_z, double v, std::array<double, 3>& colour) const {
    double best = -1e300;
    for (const std::size_t t : row) {
      std::array<std::array<double, 3>, 3> p{};  // across, along, toward
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 c = mesh.soup.corner(t, k);
        p[k] = {c[0] - c[2], c[1], c[0] + c[2]};
      }
      const auto area = [](double ax, double ay, double bx, double by, double cx, double cy) {
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      };
      const double all = area(p[0][0], p[0][1], p[1][0], p[1][1], p[2][0], p[2][1]);
      if (std::abs(all) < 1e-12) continue;
      const std::array<double, 3> w{area(x_less_z, v, p[1][0], p[1][1], p[2][0], p[2][1]) / all,
                                    area(p[0][0], p[0][1], x_less_z, v, p[2][0], p[2][1]) / all,
                                    area(p[0][0], p[0][1], p[1][0], p[1][1], x_less_z, v) / all};
      if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
      const double toward = w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2];
      if (toward <= best) continue;
      best = toward;
      colour = colour_in(mesh, image, t, w);
    }
    return best > -1e300;
  }
};

/// The card as its preview shows it, in mm, x from the wall and z from the ground.
ColourMesh opened(const Pattern& pattern, const Artwork& artwork, ColourImage& print) {
  const auto png = testing::value(png_of_image(on_paper(artwork.image)));
  const std::vector<double> angles{3.0, pattern.design_psi_rad};
  const auto table = testing::value(pose_table(pattern, angles));
  GlbOptions how;
  how.front = {png, artwork.frame.left_mm, artwork.frame.top_mm,
               static_cast<double>(artwork.frame.width) * artwork.frame.pixel_mm,
               static_cast<double>(artwork.frame.height) * artwork.frame.pixel_mm};
  const auto bytes = testing::value(glb(pattern, table, how));
  const ModelFiles files{
      [](const std::string&) -> Result<std::string> { return std::string(); },
      [&](const std::string& name, std::string_view packed, std::size_t) -> Result<ColourImage> {
        auto image = read_image(name, packed);
        if (image) print = *image;
        return image;
      }};
  auto mesh = testing::value(read_colour_mesh("preview.glb", bytes, files));
  for (std::size_t k = 0; k < mesh.soup.corners.size(); k += 3) {
    const double right = mesh.soup.corners[k], up = mesh.soup.corners[k + 1],
                 front = mesh.soup.corners[k + 2];
    mesh.soup.corners[k] = 1000 * front, mesh.soup.corners[k + 1] = 1000 * right,
    mesh.soup.corners[k + 2] = 1000 * up;
  }
  return mesh;
}

TEST_CASE("the opened card looks like the model from half way between ground and wall",
          "[artwork]") {
  const bool facets = GENERATE(false, true);
  int number = 0;
  for (const PaintedShell& shell : painted_shells()) {
    CAPTURE(++number, facets);
    const Painted card = painted(shell, facets);
    ArtworkOptions options;
    options.pixel_mm = 25.4 / 300;
    const Artwork artwork = artwork_of(card, options);
    ColourImage print;
    const ColourMesh preview = opened(card.pattern(), artwork, print);
    REQUIRE(print.width == artwork.image.width);
    const ColourImage paint = shell.texture();
    Eye on_model{card.model, paint}, on_card{preview, print};
    double squares = 0;
    int seen = 0;
    const double width = card.pattern().width_mm;
    for (double v = 0.31; v < width; v += 2.1) {
      on_model.stand_at(v), on_card.stand_at(v);
      for (double across = -60; across < 60; across += 1.9) {
        std::array<double, 3> want{}, got{};
        if (!on_model.look(across, v, want)) continue;
        REQUIRE(on_card.look(across, v, got));
        ++seen;
        for (std::size_t c = 0; c < 3; ++c) squares += (want[c] - got[c]) * (want[c] - got[c]) / 3;
      }
    }
    REQUIRE(seen > 700);
    const double psnr_db = 10 * std::log10(255.0 * 255.0 / (squares / seen));
    CAPTURE(seen, psnr_db);
    CHECK(psnr_db >= 35.0);
  }
}

double squared_to(const TriangleSoup& soup, std::size_t t, const Vec3& p,
                  std::array<double, 3>& weights) {
  // Least squares over the triangle, with its sides and corners tried one by one.
  const std::array<Vec3, 3> c{soup.corner(t, 0), soup.corner(t, 1), soup.corner(t, 2)};
  double best = 1e300;
  const auto take = [&](const std::array<double, 3>& w) {
    const Vec3 q = w[0] * c[0] + w[1] * c[1] + w[2] * c[2];
    if (const double d = (p - q).squaredNorm(); d < best) best = d, weights = w;
  };
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0], d = p - c[0];
  Eigen::Matrix2d gram;
  gram << e1.dot(e1), e1.dot(e2), e1.dot(e2), e2.dot(e2);
  if (std::abs(gram.determinant()) > 1e-14) {
    const Eigen::Vector2d s = gram.inverse() * Eigen::Vector2d(d.dot(e1), d.dot(e2));
    if (s[0] >= 0 && s[1] >= 0 && s[0] + s[1] <= 1) take({1 - s[0] - s[1], s[0], s[1]});
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t n = (k + 1) % 3;
    const Vec3 e = c[n] - c[k];
    const double share = std::clamp((p - c[k]).dot(e) / std::max(e.squaredNorm(), 1e-30), 0.0, 1.0);
    std::array<double, 3> w{};
    w[k] = 1 - share, w[n] = share;
    take(w);
  }
  return best;
}

TEST_CASE("a thousand places of panels have the colour of the model's nearest point", "[artwork]") {
  const Painted card = painted(painted_shells()[0], GENERATE(false, true));
  ArtworkOptions options;
  options.mode = PrintMode::Surface;
  options.pixel_mm = 0.2;
  options.trapping = {0, 0};
  const Artwork artwork = artwork_of(card, options);
  const auto surface = testing::value(face_surface(card.pattern()));
  const ColourImage paint = card.shell.texture();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  int looked_at = 0, wrong = 0;
  while (looked_at < 1000) {
    const std::size_t k = random() % surface.triangles.size();
    const auto& c = surface.triangles[k];
    double a = share(random), b = share(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const PagePoint at{
        c[0].page.x + a * (c[1].page.x - c[0].page.x) + b * (c[2].page.x - c[0].page.x),
        c[0].page.y + a * (c[1].page.y - c[0].page.y) + b * (c[2].page.y - c[0].page.y)};
    // The middle of its pixel, if that is in the same triangle.
    const PagePoint pixel = artwork.frame.in_pixels(at);
    const auto i = static_cast<std::size_t>(std::lround(pixel.x));
    const auto j = static_cast<std::size_t>(std::lround(pixel.y));
    const PagePoint m = artwork.frame.middle(i, j);
    Eigen::Matrix2d sides;
    sides << c[1].page.x - c[0].page.x, c[2].page.x - c[0].page.x, c[1].page.y - c[0].page.y,
        c[2].page.y - c[0].page.y;
    const Eigen::Vector2d w =
        sides.inverse() * Eigen::Vector2d(m.x - c[0].page.x, m.y - c[0].page.y);
    if (w[0] < 0.01 || w[1] < 0.01 || w[0] + w[1] > 0.99) continue;
    ++looked_at;
    const Vec3 p = c[0].place + w[0] * (c[1].place - c[0].place) + w[1] * (c[2].place - c[0].place);
    std::vector<std::pair<double, std::array<double, 3>>> found;
    double best = 1e300;
    for (std::size_t t = 0; t < card.model.size(); ++t) {
      // No point of it is nearer than its first corner less its longest side.
      const Vec3 q = card.model.soup.corner(t, 0);
      const double reach = std::max((card.model.soup.corner(t, 1) - q).norm(),
                                    (card.model.soup.corner(t, 2) - q).norm());
      if ((p - q).norm() - reach > best + 1e-6) continue;
      std::array<double, 3> weights{};
      const double d = std::sqrt(squared_to(card.model.soup, t, p, weights));
      best = std::min(best, d);
      found.emplace_back(d, colour_in(card.model, paint, t, weights));
    }
    // Of points that are equally near, each is right.
    const std::uint8_t* got = artwork.image.at(i, j);
    const bool right = std::any_of(found.begin(), found.end(), [&](const auto& one) {
      bool same = one.first < best + 1e-6;
      for (std::size_t n = 0; n < 3; ++n)
        same = same && std::abs(one.second[n] - static_cast<double>(got[n])) < 1.5;  // rounding
      return same;
    });
    wrong += right ? 0 : 1;
  }
  CHECK(wrong == 0);
}

/// Pixels of faces that are bare when the cut is off by whole pixels.
std::size_t bare_pixels(const Artwork& artwork, const std::vector<std::uint32_t>& face,
                        const std::vector<std::uint8_t>& left_out, int dx, int dy) {
  std::size_t bare = 0;
  const auto width = static_cast<long>(artwork.frame.width);
  const auto height = static_cast<long>(artwork.frame.height);
  for (long j = 0; j < height; ++j)
    for (long i = 0; i < width; ++i) {
      const std::uint32_t f = face[static_cast<std::size_t>(j * width + i)];
      if (f == kNoFace || left_out[f] != 0) continue;
      const long x = i + dx, y = j + dy;
      const bool inside = x >= 0 && y >= 0 && x < width && y < height;
      const std::uint8_t* p =
          inside ? artwork.image.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y))
                 : nullptr;
      if (p == nullptr || p[3] < 255 || (p[0] > 250 && p[1] > 250 && p[2] > 250)) ++bare;
    }
  return bare;
}

TEST_CASE("a cut that is 0.3 mm off leaves no white on any face", "[artwork]") {
  const Painted card = painted(painted_shells()[1], GENERATE(false, true));
  for (const bool bare_card : {false, true}) {
    CAPTURE(bare_card);
    ArtworkOptions options;
    options.mode = PrintMode::Surface;
    options.pixel_mm = 0.1;
    options.bare_card = bare_card;
    const Artwork trapped = artwork_of(card, options);
    options.trapping = {0, 0};
    Artwork plain = artwork_of(card, options);
    const auto surface = testing::value(face_surface(card.pattern()));
    const auto of_card = bare_card ? faces_of_card(card.pattern())
                                   : std::vector<std::uint8_t>(card.pattern().faces(), 0);
    for (const auto& [dx, dy] : {std::pair{3, 0}, {-3, 0}, {0, 3}, {0, -3}, {2, 2}, {-2, 2}}) {
      CAPTURE(dx, dy);
      CHECK(bare_pixels(trapped, face_pixels(surface, trapped.frame), of_card, dx, dy) == 0);
      CHECK(bare_pixels(plain, face_pixels(surface, plain.frame), of_card, dx, dy) > 0);
    }
  }
}

TEST_CASE("faces that the picture of the model covers stay covered when a cut is 0.3 mm off",
          "[artwork]") {
  const Painted card = painted(painted_shells()[2], GENERATE(false, true));
  ArtworkOptions options;
  options.pixel_mm = 0.1;
  const Artwork trapped = artwork_of(card, options);
  options.trapping = {0, 0};
  const Artwork plain = artwork_of(card, options);
  const auto surface = testing::value(face_surface(card.pattern()));
  const auto face = face_pixels(surface, trapped.frame), bare = face_pixels(surface, plain.frame);
  std::vector<std::uint8_t> partly(card.pattern().faces(), 0);
  for (std::size_t pixel = 0; pixel < bare.size(); ++pixel)
    if (bare[pixel] != kNoFace && plain.image.rgba[4 * pixel + 3] == 0) partly[bare[pixel]] = 1;
  CHECK(std::count(partly.begin(), partly.end(), 0) > 20);
  std::size_t without_trap = 0;
  for (const auto& [dx, dy] : {std::pair{3, 0}, {-3, 0}, {0, 3}, {0, -3}, {2, 2}, {-2, 2}}) {
    CAPTURE(dx, dy);
    CHECK(bare_pixels(trapped, face, partly, dx, dy) == 0);
    without_trap += bare_pixels(plain, bare, partly, dx, dy);
  }
  CHECK(without_trap > 0);
}

TEST_CASE("a model that stands nowhere on the card is refused", "[artwork]") {
  Painted card = painted(painted_shells()[0]);
  for (double& corner : card.model.soup.corners) corner += 5000;
  const Pattern* const part = &card.pattern();
  const auto artwork = design_artwork({&part, 1}, {&card.model, 1}, nullptr, {});
  REQUIRE(!artwork);
  CHECK(artwork.error().kind == ErrorKind::Infeasible);
  CHECK_THAT(artwork.error().detail, Catch::Contains("nothing of the model is seen"));
}

/// The outside of a box, its corners coloured.
std::string coloured_box(const Vec3& low, const Vec3& high, int first) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += fmt::format("v {} {} {} 0.7 0.2 0.1\n", k & 1 ? high[0] : low[0],
                        k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]);
  for (const auto& side : {std::array{0, 1, 3, 2},
                           {4, 5, 7, 6},
                           {0, 1, 5, 4},
                           {2, 3, 7, 6},
                           {0, 2, 6, 4},
                           {1, 3, 7, 5}})
    text += fmt::format("f {} {} {} {}\n", side[0] + first, side[1] + first, side[2] + first,
                        side[3] + first);
  return text;
}

TEST_CASE("a sloped panel is printed as the roof that it stands for", "[artwork]") {
  // Bands of 5 mm up the roof from its eave, red and blue in turn, and a green front.
  constexpr double kEaveX = 60, kEaveZ = 20, kBand = 5, kWide = 60;
  constexpr int kBands = 6;
  const double slope = GENERATE(0.42, 0.52);
  std::string obj, faces;
  int corners = 0;
  const auto add = [&](double x0, double z0, double x1, double z1, const char* colour) {
    for (const auto& [x, v, z] : {std::array{x0, 0.0, z0}, std::array{x0, kWide, z0},
                                  std::array{x1, kWide, z1}, std::array{x1, 0.0, z1}})
      obj += fmt::format("v {} {} {} {}\n", x, v, z, colour);
    faces += fmt::format("f {} {} {} {}\n", corners + 1, corners + 2, corners + 3, corners + 4);
    corners += 4;
  };
  add(kEaveX, 0, kEaveX, kEaveZ, "0 1 0");
  for (int k = 0; k < kBands; ++k)
    add(kEaveX - kBand * k * std::cos(slope), kEaveZ + kBand * k * std::sin(slope),
        kEaveX - kBand * (k + 1) * std::cos(slope), kEaveZ + kBand * (k + 1) * std::sin(slope),
        k % 2 == 0 ? "1 0 0" : "0 0 1");
  obj += faces;
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut": 1, "style": "facets", "surface": {"type": "mesh", "file": "h.obj"},
          "facets": {"sloped": "kites", "pitch_mm": 10, "strip_mm": 6}})"));
  const auto made = testing::value(design_assembly(spec, {{"h.obj", obj}}));
  const auto mesh = testing::value(read_colour_mesh("h.obj", obj, {}));
  const ColourMesh model = model_on_sheet(mesh, spec.placement, made.parts.front());
  const Pattern* const part = &made.parts.front().pattern;
  REQUIRE(part->kites.size() == 1);
  ArtworkOptions options;
  options.pixel_mm = 0.2;
  options.mode = GENERATE(PrintMode::View, PrintMode::Surface);
  const auto artwork = testing::value(design_artwork({&part, 1}, {&model, 1}, nullptr, options));
  const Kite& kite = part->kites[0];
  const double eave_u = part->wall_mm + kite.section.e.x - kite.section.e.z;
  for (int k = -1; k < kBands; ++k) {
    CAPTURE(k, slope);
    const PagePoint at =
        artwork.frame.in_pixels({0.5 * (kite.v0_mm + kite.v1_mm), eave_u - kBand * (k + 0.5)});
    const Colour is = artwork.image.colour(static_cast<std::size_t>(std::lround(at.x)),
                                           static_cast<std::size_t>(std::lround(at.y)));
    CHECK(is.r == (k >= 0 && k % 2 == 0 ? 255 : 0));
    CHECK(is.g == (k < 0 ? 255 : 0));
    CHECK(is.b == (k >= 0 && k % 2 == 1 ? 255 : 0));
  }
}

TEST_CASE("a letter of facets is printed around its window, and a little into it", "[artwork]") {
  const std::string obj =
      coloured_box({0, 10, 0}, {20, 20, 60}, 1) + coloured_box({0, 20, 50}, {20, 42, 60}, 9) +
      coloured_box({0, 20, 26}, {20, 42, 36}, 17) + coloured_box({0, 32, 36}, {20, 42, 50}, 25);
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut": 1, "style": "facets", "surface": {"type": "mesh", "file": "p.obj"}})"));
  const auto made = testing::value(design_assembly(spec, {{"p.obj", obj}}));
  const auto mesh = testing::value(read_colour_mesh("p.obj", obj, {}));
  REQUIRE(mesh.coloured);
  const ColourMesh model = model_on_sheet(mesh, spec.placement, made.parts.front());
  const Pattern* const part = &made.parts.front().pattern;
  ArtworkOptions options;
  options.pixel_mm = 0.1;
  options.mode = GENERATE(PrintMode::View, PrintMode::Surface);
  const auto artwork = testing::value(design_artwork({&part, 1}, {&model, 1}, nullptr, options));
  double twice_mm2 = 0;  // of the paper, by the sides of its faces
  for (std::size_t f = 0; f < part->faces(); ++f) {
    const auto face = part->face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const PatternVertex &p = part->vertices[face[k]],
                          &q = part->vertices[face[(k + 1) % face.size()]];
      twice_mm2 += part->u(p) * q.v - part->u(q) * p.v;
    }
  }
  const auto paper = static_cast<double>(
      std::count(artwork.on_paper.begin(), artwork.on_paper.end(), std::uint8_t{1}));
  CHECK_THAT(0.01 * paper, Catch::WithinRel(0.5 * twice_mm2, 1e-3));  // pixels along the borders
  // The letter's front is 20 from the wall, and begins 10 along the spine.
  double first_v = 1e300;
  for (std::size_t k = 1; k < model.soup.corners.size(); k += 3)
    first_v = std::min(first_v, model.soup.corners[k]);
  const auto pixel_of = [&](double y, double z) {
    const PagePoint at = artwork.frame.in_pixels({first_v + y - 10, part->wall_mm + 20 - z});
    return std::array{std::lround(at.x), std::lround(at.y)};
  };
  const auto width = static_cast<long>(artwork.frame.width);
  const auto is_paper = [&](long i, long j) {
    return artwork.on_paper[static_cast<std::size_t>(j * width + i)] != 0;
  };
  const auto has_ink = [&](long i, long j) {
    return artwork.image.rgba[static_cast<std::size_t>(4 * (j * width + i) + 3)] != 0;
  };
  const auto [middle_i, middle_j] = pixel_of(26, 43);
  CHECK(!is_paper(middle_i, middle_j));
  CHECK(!has_ink(middle_i, middle_j));
  const auto [from_i, from_j] = pixel_of(19, 51);
  const auto [to_i, to_j] = pixel_of(33, 35);
  int beside = 0, without_ink = 0;
  for (long j = from_j; j <= to_j; ++j)
    for (long i = from_i; i <= to_i; ++i) {
      if (!is_paper(i, j) && !is_paper(i - 5, j) && !is_paper(i + 5, j) && !is_paper(i, j - 5) &&
          !is_paper(i, j + 5))
        continue;
      ++beside;
      without_ink += has_ink(i, j) ? 0 : 1;
    }
  CHECK(without_ink == 0);
  CHECK(beside > 1000);
}

TEST_CASE("a picture's outline has no hairs where it crosses cuts", "[artwork]") {
  const Painted card = painted(painted_shells()[0]);
  ArtworkOptions options;
  options.pixel_mm = 0.1;
  const Artwork trapped = artwork_of(card, options);
  options.trapping.trap_mm = 0;  // the bleed stays, so that both have the same frame
  const Artwork plain = artwork_of(card, options);
  REQUIRE(plain.frame.width == trapped.frame.width);
  REQUIRE(plain.frame.height == trapped.frame.height);
  std::size_t ink = 0, more = 0;
  for (std::size_t k = 0; k < trapped.on_paper.size(); ++k) {
    if (trapped.on_paper[k] == 0) continue;
    ink += plain.image.rgba[4 * k + 3] > 0 ? 1 : 0;
    more += plain.image.rgba[4 * k + 3] == 0 && trapped.image.rgba[4 * k + 3] > 0 ? 1 : 0;
  }
  REQUIRE(ink > 100'000);
  CAPTURE(more);
  // A stretch of the outline may run along a cut; hairs at each cut would be some 50 pixels each.
  CHECK(more < 400);
}

Plan planned(const Painted& card, const std::string& mat, bool marks) {
  const auto machine = find_machine("cameo3");
  const auto material = find_material("paper-220");
  REQUIRE(machine);
  REQUIRE(material);
  PlanOptions options;
  options.mat = mat;
  options.marks = marks;
  options.place.at = PagePoint{16, 16};
  return testing::value(plan(linework_from_pattern(card.pattern()), *machine, *material, options));
}

TEST_CASE("a glue tab carries what its partner has there", "[artwork]") {
  const Painted card = painted(painted_shells()[0]);
  ArtworkOptions options;
  options.mode = PrintMode::Surface;
  options.pixel_mm = 0.1;
  const Artwork artwork = artwork_of(card, options);
  const Plan plan = planned(card, "100x130", false);
  REQUIRE(plan.layout);
  REQUIRE(plan.layout->tabs.size() > 2);
  for (std::size_t s = 0; s < plan.sheets.size(); ++s) {
    const auto raster = testing::value(printed_sheet(artwork, plan, s, 0.1, {}));
    for (const Tab& tab : plan.layout->tabs) {
      if (plan.layout->pieces[tab.on].sheet != s) continue;
      PagePoint middle;
      for (const PagePoint& p : tab.corners) middle.x += p.x / 4, middle.y += p.y / 4;
      const PagePoint from = artwork.frame.in_pixels(middle);
      const PagePoint to = raster.frame.in_pixels(plan.layout->pieces[tab.on].transform(middle));
      const Colour want = colour_between(artwork.image, from.x, from.y);
      const Colour got = colour_between(raster.image, to.x, to.y);
      // Half a pixel of the sheet, 0.05 mm, of a paint that changes by about 8 a millimetre.
      CHECK(got.a == 255);
      CHECK_THAT(got.r, Catch::WithinAbs(want.r, 3));
      CHECK_THAT(got.g, Catch::WithinAbs(want.g, 3));
      CHECK_THAT(got.b, Catch::WithinAbs(want.b, 3));
    }
  }
}

TEST_CASE("artwork that comes too near to a registration mark is refused with the distance",
          "[artwork]") {
  const Painted card = painted(painted_shells()[0]);
  ArtworkOptions options;
  options.mode = PrintMode::Surface;
  options.pixel_mm = 0.2;
  const Artwork artwork = artwork_of(card, options);
  Plan plan = planned(card, "12x12", true);
  const auto marks = testing::value(marks_for(plan.sheets[0].area_mm));
  plan.sheets[0].registration = marks;
  CHECK(printed_sheet(artwork, plan, 0, 0.2, {}));
  // The paper's corner is at (16, 16), the square's at (15, 15); 0.7 mm nearer in both directions
  // it is 0.3 sqrt(2) mm away.
  plan.sheets[0].registration->left_mm += 0.7, plan.sheets[0].registration->top_mm += 0.7;
  const auto refused = printed_sheet(artwork, plan, 0, 0.05, {});
  REQUIRE(!refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK_THAT(refused.error().detail, Catch::Contains("comes within 0.4"));
  CHECK_THAT(refused.error().detail, Catch::Contains("move the drawing"));
}

/// Two boxes and a ball, the small ones in front; or behind.
LayeredCard layers_of(bool small_in_front) {
  const std::string x = small_in_front ? "x" : "(95-x)";
  const std::string f = "min(sqrt((" + x + "-78)^2+(y-20)^2+(z-14)^2)-14,max(abs(" + x +
                        "-20)-6,max(abs(y-45)-36,z-52)))";
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"name":"two","style":"layers","surface":{"type":"implicit","f":")" + f +
      R"("},"layers":{"layers":3,"length_mm":80}})"));
  return testing::value(layered_card(spec, {}));
}

TEST_CASE("layers are printed with what of the model stands there, and pages and tabs are bare",
          "[artwork][layers]") {
  std::array<bool, 2> looks{};
  for (const bool small_in_front : {true, false}) {
    const LayeredCard made = layers_of(small_in_front);
    looks[small_in_front ? 1 : 0] = made.looks_along_spine;
    ColourMesh model = clay_on_card(made);
    // Left of the middle it is red, for who looks at its front; right of it green.
    const ColourMesh seen = as_seen_in_front(made, model);
    model.surfacings = {{{255, 0, 0, 255}}, {{0, 255, 0, 255}}};
    for (std::uint32_t t = 0; t < model.size(); ++t) {
      const double right =
          seen.soup.corner(t, 0).y() + seen.soup.corner(t, 1).y() + seen.soup.corner(t, 2).y();
      model.surfacing_of[t] = right < 0.0 ? 0 : 1;
    }
    std::vector<DrawnPart> places;
    double x = 0.0;
    for (const SheetPart& part : made.card.parts) {
      Eigen::AlignedBox2d box;
      for (const Vec2& p : part.vertices) box.extend(p);
      places.push_back({part.name, {x, 0.0, x + box.sizes().y(), box.sizes().x()}});
      x += box.sizes().y() + 10.0;
    }
    ArtworkOptions how;
    how.pixel_mm = 0.25;
    const auto artwork = testing::value(layers_artwork(made, model, places, how));
    const PixelFrame& frame = artwork.frame;
    for (std::size_t p = 0; p < places.size(); ++p) {
      CAPTURE(small_in_front, p);
      const SheetPart& part = made.card.parts[p];
      double low = 1e9, left = 1e9;
      for (const Vec2& at : part.vertices)
        low = std::min(low, at.y()), left = std::min(left, at.x());
      std::size_t red = 0, green = 0, wrong = 0, on_tabs = 0;
      for (std::size_t j = 0; j < frame.height; ++j)
        for (std::size_t i = 0; i < frame.width; ++i) {
          const PagePoint at = frame.middle(i, j);
          const Vec2 on_sheet{at.y - places[p].box.y0 + left, at.x - places[p].box.x0 + low};
          const Box& box = places[p].box;
          if (at.x < box.x0 || at.x > box.x1 || at.y < box.y0 || at.y > box.y1) continue;
          const Colour colour = artwork.image.colour(i, j);
          if (colour.a < 128) continue;
          const bool is_paper = artwork.on_paper[j * frame.width + i] != 0;
          if (p == 0 || (is_paper && on_sheet.y() < -1.0)) ++on_tabs;
          // u runs to the right on the printed side, which looks to the front.
          if (std::abs(on_sheet.x()) < 2.0) continue;
          const bool is_red = colour.r > colour.g;
          ++(is_red ? red : green);
          wrong += is_red == (on_sheet.x() < 0.0) ? 0 : 1;
        }
      CHECK(on_tabs == 0);
      CHECK(wrong == 0);
      if (p == 0) continue;
      CHECK(red + green > 1000);
    }
    const ColourMesh card = standing_layers(made, places, artwork);
    CHECK(card.size() > 25);
    CHECK(card.st.size() == 3 * card.size());
    how.mode = PrintMode::Lines;
    CHECK_FALSE(layers_artwork(made, model, places, how));
  }
  CHECK(looks[0] != looks[1]);  // the front is at either end of the spine
}

TEST_CASE("boxes are printed with the colours of the model's sides, windows too, and tabs are bare",
          "[artwork][boxes]") {
  // Walls 60 mm long and 30 wide; a window of the x side stands 1 mm out of it.
  const std::string obj =
      "v 0 0 0\nv 30 0 0\nv 30 60 0\nv 0 60 0\nv 0 0 40\nv 30 0 40\nv 30 60 40\nv 0 60 40\n"
      "v 31 20 10\nv 31 40 10\nv 31 40 30\nv 31 20 30\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 9 10 11 12\n";
  const auto spec =
      parse_design_spec(R"({"popcut":1,"style":"boxes","surface":{"type":"mesh","file":"a.obj"}})");
  if (!spec) FAIL(message(spec.error()));
  const auto made = testing::value(boxed_card(*spec, {{"a.obj", obj}}));
  ColourMesh model = clay_on_card(made);
  // The roof red, the window blue, all else green.
  model.surfacings = {{{0, 255, 0, 255}}, {{255, 0, 0, 255}}, {{0, 0, 255, 255}}};
  double window_x = 0.0;
  for (std::uint32_t t = 0; t < model.size(); ++t) {
    double least_z = 1e9, least_x = 1e9;
    for (std::size_t k = 0; k < 3; ++k)
      least_z = std::min(least_z, model.soup.corner(t, k).z()),
      least_x = std::min(least_x, model.soup.corner(t, k).x());
    model.surfacing_of[t] = least_z > 39.9 ? 1 : least_x > 15.5 ? 2 : 0;
    if (model.surfacing_of[t] == 2) window_x = least_x;
  }
  CHECK(window_x > 15.5);
  std::vector<DrawnPart> places;
  double x = 0.0;
  for (const SheetPart& part : made.card.parts) {
    Eigen::AlignedBox2d box;
    for (const Vec2& p : part.vertices) box.extend(p);
    places.push_back({part.name, {x, 0.0, x + box.sizes().y(), box.sizes().x()}});
    x += box.sizes().y() + 10.0;
  }
  ArtworkOptions how;
  how.pixel_mm = 0.25;
  how.trapping = {0.0, 0.0};
  const auto artwork = testing::value(boxes_artwork(made, model, places, how));
  std::array<std::array<std::size_t, 4>, 4> pixels{};  // red, green, blue, bare; of each part
  for (std::size_t j = 0; j < artwork.frame.height; ++j)
    for (std::size_t i = 0; i < artwork.frame.width; ++i) {
      const PagePoint at = artwork.frame.middle(i, j);
      if (artwork.on_paper[j * artwork.frame.width + i] == 0) continue;
      for (std::size_t p = 0; p < places.size(); ++p) {
        const Box& box = places[p].box;
        if (at.x < box.x0 || at.x > box.x1 || at.y < box.y0 || at.y > box.y1) continue;
        const Colour colour = artwork.image.colour(i, j);
        ++pixels[p][colour.a < 128 ? 3 : colour.r > 128 ? 0 : colour.g > 128 ? 1 : 2];
      }
    }
  REQUIRE(places.size() == 4);  // pages, walls, lid, the wall inside
  const auto mm2 = [&](std::size_t part, std::size_t colour) {
    return how.pixel_mm * how.pixel_mm * static_cast<double>(pixels[part][colour]);
  };
  for (const std::size_t bare : {0U, 3U})
    CHECK(pixels[bare][0] + pixels[bare][1] + pixels[bare][2] == 0);
  CHECK(mm2(1, 2) == Approx(20.0 * 20.0).epsilon(0.15));           // the window
  CHECK(mm2(1, 1) == Approx(180.0 * 40.0 - 400.0).epsilon(0.05));  // the walls
  CHECK(mm2(2, 0) == Approx(30.0 * 60.0).epsilon(0.05));           // the roof
  CHECK(mm2(1, 3) > 100.0);                                        // tabs
  const ColourMesh card = standing_boxes(made, places, artwork);
  CHECK(card.size() == 22);  // two pages and nine panels, without tabs
  CHECK(card.st.size() == 3 * card.size());
  how.mode = PrintMode::Flat;
  CHECK_FALSE(boxes_artwork(made, model, places, how));
}

}  // namespace
}  // namespace popcut
