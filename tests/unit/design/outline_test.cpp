// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/design/outline/area.hpp"
#include "core/design/outline/bridges.hpp"
#include "core/design/outline/drawing_outline.hpp"
#include "core/design/outline/extrusion.hpp"
#include "core/design/outline/text_outline.hpp"
#include "core/design/patches.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/sweep_triangles.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/value.hpp"

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
  const auto even = testing::value(areas_within(frame, FillRule::EvenOdd));
  REQUIRE(even.size() == 1);
  CHECK(holes_of(even) == 1);
  CHECK(area_of(even) == Approx(80.0).margin(1e-3));
  const auto all = testing::value(areas_within(frame, FillRule::NonZero));
  CHECK(holes_of(all) == 0);
  CHECK(area_of(all) == Approx(100.0).margin(1e-3));
  const auto joined =
      testing::value(areas_within({box(0, 0, 10, 10), box(5, 5, 10, 10)}, FillRule::NonZero));
  CHECK(joined.size() == 1);
  CHECK(area_of(joined) == Approx(175.0).margin(1e-3));
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
  const auto areas = testing::value(areas_within({disc}, FillRule::EvenOdd));
  REQUIRE(areas.size() == 1);
  const Ring& outline = areas.front().outline;
  CHECK(outline.size() < 2000);
  CHECK(area_of(outline) == Approx(std::numbers::pi * 2500).epsilon(1e-4));
  for (const Vec2& p : outline) CHECK(p.norm() == Approx(50).margin(1e-3));
}

/// Exact figures of triangles on a grid.
struct WholeFigures {
  std::int64_t twice{};
  bool all_left{true};  ///< each turns left
};
WholeFigures figures_of(const std::vector<WholePoint>& points, const std::vector<Triangle>& all) {
  WholeFigures out;
  for (const auto& [a, b, c] : all) {
    const WholePoint &p = points[a], &q = points[b], &r = points[c];
    const std::int64_t twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    out.twice += twice;
    out.all_left = out.all_left && twice > 0;
  }
  return out;
}

