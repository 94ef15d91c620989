// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "core/curvature/fold_vertices.hpp"
#include "core/curvature/pattern_curvature.hpp"
#include "core/design/patches.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "tests/support/lattice_reader.hpp"
#include "tests/support/value.hpp"

namespace lattice_blob_test {

using namespace popcut;
using testing::LatticeReader;

namespace {

Design made_of(const std::string& text) {
  return testing::value(design(testing::value(parse_design_spec(text))));
}

const std::string kSphere = R"j({"popcut": 1, "name": "sphere", "surface":
  {"type": "revolution", "radius": "sqrt(3600 - y^2)"}, "translate_mm": [0, 45, 0],
  "units_per_slice": 5, "slices": 10, "widths_mm": 10})j";

/// A sheet of 20 x 10 mm that is folded along u = 10 for half of its width and slit for the other
/// half; a diagonal that is no fold cuts the right part in two.
Pattern slit_sheet() {
  Pattern p;
  p.name = "slit";
  p.card = false;
  p.ground_mm = 20, p.width_mm = 10;
  const auto at = [&](double u, double v) { p.vertices.push_back({u, 0, v}); };
  at(0, 0), at(10, 0), at(20, 0), at(20, 10), at(10, 10), at(0, 10);  // 0 .. 5
  at(10, 5), at(10, 10);  // 6: the slit's end; 7: its other side
  p.face_vertices = {0, 1, 6, 7, 5, /**/ 1, 2, 3, 6, /**/ 3, 4, 6};
  p.face_first = {0, 5, 9, 12};
  const auto edge = [&](std::uint32_t from, std::uint32_t to, std::int32_t left, std::int32_t right,
                        EdgeRole role) {
    p.edges.push_back({from, to, left, right, role});
  };
  edge(0, 1, 0, -1, EdgeRole::Outline), edge(1, 2, 1, -1, EdgeRole::Outline);
  edge(2, 3, 1, -1, EdgeRole::Outline), edge(3, 4, 2, -1, EdgeRole::Outline);
  edge(7, 5, 0, -1, EdgeRole::Outline), edge(5, 0, 0, -1, EdgeRole::Outline);
  edge(1, 6, 0, 1, EdgeRole::Valley);
  edge(6, 7, 0, -1, EdgeRole::Outline), edge(4, 6, 2, -1, EdgeRole::Outline);  // the slit
  edge(3, 6, 1, 2, EdgeRole::Outline);                                         // flat
  return p;
}

}  // namespace

TEST_CASE("a lattice blob of a pattern alone has no report, slices and levels", "[core][blob]") {
  const Design sphere = made_of(kSphere);
  const auto bytes =
      lattice_blob(sphere.pattern, {.quality = LatticeQuality::Stored, .kind = "fold"});
  REQUIRE(bytes);
  const LatticeReader blob(*bytes);
  CHECK(blob.head["kind"] == "fold");
  CHECK(blob.head["quality"] == "stored");
  CHECK(blob.head["name"] == "sphere");
  CHECK(blob.head["report"].is_null());
  CHECK(blob.head["error_mm"].is_null());
  CHECK(blob.head["motion"] == "pose");
  CHECK(blob.head["card"]["wall_mm"] == sphere.pattern.wall_mm);
  CHECK(blob.head["card"]["width_mm"] == sphere.pattern.width_mm);
  CHECK(blob.head["card"]["card"] == true);
  const auto of_design = LatticeReader(*lattice_blob(sphere));
  CHECK(blob.floats("points") == of_design.floats("points"));
  CHECK(blob.words("triangles") == of_design.words("triangles"));
  CHECK(blob.bytes("face_kind") == of_design.bytes("face_kind"));
  for (const int slice : blob.numbers("face_slice")) CHECK(slice == -1);
  for (const float error : blob.floats("face_error")) CHECK(std::isnan(error));
  for (const char* none : {"tips", "ghost_points", "frames", "point_k", "face_part"})
    CHECK_FALSE(blob.has(none));
}

