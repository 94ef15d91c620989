// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/design/outline/area.hpp"
#include "core/design/outline/drawing_outline.hpp"
#include "core/design/outline/extrusion.hpp"
#include "core/design/outline/text_outline.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface.hpp"
#include "core/fit/triangle_soup.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"

namespace outline_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

Ring box(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

double area_of(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

double area_of(const std::vector<Area>& areas) {
  double sum = 0.0;
  for (const Area& area : areas) {
    sum += area_of(area.outline);
    for (const Ring& hole : area.holes) sum += area_of(hole);  // clockwise: less than 0
  }
  return sum;
}

std::size_t holes_of(const std::vector<Area>& areas) {
  std::size_t sum = 0;
  for (const Area& area : areas) sum += area.holes.size();
  return sum;
}

/// Volume of a closed mesh by the divergence theorem; less than 0 where it is inside out.
double volume_of(const std::vector<float>& corners) {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners.size(); k += 9) {
    const auto corner = [&](std::size_t c) {
      return Vec3(corners[k + 3 * c], corners[k + 3 * c + 1], corners[k + 3 * c + 2]);
    };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return sum;
}

/// Sides of triangles that no other triangle has in the other direction.
std::size_t open_sides(const std::vector<float>& corners) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> sides;
  for (std::size_t k = 0; k < corners.size(); k += 9)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](std::size_t i) {
        const float* p = &corners[k + 3 * (i % 3)];
        return Point{p[0], p[1], p[2]};
      };
      const Point a = at(c), b = at(c + 1);
      ++sides[{a, b}];
      --sides[{b, a}];
    }
  std::size_t open = 0;
  for (const auto& [side, count] : sides) open += count != 0 ? 1 : 0;
  return open;
}

TEST_CASE("a ring within a ring is a hole, and rings over each other are one piece", "[outline]") {
  const std::vector<Ring> frame{box(0, 0, 10, 10), box(2, 3, 4, 5)};
  const auto even = areas_within(frame, FillRule::EvenOdd);
  REQUIRE(even);
  REQUIRE(even->size() == 1);
  CHECK(holes_of(*even) == 1);
  CHECK(area_of(*even) == Approx(80.0).margin(1e-3));
  const auto all = areas_within(frame, FillRule::NonZero);
  REQUIRE(all);
  CHECK(holes_of(*all) == 0);
  CHECK(area_of(*all) == Approx(100.0).margin(1e-3));
  const auto joined = areas_within({box(0, 0, 10, 10), box(5, 5, 10, 10)}, FillRule::NonZero);
  REQUIRE(joined);
  CHECK(joined->size() == 1);
  CHECK(area_of(*joined) == Approx(175.0).margin(1e-3));
}

TEST_CASE("lines without an area are refused", "[outline]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(areas_within({}, FillRule::NonZero).error().kind == ErrorKind::Infeasible);
  CHECK(areas_within({{{0, 0}, {5, 0}}}, FillRule::NonZero).error().kind == ErrorKind::Infeasible);
  CHECK(areas_within({{{0, 0}, {5, 5}, {2, 2}}}, FillRule::EvenOdd).error().kind ==
        ErrorKind::Infeasible);
  CHECK(areas_within({{{0, 0}, {nan, 0}, {1, 1}}}, FillRule::NonZero).error().kind ==
        ErrorKind::OutOfRange);
  CHECK(areas_within({Ring(kMostRingPoints + 1, Vec2(1, 2))}, FillRule::NonZero).error().reason ==
        ErrorReason::TooMuch);
}

TEST_CASE("a smooth outline of very many points keeps only those that show", "[outline]") {
  Ring disc;
  for (int k = 0; k < 100'000; ++k) {
    const double at = 2 * std::numbers::pi * k / 100'000;
    disc.emplace_back(50 * std::cos(at), 50 * std::sin(at));
  }
  const auto areas = areas_within({disc}, FillRule::EvenOdd);
  REQUIRE(areas);
  REQUIRE(areas->size() == 1);
  const Ring& outline = areas->front().outline;
  CHECK(outline.size() < 2000);
  CHECK(area_of(outline) == Approx(std::numbers::pi * 2500).epsilon(1e-4));
  for (const Vec2& p : outline) CHECK(p.norm() == Approx(50).margin(1e-3));
}