TEST_CASE("the sweep fills lines that touch along sides and at corners, and nothing else",
          "[outline]") {
  std::mt19937 random(20261126);
  for (int round = 0; round < testing::rounds(400); ++round) {
    // Cells of a slanted grid, each a line of its own: sides of neighbours lie over each other.
    // Blocks of several cells put corners on sides, and blocks on blocks take their cells away.
    constexpr std::int64_t kCells = 7;
    std::array<std::array<bool, kCells>, kCells> chosen{};
    const std::int64_t a = whole(random, 1, 5), b = whole(random, -4, 4), c = whole(random, -4, 4);
    const std::int64_t d = whole(random, 0, 1) * (b * c / a + 1) + whole(random, 1, 5);
    const std::int64_t step = a * d - b * c;
    if (step == 0) continue;
    std::vector<WholePoint> points;
    std::vector<std::uint32_t> ends;
    const auto add = [&](std::int64_t i, std::int64_t j) {
      points.push_back({a * i + b * j, c * i + d * j});
    };
    for (int n = 0; n < 12; ++n) {
      const int i = whole(random, 0, 6), j = whole(random, 0, 6);
      const bool is_cell = whole(random, 0, 3) > 0;
      const int wide = is_cell ? 1 : std::min<int>(kCells - i, whole(random, 1, 3));
      // Blocks that share no inner line with others do not cross them: a column or a cell.
      add(i, j), add(i + wide, j), add(i + wide, j + 1), add(i, j + 1);
      ends.push_back(static_cast<std::uint32_t>(points.size()));
      for (int k = i; k < i + wide; ++k)
        chosen[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] ^= true;
    }
    std::int64_t cells = 0;
    for (const auto& column : chosen)
      for (const bool inside : column) cells += inside ? 1 : 0;
    CAPTURE(round, a, b, c, d);
    const auto triangles = testing::value(sweep_triangles(points, ends));
    const WholeFigures figures = figures_of(points, triangles);
    CHECK(figures.all_left);
    CHECK(figures.twice == 2 * cells * std::abs(step));
    for (const auto& [p, q, r] : triangles) {  // the middle of each is in a cell that was chosen
      const std::int64_t x = points[p].x + points[q].x + points[r].x;
      const std::int64_t y = points[p].y + points[q].y + points[r].y;
      const double i = static_cast<double>(d * x - b * y) / (3.0 * static_cast<double>(step));
      const double j = static_cast<double>(a * y - c * x) / (3.0 * static_cast<double>(step));
      CHECK(chosen[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
    }
  }
}

TEST_CASE("the sweep says so where sides cross", "[outline]") {
  const std::vector<WholePoint> bow{{0, 0}, {10, 10}, {10, 0}, {0, 10}};
  const std::vector<std::uint32_t> whole_line{4};
  CHECK_FALSE(sweep_triangles(bow, whole_line));
  // The same with a corner where they meet is two triangles.
  const std::vector<WholePoint> met{{0, 0}, {5, 5}, {10, 10}, {10, 0}, {5, 5}, {0, 10}};
  const std::vector<std::uint32_t> all{6};
  const auto triangles = testing::value(sweep_triangles(met, all));
  CHECK(figures_of(met, triangles).twice == 100);
  CHECK(sweep_triangles({}, {})->empty());
}

/// A ring of `n` points whose distance from the middle jumps from each to the next.
Ring jagged(int n, std::mt19937& random) {
  Ring ring;
  for (int k = 0; k < n; ++k) {
    const double at = 2 * std::numbers::pi * k / n, radius = uniform(random, 30.0, 50.0);
    ring.emplace_back(radius * std::cos(at), radius * std::sin(at));
  }
  return ring;
}

TEST_CASE("a jagged outline of twice the points is a solid in about twice the time", "[outline]") {
  std::mt19937 random(9);
  const int points = testing::rounds(50'000, 10);
  const Ring once = jagged(points, random), twice = jagged(2 * points, random);
  const auto solid_of = [](const Ring& ring) {
    const auto areas = testing::value(areas_within({ring}, FillRule::EvenOdd));
    const auto solid = extruded(areas, 5.0);
    const double sum = area_of(areas);
    CHECK(sum == Approx(std::abs(area_of(ring))).epsilon(1e-3));
    CHECK(volume_of(solid) == Approx(5.0 * sum).epsilon(1e-4));
  };
  // Ear by ear it takes four times as long.
  CHECK(testing::takes_at_most(
      2.6, [&] { solid_of(twice); }, [&] { solid_of(once); }));
}

TEST_CASE("thousands of holes are as easily cut out", "[outline]") {
  const int side = testing::fewer_rounds() ? 50 : 100, holes = side * side;
  std::vector<Ring> rings{box(0, 0, side, side)};
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) rings.push_back(box(i + 0.3, j + 0.2, 0.5, 0.6));
  const auto areas = testing::value(areas_within(rings, FillRule::EvenOdd));
  REQUIRE(areas.size() == 1);
  CHECK(areas.front().triangles.size() == static_cast<std::size_t>(4 + 4 * holes + 2 * holes - 2));
  CHECK(open_sides(extruded(areas, 5.0)) == 0);
}

TEST_CASE("lines that cross everywhere are areas or refused, never a solid with holes",
          "[outline]") {
  std::mt19937 random(11);
  for (int round = 0; round < testing::rounds(60); ++round) {
    std::vector<Ring> rings(1);
    const int n = whole(random, 3, 200);
    // Few places, so that many lines meet within a step of the grid.
    const double places = round % 2 == 0 ? 1e9 : 40.0;
    for (int k = 0; k < n; ++k)
      rings[0].emplace_back(std::round(places * uniform(random, 0, 1)) / places,
                            std::round(places * uniform(random, 0, 1)) / places * 1e-2);
    const auto areas = areas_within(rings, round % 3 == 0 ? FillRule::EvenOdd : FillRule::NonZero);
    CAPTURE(round, n);
    if (!areas) {
      CHECK(areas.error().kind == ErrorKind::Infeasible);
      continue;
    }
    CHECK(volume_of(extruded(*areas, 1.0)) == Approx(area_of(*areas)).epsilon(1e-3));
  }
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
    const auto areas = testing::value(areas_within(rings, FillRule::EvenOdd));
    CHECK(holes_of(areas) == rings.size() - 1);
    const auto solid = extruded(areas, 7.0);
    CHECK(open_sides(solid) == 0);
    CHECK(volume_of(solid) == Approx(7.0 * area_of(areas)).epsilon(1e-4));
  }
}

TEST_CASE("a part that stands free in a hole gets a bridge to either side, and windows stay",
          "[outline]") {
  // A frame of 5 around a hole of 40 x 40, in it a block of 10 x 10, nearer to the right side.
  const std::vector<Ring> rings{box(0, 0, 50, 50), box(5, 5, 40, 40), box(30, 20, 10, 10)};
  const auto areas = testing::value(areas_within(rings, FillRule::EvenOdd));
  REQUIRE(areas.size() == 2);
  const auto joined = testing::value(with_bridges(areas, 3.0));
  CHECK(joined.islands == 1);
  REQUIRE(joined.areas.size() == 1);
  CHECK(holes_of(joined.areas) == 2);  // above and below the bridges
  CHECK(area_of(joined.areas) == Approx(900.0 + 100.0 + 3.0 * (25.0 + 5.0)).epsilon(1e-3));
  CHECK(open_sides(extruded(joined.areas, 5.0)) == 0);
  // Nothing that holds already is touched, and 0 means none.
  CHECK(with_bridges(areas, 0.0)->areas.size() == 2);
  const auto plain = areas_within({box(0, 0, 50, 50), box(5, 5, 40, 40)}, FillRule::EvenOdd);
  CHECK(with_bridges(*plain, 3.0)->islands == 0);
}

TEST_CASE("rings within rings are all joined, each to the next one", "[outline]") {
  std::vector<Ring> rings;
  for (int k = 0; k < 6; ++k) {  // a target: three rings with a disc of paper between
    Ring circle;
    for (int n = 0; n < 90; ++n) {
      const double turn = 2 * std::numbers::pi * n / 90, radius = 60.0 - 10.0 * k;
      circle.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
    }
    rings.push_back(std::move(circle));
  }
  const auto areas = testing::value(areas_within(rings, FillRule::EvenOdd));
  REQUIRE(areas.size() == 3);
  const auto joined = testing::value(with_bridges(areas, 4.0));
  CHECK(joined.islands == 2);
  CHECK(joined.areas.size() == 1);
  CHECK(holes_of(joined.areas) == 5);  // two half rings, twice, and the hole in the middle
  // A letter in a ring, as fonts have it.
  const auto registered = testing::value(text_areas("\u00AE", usual_font(), 30.0));
  REQUIRE(registered.size() == 2);
  CHECK(with_bridges(registered, 2.0)->areas.size() == 1);
}

TEST_CASE("letters stand side by side, with their counters as holes", "[outline]") {
  const auto areas = testing::value(text_areas("POPCUT", usual_font(), 30.0));
  CHECK(areas.size() == 6);
  CHECK(holes_of(areas) == 3);  // P, O, P
  Eigen::AlignedBox2d size;
  for (const Area& area : areas)
    for (const Vec2& p : area.outline) size.extend(p);
  CHECK(size.min().norm() == Approx(0.0).margin(1e-3));
  // Round letters reach a little over the capitals' height and below the line.
  CHECK(size.max()[1] > 30.0);
  CHECK(size.max()[1] < 31.5);
  CHECK(size.max()[0] > 120.0);
  const auto half = testing::value(text_areas("POPCUT", usual_font(), 15.0));
  CHECK(area_of(half) == Approx(0.25 * area_of(areas)).epsilon(1e-3));
  CHECK(open_sides(extruded(areas, 15.0)) == 0);
}

TEST_CASE("scripts are shaped: accents are set, and Arabic letters join", "[outline]") {
  CHECK(text_areas("i", usual_font(), 30.0)->size() == 2);
  CHECK(text_areas("e\u0301", usual_font(), 30.0)->size() == 2);  // an accent that is added
  CHECK(text_areas("\u0627", usual_font(), 30.0)->size() == 1);
  // Seen, lam and the end of meem join, alef with lam: four letters in fewer pieces.
  const auto salaam = testing::value(text_areas("\u0633\u0644\u0627\u0645", usual_font(), 30.0));
  CHECK(salaam.size() == 2);
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
  const auto areas = testing::value(drawing_areas(svg, {}));
  REQUIRE(areas.size() == 1);
  CHECK(holes_of(areas) == 1);
  CHECK(area_of(areas) == Approx(1100.0).epsilon(1e-4));
  // Up is up: the hole lies 10 mm below the upper edge and 10 mm right of the left one.
  CHECK(areas[0].holes[0].size() == 4);
  Eigen::AlignedBox2d hole;
  for (const Vec2& p : areas[0].holes[0]) hole.extend(p);
  CHECK((hole.min() - Vec2(10.0, 10.0)).norm() < 1e-3);
  CHECK(area_of(*drawing_areas(svg, 15.0)) == Approx(275.0).epsilon(1e-4));
  // Curves follow the size that the drawing gets.
  const auto round = drawing_areas(
      "<svg xmlns='http://www.w3.org/2000/svg' width='1mm' height='1mm' viewBox='0 0 1 1'>"
      "<circle cx='.5' cy='.5' r='.4'/></svg>",
      100.0);
  REQUIRE(round);
  CHECK(area_of(*round) == Approx(std::numbers::pi * 2500).epsilon(1e-3));
  CHECK(drawing_areas("<svg xmlns='http://www.w3.org/2000/svg'/>", {}).error().kind !=
        ErrorKind::Internal);
  CHECK_FALSE(drawing_areas("", {}));
  CHECK_FALSE(drawing_areas("solid x", {}));
}

TEST_CASE("a drawing that stands upright is read in any encoding, and what is none is named",
          "[outline]") {
  const std::string svg =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm"><rect width="5mm" height="4mm"/></svg>)";
  std::string wide = "\xFF\xFE";
  for (const char c : svg) wide += {c, '\0'};
  const auto areas = testing::value(drawing_areas(wide, std::nullopt));
  CHECK(areas.size() == 1);
  CHECK_THAT(drawing_areas("\x1F\x8B\x08", std::nullopt).error().detail, Catch::Contains("gunzip"));
  CHECK(drawing_areas("\x89PNG\r\n\x1A\n", std::nullopt).error().detail ==
        "is a PNG picture; give an SVG or DXF drawing");
}

TEST_CASE("white shapes of a drawing are holes in what they lie on", "[outline]") {
  const auto area = [](const std::string& inner) {
    const auto areas = testing::value(drawing_areas(
        "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='60mm' viewBox='0 0 60 60'>" +
            inner + "</svg>",
        {}));
    return area_of(areas);
  };
  const std::string black = "<rect x='5' y='5' width='50' height='50'/>";
  const std::string hole = "<rect x='10' y='10' width='10' height='10' fill='white'/>";
  CHECK(area(black + hole) == Approx(2400).epsilon(1e-4));
  CHECK(area(hole + black) == Approx(2500).epsilon(1e-4));
  CHECK(area(black + hole + "<rect x='12' y='12' width='2' height='2'/>") ==
        Approx(2404).epsilon(1e-4));
  CHECK(area(black + "<rect x='50' y='10' width='9' height='10' style='fill:#fefefe'/>") ==
        Approx(2450).epsilon(1e-4));
  CHECK(area("<rect width='60' height='60' fill='#111'/>" + hole) == Approx(3500).epsilon(1e-4));
  // Backgrounds.
  CHECK(area("<rect width='60' height='60' fill='#eee'/>" + black) == Approx(2500).epsilon(1e-4));
  CHECK(area("<rect x='1' width='58' height='59' fill='white'/>" + black) ==
        Approx(2500).epsilon(1e-4));
  CHECK_FALSE(drawing_areas("<svg xmlns='http://www.w3.org/2000/svg'>" + hole + "</svg>", {}));
}

TEST_CASE("a design from a drawing tells what its reader warns of", "[outline]") {
  const auto spec =
      testing::value(parse_design_spec(R"j({"popcut": 1, "name": "t", "style": "facets",
    "surface": {"type": "outline", "file": "a.svg", "depth": 20}})j"));
  const auto made = design_assembly(
      spec, {{"a.svg",
              "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='60mm' viewBox='0 0 60 "
              "60'><rect x='5' y='5' width='50' height='20'/><text>Ab</text><path d='M0 0h5' "
              "stroke='red'/></svg>"}});
  REQUIRE(made);
  std::vector<std::string> codes;
  for (const Warning& one : made->parts.front().report.warnings) codes.push_back(one.code);
  CHECK(std::count(codes.begin(), codes.end(), "element_unread") == 1);
  CHECK(std::count(codes.begin(), codes.end(), "open_line") == 1);
  CHECK(std::count(codes.begin(), codes.end(), "fill_cut") == 0);
}

TEST_CASE("a text is a surface that begins and ends along the spine", "[outline]") {
  const auto surface =
      testing::value(Surface::make(TextSpec{"HI", "", 40.0, 12.0}, {}, FitMode::Nearest));
  const TriangleSoup soup = surface.triangles({});
  REQUIRE(soup.size() > 0);
  double high = 0.0, front = 0.0;
  for (std::size_t k = 0; k < soup.corners.size(); k += 3) {
    front = std::max(front, soup.corners[k]);
    high = std::max(high, soup.corners[k + 2]);
  }
  CHECK(front == Approx(12.0));
  CHECK(high == Approx(40.0).epsilon(1e-3));
  const auto curve = surface.slice(5.0);  // through the stem of the H
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