TEST_CASE("a lattice blob tells fold, slit and flat sides of a sheet from elsewhere",
          "[core][blob]") {
  const Pattern sheet = slit_sheet();
  LatticeFrames frames{{std::numbers::pi, 1.0}, {{}, {}}};
  for (std::size_t f = 0; f < 2; ++f)
    for (const PatternVertex& p : sheet.vertices)
      frames.places[f].emplace_back(p.x, p.v, 0.25 * static_cast<double>(f));
  const auto bytes =
      testing::value(lattice_blob(sheet, frames, {.kind = "svg", .judged = {"one piece"}}));
  const LatticeReader blob(bytes);
  CHECK(blob.head["motion"] == "frames");
  CHECK(blob.head["frames"]["psi_rad"] == nlohmann::json({std::numbers::pi, 1.0}));
  CHECK(blob.head["judged"] == nlohmann::json({"one piece"}));
  const auto places = blob.floats("frames");
  REQUIRE(places.size() == 2 * 3 * sheet.vertices.size());
  CHECK(places[3 * sheet.vertices.size() + 2] == 0.25F);
  CHECK(places[3 * 3] == 20.0F);

  // Sides by the ends of each, without direction.
  const auto corners = blob.words("triangles");
  const auto sides = blob.bytes("sides");
  std::set<std::array<std::uint32_t, 3>> drawn;  // role, from, to
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::uint32_t i = corners[k], j = corners[k % 3 == 2 ? k - 2 : k + 1];
    if (sides[k] != 0)
      drawn.insert({static_cast<std::uint32_t>(sides[k]), std::min(i, j), std::max(i, j)});
  }
  // The straight side 1 - 6 - 7 of the left face is a fold and then a cut: 6 is a corner there.
  CHECK(drawn == std::set<std::array<std::uint32_t, 3>>{{1, 0, 1},
                                                        {1, 0, 5},
                                                        {1, 1, 2},
                                                        {1, 2, 3},
                                                        {1, 3, 4},
                                                        {1, 4, 6},
                                                        {1, 5, 7},
                                                        {1, 6, 7},
                                                        {3, 1, 6}});
  // The slit is one line, the flat diagonal none.
  const auto roles = blob.bytes("line_role");
  CHECK(std::count(roles.begin(), roles.end(), 1) == 6);
  CHECK(std::count(roles.begin(), roles.end(), 3) == 1);
  CHECK(std::count(roles.begin(), roles.end(), 4) == 1);
  for (const int kind : blob.bytes("face_kind")) CHECK(kind == 0);

  CHECK(LatticeReader(*lattice_blob(sheet, LatticeFrames{})).head["motion"] == "flat");

  // Lines that are neither cut nor folded come after these, without a role.
  const auto scored =
      testing::value(lattice_blob(sheet, LatticeFrames{}, {.others = {{1, 2, 3, 4, {}}}}));
  const auto lines = LatticeReader(scored).floats("lines");
  REQUIRE(lines.size() == 4 * (6 + 1 + 1 + 1));
  CHECK(std::vector(lines.end() - 4, lines.end()) == std::vector<float>{1, 2, 3, 4});
  CHECK(LatticeReader(scored).bytes("line_role")[8] == 0);
}

TEST_CASE("a lattice blob turns faces that run clockwise", "[core][blob]") {
  Pattern sheet = slit_sheet();
  const auto before = LatticeReader(*lattice_blob(sheet, LatticeFrames{}));
  std::reverse(sheet.face_vertices.begin(), sheet.face_vertices.begin() + 5);
  const auto after = LatticeReader(*lattice_blob(sheet, LatticeFrames{}));
  const auto lengths = [](const LatticeReader& blob) {
    const auto corners = blob.words("triangles");
    const auto points = blob.floats("points");
    const auto sides = blob.bytes("sides");
    std::array<double, 5> out{};
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t i = corners[k], j = corners[k % 3 == 2 ? k - 2 : k + 1];
      out.at(static_cast<std::size_t>(sides[k])) +=
          std::hypot(points[3 * i] - points[3 * j], points[3 * i + 2] - points[3 * j + 2]);
      if (k % 3 != 0) continue;
      const auto at = [&](std::size_t n, std::size_t c) { return points[3 * corners[k + n] + c]; };
      CHECK((at(1, 0) - at(0, 0)) * (at(2, 2) - at(0, 2)) -
                (at(1, 2) - at(0, 2)) * (at(2, 0) - at(0, 0)) >
            0);
    }
    return out;
  };
  const auto due = lengths(before), is = lengths(after);
  for (const std::size_t role : {1U, 3U}) CHECK(is[role] == Approx(due[role]));
}

