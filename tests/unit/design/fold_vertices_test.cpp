// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/curvature/fold_lines.hpp"
#include "core/curvature/pattern_curvature.hpp"
#include "core/design/design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/value.hpp"

namespace fold_vertices_test {

using namespace popcut;

namespace {

constexpr double kPi = std::numbers::pi;

Design design_of(const std::string& lattice, int units, int slices, bool card = true,
                 const std::string& radius = "sqrt(36-(y-2.4)^2)") {
  const auto spec = testing::value(parse_design_spec(fmt::format(
      R"({{"popcut": 1, "name": "t", "surface": {{"type": "revolution", "radius": "{}"}},
           "scale_mm": 10, "units_per_slice": {}, "slices": {}, "widths_mm": 6,
           "lattice": "{}"{}}})",
      radius, units, slices, lattice, card ? "" : R"(, "card": false)")));
  return testing::value(design(spec));
}

std::string fold_text(const Design& made) {
  std::ostringstream out;
  REQUIRE(write_fold(made.pattern, {"test", std::vector{kPi}}, out));
  return out.str();
}

/// The connectors' valleys between wall and ground as the strips have them, as (x, v, z).
std::vector<Point3> inner_valleys(const Design& made) {
  std::vector<Point3> out;
  const Strips& strips = made.strips;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Connector) continue;
    for (std::size_t q = strips.first_point(s);
         q <= strips.first_point(s) + strips.first_panel[s + 1] - strips.first_panel[s]; ++q) {
      const std::size_t begin = strips.first_point(s);
      const std::size_t end = begin + strips.first_panel[s + 1] - strips.first_panel[s];
      if (q == begin || q == end) continue;
      const bool valley = strips.x[q] == strips.x[q - 1] && strips.z[q + 1] == strips.z[q];
      if (!valley || strips.x[q] == 0 || strips.z[q] == 0) continue;
      out.push_back({strips.x[q], 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]), strips.z[q]});
    }
  }
  return out;
}

bool has(const std::vector<FoldVertex>& vertices, const Point3& p) {
  for (const FoldVertex& vertex : vertices) {
    if (std::abs(vertex.x - p[0]) + std::abs(vertex.v - p[1]) + std::abs(vertex.z - p[2]) < 1e-6)
      return true;
  }
  return false;
}

}  // namespace

TEST_CASE("every fold vertex of a design is found in its FOLD file alone",
          "[core][curvature][pattern]") {
  for (const std::string lattice : {"conformal", "slices", "branching"}) {
    for (const auto& [units, slices] : {std::pair(2, 4), std::pair(5, 8), std::pair(7, 9)}) {
      CAPTURE(lattice, units, slices);
      const Design made = design_of(lattice, units, slices);
      const auto found = testing::value(fold_vertices_from_fold(fold_text(made)));
      const std::vector<Point3> due = inner_valleys(made);
      for (const Point3& p : due) {
        CAPTURE(p[0], p[1], p[2]);
        CHECK(has(found, p));
      }
      if (made.report.merged.empty()) {
        const auto all = static_cast<std::size_t>((units + 1) * (slices - 1));
        CHECK(found.size() == all);
        CHECK(inner_count(found) == static_cast<std::size_t>((units - 1) * (slices - 3)));
        for (const FoldVertex& vertex : found) {
          const bool inner =
              vertex.i > 0 && vertex.i < units && vertex.j > 0 && vertex.j < slices - 2;
          REQUIRE(vertex.inner() == inner);
          for (std::size_t n = 0; n < 4; ++n) {
            if (vertex.ring[n] < 0) continue;
            const FoldVertex& next = found[static_cast<std::size_t>(vertex.ring[n])];
            constexpr int kLevel[] = {1, 0, -1, 0}, kConnector[] = {0, 1, 0, -1};
            REQUIRE(next.i == vertex.i + kLevel[n]);
            REQUIRE(next.j == vertex.j + kConnector[n]);
          }
        }
      }
    }
  }
}

