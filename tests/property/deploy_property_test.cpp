// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/deploy/glb.hpp"
#include "core/deploy/loaded_pattern.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/deploy/sheet_mesh.hpp"
#include "core/design/design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "tests/support/glb_scene.hpp"
#include "tests/support/value.hpp"

namespace deploy_property_test {

using namespace popcut;
using namespace std::numbers;
using testing::GlbScene;

namespace {

constexpr unsigned kSeed = 20261121;

/// Designs of many kinds: radii, units, slices, with a card or without, with V-folds or without.
std::optional<Design> random_design(std::mt19937& random) {
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  const auto whole = [&](int low, int high) {
    return std::uniform_int_distribution(low, high)(random);
  };
  const bool splayed = whole(0, 3) == 0;
  std::string surface =
      fmt::format(R"j({{"type": "revolution", "radius": "{:.2f} + {:.2f}*cos({:.3f}*y)"}})j",
                  number(40, 60), number(-8, 8), number(0.01, 0.05));
  std::string rest = whole(0, 2) == 0 ? R"(, "card": false)" : "";
  if (splayed) {
    surface = fmt::format(R"({{"type": "profile", "z": "{0:.2f} - x"}})", number(60, 90));
    rest = fmt::format(R"(, "splay": {{"alpha": {:.2f}, "length_mm": 4}})", number(0.3, 2));
  }
  const std::string text = fmt::format(
      R"({{"popcut": 1, "name": "random", "surface": {}, "units_per_slice": {}, "slices": {},
      "widths_mm": {:.2f}{}}})",
      surface, splayed ? whole(2, 4) : whole(1, 7), whole(2, 8), number(11, 16), rest);
  INFO(text);
  auto made = design(testing::value(parse_design_spec(text)));
  if (!made) return std::nullopt;  // not every random target has a pattern
  return std::move(*made);
}

template <typename Check>
void for_designs(int wanted, Check check) {
  std::mt19937 random(kSeed);
  int made = 0, splayed = 0, loose = 0;
  for (int i = 0; i < 4 * wanted && made < wanted; ++i) {
    CAPTURE(kSeed, i);
    const auto found = random_design(random);
    if (!found) continue;
    ++made;
    splayed += found->pattern.v_folds.empty() ? 0 : 1;
    loose += found->pattern.card ? 0 : 1;
    check(*found, random);
  }
  CHECK(made == wanted);
  CHECK(splayed > 0);
  CHECK(loose > 0);
}

}  // namespace

TEST_CASE("every face stays congruent and on its hinge in all poses", "[core][deploy]") {
  for_designs(24, [](const Design& made, std::mt19937&) {
    const Pattern& pattern = made.pattern;
    const auto angles = opening_angles(pi, 0, 13);
    const auto table = testing::value(pose_table(pattern, *angles));
    double off = 0, apart = 0;
    for (std::size_t k = 0; k < table.poses(); ++k) {
      const auto due = posed_vertices(pattern, (*angles)[k]);
      for (std::size_t f = 0; f < pattern.faces(); ++f) {
        for (const std::uint32_t i : pattern.face(f)) {
          const Vec3 flat = flat_place(pattern, pattern.vertices[i]);
          off = std::max(off, norm(table.at(k, f)(flat) - vec3(due[i])));
        }
      }
      for (std::size_t b = 0; b < table.bodies(); ++b) {
        if (table.parent[b] < 0) continue;
        const auto parent = static_cast<std::size_t>(table.parent[b]);
        apart = std::max(
            apart, norm(table.at(k, b)(table.pivot[b]) - table.at(k, parent)(table.pivot[b])));
      }
    }
    CHECK(off < 1e-9);
    CHECK(apart < 1e-9);
    CHECK(table.order.size() == table.bodies());
  });
}

TEST_CASE("the nodes of a GLB composed along the tree match the pattern", "[core][deploy][glb]") {
  for_designs(10, [](const Design& made, std::mt19937& random) {
    const Pattern& pattern = made.pattern;
    const double from = pi, to = std::uniform_real_distribution(0.0, 2.0)(random);
    const auto angles = opening_angles(from, to, 61);
    const auto table = testing::value(pose_table(pattern, *angles));
    const auto bytes = testing::value(glb(pattern, table, {}));
    const GlbScene scene(bytes);
    const auto faces = testing::value(triangulate_faces(pattern));
    // At keys all is exact; between them panels are, too, while V-folds follow within their steps.
    const bool exact = pattern.v_folds.empty();
    double off = 0;
    for (const double part : {0.0, 0.25, exact ? 0.4137 : 0.5, 1.0}) {
      const auto due = posed_vertices(pattern, from + part * (to - from));
      for (std::size_t f = 0; f < pattern.faces(); ++f) {
        const auto places = scene.places(f, part * scene.seconds());
        for (std::size_t c = 0; c < places.size(); ++c) {
          const Vec3& corner = faces.corner[faces.first_corner[f] + c];
          double nearest = 1e9;
          for (const std::uint32_t i : pattern.face(f)) {
            if (norm(flat_place(pattern, pattern.vertices[i]) - corner) > 1e-9) continue;
            const Vec3 world{due[i][1], due[i][2], due[i][0]};  // y up, metres
            nearest = std::min(nearest, norm(1000.0 * places[c] - world));
          }
          off = std::max(off, nearest);
        }
      }
    }
    CHECK(off < 2e-4);  // mm; numbers of a GLB have seven digits, and a chain has some joints
  });
}