TEST_CASE("shapes with any holes become closed solids of the right volume", "[outline]") {
  std::mt19937 random(20261125);
  for (int round = 0; round < testing::rounds(200); ++round) {
    // A star, and squares in the cells of a grid that lie well within it.
    std::vector<Ring> rings(1);
    const int corners = whole(random, 5, 40);
    double least = 100.0;
    for (int k = 0; k < corners; ++k) {
      const double radius = uniform(random, 40.0, 60.0);
      const double turn = 2.0 * std::numbers::pi * k / corners;
      rings[0].emplace_back(radius * std::cos(turn), radius * std::sin(turn));
      least = std::min(least, radius);
    }
    const double within = 0.5 * least * std::cos(std::numbers::pi / corners);
    const int cells = whole(random, 1, 6);
    const double cell = 2.0 * within / 1.5 / cells;
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        if (uniform(random, 0.0, 1.0) < 0.3) continue;
        const double size = uniform(random, 0.2, 0.9) * cell;
        rings.push_back(box((i - 0.5 * cells) * cell, (j - 0.5 * cells) * cell, size, size));
      }
    CAPTURE(round, rings.size());
    const auto areas = areas_within(rings, FillRule::EvenOdd);
    REQUIRE(areas);
    CHECK(holes_of(*areas) == rings.size() - 1);
    const auto solid = extruded(*areas, 7.0);
    REQUIRE(solid);
    CHECK(open_sides(*solid) == 0);
    CHECK(volume_of(*solid) == Approx(7.0 * area_of(*areas)).epsilon(1e-4));
  }
}

TEST_CASE("letters stand side by side, with their counters as holes", "[outline]") {
  const auto areas = text_areas("POPCUT", usual_font(), 30.0);
  REQUIRE(areas);
  CHECK(areas->size() == 6);
  CHECK(holes_of(*areas) == 3);  // P, O, P
  Eigen::AlignedBox2d size;
  for (const Area& area : *areas)
    for (const Vec2& p : area.outline) size.extend(p);
  CHECK(size.min().norm() == Approx(0.0).margin(1e-3));
  // Round letters reach a little over the capitals' height and below the line.
  CHECK(size.max()[1] > 30.0);
  CHECK(size.max()[1] < 31.5);
  CHECK(size.max()[0] > 120.0);
  const auto half = text_areas("POPCUT", usual_font(), 15.0);
  REQUIRE(half);
  CHECK(area_of(*half) == Approx(0.25 * area_of(*areas)).epsilon(1e-3));
  CHECK(open_sides(*extruded(*areas, 15.0)) == 0);
}

TEST_CASE("scripts are shaped: accents are set, and Arabic letters join", "[outline]") {
  CHECK(text_areas("i", usual_font(), 30.0)->size() == 2);
  CHECK(text_areas("e\u0301", usual_font(), 30.0)->size() == 2);  // an accent that is added
  CHECK(text_areas("\u0627", usual_font(), 30.0)->size() == 1);
  // Seen, lam and the end of meem join, alef with lam: four letters in fewer pieces.
  const auto salaam = text_areas("\u0633\u0644\u0627\u0645", usual_font(), 30.0);
  REQUIRE(salaam);
  CHECK(salaam->size() == 2);
}

TEST_CASE("text that cannot be set is refused in one line", "[outline]") {
  const auto why = [](const std::string& text, std::string_view font = usual_font()) {
    const auto areas = text_areas(text, font, 30.0);
    REQUIRE_FALSE(areas);
    return message(areas.error());
  };
  using Catch::Contains;
  CHECK_THAT(why("\u3042"), Contains("the font has no \"\u3042\" (U+3042)"));
  CHECK_THAT(why(""), Contains("has no letter"));
  CHECK_THAT(why("   "), Contains("has no letter"));
  CHECK_THAT(why("a\nb"), Contains("line break"));
  CHECK_THAT(why("a\xFF"), Contains("UTF-8"));
  CHECK_THAT(why(std::string(201, 'a')), Contains("201 letters"));
  CHECK_THAT(why("abc \u05D0"), Contains("both directions"));
  CHECK_THAT(why("A", ""), Contains("no font"));
  CHECK_THAT(why("A", "not a font"), Contains("no font"));
}

