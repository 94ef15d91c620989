// SPDX-License-Identifier: MIT
#include "core/judge/sheet_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/deploy/loaded_pattern.hpp"
#include "core/design/design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace sheet_motion_test {

using namespace popcut;
using nlohmann::json;
using Places = std::vector<std::array<double, 3>>;

namespace {

Pattern example(const std::string& name) {
  std::ifstream file(testing::source_file("examples/" + name + ".json"));
  std::ostringstream text;
  text << file.rdbuf();
  const auto spec = testing::value(parse_design_spec(text.str()));
  auto made = testing::value(design(spec));
  return std::move(made.pattern);
}

std::string fold_of(const Pattern& pattern) {
  std::ostringstream text;
  REQUIRE(write_fold(pattern, {}, text));
  return text.str();
}

/// The corners at which faces turn, at an opening angle; a pattern can also have vertices along
/// their sides.
Places corners(const Pattern& pattern, double psi_rad) {
  const Places all = posed_vertices(pattern, psi_rad);
  Places found;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto at = [&](std::size_t i) {
        return flat_place(pattern, pattern.vertices[face[i % face.size()]]);
      };
      const Vec3 in = at(k + 1) - at(k), out = at(k + 2) - at(k + 1);
      if (in.cross(out).norm() > 1e-6 * in.norm() * out.norm())
        found.push_back(all[face[(k + 1) % face.size()]]);
    }
  }
  return found;
}

/// What a program leaves of it that knows only vertices, edges and assignments.
std::string stripped(const std::string& fold) {
  json file = json::parse(fold);
  for (const char* key : {"faces_vertices", "edges_faces", "edges_foldAngle", "file_frames"})
    file.erase(key);
  return file.dump();
}

std::string drawn(const Pattern& pattern) {
  std::ostringstream svg;
  write_pattern_svg(pattern, svg);
  std::vector<std::string> warnings;
  return testing::value(cli::fold_of_drawing(svg.str(), "pattern.svg", "origami-sim", warnings));
}

judge::SheetMotion opened(const std::string& fold,
                          const std::vector<double>& psi_rad = {std::numbers::pi / 2}) {
  auto sheet = judge::open_flat_sheet(fold, psi_rad);
  INFO((sheet ? "" : message(sheet.error())));
  REQUIRE(sheet);
  return std::move(*sheet);
}

/// How far the places of one list are from the nearest of the other, both ways.
double apart(const Places& a, const Places& b) {
  double most = 0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const auto& p : *from) {
      double least = INFINITY;
      for (const auto& q : *to)
        least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
      most = std::max(most, least);
    }
  }
  return most;
}

/// One vertex of four folds, the longest along v; its slanted ones must be mountains to open.
std::string reverse_fold(char slanted) {
  return fmt::format(R"({{"frame_unit":"mm","vertices_coords":
      [[-20,-20],[0,-20],[20,-20],[20,14],[20,30],[0,30],[-20,30],[-20,14],[0,20]],
      "edges_vertices":[[0,1],[1,2],[2,3],[3,4],[4,5],[5,6],[6,7],[7,0],[1,8],[8,5],[3,8],[8,7]],
      "edges_assignment":["B","B","B","B","B","B","B","B","V","M","{0}","{0}"]}})",
                     slanted);
}

std::string refusal(const std::string& fold) {
  const std::array<double, 2> angles{std::numbers::pi, std::numbers::pi / 2};
  const auto sheet = judge::open_flat_sheet(fold, angles);
  REQUIRE_FALSE(sheet);
  return message(sheet.error());
}

}  // namespace

TEST_CASE("a pattern opens to the same poses from its frames, its lines alone and its drawing",
          "[deploy]") {
  // In the drawing coordinates are rounded to 5e-7 mm, and a place is a sum over the folds before
  // it; those of the box are round numbers.
  struct Case {
    const char* name;
    double drawn_within_mm;
  };
  for (const auto& [name, drawn_within_mm] :
       {Case{"unit", 1e-6}, Case{"sphere", 1e-5}, Case{"multistate", 1e-5}}) {
    CAPTURE(name);
    const Pattern made = example(name);
    const std::string fold = fold_of(made);
    const auto file = testing::value(read_fold(fold));
    const auto framed = testing::value(pattern_from_fold(file));
    json faceless = json::parse(fold);
    faceless.erase("faces_vertices");
    faceless.erase("edges_faces");
    CHECK(apart(corners(opened(faceless.dump()).pattern, 1.2), corners(made, 1.2)) < 1e-6);
    const auto lines = opened(stripped(fold)), drawing = opened(drawn(made));
    CHECK_FALSE(lines.motion);
    CHECK_FALSE(drawing.motion);
    for (const Pattern* found : {&lines.pattern, &drawing.pattern}) {
      CHECK(found->wall_mm == Approx(made.wall_mm).margin(drawn_within_mm));
      CHECK(found->ground_mm == Approx(made.ground_mm).margin(drawn_within_mm));
      CHECK(found->width_mm == Approx(made.width_mm).margin(drawn_within_mm));
    }
    CHECK(lines.pattern.v_folds.size() == made.v_folds.size());
    CHECK(drawing.pattern.v_folds.size() == made.v_folds.size());
    for (const double psi : {2.5, std::numbers::pi / 2, 0.7}) {
      CAPTURE(psi);
      const Places due = corners(made, psi);
      CHECK(apart(corners(framed, psi), due) < 1e-6);
      CHECK(apart(corners(lines.pattern, psi), due) < 1e-6);
      CHECK(apart(corners(drawing.pattern, psi), due) < drawn_within_mm);
    }
  }
}

