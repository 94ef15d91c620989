// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/design/book.hpp"
#include "core/design/book_fit.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/verify/book.hpp"
#include "tests/support/glb_scene.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/value.hpp"

namespace book_test {

using namespace popcut;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr const char* kSphere = R"j({"type":"revolution","radius":"sqrt(1600-y^2)"})j";
/// A ball of 40 mm whose middle is 8 mm from the spine.
constexpr const char* kOffCentre =
    R"({"type":"mesh","file":"ball.stl"},"rotate_deg":[0,0,0],"translate_mm":[8,20,0])";
/// The same beside the spine: on its far side there are corners without any of it.
constexpr const char* kAside =
    R"({"type":"mesh","file":"ball.stl"},"rotate_deg":[0,0,0],"translate_mm":[60,20,50])";

SurfaceAssets ball() {
  static const SurfaceAssets assets{{"ball.stl", testing::binary_stl(testing::icosphere(40, 3))}};
  return assets;
}

std::string spec_text(const std::string& surface, int cards, const std::string& more = "",
                      int units = 4) {
  return fmt::format(
      R"({{"popcut":1,"name":"b","surface":{},"units_per_slice":{},"slices":8,"widths_mm":5,
          "book":{{"cards":{}}}{}}})",
      surface, units, cards, more);
}

DesignSpec spec_of(const std::string& text) { return testing::value(parse_design_spec(text)); }

PatchAssembly book_of(const std::string& text, const SurfaceAssets& assets = ball()) {
  CAPTURE(text);
  auto made = testing::value(design_assembly(spec_of(text), assets));
  REQUIRE(made.book);
  return made;
}

std::string fold_of(const Pattern& pattern) {
  std::ostringstream out;
  REQUIRE(write_fold(pattern, {}, out));
  return std::move(out).str();
}

BookVerifyReport verified(const std::vector<std::string>& folds) {
  std::vector<VerifiedCard> cards;
  for (std::size_t i = 0; i < folds.size(); ++i)
    cards.push_back({fmt::format("card {}", i + 1), folds[i]});
  return testing::value(verify_book(cards));
}

std::vector<std::string> folds_of(const PatchAssembly& book) {
  std::vector<std::string> out;
  for (const Design& card : book.parts) out.push_back(fold_of(card.pattern));
  return out;
}

/// The check of that name.
const VerifyCheck& check_of(const BookVerifyReport& report, const std::string& name) {
  const auto found = std::find_if(report.checks.begin(), report.checks.end(),
                                  [&](const VerifyCheck& check) { return check.name == name; });
  REQUIRE(found != report.checks.end());
  return *found;
}

}  // namespace

TEST_CASE("the first card of a book of right angles is the card that its design alone gives",
          "[core][book]") {
  const PatchAssembly book = book_of(spec_text(kOffCentre, 4));
  const double page = book.book->page_mm;
  const DesignSpec alone = spec_of(fmt::format(
      R"({{"popcut":1,"name":"b, card 1","surface":{},"units_per_slice":4,"slices":8,"widths_mm":5,
          "fit":"nearest","card":{{"wall_mm":{:.17g},"ground_mm":{:.17g}}}}})",
      kOffCentre, page, page));
  const auto made = testing::value(design(alone, ball()));
  CHECK(fold_of(made.pattern) == fold_of(book.parts.front().pattern));
}

TEST_CASE("all cards of a book have one page, which clears each shut structure", "[core][book]") {
  for (const int cards : {3, 4, 8}) {
    CAPTURE(cards);
    const PatchAssembly book = book_of(spec_text(kOffCentre, cards));
    REQUIRE(book.parts.size() == static_cast<std::size_t>(cards));
    CHECK(book.book->angle_deg == Approx(360.0 / cards));
    CHECK(book.book->seams.size() + 1 == book.parts.size());
    for (const Design& card : book.parts) {
      CHECK(card.pattern.wall_mm == book.book->page_mm);
      CHECK(card.pattern.ground_mm == book.book->page_mm);
      CHECK(card.pattern.width_mm == book.book->width_mm);
      CHECK(card.pattern.design_psi_rad == Approx(2.0 * std::numbers::pi / cards));
      CHECK(card.report.degrees_of_freedom == 1);
      for (const PatternVertex& p : card.pattern.vertices) {
        CHECK(p.x + p.z <= book.book->page_mm + 1e-9);
        CHECK(p.x >= 0.0);
        CHECK(p.z >= 0.0);
      }
      // Each slice that stands is at its place along the target, on every card.
      for (const SliceReport& slice : card.report.slices)
        if (!slice.blank)
          CHECK(std::abs(slice.v_mm - slice.s_mm - book.book->shift_mm) < 0.5 * slice.width_mm);
    }
    CHECK(book.book->closed_mm < book.book->page_mm);
  }
}