TEST_CASE("a lattice blob has K and H where folds have their fold vertex", "[core][blob]") {
  const Design sphere = made_of(kSphere);
  const LatticeReader blob(*lattice_blob(sphere, {.curvature = true}));
  const auto k = blob.floats("point_k"), h = blob.floats("point_h");
  const auto points = blob.floats("points");
  REQUIRE(k.size() == sphere.pattern.vertices.size());
  const auto vertices = testing::value(fold_vertices(sphere.pattern));
  const auto values = pattern_curvature(vertices, std::numbers::pi / 2);
  REQUIRE_FALSE(values.empty());
  std::size_t found = 0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    CHECK(std::isnan(k[i]) == std::isnan(h[i]));
    if (std::isnan(k[i])) continue;
    ++found;
    // The fold vertex is half a connector beside its fold's end, at the same x and z.
    const auto near = std::find_if(values.begin(), values.end(), [&](const PosedCurvature& value) {
      return std::abs(value.at[0] - points[3 * i]) < 1e-4 &&
             std::abs(value.at[2] - points[3 * i + 1]) < 1e-4 &&
             std::abs(value.at[1] - points[3 * i + 2]) < 2.6;
    });
    REQUIRE(near != values.end());
    CHECK(k[i] == Approx(near->curvature.K_area));
    CHECK(h[i] == Approx(near->curvature.H));
  }
  CHECK(found == 2 * values.size());
  const auto of_faces = blob.floats("face_k");
  REQUIRE(of_faces.size() == sphere.pattern.faces());
  CHECK(std::count_if(of_faces.begin(), of_faces.end(), [](float f) { return std::isfinite(f); }) >
        0);
}

TEST_CASE("a lattice blob measures faces as pictures do, and shows the target coarsely",
          "[core][blob]") {
  const Design cylinder = made_of(R"({"popcut": 1, "surface": {"type": "revolution",
    "radius": "50"}, "units_per_slice": 4, "slices": 5, "widths_mm": 12})");
  const LatticeReader blob(*lattice_blob(cylinder, {.most_ghost_triangles = 500}));
  const auto corners = blob.words("triangles"), face_of = blob.words("triangle_face");
  const auto kind = blob.bytes("face_kind");
  const auto error = blob.floats("face_error");
  const auto at = blob.opened(std::numbers::pi / 2);
  std::vector<double> sum(kind.size()), area(kind.size());
  for (std::size_t t = 0; t < face_of.size(); ++t) {
    const auto &a = at[corners[3 * t]], &b = at[corners[3 * t + 1]], &c = at[corners[3 * t + 2]];
    const double size = std::abs((b[0] - a[0] + b[2] - a[2]) * (c[1] - a[1]) -
                                 (b[1] - a[1]) * (c[0] - a[0] + c[2] - a[2]));
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; i + j < kSteps; ++j) {
        const double p = (i + 1.0 / 3) / kSteps, q = (j + 1.0 / 3) / kSteps;
        const double x = a[0] + p * (b[0] - a[0]) + q * (c[0] - a[0]);
        const double z = a[2] + p * (b[2] - a[2]) + q * (c[2] - a[2]);
        sum[face_of[t]] += size * std::abs(std::hypot(x, z) - 50);
        area[face_of[t]] += size;
      }
  }
  for (std::size_t f = 0; f < kind.size(); ++f) {
    CAPTURE(f, kind[f]);
    if (kind[f] != 0)
      CHECK(error[f] == 0);
    else
      CHECK(error[f] == Approx(sum[f] / area[f]).epsilon(0.08).margin(0.05));  // nine samples
  }
  const auto worst = std::max_element(error.begin(), error.end());
  CHECK(blob.head["error_mm"]["max"].get<float>() == *worst);
  const auto place = static_cast<std::size_t>(worst - error.begin());
  CHECK(blob.head["error_mm"]["at"]["slice"] == blob.numbers("face_slice")[place]);
  CHECK(blob.head["error_mm"]["at"]["level"] == blob.numbers("face_level")[place]);

  const auto ghost = blob.floats("ghost_points");
  const auto ghost_corners = blob.words("ghost_triangles");
  CHECK(ghost_corners.size() % 3 == 0);
  CHECK(ghost_corners.size() / 3 <= 500);
  CHECK(ghost_corners.size() / 3 > 50);
  for (const std::uint32_t corner : ghost_corners) REQUIRE(3 * corner + 2 < ghost.size());
  for (std::size_t i = 0; i < ghost.size(); i += 3)
    CHECK(std::hypot(ghost[i], ghost[i + 2]) == Approx(50).margin(2));
  CHECK_FALSE(LatticeReader(*lattice_blob(cylinder, {.error = false})).has("ghost_points"));
}

