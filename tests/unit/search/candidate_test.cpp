// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/model/model.hpp"
#include "core/search/book_standing.hpp"
#include "core/search/candidate.hpp"
#include "core/search/coarse_mesh.hpp"
#include "core/search/mesh_faults.hpp"
#include "core/search/seen_share.hpp"
#include "core/search/standing.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/value.hpp"

namespace candidate_test {

using namespace popcut;
using namespace popcut::testing;
using Catch::WithinAbs;

namespace {

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  a.corners.insert(a.corners.end(), b.corners.begin(), b.corners.end());
  return a;
}

}  // namespace

TEST_CASE("the same seed draws the same candidates, each of its style", "[search]") {
  const StyleChoice& any = style_choices().front();
  REQUIRE(any.name == "any");
  std::set<std::string> styles;
  std::set<std::size_t> ways;
  for (std::uint64_t k = 0; k < 300; ++k) {
    const Candidate one = drawn_candidate(any, 1, 4, 11, k);
    CHECK(one == drawn_candidate(any, 1, 4, 11, k));
    styles.emplace(style_name(one));
    ways.insert(one.way);
    const Candidate changed = changed_candidate(one, 4, 11, 1000 + k);
    CHECK(changed == changed_candidate(one, 4, 11, 1000 + k));
    CHECK(changed.style == one.style);
    CHECK_FALSE(changed.usual);
  }
  CHECK(styles == std::set<std::string>{"facets", "silhouette", "slices", "branching", "levels",
                                        "conformal", "direct"});
  CHECK(ways == std::set<std::size_t>{0, 1, 2, 3});
  for (const StyleChoice& choice : style_choices())
    if (choice.name != "any") {
      const Candidate one = drawn_candidate(choice, 1, 1, 3, 5);
      CHECK((one.style == DesignStyle::Facets) == choice.facets);
      CHECK((one.style == DesignStyle::Silhouette) == choice.silhouettes);
      CHECK_FALSE(usual_candidates(choice, 1).empty());
    }
}

TEST_CASE("the largest scale fills the sheet, whichever way round", "[search]") {
  const Way way = way_of(box_mesh({0, 0, 0}, {3, 4, 2}, false), {0, 0, 90});
  CHECK_THAT(way.shut_reach, WithinAbs(6.0, 1e-9));  // 4 deep, 2 high
  CHECK_THAT(way.length(), WithinAbs(3.0, 1e-9));
  // Twice 6 across, 3 along, and 30 mm of margins each.
  CHECK_THAT(largest_scale_mm(way, {300, 200}), WithinAbs(270.0 / 12.0, 1e-9));
  CHECK_THAT(largest_scale_mm(way, {200, 300}), WithinAbs(270.0 / 12.0, 1e-9));
  CHECK_THAT(largest_scale_mm(way, {300, 60}), WithinAbs(30.0 / 3.0, 1e-9));
  CHECK(largest_scale_mm(way, {25, 25}) < 0.0);
}

TEST_CASE("the usual candidates are designed about as large as the sheet", "[search]") {
  const TriangleMesh ball = icosphere(2.0, 3);
  const Way way = way_of(ball, {0, 0, 0});
  const double scale = 0.9 * largest_scale_mm(way, {300, 200});
  for (const StyleChoice& choice : style_choices())
    for (const Candidate& candidate : usual_candidates(choice, 1)) {
      const auto spec =
          parse_design_spec(spec_text(candidate, way, scale, {"ball", "ball.stl", "paper-220"}));
      INFO(style_name(candidate));
      REQUIRE(spec);
      const auto made = design(*spec, {{"ball.stl", binary_stl(ball)}});
      INFO((made ? std::string() : message(made.error())));
      REQUIRE(made);
      CHECK(made->report.degrees_of_freedom == 1);
      // What lies behind a layer comes forward to it, and so shuts a little farther out.
      const double room_mm = candidate.style == DesignStyle::Silhouette ? 330.0 : 300.0;
      CHECK(made->pattern.wall_mm + made->pattern.ground_mm <= room_mm);
      CHECK(made->pattern.width_mm <= 200.0);
      REQUIRE(made->pattern.model_placement);
      // The model begins at the margin of the sheet, give or take half a slice.
      const auto& at = *made->pattern.model_placement;
      CHECK_THAT(at[5] + at[0] * way.box.low[1], WithinAbs(15.0, 0.5 * 4 * scale / 20));
      CHECK(made->pattern.wall_mm + made->pattern.ground_mm > 150.0);
    }
}