TEST_CASE("the cards of a book show the target on their own sides", "[core][book]") {
  PatchAssembly book = book_of(
      R"({"popcut":1,"surface":{"type":"mesh","file":"ball.stl"},"rotate_deg":[0,0,0],
          "translate_mm":[8,38,0],"units_per_slice":8,"slices":20,"widths_mm":4,
          "book":{"cards":6}})");
  const auto fit = testing::value(book_fit(book));
  CHECK(fit.size_mm == Approx(80.0 * std::sqrt(3.0)).margin(0.5));
  CHECK(fit.share_within[2] > 0.97);
  CHECK(fit.to_structure.mean_mm < 0.017 * fit.size_mm);
  // Turned to where they do not belong the cards are far off.
  std::rotate(book.parts.begin(), book.parts.begin() + 3, book.parts.end());
  const TriangleSoup wrong = book_structure(book);
  double least = 0.0, most = 0.0;
  for (std::size_t k = 0; k < wrong.corners.size(); k += 3) {
    least = std::min(least, wrong.corners[k]);
    most = std::max(most, wrong.corners[k]);
  }
  CHECK(most < 42.0);  // the ball reaches from x = -32 to 48
  CHECK(least < -42.0);
}

TEST_CASE("a turn about the spine is a turn of the whole target, shift and all", "[core][book]") {
  TargetPlacement placement{2.0, {10.0, 20.0, 30.0}, {5.0, 6.0, 7.0}};
  const PlacementMap plain(placement);
  placement.about_spine_deg = 72.0;
  const PlacementMap turned(placement);
  const std::array<double, 3> q{1.0, -2.0, 3.0};
  const auto a = plain.to_corner(q), b = turned.to_corner(q);
  CHECK(std::atan2(a[2], a[0]) - std::atan2(b[2], b[0]) == Approx(72.0 * kDegree));
  CHECK(std::hypot(a[0], a[2]) == Approx(std::hypot(b[0], b[2])));
  CHECK(a[1] == Approx(b[1]));
  const auto back = turned.to_surface(b);
  for (std::size_t k = 0; k < 3; ++k) CHECK(back[k] == Approx(q[k]));
  // The same as degrees about the axes.
  TargetPlacement same = placement;
  same.about_spine_deg = 0.0;
  same.rotate_deg = degrees_of(whole_turn(placement));
  same.translate_mm = whole_shift_mm(placement);
  const auto c = PlacementMap(same).to_corner(q);
  for (std::size_t k = 0; k < 3; ++k) CHECK(c[k] == Approx(b[k]));
}

TEST_CASE(
    "cards of a surface of revolution are one design, and a plain one is left where nothing is",
    "[core][book]") {
  const PatchAssembly round = book_of(spec_text(kSphere, 6));
  CHECK(round.book->is_alike);
  CHECK(fold_of(round.parts[0].pattern).size() == fold_of(round.parts[5].pattern).size());
  CHECK(round.parts[0].pattern.vertices.size() == round.parts[5].pattern.vertices.size());

  const PatchAssembly aside = book_of(spec_text(kAside, 4));
  CHECK_FALSE(aside.book->is_alike);
  CHECK(aside.book->is_plain == std::vector<bool>{false, true, true, true});
  const Design& plain = aside.parts[2];
  CHECK(plain.pattern.faces() == 2);
  CHECK(plain.report.degrees_of_freedom == 1);
  CHECK(plain.report.folds == 1);
  CHECK(verified(folds_of(aside)).ok());
}

TEST_CASE("a mesh stands with its z axis on the spine of a book, its middle halfway",
          "[core][book]") {
  using namespace popcut::testing;
  const TriangleMesh box = box_mesh({10, 20, 30}, {30, 40, 80}, false);
  const SurfaceAssets assets{{"box.stl", binary_stl(box)}};
  const auto text = [](const std::string& more) {
    return fmt::format(
        R"({{"popcut":1,"surface":{{"type":"mesh","file":"box.stl"}},"units_per_slice":3,
            "slices":9,"widths_mm":5,"book":{{"cards":4}}{}}})",
        more);
  };
  const DesignSpec spec = spec_of(text(""));
  CHECK(spec.fit == FitMode::Nearest);
  const auto placement = testing::value(book_placement(spec, assets));
  const PlacementMap map(placement);
  const auto middle = map.to_corner({20, 30, 55});
  CHECK(middle[0] == Approx(0.0).margin(1e-4));
  CHECK(middle[1] == Approx(20.0).margin(1e-4));  // the slices' middles reach from 0 to 40
  CHECK(middle[2] == Approx(0.0).margin(1e-4));
  const auto top = map.to_corner({20, 30, 80});
  CHECK(top[1] - middle[1] == Approx(25.0).margin(1e-4));
  // What the spec says stands.
  const auto given =
      book_placement(spec_of(text(R"(,"rotate_deg":[0,0,0],"translate_mm":[1,2,3])")), assets);
  REQUIRE(given);
  CHECK(given->rotate_deg == std::array<double, 3>{});
  CHECK(given->translate_mm == std::array<double, 3>{1.0, 2.0, 3.0});
  const PatchAssembly book = book_of(text(""), assets);
  CHECK(verified(folds_of(book)).ok());
  REQUIRE(book.parts[1].pattern.model_placement);
}