TEST_CASE("a font that is cut off or changed is refused or read, never a crash", "[outline]") {
  std::mt19937 random(7);
  const std::string whole_font(usual_font());
  for (int round = 0; round < testing::rounds(60); ++round) {
    std::string font = whole_font;
    if (round % 2 == 0) font.resize(static_cast<std::size_t>(uniform(random, 0, 1) * 700'000));
    for (int k = 0; k < 20 && !font.empty(); ++k) {
      const auto reach =
          static_cast<double>(k < 15 ? std::min<std::size_t>(font.size(), 3000) : font.size());
      font[static_cast<std::size_t>(uniform(random, 0, 1) * (reach - 1))] =
          static_cast<char>(whole(random, 0, 255));
    }
    const auto areas = text_areas("Pop\u00FC", font, 30.0);
    if (!areas) CHECK_FALSE(areas.error().detail.empty());
  }
}

TEST_CASE("the filled shapes and closed lines of a drawing stand upright", "[outline]") {
  const std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='40mm' viewBox='0 0 60 40'>"
      "<path fill='#a00' d='M5 5h40v30h-40z M15 15v10h10v-10z'/>"
      "<path stroke='black' fill='none' d='M50 5 L58 5'/></svg>";
  const auto areas = drawing_areas(svg, {});
  REQUIRE(areas);
  REQUIRE(areas->size() == 1);
  CHECK(holes_of(*areas) == 1);
  CHECK(area_of(*areas) == Approx(1100.0).epsilon(1e-4));
  // Up is up: the hole lies 10 mm below the upper edge and 10 mm right of the left one.
  CHECK((*areas)[0].holes[0].size() == 4);
  Eigen::AlignedBox2d hole;
  for (const Vec2& p : (*areas)[0].holes[0]) hole.extend(p);
  CHECK((hole.min() - Vec2(10.0, 10.0)).norm() < 1e-3);
  CHECK(area_of(*drawing_areas(svg, 15.0)) == Approx(275.0).epsilon(1e-4));
  CHECK(drawing_areas("<svg xmlns='http://www.w3.org/2000/svg'/>", {}).error().kind !=
        ErrorKind::Internal);
  CHECK_FALSE(drawing_areas("", {}));
  CHECK_FALSE(drawing_areas("solid x", {}));
}

TEST_CASE("a text is a surface that begins and ends along the spine", "[outline]") {
  const auto surface = Surface::make(TextSpec{"HI", "", 40.0, 12.0}, {}, FitMode::Nearest);
  REQUIRE(surface);
  const TriangleSoup soup = surface->triangles({});
  REQUIRE(soup.size() > 0);
  double high = 0.0, front = 0.0;
  for (std::size_t k = 0; k < soup.corners.size(); k += 3) {
    front = std::max(front, soup.corners[k]);
    high = std::max(high, soup.corners[k + 2]);
  }
  CHECK(front == Approx(12.0));
  CHECK(high == Approx(40.0).epsilon(1e-3));
  const auto curve = surface->slice(5.0);  // through the stem of the H
  REQUIRE(curve);
  CHECK(curve->h() == Approx(40.0).epsilon(1e-3));
  CHECK(curve->d() == Approx(12.0).epsilon(1e-3));
  const Error absent =
      Surface::make(TextSpec{"HI", "mine.ttf", 40.0, 12.0}, {}, FitMode::Nearest).error();
  CHECK(absent.place == "/surface/font");
  const Error glyph =
      Surface::make(TextSpec{"\u3042", "", 40.0, 12.0}, {}, FitMode::Nearest).error();
  CHECK(glyph.place == "/surface/text");
}

TEST_CASE("a spec of a text names what is wrong with it", "[outline]") {
  const auto why = [](const std::string& surface) {
    const auto spec =
        parse_design_spec(R"({"popcut": 1, "style": "facets", "surface": )" + surface + "}");
    return spec ? std::string() : message(spec.error());
  };
  CHECK(why(R"({"type": "text", "text": "POPCUT"})").empty());
  CHECK(why(R"({"type": "outline", "file": "heart.svg", "height": 50, "depth": 20})").empty());
  CHECK_THAT(why(R"({"type": "text"})"), Catch::Contains("/surface/text"));
  CHECK_THAT(why(R"({"type": "text", "text": 5})"), Catch::Contains("/surface/text"));
  CHECK_THAT(why(R"({"type": "text", "text": "A", "height": 0})"),
             Catch::Contains("/surface/height"));
  CHECK_THAT(why(R"({"type": "outline"})"), Catch::Contains("/surface/file"));
}

}  // namespace outline_test
