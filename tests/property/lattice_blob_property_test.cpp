// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "tests/support/lattice_reader.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/value.hpp"

namespace lattice_blob_property_test {

using namespace popcut;
using testing::LatticeReader;
using testing::uniform;
using testing::whole;

namespace {

constexpr unsigned kSeed = 20261124;

std::optional<Design> random_design(std::mt19937& random) {
  const bool splayed = whole(random, 0, 2) == 0;
  std::string surface =
      fmt::format(R"j({{"type": "revolution", "radius": "{:.2f} + {:.2f}*cos({:.3f}*y)"}})j",
                  uniform(random, 40, 60), uniform(random, -8, 8), uniform(random, 0.01, 0.05));
  std::string rest = whole(random, 0, 2) == 0 ? R"(, "card": false)" : "";
  if (splayed) {
    surface = fmt::format(R"({{"type": "profile", "z": "{:.2f} - x"}})", uniform(random, 60, 90));
    rest =
        fmt::format(R"(, "splay": {{"alpha": {:.2f}, "length_mm": 4}})", uniform(random, 0.3, 2));
  }
  static constexpr std::array kLattices{"conformal", "levels", "slices", "direct"};
  const std::string text = fmt::format(
      R"({{"popcut": 1, "name": "random", "surface": {}, "units_per_slice": {}, "slices": {},
      "widths_mm": {:.2f}, "lattice": "{}"{}}})",
      surface, splayed ? whole(random, 2, 4) : whole(random, 1, 7), whole(random, 2, 8),
      uniform(random, 11, 16), kLattices.at(static_cast<std::size_t>(whole(random, 0, 3))), rest);
  INFO(text);
  auto made = design(testing::value(parse_design_spec(text)));
  if (!made) return std::nullopt;  // not every random target has a pattern
  return std::move(*made);
}

double sheet_u(const LatticeReader& blob, const std::vector<float>& points, std::size_t i) {
  return points[3 * i] + blob.head["card"]["wall_mm"].get<double>() - points[3 * i + 1];
}

/// Twice the area of the triangle on the sheet, counter-clockwise positive.
double twice_area(const std::array<std::array<double, 2>, 3>& t) {
  return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]);
}

void check_points(const LatticeReader& blob, const Pattern& pattern) {
  constexpr double kFloat = 1e-4;  // half a millionth of 200 mm, summed three times
  for (const double psi : {std::numbers::pi, std::numbers::pi / 2, 0.4}) {
    const auto is = blob.opened(psi), due = posed_vertices(pattern, psi);
    REQUIRE(is.size() == due.size());
    double off = 0;
    for (std::size_t i = 0; i < is.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(is[i][k] - due[i][k]));
    CHECK(off < kFloat);
  }
}

void check_triangles(const LatticeReader& blob, const Pattern& pattern) {
  const auto points = blob.floats("points");
  const auto corners = blob.words("triangles"), face_of = blob.words("triangle_face");
  const auto sides = blob.bytes("sides");
  REQUIRE(corners.size() == 3 * face_of.size());
  REQUIRE(sides.size() == corners.size());
  std::vector<double> area(pattern.faces());
  std::map<int, double> drawn;  // length by role
  for (std::size_t t = 0; t < face_of.size(); ++t) {
    std::array<std::array<double, 2>, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = corners[3 * t + k];
      at[k] = {sheet_u(blob, points, corner), points[3 * corner + 2]};
      const auto face = pattern.face(face_of[t]);
      CHECK(std::find(face.begin(), face.end(), corner) != face.end());
    }
    CHECK(twice_area(at) > 0);
    area[face_of[t]] += 0.5 * twice_area(at);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &a = at[k], &b = at[(k + 1) % 3];
      drawn[sides[3 * t + k]] += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
  }
  std::map<int, double> due;
  for (const PatternEdge& e : pattern.edges) {
    const PatternVertex &a = pattern.vertices[e.from], &b = pattern.vertices[e.to];
    const double length = std::hypot(pattern.u(a) - pattern.u(b), a.v - b.v);
    static constexpr std::array kNumber{2, 3, 4, 1};  // mountain, valley, slit, outline
    due[kNumber.at(static_cast<std::size_t>(e.role))] +=
        length * ((e.left >= 0 ? 1 : 0) + (e.right >= 0 ? 1 : 0));
  }
  for (const int role : {1, 2, 3, 4}) {
    CAPTURE(role);
    CHECK(drawn[role] == Approx(due[role]).epsilon(1e-5));  // of floats
  }
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    double twice = 0;
    const auto face = pattern.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const PatternVertex &a = pattern.vertices[face[k]],
                          &b = pattern.vertices[face[(k + 1) % face.size()]];
      twice += pattern.u(a) * b.v - pattern.u(b) * a.v;
    }
    CHECK(area[f] == Approx(0.5 * twice).epsilon(1e-4).margin(1e-3));
  }
}