TEST_CASE("the animation of a book puts each card at its turn about the spine", "[core][book]") {
  const PatchAssembly book = book_of(spec_text(kSphere, 5));
  const auto angles = testing::value(opening_angles(0.0, book.parts[0].pattern.design_psi_rad, 9));
  std::vector<PoseTable> tables;
  for (const Design& card : book.parts) {
    tables.push_back(testing::value(pose_table(card.pattern, angles)));
  }
  std::vector<GlbCard> cards;
  for (std::size_t i = 0; i < tables.size(); ++i)
    cards.push_back({&book.parts[i].pattern, &tables[i]});
  const auto bytes = testing::value(book_glb(cards, "b", {}));
  const testing::GlbScene scene(bytes);
  std::size_t grounds = 0, walls = 0;
  for (const double part : {0.0, 0.4, 1.0}) {
    const double psi = part * book.parts[0].pattern.design_psi_rad;
    std::size_t card = 0;
    for (std::size_t n = 0; n < scene.nodes(); ++n) {
      const std::string name = scene.json()["nodes"][n]["name"];
      if (name.rfind("card ", 0) == 0) ++card;
      const bool is_ground = name.rfind("ground ", 0) == 0, is_wall = name.rfind("wall ", 0) == 0;
      if (!is_ground && !is_wall) continue;
      ++(is_ground ? grounds : walls);
      // y is up along the spine: a ground lies at the angle of its card, a wall one opening on.
      const double at = psi * static_cast<double>(card + (is_wall ? 1 : 0));
      for (const Vec3& p : scene.places(n, part * scene.seconds()))
        CHECK(std::sin(at) * p[0] - std::cos(at) * p[2] == Approx(0.0).margin(2e-6));
    }
    CHECK(card == 5);
  }
  CHECK(grounds >= 15);
  CHECK(walls >= 15);
}

TEST_CASE("verify finds what is wrong with a book", "[verify][book]") {
  const PatchAssembly book = book_of(spec_text(kOffCentre, 4));
  const std::vector<std::string> folds = folds_of(book);
  const BookVerifyReport sound = verified(folds);
  CHECK(sound.ok());
  CHECK(sound.open_deg == Approx(360.0));
  CHECK(sound.page_mm == Approx(book.book->page_mm));
  CHECK(sound.closed_mm == Approx(book.book->closed_mm));
  CHECK(nlohmann::json::parse(verify_json(sound))["ok"] == true);

  SECTION("a card too many") {
    std::vector<std::string> five = folds;
    five.push_back(folds.front());
    CHECK(check_of(verified(five), "around").failed == 1);
  }
  SECTION("a page of another size") {
    const PatchAssembly larger =
        book_of(spec_text(kOffCentre, 4, R"(,"card":{"wall_mm":120,"ground_mm":120})"));
    std::vector<std::string> mixed = folds;
    mixed[1] = fold_of(larger.parts[1].pattern);
    CHECK(check_of(verified(mixed), "seams").failed == 2);  // on both of its sides
  }
  SECTION("a card that leaves its wedge") {
    Pattern through = book.parts[1].pattern;
    const auto highest =
        std::max_element(through.vertices.begin(), through.vertices.end(),
                         [](const auto& a, const auto& b) { return a.x * a.z < b.x * b.z; });
    highest->x = -3.0;
    std::vector<std::string> bad = folds;
    bad[1] = fold_of(through);
    const BookVerifyReport report = verified(bad);
    CHECK_FALSE(report.ok());
    CHECK(check_of(report, "apart").failed == 1);
  }
  SECTION("a structure that sticks out of the shut book") {
    const DesignSpec free = spec_of(fmt::format(
        R"({{"popcut":1,"surface":{},"units_per_slice":4,"slices":8,"widths_mm":5,"fit":"nearest",
            "card":{{"wall_mm":50,"ground_mm":50,"shut":"free"}}}})",
        kOffCentre));
    const auto made = testing::value(design(free, ball()));
    const std::string fold = fold_of(made.pattern);
    CHECK(check_of(verified({fold, fold, fold, fold}), "closed").failed == 4);
  }
  SECTION("a card with two movements") {
    const DesignSpec loose = spec_of(
        R"({"popcut":1,"surface":{"type":"revolution","radius":"40"},"units_per_slice":3,"slices":2,
            "widths_mm":5,"card":false})");
    const auto made = testing::value(design(loose));
    std::vector<std::string> bad = folds;
    bad[3] = fold_of(made.pattern);
    CHECK_FALSE(verified(bad).cards[3].ok());
  }
}