TEST_CASE("ways are ranked by what is seen, and those that look alike count once", "[search]") {
  const TriangleMesh mushroom =
      joined(box_mesh({20, 20, 0}, {40, 40, 40}, false), box_mesh({0, 0, 40}, {60, 60, 55}, false));
  const auto judged = [&](const std::array<double, 3>& turn) {
    Way way = way_of(mushroom, turn);
    way.misfit = misfit_of(mushroom, way);
    CHECK((way.misfit > 0.0 && way.misfit < 1.0));
    return way;
  };
  const Way upright = judged({0, 0, 0}), turned = judged({180, 0, 0});
  CHECK_THAT(judged({180, 0, 180}).misfit, WithinAbs(turned.misfit, 1e-4));
  const std::vector<Way> best = best_ways({turned, upright, judged({180, 0, 180})}, 3);
  REQUIRE(best.size() == 2);
  CHECK(best[0].misfit <= best[1].misfit);
  CHECK(best_ways({turned, upright}, 1).size() == 1);
  CHECK(best_ways({turned, upright}, 1).front().misfit == std::min(turned.misfit, upright.misfit));
  CHECK(upright_turns(std::nullopt).size() == 24);
}

TEST_CASE("an axis that is said to be up stays up", "[search]") {
  const TriangleMesh tower = box_mesh({0, 0, 0}, {20, 60, 30}, false);
  const auto turns = upright_turns(std::array{0, 1, 0});
  CHECK(turns.size() == 4);
  for (const auto& turn : turns) {
    const Way way = way_of(tower, turn);
    CHECK_THAT(way.box.high[2] - way.box.low[2], WithinAbs(60.0, 1e-6));
    for (const auto& near : turns_near(turn, false)) {
      const Way yawed = way_of(tower, near);
      CHECK_THAT(yawed.box.high[2] - yawed.box.low[2], WithinAbs(60.0, 1e-3));
    }
  }
}

TEST_CASE("a side that is said to be in front faces away from the wall", "[search]") {
  const TriangleMesh slab = box_mesh({0, 0, 0}, {20, 60, 30}, false);
  const auto turns = upright_turns(std::nullopt, std::array{0, 0, -1});
  CHECK(turns.size() == 4);
  for (const auto& turn : turns) {
    const Way way = way_of(slab, turn);
    CHECK_THAT(way.box.high[0] - way.box.low[0], WithinAbs(30.0, 1e-6));
    CHECK_THAT(way.box.high[0], WithinAbs(0.0, 1e-6));  // what was lowest is in front
  }
  const auto only = upright_turns(std::array{0, 1, 0}, std::array{0, 0, 1});
  REQUIRE(only.size() == 1);
  const Way way = way_of(slab, only.front());
  CHECK_THAT(way.box.high[2], WithinAbs(60.0, 1e-6));
  CHECK_THAT(way.box.high[0], WithinAbs(30.0, 1e-6));
  CHECK(upright_turns(std::array{0, 1, 0}, std::array{0, -1, 0}).empty());
}

TEST_CASE("a mesh as binary STL is the same mesh, and a coarse one is near to it", "[search]") {
  const TriangleMesh ball = icosphere(30.0, 5);
  const auto again = value(read_mesh("ball.stl", stl_bytes(ball)));
  CHECK(again.corners == ball.corners);
  CHECK(coarse_mesh(ball, 64, ball.size()).corners == ball.corners);
  const TriangleMesh coarse = coarse_mesh(ball, 24, 1000);
  CHECK(coarse.size() < ball.size() / 3);
  CHECK(coarse.size() > 500);
  const double cell = 60.0 / 24;
  for (std::size_t k = 0; k < coarse.corners.size(); k += 3) {
    const double r = std::hypot(static_cast<double>(coarse.corners[k]),
                                static_cast<double>(coarse.corners[k + 1]),
                                static_cast<double>(coarse.corners[k + 2]));
    CHECK(std::abs(r - 30.0) < cell);
  }
}

TEST_CASE("a model in a book stands about the spine and each card has room for it", "[search]") {
  const TriangleMesh box = box_mesh({10, 20, 30}, {16, 28, 130}, false);
  for (const int cards : {3, 4, 6, 12}) {
    CAPTURE(cards);
    // Its z along the spine, turned by four shares of a card.
    const auto turns = turns_in_book(UpSide{{0, 0, 1}}, cards);
    REQUIRE(turns.size() == 4);
    CHECK(turns_in_book(std::nullopt, cards).size() == 12);
    for (const auto& turn : turns) {
      const Way way = way_in_book(box, turn, cards);
      CHECK_THAT(way.length(), WithinAbs(100.0, 1e-3));
      // The farthest points are the corners, 5 from the middle: in the middle of a card their
      // X + Z is 5 / cos(pi / cards), and a page is never asked for more.
      CHECK_THAT(way.shut_reach, WithinAbs(5.0 / std::cos(3.141592653589793 / cards), 1e-3));
      const auto standing = standing_in_book(box, way);
      double x = 0.0, z = 0.0, low = 1e9;
      for (std::size_t k = 0; k < standing.size(); k += 3) {
        x += static_cast<double>(standing[k]), z += static_cast<double>(standing[k + 2]);
        low = std::min(low, static_cast<double>(standing[k + 1]));
      }
      CHECK_THAT(low, WithinAbs(0.0, 1e-3));
      CHECK_THAT(x, WithinAbs(0.0, 0.05));
      CHECK_THAT(z, WithinAbs(0.0, 0.05));
    }
  }
  // Up is where the spine goes to.
  const TriangleMesh spike = box_mesh({0, 0, -50}, {1, 1, 0}, false);
  const auto down = way_in_book(spike, turns_in_book(UpSide{{0, 0, -1}}, 4).front(), 4);
  CHECK_THAT(down.box.high[1], WithinAbs(50.0, 1e-3));
}