TEST_CASE("a sheet turned on its page opens to the same pose", "[deploy]") {
  const Pattern made = example("unit");
  json file = json::parse(stripped(fold_of(made)));
  for (json& at : file["vertices_coords"]) {  // a quarter turn, and away from the corner
    const double u = at[0], v = at[1];
    at = {17.25 - v, 3.5 + u};
  }
  const Pattern turned = opened(file.dump()).pattern;
  // The fold along u reads from the other side of the sheet: half a turn about the upright line.
  Places places = corners(turned, 1.2);
  const Places due = corners(made, 1.2);
  const double far = apart(places, due);
  double width = 0;
  for (const auto& p : places) width = std::max(width, p[1]);
  for (auto& p : places) {
    const double x = p[0], z = p[2];
    // Wall and ground change places: mirrored in the plane between them, and along the spine.
    p = {x * std::cos(1.2) + z * std::sin(1.2), width - p[1],
         x * std::sin(1.2) - z * std::cos(1.2)};
  }
  CHECK(std::min(far, apart(places, due)) < 1e-6);
}

TEST_CASE("a pattern with slanted folds is opened to each angle that is asked for", "[deploy]") {
  const std::string fold = reverse_fold('M');
  const std::vector<double> angles{std::numbers::pi, 3.1, 2.0, 1.0};
  const auto sheet = opened(fold, angles);
  REQUIRE(sheet.motion);
  const auto table = sheet.motion->table(sheet.pattern, angles);
  INFO((table ? "" : message(table.error())));
  REQUIRE(table);
  CHECK(table->faces == 4);
  // Flat first; then the two panels beside the driving fold meet at the angle that was asked for.
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const auto& at = sheet.motion->places[k];
    const Vec3 wall = (at[0] - at[1]).normalized(), ground = (at[2] - at[1]).normalized();
    CHECK(std::acos(std::clamp(wall.dot(ground), -1.0, 1.0)) == Approx(angles[k]).margin(1e-6));
    CHECK((at[8] - at[3]).norm() == Approx(std::hypot(20, 6)).margin(1e-6));
  }
}

TEST_CASE("a sheet that cannot be opened says why and what would help", "[deploy]") {
  const std::string square = R"("vertices_coords":[[0,0],[10,0],[10,10],[0,10]],)";
  CHECK_THAT(refusal("{" + square + R"("edges_vertices":[[0,1],[1,2],[2,3],[3,0]]})"),
             Catch::Contains("no fold joins two faces"));
  CHECK_THAT(refusal("{" + square + R"("edges_vertices":[[0,1],[1,2],[2,3]]})"),
             Catch::Contains("close the outline"));
  CHECK_THAT(refusal(reverse_fold('V')),
             Catch::Contains("turn the other way") && Catch::Contains("popcut verify"));
  // A frame that does not fit the sheet is not passed over.
  json torn = json::parse(fold_of(example("unit")));
  torn.erase("faces_vertices");
  torn.erase("edges_faces");
  torn["file_frames"][1]["vertices_coords"][0][0] =
      torn["file_frames"][1]["vertices_coords"][0][0].get<double>() + 0.5;
  CHECK_THAT(refusal(torn.dump()), Catch::Contains("the frame stretches the sheet by"));
}

TEST_CASE("the samples of other programs open, or say what is wrong with them", "[deploy]") {
  const auto cut = [](const std::string& name) {
    const std::string text = popcut::testing::sample("fold/" + name);
    if (text.empty()) WARN("skipped: " << name << " is not here");
    if (text.empty() || !cli::is_svg(text)) return text;
    std::vector<std::string> warnings;
    return testing::value(cli::fold_of_drawing(text, name, "origami-sim", warnings));
  };
  const std::vector<double> angles{std::numbers::pi, 2.4, std::numbers::pi / 2};
  for (const char* name : {"fold_diagonal-cp.fold", "re_panels-6x2-90deg.fold", "os_miura-ori.svg",
                           "os_popupSimple.svg", "os_housePopup.svg", "re_hex-box.svg"}) {
    const std::string fold = cut(name);
    if (fold.empty()) continue;
    CAPTURE(name);
    const auto sheet = opened(fold, angles);
    if (sheet.motion) CHECK(sheet.motion->table(sheet.pattern, angles));
  }
  if (const std::string fold = cut("re_windmill.fold"); !fold.empty())
    CHECK_THAT(refusal(fold), Catch::Contains("mountains and valleys"));
}

}  // namespace sheet_motion_test