TEST_CASE("a sheet without a card has the same curvatures", "[core][curvature][pattern]") {
  for (const std::string lattice : {"slices", "conformal"}) {
    const auto with = fold_vertices_from_fold(fold_text(design_of(lattice, 5, 8)));
    const auto without = fold_vertices_from_fold(fold_text(design_of(lattice, 5, 8, false)));
    REQUIRE(with);
    REQUIRE(without);
    const auto a = pattern_curvature(*with, 1.1), b = pattern_curvature(*without, 1.1);
    REQUIRE(a.size() == b.size());
    REQUIRE_FALSE(a.empty());
    for (std::size_t k = 0; k < a.size(); ++k) {
      CHECK(a[k].i == b[k].i);
      CHECK(a[k].curvature.K == Approx(b[k].curvature.K).margin(1e-9));
      CHECK(a[k].at[0] == Approx(b[k].at[0]).margin(1e-6));
    }
  }
}

TEST_CASE("a sphere's pattern is a dome and a saddle's is not", "[core][curvature][pattern]") {
  const auto dome =
      testing::value(fold_vertices_from_fold(fold_text(design_of("conformal", 6, 10))));
  for (const double psi : {kPi / 2, 1.1, 2.5}) {
    for (const PosedCurvature& p : pattern_curvature(dome, psi)) {
      CHECK(p.curvature.K > 0);
      CHECK(p.curvature.H > 0);
    }
  }
  for (const PosedCurvature& p : pattern_curvature(dome, kPi)) {
    CHECK(p.curvature.K == Approx(0).margin(1e-12));
    CHECK(p.curvature.H == Approx(0).margin(1e-12));
  }
  const auto saddle =
      fold_vertices_from_fold(fold_text(design_of("conformal", 6, 10, true, "sqrt(20+(y-2.7)^2)")));
  REQUIRE(saddle);
  const auto values = pattern_curvature(*saddle, kPi / 2);
  CHECK(summary_of(values).K.mean < 0);
}

TEST_CASE("a cylinder drawn by hand has no Gaussian curvature in any pose",
          "[core][curvature][pattern]") {
  for (const bool card : {true, false}) {
    const auto found = testing::value(fold_vertices_from_fold(
        popcut::testing::draft_of(popcut::testing::CylinderCard{4, 6, 30, 10, 15, card}).text()));
    CHECK(inner_count(found) == 3 * 3);
    for (const double psi : {0.3, 1.1, kPi / 2, 2.6}) {
      for (const PosedCurvature& p : pattern_curvature(found, psi)) {
        CHECK(p.curvature.K == Approx(0).margin(1e-9));
        CHECK(p.curvature.H > 0);
      }
    }
    for (const FoldVertex& vertex : found)
      CHECK(std::hypot(vertex.x, vertex.z) == Approx(30).margin(1e-6));
  }
}

TEST_CASE("a V-fold on a crease moves its fold vertex to the tip", "[core][curvature][splay]") {
  FoldVertex vertex;
  vertex.x = 20;
  vertex.z = 30;
  vertex.v = 50;
  vertex.v_fold = CreaseVFold{47, 4, 0.8, 1};
  const Point3 flat = vertex.posed(kPi);
  CHECK(flat[1] == Approx(51));  // theta = 0: A lies on the crease
  CHECK(flat[0] == Approx(-10));
  for (const double psi : {0.5, 1.1, 2.0}) {
    const Point3 tip = vertex.posed(psi);
    const Point3 apex{20 + 30 * std::cos(psi), 47, 30 * std::sin(psi)};
    const double w = std::hypot(tip[0] - apex[0], tip[1] - apex[1], tip[2] - apex[2]);
    CHECK(w == Approx(4));
    // B lies on the level panel, w along and w alpha beyond the crease: AB keeps its length.
    const Point3 b{apex[0] + 4 * 0.8, 51, apex[2]};
    CHECK(std::hypot(tip[0] - b[0], tip[1] - b[1], tip[2] - b[2]) == Approx(3.2));
    const Point3 c{apex[0] + 3.2 * std::cos(psi), 51, apex[2] + 3.2 * std::sin(psi)};
    CHECK(std::hypot(tip[0] - c[0], tip[1] - c[1], tip[2] - c[2]) == Approx(3.2));
  }
}