TEST_CASE("a lattice blob marks the panels beside a level that was left out", "[core][blob]") {
  const Design steep = made_of(R"j({"popcut": 1, "surface": {"type": "revolution",
    "radius": "50 + 25*sin(y/20)"}, "units_per_slice": 8, "slices": 12, "widths_mm": 10,
    "lattice": "levels", "min_panel_mm": 3})j");
  REQUIRE_FALSE(steep.report.merged.empty());
  const LatticeReader blob(*lattice_blob(steep));
  const auto merged = blob.bytes("face_merged"), kind = blob.bytes("face_kind");
  const auto slice = blob.numbers("face_slice"), level = blob.numbers("face_level");
  CHECK(std::count(merged.begin(), merged.end(), 1) > 0);
  for (std::size_t f = 0; f < merged.size(); ++f) {
    if (merged[f] == 0) continue;
    CAPTURE(f, slice[f], level[f]);
    CHECK(kind[f] == 0);
    // Joined panels belong to a slice and to the connectors beside it.
    CHECK(std::any_of(steep.report.merged.begin(), steep.report.merged.end(),
                      [&](const MergedPlace& place) {
                        return std::abs(place.slice - slice[f]) <= 1 && place.level != level[f];
                      }));
  }
}

TEST_CASE("a lattice blob of glued parts lays them side by side", "[core][blob]") {
  const auto spec =
      testing::value(parse_design_spec(R"({"popcut": 1, "name": "two", "join": "seam", "patches": [
    {"surface": {"type": "revolution", "radius": "40"}, "units_per_slice": 3, "slices": 3,
     "widths_mm": 12, "card": {"wall_mm": 90}},
    {"surface": {"type": "revolution", "radius": "40"}, "units_per_slice": 4, "slices": 3,
     "widths_mm": 12, "card": {"wall_mm": 110}}]})"));
  const auto assembly = testing::value(design_assembly(spec));
  REQUIRE(assembly.parts.size() == 2);
  const LatticeReader blob(*lattice_blob(assembly, {.curvature = true}));
  CHECK(blob.head["name"] == "two");
  CHECK(blob.head["card"]["wall_mm"] == 110.0);
  CHECK(blob.head["card"]["width_mm"] == Approx(assembly.v_mm));
  CHECK(blob.head["report"]["parts"].size() == 2);
  const Pattern &a = assembly.parts[0].pattern, &b = assembly.parts[1].pattern;
  const auto part = blob.numbers("face_part");
  REQUIRE(part.size() == a.faces() + b.faces());
  CHECK(part.front() == 0);
  CHECK(part.back() == 1);
  const auto at = blob.opened(1.2);
  const auto due_a = posed_vertices(a, 1.2), due_b = posed_vertices(b, 1.2);
  REQUIRE(at.size() == due_a.size() + due_b.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    const bool is_a = i < due_a.size();
    const auto& due = is_a ? due_a[i] : due_b[i - due_a.size()];
    CHECK(at[i][0] == Approx(due[0]).margin(1e-4));
    CHECK(at[i][1] == Approx(due[1] + (is_a ? 0 : a.width_mm)).margin(1e-4));
    CHECK(at[i][2] == Approx(due[2]).margin(1e-4));
  }
  // Lines lie where the points say.
  const auto lines = blob.floats("lines");
  const std::size_t second = 4 * a.lines.size();
  CHECK(lines[1 + second] == Approx(b.lines.front().v0 + a.width_mm));
  CHECK(lines[0] == Approx(a.lines.front().u0 + 20));
  CHECK(lines[second] == Approx(b.lines.front().u0));
  const auto k = blob.floats("point_k");
  CHECK(k.size() == at.size());
}

TEST_CASE("a lattice blob refuses what cannot be shown", "[core][blob]") {
  Pattern bow = slit_sheet();
  bow.face_vertices = {0, 3, 2, 5};
  bow.face_first = {0, 4};
  const auto crossed = lattice_blob(bow);
  REQUIRE_FALSE(crossed);
  CHECK(crossed.error().kind == ErrorKind::OutOfRange);
  CHECK(crossed.error().place == "faces/0");
  const auto short_frame = lattice_blob(slit_sheet(), LatticeFrames{{1.0}, {{Vec3(), Vec3()}}});
  REQUIRE_FALSE(short_frame);
  CHECK(short_frame.error().place == "frames/0");
  CHECK_FALSE(lattice_blob(slit_sheet(), LatticeFrames{{1.0, 0.5}, {{}}}));
  const auto large = lattice_blob(slit_sheet(), {.most_ghost_triangles = 5'000'000});
  REQUIRE_FALSE(large);
  CHECK(large.error().kind == ErrorKind::OutOfRange);
  CHECK(large.error().detail.find("256 MiB") != std::string::npos);
}

}  // namespace lattice_blob_test