/// Each side of a triangle that is drawn lies on an edge of that role.
void check_side_places(const LatticeReader& blob, const Pattern& pattern) {
  std::map<int, std::vector<const PatternEdge*>> edges;
  static constexpr std::array kNumber{2, 3, 4, 1};
  for (const PatternEdge& e : pattern.edges)
    edges[kNumber.at(static_cast<std::size_t>(e.role))].push_back(&e);
  const auto points = blob.floats("points");
  const auto corners = blob.words("triangles");
  const auto sides = blob.bytes("sides");
  std::size_t astray = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (sides[k] == 0) continue;
    const std::uint32_t i = corners[k], j = corners[k % 3 == 2 ? k - 2 : k + 1];
    const double u = 0.5 * (sheet_u(blob, points, i) + sheet_u(blob, points, j));
    const double v = 0.5 * (points[3 * i + 2] + points[3 * j + 2]);
    const bool found =
        std::any_of(edges[sides[k]].begin(), edges[sides[k]].end(), [&](const PatternEdge* e) {
          const PatternVertex &a = pattern.vertices[e->from], &b = pattern.vertices[e->to];
          const double du = pattern.u(b) - pattern.u(a), dv = b.v - a.v;
          const double length = std::hypot(du, dv);
          const double along = ((u - pattern.u(a)) * du + (v - a.v) * dv) / length;
          const double off = std::abs((u - pattern.u(a)) * dv - (v - a.v) * du) / length;
          return off < 1e-3 && along > 0 && along < length;
        });
    astray += found ? 0 : 1;
  }
  CHECK(astray == 0);
}

void check_lines(const LatticeReader& blob, const Pattern& pattern) {
  const auto lines = blob.floats("lines");
  const auto roles = blob.bytes("line_role");
  REQUIRE(lines.size() == 4 * pattern.lines.size());
  REQUIRE(roles.size() == pattern.lines.size());
  static constexpr std::array kNumber{2, 3, 4, 1};
  for (std::size_t k = 0; k < roles.size(); ++k) {
    const SheetLine& line = pattern.lines[k];
    CHECK(roles[k] == kNumber.at(static_cast<std::size_t>(line.role)));
    CHECK(lines[4 * k] == Approx(line.u0));
    CHECK(lines[4 * k + 1] == Approx(line.v0));
    CHECK(lines[4 * k + 2] == Approx(line.u1));
    CHECK(lines[4 * k + 3] == Approx(line.v1));
  }
}

/// Slices and levels of faces are those of the strips' panels that lie in them.
void check_faces(const LatticeReader& blob, const Design& design) {
  const auto kind = blob.bytes("face_kind"), merged = blob.bytes("face_merged");
  const auto slice = blob.numbers("face_slice"), level = blob.numbers("face_level");
  const auto error = blob.floats("face_error");
  REQUIRE(kind.size() == design.pattern.faces());
  REQUIRE(merged.size() == kind.size());
  REQUIRE(error.size() == kind.size());
  float worst = 0;
  for (std::size_t f = 0; f < kind.size(); ++f) {
    const auto face = design.pattern.face(f);
    const bool in_wall = std::all_of(face.begin(), face.end(), [&](std::uint32_t i) {
      return design.pattern.vertices[i].x == 0;
    });
    const bool in_ground = std::all_of(face.begin(), face.end(), [&](std::uint32_t i) {
      return design.pattern.vertices[i].z == 0;
    });
    if (design.pattern.card) CHECK(kind[f] == (in_wall ? 1 : in_ground ? 2 : 0));
    if (kind[f] == 0) worst = std::isfinite(error[f]) ? std::max(worst, error[f]) : worst;
    if (kind[f] != 0) CHECK((error[f] == 0 && slice[f] == -1 && level[f] == -1 && merged[f] == 0));
    if (kind[f] == 0) CHECK((slice[f] >= 0 && level[f] >= 0));
    CHECK(slice[f] < static_cast<int>(design.report.slices.size()));
  }
  CHECK(blob.head["error_mm"]["max"].get<float>() == worst);
  const bool any_merged = std::any_of(merged.begin(), merged.end(), [](int m) { return m == 1; });
  if (design.report.merged.empty()) CHECK_FALSE(any_merged);
}

}  // namespace

TEST_CASE("a lattice blob says where every vertex, fold and cut of a design is", "[core][blob]") {
  std::mt19937 random(kSeed);
  int made = 0, splayed = 0, loose = 0, with_merged = 0;
  for (int i = 0; i < 160 && made < 60; ++i) {
    CAPTURE(kSeed, i);
    const auto found = random_design(random);
    if (!found) continue;
    ++made;
    splayed += found->pattern.v_folds.empty() ? 0 : 1;
    loose += found->pattern.card ? 0 : 1;
    with_merged += found->report.merged.empty() ? 0 : 1;
    const auto bytes = testing::value(lattice_blob(*found, {.quality = LatticeQuality::Draft}));
    const LatticeReader blob(bytes);
    CHECK(blob.head["quality"] == "draft");
    CHECK(blob.head["motion"] == "pose");
    CHECK(blob.head["faces"] == found->pattern.faces());
    CHECK(blob.head["report"]["faces"] == found->report.faces);
    CHECK(blob.head["lattice"] == found->report.lattice);
    for (const auto& slice : blob.head["report"]["slices"]) {
      const double wall = slice["ends_mm"][0], ground = slice["ends_mm"][1];
      CHECK(wall > 0);  // quarter circles and 45 degree slopes
      CHECK(ground == Approx(wall));
    }
    check_points(blob, found->pattern);
    check_triangles(blob, found->pattern);
    check_side_places(blob, found->pattern);
    check_lines(blob, found->pattern);
    check_faces(blob, *found);
  }
  CHECK(made == 60);
  CHECK(splayed > 5);
  CHECK(loose > 5);
  CHECK(with_merged > 0);
}

}  // namespace lattice_blob_property_test
