// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/spec/spec.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/picture/ghost.hpp"
#include "core/picture/poster.hpp"
#include "core/picture/sheet_picture.hpp"
#include "core/picture/slabs.hpp"
#include "core/picture/target_on_sheet.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/random_lattice.hpp"
#include "tests/support/value.hpp"

namespace pictures_test {

using namespace popcut;
using Catch::WithinAbs;
using testing::box_card_pattern;

namespace {

constexpr double kPi = std::numbers::pi;

/// Looks at an opened card as pictures do: coordinates to the right, up and towards the eye.
struct Look {
  Vec3 right, up, eye;

  explicit Look(double psi_rad) {
    const double a = View{}.azimuth_rad, e = std::min(psi_rad / 2, 0.55);
    right = {-std::sin(a), std::cos(a), 0};
    up = {-std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a), std::cos(e)};
    eye = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  }
  [[nodiscard]] Vec3 operator()(const PatternVertex& p, double psi_rad) const {
    const Vec3 at = vec3(posed(p, psi_rad));
    return {dot(right, at), dot(up, at), dot(eye, at)};
  }
};

using Seen = std::array<Vec3, 4>;  // a rectangle as it is seen

/// How near a seen parallelogram is at (x, y), if it is there, well within its edges.
std::optional<double> nearness(const Seen& quad, double x, double y) {
  const Vec3 a = quad[1] - quad[0], b = quad[3] - quad[0];
  const double area = a[0] * b[1] - a[1] * b[0];
  if (std::abs(area) < 1e-9) return std::nullopt;
  const double px = x - quad[0][0], py = y - quad[0][1];
  const double s = (px * b[1] - py * b[0]) / area, t = (a[0] * py - a[1] * px) / area;
  if (s < 1e-6 || t < 1e-6 || s > 1 - 1e-6 || t > 1 - 1e-6) return std::nullopt;
  return quad[0][2] + s * a[2] + t * b[2];
}

/// All that is painted, in its order.
std::vector<Seen> painted(const Slabs& slabs, double psi_rad) {
  const Look look(psi_rad);
  std::vector<Seen> out;
  for (const Slab& slab : slabs.slabs)
    for (const auto& panels : {slab.holes(), slab.panels})
      for (const SlabPanel& panel : panels) {
        Seen& quad = out.emplace_back();
        const auto corners = panel.corners(slab.low_mm, slab.high_mm);
        for (std::size_t k = 0; k < 4; ++k) quad[k] = look(corners[k], psi_rad);
      }
  return out;
}

/// At random points, what is painted last is the nearest of all that is there.
void check_order(const Slabs& slabs, double psi_rad, std::mt19937& random) {
  CAPTURE(psi_rad);
  const std::vector<Seen> order = painted(slabs, psi_rad);
  Eigen::AlignedBox2d frame;
  for (const Seen& quad : order)
    for (const Vec3& p : quad) frame.extend(Vec2{p[0], p[1]});
  int hits = 0;
  for (int n = 0; n < 150; ++n) {
    std::uniform_real_distribution<double> across(frame.min()[0], frame.max()[0]);
    std::uniform_real_distribution<double> upwards(frame.min()[1], frame.max()[1]);
    const double x = across(random), y = upwards(random);
    double nearest = -std::numeric_limits<double>::infinity(), last = nearest;
    for (const Seen& quad : order)
      if (const auto near = nearness(quad, x, y)) nearest = std::max(nearest, *near), last = *near;
    if (!std::isfinite(nearest)) continue;
    ++hits;
    CAPTURE(x, y);
    REQUIRE_THAT(last, WithinAbs(nearest, 1e-6));
  }
  CHECK(hits > 20);
}

TriangleSoup soup_of(const TriangleMesh& mesh, bool turned) {
  TriangleSoup out;
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const auto at = [&](std::size_t k) {
      const float* p = mesh.corners.data() + 9 * t + 3 * k;
      return Vec3{p[0], p[1], p[2]};
    };
    turned ? out.add(at(0), at(2), at(1)) : out.add(at(0), at(1), at(2));
  }
  return out;
}