TEST_CASE("meshes keep the sheet's area and solids are closed", "[core][deploy][stl]") {
  for_designs(16, [](const Design& made, std::mt19937&) {
    const Pattern& pattern = made.pattern;
    double sheet = 0;
    for (std::size_t f = 0; f < pattern.faces(); ++f) {
      const auto face = pattern.face(f);
      for (std::size_t i = 0; i < face.size(); ++i)
        sheet += cross(flat_place(pattern, pattern.vertices[face[i]]),
                       flat_place(pattern, pattern.vertices[face[(i + 1) % face.size()]]))[2] /
                 2;
    }
    for (const auto& mesh : {surface_mesh(pattern), surface_mesh(pattern, made.strips)}) {
      REQUIRE(mesh);
      double area = 0;
      for (const auto& [a, b, c] : mesh->triangles)
        area += cross(mesh->at[b] - mesh->at[a], mesh->at[c] - mesh->at[a])[2] / 2;
      CHECK(area == Approx(sheet));
    }
    const auto faces = testing::value(triangulate_faces(pattern));
    double thinnest = 1e9;
    for (const auto& [a, b, c] : faces.triangle)
      thinnest = std::min(
          thinnest, cross(faces.corner[b] - faces.corner[a], faces.corner[c] - faces.corner[a])[2]);
    CHECK(thinnest > 1e-6);
    if (pattern.v_folds.empty()) {
      CHECK(surface_mesh(pattern, made.strips)->triangles.size() == 2 * made.report.panels);
    }
    const auto solid = testing::value(solid_mesh(pattern, 0.3));
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const auto& [a, b, c] : solid.triangles)
      for (const auto& side : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++sides[side];
    const bool closed = std::all_of(sides.begin(), sides.end(), [&](const auto& entry) {
      return entry.second == 1 && sides.count({entry.first.second, entry.first.first}) == 1;
    });
    CHECK(closed);
  });
}

TEST_CASE("patterns come back from their FOLD files with their V-folds", "[core][deploy][fold]") {
  for_designs(12, [](const Design& made, std::mt19937& random) {
    const Pattern& pattern = made.pattern;
    std::ostringstream text;
    const double psi = std::uniform_real_distribution(0.2, 2.9)(random);
    REQUIRE(write_fold(pattern, {.psi_rad = std::vector{pi, psi}}, text));
    const auto back = testing::value(pattern_from_fold(testing::value(read_fold(text.str()))));
    CHECK(back.v_folds.size() == pattern.v_folds.size());
    double off = 0;
    for (const double angle : {3.0, 1.7, 0.4}) {
      const auto a = posed_vertices(pattern, angle), b = posed_vertices(back, angle);
      for (std::size_t i = 0; i < a.size(); ++i) off = std::max(off, norm(vec3(a[i]) - vec3(b[i])));
    }
    CHECK(off < 1e-9);
  });
}

TEST_CASE("a FOLD file with any bytes changed is deployed or refused", "[core][deploy][fold]") {
  std::mt19937 random(kSeed);
  const std::string alphabet = "0123456789.-+eE[]{},:\"nulBMVF \n";
  std::optional<Design> made;
  while (!made) made = random_design(random);
  std::ostringstream sound;
  REQUIRE(write_fold(made->pattern, {.psi_rad = std::vector{pi, 1.1}}, sound));
  std::size_t read = 0, deployed = 0;
  for (int round = 0; round < 400; ++round) {
    CAPTURE(kSeed, round);
    std::string text = sound.str();
    for (unsigned k = 0; k < 1 + random() % 3; ++k)
      text[random() % text.size()] = alphabet[random() % alphabet.size()];
    const auto file = read_fold(text);
    if (!file) continue;
    ++read;
    const auto pattern = pattern_from_fold(*file);
    if (!pattern) {
      CHECK_FALSE(pattern.error().detail.empty());
      continue;
    }
    const auto table = pose_table(*pattern, std::vector<double>{2.0, 1.0});
    if (!table) continue;
    const auto surface = surface_mesh(*pattern);
    const auto animation = glb(*pattern, *table, {});
    deployed += surface && animation ? 1 : 0;
  }
  CHECK(read > 20);
  CHECK(deployed > 0);
}

}  // namespace deploy_property_test
