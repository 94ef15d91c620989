// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>
#include <string>

#include <catch2/catch.hpp>

#include "core/geometry/triangulate.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace verify_property_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("a file with any bytes changed is verified without a crash", "[core][verify][property]") {
  const std::string sound = draft_of(CylinderCard{.levels = 2, .slices = 2}).text();
  const unsigned seed = 20261121;
  CAPTURE(seed);
  std::mt19937 random(seed);
  const std::string alphabet = "0123456789.-+eE[]{},:\"nulBMVFUCJ \n\\\x80";
  std::size_t read = 0;
  for (int round = 0; round < 400; ++round) {
    CAPTURE(round);
    std::string text = sound;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 20);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 30));
          break;
        default:
          text[at] = static_cast<char>('0' + random() % 10);
          break;
      }
    }
    const auto report = verify_fold(text);
    if (!report) {
      CHECK(exit_code(report.error().kind) == 3);
      CHECK_FALSE(report.error().detail.empty());
      continue;
    }
    ++read;
    CHECK_FALSE(verify_text(*report).empty());
    CHECK(verify_json(*report).back() == '\n');
  }
  CHECK(read > 20);  // not everything may be refused before it is judged
}

TEST_CASE("flat files with changed numbers are opened or refused and always verified",
          "[core][verify][property]") {
  const unsigned seed = 20261122;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> change(-8.0, 8.0);
  std::size_t opened = 0;
  const int all = testing::rounds(160, 4);
  for (int round = 0; round < all; ++round) {
    CAPTURE(round);
    FoldDraft draft = draft_of(CylinderCard{.levels = 2, .slices = 2});
    draft.poses.clear();
    if (round % 2 == 0) draft.key_angle_deg.clear();
    if (round % 4 < 2) draft.faces.clear();
    const int changes = static_cast<int>(random() % 6);
    for (int k = 0; k < changes; ++k) {
      const std::size_t vertex = random() % draft.flat.size();
      const std::size_t edge = random() % draft.edges.size();
      switch (random() % 5) {
        case 0:
          draft.flat[vertex][random() % 2] += change(random);
          break;
        case 1:
          draft.assignment[edge] = "BMVFUCJ"[random() % 7];
          break;
        case 2:
          draft.edges[edge][random() % 2] = vertex == draft.edges[edge][0] ? 0 : vertex;
          break;
        case 3:
          draft.flat[vertex] = draft.flat[random() % draft.flat.size()];
          break;
        default:
          if (!draft.faces.empty())
            draft.faces.erase(draft.faces.begin() +
                              static_cast<long>(random() % draft.faces.size()));
          break;
      }
    }
    const auto report = verify_fold(draft.text());
    if (!report) {
      CHECK(exit_code(report.error().kind) == 3);
      continue;
    }
    CHECK(verify_json(*report).back() == '\n');
    if (changes == 0) {
      INFO(verify_text(*report));
      CHECK(report->ok());
    }
    if (report->opening && report->opening->reached_psi_rad < 3.0) ++opened;
  }
  CHECK(static_cast<int>(opened) > all / 4);
}

TEST_CASE("a pattern with one number changed is never called sound", "[core][verify][property]") {
  const FoldDraft sound = draft_of(CylinderCard{.levels = 3, .slices = 3});
  REQUIRE(verify_fold(sound.text(), {.degrees_of_freedom = 1})->ok());
  const unsigned seed = 7;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> change(0.01, 3.0);
  for (int round = 0; round < 150; ++round) {
    CAPTURE(round);
    FoldDraft draft = sound;
    const double by = (random() % 2 == 0 ? 1.0 : -1.0) * change(random);
    const std::size_t vertex = random() % draft.flat.size();
    const std::size_t fold = draft.assignment.find(random() % 2 == 0 ? 'M' : 'V', random() % 10);
    switch (random() % 6) {
      case 0:
        draft.flat[vertex][random() % 2] += by;
        break;
      case 1:
        draft.poses[random() % 3].at[vertex][random() % 3] += by;
        break;
      case 2:
        draft.poses[random() % 3].angle_deg[fold] += 0.01 * by;
        break;
      case 3:
        draft.assignment[fold] = draft.assignment[fold] == 'M' ? 'V' : 'M';
        break;
      case 4:
        draft.faces.erase(draft.faces.begin() + static_cast<long>(random() % draft.faces.size()));
        break;
      default:
        draft.key_angle_deg[fold] *= -1.0;
        break;
    }
    const auto report = verify_fold(draft.text(), {.degrees_of_freedom = 1});
    CHECK((!report || !report->ok()));
  }
}

TEST_CASE("lattices of random sizes are sound with one freedom", "[core][verify][property]") {
  const unsigned seed = 3;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> measure(2.0, 90.0);
  for (int round = 0; round < 12; ++round) {
    const CylinderCard card{.levels = 2 + static_cast<int>(random() % 5),
                            .slices = 2 + static_cast<int>(random() % 4),
                            .radius_mm = measure(random),
                            .width_mm = measure(random),
                            .margin_mm = measure(random)};
    CAPTURE(card.levels, card.slices, card.radius_mm, card.width_mm, card.margin_mm);
    const auto report = value(verify_fold(draft_of(card).text(), {.degrees_of_freedom = 1}));
    INFO(verify_text(report));
    CHECK(report.ok());
    CHECK(report.crossing_method == "exact");
  }
}

TEST_CASE("triangles of a comb make up its area and none overlaps another",
          "[core][verify][property]") {
  const unsigned seed = 11;
  CAPTURE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    // A wall with teeth of random depth, as the panels of a lattice leave it.
    std::vector<Vec2> points{{0.0, 0.0}};
    const std::size_t teeth = 1 + random() % 12;
    for (std::size_t k = 0; k < teeth; ++k) {
      const double depth = 2.0 + static_cast<double>(random() % 8);
      points.push_back({depth, static_cast<double>(k)});
      points.push_back({depth, static_cast<double>(k + 1)});
    }
    points.push_back({0.0, static_cast<double>(teeth)});
    std::vector<std::uint32_t> polygon;
    double whole = 0.0;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      polygon.push_back(k);
      whole += 0.5 * cross(points[k], points[(k + 1) % points.size()]);
    }
    std::vector<Triangle> triangles;
    REQUIRE(triangulate(points, polygon, triangles));
    const auto corners = [&](const Triangle& t) {
      return std::array{points[t[0]], points[t[1]], points[t[2]]};
    };
    double sum = 0.0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      sum += common_area(corners(triangles[i]), corners(triangles[i]));
      for (std::size_t j = 0; j < i; ++j) {
        CHECK(common_area(corners(triangles[i]), corners(triangles[j])) < 1e-9);
      }
    }
    CHECK(sum == Approx(whole));
  }
}

}  // namespace verify_property_test