std::string svg_of(const CardScene& scene, double psi_rad, const View& view = {}) {
  std::ostringstream out;
  write_deployed_svg(scene, psi_rad, view, out);
  return out.str();
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("no panel is painted over one that is before it", "[core][picture]") {
  std::mt19937 random(20);
  int designs = 0;
  for (int i = 0; i < 40 && designs < 5; ++i) {
    const std::string text = testing::random_lattice_spec(random);
    const auto made = design(testing::value(parse_design_spec(text)));
    if (!made) continue;
    ++designs;
    INFO(text);
    const Slabs slabs = cut_into_slabs(made->pattern, 100'000);
    for (const double psi : {kPi, 2.2, kPi / 2, 0.7}) check_order(slabs, psi, random);
    check_order(cut_into_slabs(made->pattern, 60), kPi / 2, random);
  }
  CHECK(designs == 5);
}

TEST_CASE("what was cut out of wall and ground is a hole and nothing else is", "[core][picture]") {
  const Slabs slabs = cut_into_slabs(box_card_pattern(), 1000);
  REQUIRE(slabs.slabs.size() == 3);
  CHECK(slabs.slabs[0].holes().empty());
  CHECK(slabs.slabs[2].holes().empty());
  const auto holes = slabs.slabs[1].holes();
  REQUIRE(holes.size() == 2);
  CHECK(holes[0].low_a.z == Approx(24.5));
  CHECK(holes[0].low_b.z == 0);
  CHECK(holes[1].high_b.x == Approx(13.3));
  const std::string svg = svg_of(card_scene(box_card_pattern()), kPi / 2);
  CHECK(has(svg, "fill=\"#38322d\""));
  CHECK(has(svg, "fill=\"#4a423b\""));
}

TEST_CASE("a pattern of many panels is drawn coarser and the picture says so", "[core][picture]") {
  const Pattern pattern = testing::row_of_boxes(3000);
  const CardScene scene = card_scene(pattern, {.most_panels = 500});
  CHECK(scene.slabs.every_strip > 1);
  std::size_t panels = 0;
  double at = 0;
  for (const Slab& slab : scene.slabs.slabs) {
    CHECK(slab.low_mm == at);
    at = slab.high_mm;
    panels += slab.panels.size();
  }
  CHECK(at == pattern.width_mm);
  CHECK(panels > 100);
  CHECK(panels < 1000);
  CHECK(has(svg_of(scene, kPi / 2, {.labels = Labels::All}), "drawn coarser than it is"));
  CHECK_FALSE(
      has(svg_of(card_scene(box_card_pattern()), kPi / 2, {.labels = Labels::All}), "coarser"));

  // Steps of one staircase become fewer, between the same ends.
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"name":"s","surface":{"type":"revolution","radius":"50"},"min_panel_mm":0.1,
          "units_per_slice":24,"slices":4,"widths_mm":8,"lattice":"slices"})"));
  const auto made = testing::value(design(spec));
  const Slabs fine = cut_into_slabs(made.pattern, 10'000);
  const Slabs thin = cut_into_slabs(made.pattern, 60);
  CHECK(thin.every_step > 1);
  const auto largest = [](const Slabs& slabs) {
    double x = 0;
    for (const Slab& slab : slabs.slabs)
      for (const SlabPanel& panel : slab.panels)
        if (panel.place == PanelPlace::Structure) x = std::max(x, panel.low_b.x);
    return x;
  };
  CHECK(largest(thin) == Approx(largest(fine)));
}

TEST_CASE("a ghost is cut just where it goes through the paper", "[core][picture]") {
  const Slabs slabs = cut_into_slabs(box_card_pattern(), 1000);
  // A plane through the box of 24.5 mm by 13.3 mm over v = 20..45, and beyond the card's ends.
  TriangleSoup plane;
  plane.add({0, -10, 30}, {20, -10, 0}, {20, 90, 0}, {0, 90, 30});
  const Look look(kPi / 2);
  const auto ghost = ghost_slabs(plane, slabs.slabs, look.eye, look.eye, 3000);
  REQUIRE(ghost.size() == 5);
  double area = 0;
  const auto add_area = [&](const GhostPolygon& polygon) {
    for (std::size_t k = 2; k < polygon.corners.size(); ++k) {
      const Vec3 a = polygon.corners[k - 1] - polygon.corners[0];
      const Vec3 b = polygon.corners[k] - polygon.corners[0];
      area += 0.5 * norm(Vec3(cross(a, b)));
    }
  };
  const auto is_within = [](const Vec3& p) { return p[0] < 13.3 + 1e-9 && p[2] < 24.5 + 1e-9; };
  for (const GhostSlab& slab : ghost) {
    for (const GhostPolygon& polygon : slab.inside) {
      add_area(polygon);
      CHECK(std::all_of(polygon.corners.begin(), polygon.corners.end(), is_within));
    }
    for (const GhostPolygon& polygon : slab.outside) {
      add_area(polygon);
      Vec3 middle = Vec3::Zero();
      for (const Vec3& p : polygon.corners)
        middle += p / static_cast<double>(polygon.corners.size());
      const bool is_at_box = middle[1] > 20 && middle[1] < 45;
      CHECK_FALSE((is_at_box && is_within(middle)));
    }
  }
  CHECK_THAT(area, WithinAbs(100 * std::hypot(20, 30), 1e-6));
  CHECK_FALSE(ghost[2].inside.empty());
  CHECK(ghost[1].inside.empty());
  CHECK(ghost[0].outside.size() + ghost[4].outside.size() >= 2);
}

TEST_CASE("a target of many triangles is coarsened and still looks out", "[core][picture]") {
  const auto ball = testing::icosphere(30, 5);  // 20 480 triangles
  for (const bool turned : {false, true}) {
    const CoarseTarget coarse = coarse_target(soup_of(ball, turned), 2000);
    CHECK(coarse.corners.size() <= 2000);
    CHECK(coarse.corners.size() > 300);
    for (std::size_t t = 0; t < coarse.corners.size(); ++t) {
      const Vec3 middle = (coarse.corners[t][0] + coarse.corners[t][1] + coarse.corners[t][2]) / 3;
      REQUIRE(norm(middle) > 28);
      REQUIRE(norm(middle) < 30);
      REQUIRE(dot(coarse.normal[t], middle) > 0.9 * norm(middle));
    }
  }
}

TEST_CASE("the target of every kind looks out of the corner in a picture", "[core][picture]") {
  for (const char* surface :
       {R"({"type":"revolution","radius":"40"})", R"({"type":"profile","z":"40 - x"})",
        R"({"type":"implicit","f":"x^2 + z^2 - 1600"})"}) {
    CAPTURE(surface);
    const auto spec = testing::value(parse_design_spec(
        std::string(R"({"popcut":1,"name":"t","units_per_slice":4,"slices":5,"widths_mm":8,)") +
        R"("surface":)" + surface + "}"));
    const auto made = testing::value(design(spec));
    const TriangleSoup target = target_on_sheet(made, true);
    REQUIRE(target.size() > 0);
    const CoarseTarget coarse = coarse_target(target, 3000);
    REQUIRE_FALSE(coarse.normal.empty());
    for (const Vec3& normal : coarse.normal) REQUIRE(normal[0] + normal[2] > 0.9);
    double low = 1e9, high = -1e9;
    for (const auto& corners : coarse.corners)
      for (const Vec3& p : corners) low = std::min(low, p[1]), high = std::max(high, p[1]);
    CHECK(low >= made.strips.v_begin[1] - 1);  // from the first strip to the last
    CHECK(high <= made.strips.v_begin[made.strips.size() - 1] + 1);
    const std::string svg = svg_of(card_scene(made.pattern, {.ghost = &target}), kPi / 2);
    CHECK(has(svg, "fill-opacity"));
    CHECK_FALSE(has(svg_of(card_scene(made.pattern, {.ghost = &target}), 2.0), "fill-opacity"));
  }
}

TEST_CASE("panels have the colour of their mean distance from the target", "[core][picture]") {
  const Pattern card = box_card_pattern();
  TriangleSoup lid;  // as high as the box's top
  lid.add({-100, -100, 24.5}, {100, -100, 24.5}, {100, 200, 24.5}, {-100, 200, 24.5});
  const CardScene scene = card_scene(card, {.target = &lid});
  REQUIRE(scene.error_mm.size() == 3);
  const Slab& box = scene.slabs.slabs[1];
  for (std::size_t p = 0; p < box.panels.size(); ++p) {
    const SlabPanel& panel = box.panels[p];
    if (panel.place != PanelPlace::Structure)
      CHECK(scene.error_mm[1][p] == 0);
    else
      CHECK_THAT(scene.error_mm[1][p], WithinAbs(panel.is_upright ? 24.5 / 2 : 0.0, 1e-9));
  }
  CHECK(scene.largest_error_mm == Approx(24.5 / 2));
  const std::string svg = svg_of(scene, kPi / 2, {.labels = Labels::All});
  CHECK(has(svg, "mean distance from the shape"));
  CHECK(has(svg, ">12 mm<"));
  std::ostringstream poster;
  REQUIRE(write_poster_svg(card, std::vector<double>{kPi, kPi / 2}, {.scene = {.target = &lid}},
                           poster));
  CHECK(has(poster.str(), "mean distance from the shape"));
}

TEST_CASE("pictures give the card's size and a bar of round millimetres", "[core][picture]") {
  const std::string svg = svg_of(card_scene(box_card_pattern()), kPi / 2, {.labels = Labels::All});
  CHECK(has(svg, "wall 40 x 70 mm, ground 30 x 70 mm, opened to 90\u00b0"));
  for (const char* length : {">40 mm<", ">30 mm<", ">70 mm<", ">20 mm<"}) {
    CAPTURE(length);
    CHECK(has(svg, length));
  }
  std::ostringstream sheet;
  write_sheet_picture(box_card_pattern(), sheet);
  CHECK(has(sheet.str(), "70 x 70 mm"));
  CHECK(has(sheet.str(), ">20 mm<"));
  CHECK(has(sheet.str(), "stroke-dasharray"));
}

}  // namespace pictures_test