TEST_CASE("a valley with a V-fold on it is one fold line that knows its V-fold",
          "[core][curvature][splay]") {
  for (const bool forward : {true, false}) {
    const auto v = [&](double along) { return forward ? along : 20 - along; };
    FoldFrame frame;  // crease from 0 to 20 at u = 30, apex at 6, w = 5, alpha = 0.6
    frame.vertices = {{30, v(0), 0},  {30, v(6), 0},  {30, v(11), 0},
                      {30, v(11), 0}, {30, v(20), 0}, {27, v(11), 0},
                      {33, v(11), 0}, {40, v(0), 0},  {40, v(20), 0}};
    frame.edges = {{0, 1}, {1, 2}, {3, 4}, {1, 5}, {1, 6}, {5, 2}, {2, 6}, {5, 3}, {3, 6}, {7, 8}};
    const std::string roles = "VMVVVBBBBM";
    frame.assignments.assign(roles.begin(), roles.end());
    frame.fold_angles_deg.assign(roles.size(), 0.0);
    const auto lines = fold_lines(frame, 1.0, 1e-6);
    REQUIRE(lines.size() == 2);
    CHECK_FALSE(lines[0].mountain);
    CHECK(lines[0].v0 == Approx(0).margin(1e-12));
    CHECK(lines[0].v1 == Approx(20));
    REQUIRE(lines[0].v_fold);
    CHECK(lines[0].v_fold->apex_v_mm == Approx(v(6)));
    CHECK(lines[0].v_fold->w_mm == Approx(5));
    CHECK(lines[0].v_fold->alpha == Approx(0.6));
    CHECK(lines[0].v_fold->sign == (forward ? 1.0 : -1.0));
    CHECK(lines[1].mountain);
    CHECK_FALSE(lines[1].v_fold);
  }
}

TEST_CASE("a pattern without connectors is refused in one clear line",
          "[core][curvature][pattern]") {
  const auto box = fold_vertices_from_fold(popcut::testing::box_card().text());
  REQUIRE_FALSE(box);
  CHECK(box.error().kind == ErrorKind::Infeasible);
  CHECK_FALSE(fold_vertices_from_fold("{}"));
  CHECK_FALSE(
      fold_vertices_from_fold(R"({"vertices_coords": [[0,0],[1,0]], "edges_vertices": []})"));
  CHECK_FALSE(fold_vertices_from_fold(
      R"({"vertices_coords": [[0,0],[1,0]], "edges_vertices": [[0,1]], "frame_unit": "parsec"})"));
}

TEST_CASE("strips that do not close are refused with the place", "[core][curvature][pattern]") {
  Design made = design_of("conformal", 4, 6);
  const auto sound = testing::value(fold_vertices_from_fold(fold_text(made)));
  const auto inner = std::find_if(sound.begin(), sound.end(),
                                  [](const FoldVertex& vertex) { return vertex.inner(); });
  REQUIRE(inner != sound.end());
  int moved = 0;  // that valley alone slides along the strip
  for (PatternVertex& p : made.pattern.vertices) {
    if (std::abs(p.x - inner->x) + std::abs(p.z - inner->z) > 1e-9) continue;
    p.x += 0.2;
    ++moved;
  }
  REQUIRE(moved >= 2);
  const auto found = fold_vertices_from_fold(fold_text(made));
  REQUIRE_FALSE(found);
  CHECK(found.error().kind == ErrorKind::Infeasible);
  CHECK(found.error().place.rfind("fold at u ", 0) == 0);
}

TEST_CASE("the table has one row per pose and inner vertex", "[core][curvature][pattern]") {
  const auto found =
      testing::value(fold_vertices_from_fold(fold_text(design_of("conformal", 3, 5))));
  std::ostringstream csv;
  write_curvature_csv(found, {kPi, kPi / 2, 3}, csv);
  const std::string text = csv.str();
  CHECK(text.rfind("psi,i,j,x,v,z,K,K_area,H,A\n", 0) == 0);
  CHECK(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) ==
        1 + 3 * inner_count(found));
}

}  // namespace fold_vertices_test