TEST_CASE("what a book cannot be is said in one line", "[core][book]") {
  struct Row {
    std::string text, place, part;
  };
  const std::vector<Row> rows{
      {spec_text(kSphere, 2), "/book/cards", "from 3 to 12"},
      {spec_text(kSphere, 13), "/book/cards", "from 3 to 12"},
      {spec_text(kSphere, 4, R"(,"design_angle_deg":90)"), "/design_angle_deg", "/book"},
      {spec_text(kSphere, 6, R"(,"curvature":{"H":1})"), "/curvature", "60 degrees"},
      {spec_text(kSphere, 4, R"(,"card":false)"), "/card", "glued"},
      {spec_text(kSphere, 4, R"(,"card":{"shut":"free"})"), "/card/shut", "inside its pages"},
      {spec_text(kSphere, 4, R"(,"patches":[])"), "/book", "/patches"},
      {R"({"popcut":1,"style":"facets","surface":{"type":"revolution","radius":"40"},
           "facets":{"length_mm":40},"book":{"cards":6}})",
       "/book/cards", "90 degrees only"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"40"},"units_per_slice":3,"slices":9,
           "widths_mm":{"max_error_mm":1},"book":{"cards":4}})",
       "/widths_mm", "a number or a list"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"40"},"units_per_slice":3,"slices":9,
           "widths_mm":5,"book":{}})",
       "/book/cards", "missing"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    const auto spec = parse_design_spec(row.text);
    REQUIRE_FALSE(spec);
    CHECK(spec.error().place == row.place);
    INFO(spec.error().detail);
    CHECK(spec.error().detail.find(row.part) != std::string::npos);
  }
  const auto unequal =
      design_assembly(spec_of(spec_text(kSphere, 4, R"(,"card":{"wall_mm":90,"ground_mm":91})")));
  REQUIRE_FALSE(unequal);
  CHECK(unequal.error().place == "/card/ground_mm");
  const PatchAssembly given = book_of(spec_text(kSphere, 4, R"(,"card":{"wall_mm":90})"));
  CHECK(given.parts[3].pattern.ground_mm == 90.0);
  // Nothing of it anywhere: the error of the first card.
  const auto nowhere = design_assembly(
      spec_of(spec_text(
          R"({"type":"mesh","file":"ball.stl"},"rotate_deg":[0,0,0],"translate_mm":[0,900,0])", 4)),
      ball());
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().kind == ErrorKind::Infeasible);
}

TEST_CASE("facets make a book of four right angles", "[core][book]") {
  const PatchAssembly book = book_of(
      R"j({"popcut":1,"style":"facets","surface":{"type":"implicit",
          "f":"max(max(abs(x-4)-30,abs(z)-25),abs(y-20)-15)"},
          "facets":{"length_mm":40,"pitch_mm":5,"strip_mm":10},"book":{"cards":4}})j");
  CHECK(verified(folds_of(book)).ok());
  const auto fit = testing::value(book_fit(book));
  CHECK(fit.to_target.mean_mm < 1.0);
}

TEST_CASE("the report of a book says what is glued and where its cards are", "[core][book]") {
  PatchAssembly book = book_of(spec_text(kOffCentre, 3));
  book.book->fit = book_fit(book);
  const auto json = nlohmann::json::parse(report_json(book));
  CHECK(json["cards"] == 3);
  CHECK(json["angle_deg"] == 120.0);
  CHECK(json["degrees_of_freedom"] == nlohmann::json({1, 1, 1}));
  CHECK(json["glued"] ==
        nlohmann::json::parse(R"([{"wall_of":1,"ground_of":2},{"wall_of":2,"ground_of":3}])"));
  CHECK(json["covers"] == nlohmann::json::parse(R"({"ground_of":1,"wall_of":3})"));
  CHECK(json["card"][2]["folder"] == "card-03");
  CHECK(json["fit"]["share_within"]["5_percent"] == book.book->fit->share_within[2]);
  double cut = 0.0;
  for (const Design& card : book.parts)
    for (const SheetLine& line : card.pattern.lines)
      if (line.role == EdgeRole::Slit) cut += std::hypot(line.u1 - line.u0, line.v1 - line.v0);
  CHECK(json["cut_length_mm"] == Approx(cut));
}

}  // namespace book_test