TEST_CASE("a model stands as files of its kind do, unless that is said or its front forbids it",
          "[search]") {
  for (const auto& [file, up] : {std::pair{"a/b.OBJ", "y"},
                                 {"c.glb", "y"},
                                 {"d.e.stl", "z"},
                                 {"teapot", "any"},
                                 {"obj", "any"},
                                 {".stl", "z"},
                                 {"", "any"}}) {
    CAPTURE(file);
    CHECK(up_for_file(kUsualUp, file, "any") == up);
    CHECK(up_for_file(kUsualUp, file, "x") == up);
    CHECK(up_for_file("-x", file, "any") == "-x");
    CHECK(up_for_file("any", file, "y") == "any");
  }
  CHECK(up_for_file(kUsualUp, "a.obj", "-y") == "any");
  CHECK(up_for_file(kUsualUp, "a.stl", "-y") == "z");
}

TEST_CASE("silhouettes of few layers stand in each way, and a card alone has them", "[search]") {
  const auto all = silhouette_candidates(style_choice("any"), 3);
  std::set<std::pair<std::size_t, int>> seen;
  for (const Candidate& one : all) {
    CHECK(one.style == DesignStyle::Silhouette);
    CHECK(style_name(one) == "silhouette");
    seen.emplace(one.way, one.layers);
  }
  CHECK(seen.size() == 9);
  CHECK(silhouette_candidates(style_choice("facets"), 3).empty());
  const auto spec =
      parse_design_spec(spec_text(all[6], way_of(box_mesh({0, 0, 0}, {1, 2, 1}, false), {}), 20.0,
                                  {"box", "box.stl", "paper-220"}));
  REQUIRE(spec);
  CHECK(spec->style == DesignStyle::Silhouette);
  CHECK(spec->facets.layers == all[6].layers);
}

TEST_CASE("a house has cards with sloped panels, off the wall as its roof asks; a box has none",
          "[search]") {
  TriangleMesh house = box_mesh({0, 0, 0}, {4, 6, 3.5}, false);
  const double slope = GENERATE(0.5, 0.9);
  const auto up = static_cast<float>(3.5 + 2 * std::tan(slope));
  for (const auto& [a, b] : {std::pair{4.0F, 2.0F}, std::pair{2.0F, 0.0F}}) {
    const float low = a == 4.0F ? 3.5F : up, high = a == 4.0F ? up : 3.5F;
    for (const float corner :
         {a, 0.0F, low, a, 6.0F, low, b, 6.0F, high, a, 0.0F, low, b, 6.0F, high, b, 0.0F, high})
      house.corners.push_back(corner);
  }
  Way way = way_of(house, {});
  way.roof_off = roof_off_of(house, way);
  REQUIRE(way.roof_off);
  CHECK((*way.roof_off > 0.0) == (slope > 0.55));
  const std::vector<Way> ways{way};
  const auto all = kite_candidates(style_choice("any"), 1, ways);
  REQUIRE(all.size() == 4);
  CHECK(kite_candidates(style_choice("silhouette"), 1, ways).empty());
  CHECK(kite_candidates(style_choice("facets"), 4, ways).empty());
  for (const Candidate& one : all) {
    const auto spec =
        parse_design_spec(spec_text(one, off_wall(way), 12.0, {"house", "house.stl", "paper-220"}));
    REQUIRE(spec);
    CHECK(spec->facets.sloped == SlopedParts::Kites);
    CHECK(spec->placement.translate_mm[0] == Approx(12.0 * *way.roof_off).margin(1e-5));
  }
  const TriangleMesh box = box_mesh({0, 0, 0}, {4, 6, 3.5}, false);
  CHECK_FALSE(roof_off_of(box, way_of(box, {})));
}

TEST_CASE("facets are for books of four cards only", "[search]") {
  for (const StyleChoice& choice : style_choices()) {
    CHECK(styles_for_cards(choice, 1).facets == choice.facets);
    CHECK(styles_for_cards(choice, 4).facets == choice.facets);
    CHECK_FALSE(styles_for_cards(choice, 6).facets);
    CHECK(styles_for_cards(choice, 1).silhouettes == choice.silhouettes);
    CHECK_FALSE(styles_for_cards(choice, 4).silhouettes);
    CHECK(styles_for_cards(choice, 6).lattices == choice.lattices);
    for (const Candidate& candidate : usual_candidates(styles_for_cards(choice, 6), 6)) {
      CHECK(candidate.cards == 6);
      CHECK(candidate.style == DesignStyle::Lattice);
    }
  }
}

TEST_CASE("open edges and crossings of a mesh are counted", "[search]") {
  const TriangleMesh box = box_mesh({0, 0, 0}, {10, 10, 10}, false);
  const MeshFaults sound = faults_of(box);
  CHECK(sound.open_edges == 0);
  CHECK(sound.crossings == 0);
  CHECK_THAT(sound.area, WithinAbs(600.0, 1e-3));
  CHECK(in_words(sound).empty());
  const MeshFaults open = faults_of(box_mesh({0, 0, 0}, {10, 10, 10}, true));
  CHECK(open.open_edges == 4);
  CHECK(open.crossings == 0);
  // A smaller box that comes out of one side.
  const MeshFaults crossing = faults_of(joined(box, box_mesh({3, 4, 5}, {6, 7, 15}, false)));
  CHECK(crossing.open_edges == 0);
  CHECK(crossing.crossings > 0);
  CHECK(in_words(crossing).size() == 1);
  // Boxes side by side touch and do not cross.
  const MeshFaults beside = faults_of(joined(box, box_mesh({10, 0, 0}, {20, 10, 10}, false)));
  CHECK(beside.crossings == 0);
}

TEST_CASE("a model with a face does not show its back", "[search]") {
  // A dark head with two light eyes on one side, for each of the four sides.
  constexpr std::array<std::array<int, 2>, 4> kSides{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  for (const auto& [x, y] : kSides) {
    TriangleMesh head = box_mesh({-10, -10, 0}, {10, 10, 24}, false);
    const std::size_t dark = head.size();
    for (const double aside : {-5.0, 5.0}) {
      const double at[2] = {10.5 * x - aside * y, 10.5 * y + aside * x};
      head = joined(head, box_mesh({at[0] - 2, at[1] - 2, 14}, {at[0] + 2, at[1] + 2, 18}, false));
    }
    std::vector<likeness::Rgb> colours(head.size(), {240, 240, 230});
    std::fill_n(colours.begin(), dark, likeness::Rgb{120, 60, 40});
    std::vector<Way> ways;
    for (const auto& turn : upright_turns(up_side("z"))) {
      ways.push_back(way_of(head, turn));
      ways.back().detail = detail_of(head, colours, ways.back());
    }
    REQUIRE(ways.size() == 4);
    const auto front = upright_turns(
        up_side("z"), up_side(std::string(x + y < 0 ? "-" : "") + (x != 0 ? "x" : "y")));
    REQUIRE(front.size() == 1);
    const std::vector<Way> kept = telling_ways(ways);
    REQUIRE_FALSE(kept.empty());
    const auto most = std::max_element(
        kept.begin(), kept.end(), [](const Way& a, const Way& b) { return a.detail < b.detail; });
    CHECK(most->rotate_deg == front.front());
    const auto back = upright_turns(
        up_side("z"), up_side(std::string(x + y < 0 ? "" : "-") + (x != 0 ? "x" : "y")));
    CHECK(std::none_of(kept.begin(), kept.end(),
                       [&](const Way& way) { return way.rotate_deg == back.front(); }));
  }
  // A cube in clay shows as much from all sides.
  std::vector<Way> alike;
  const TriangleMesh cube = box_mesh({0, 0, 0}, {10, 10, 10}, false);
  for (const auto& turn : upright_turns(up_side("z"))) {
    alike.push_back(way_of(cube, turn));
    alike.back().detail = detail_of(cube, {}, alike.back());
  }
  CHECK(telling_ways(alike).size() == 4);
  CHECK(telling_ways({}).empty());
}

TEST_CASE("the share of a shape that is seen is that of its sides", "[search]") {
  const TriangleMesh box = box_mesh({0, 0, 0}, {10, 10, 10}, false);
  // Two sides of six face the diagonal; a point in 100 is at an edge.
  const std::array diagonal{Vec3(1.0, 0.0, 1.0)};
  CHECK_THAT(seen_share(box, diagonal), WithinAbs(2.0 / 6.0, 0.06));
  CHECK_THAT(share_of_book(box, 4), WithinAbs(4.0 / 6.0, 0.08));
  const TriangleMesh ball = icosphere(10.0, 4);
  CHECK_THAT(seen_share(ball, diagonal), WithinAbs(0.5, 0.06));
  CHECK(seen_share(ball, {}) == 0.0);
}

}  // namespace candidate_test
