// SPDX-License-Identifier: MIT
// Whatever is seen along the diagonal, facets make a card of it that folds.
#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

#include "core/design/facets/facets.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace facets_property_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

void add_box(std::mt19937& random, TriangleSoup& soup) {
  const Vec3 low(whole(random, 0, 1) * uniform(random, 0, 30), uniform(random, 0, 40),
                 whole(random, 0, 1) * uniform(random, 0, 30));
  const Vec3 high =
      low + Vec3(uniform(random, 4, 30), uniform(random, 4, 20), uniform(random, 4, 30));
  const auto at = [&](int i, int j, int k) {
    return Vec3(i ? high[0] : low[0], j ? high[1] : low[1], k ? high[2] : low[2]);
  };
  soup.add(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
  soup.add(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
}

void add_gable(std::mt19937& random, TriangleSoup& soup) {
  const double x = uniform(random, 15, 40), eave = uniform(random, 10, 30),
               ridge = eave + uniform(random, 5, 20), v0 = uniform(random, 0, 20),
               v1 = v0 + uniform(random, 12, 30), middle = 0.5 * (v0 + v1);
  soup.add({x, v0, 0}, {x, v1, 0}, {x, v1, eave}, {x, v0, eave});
  soup.add({x, v0, eave}, {x, v1, eave}, {x, middle, ridge});
  soup.add({0, v0, eave}, {x, v0, eave}, {x, middle, ridge}, {0, middle, ridge});
  soup.add({0, v1, eave}, {0, middle, ridge}, {x, middle, ridge}, {x, v1, eave});
}

void add_triangle(std::mt19937& random, TriangleSoup& soup) {
  const auto at = [&] {
    return Vec3(uniform(random, -5, 45), uniform(random, -5, 55), uniform(random, -5, 45));
  };
  soup.add(at(), at(), at());
}

/// The least panel along u, and the least stretch that joins panels of neighbouring strips.
double narrowest(const Strips& strips, double min_panel_mm) {
  double least = 1e9;
  for (std::size_t s = 0; s < strips.size(); ++s)
    for (std::uint32_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
      if (strips.is_cut(p)) continue;
      const std::size_t i = p + s;
      const auto across = [&](std::size_t point) { return strips.x[point] - strips.z[point]; };
      least = std::min(least, across(i + 1) - across(i));
      if (s + 1 == strips.size()) continue;
      for (std::uint32_t q = strips.first_panel[s + 1]; q < strips.first_panel[s + 2]; ++q) {
        if (strips.plane[q] != strips.plane[p]) continue;
        const std::size_t j = q + s + 1;
        const double joint =
            std::min(across(i + 1), across(j + 1)) - std::max(across(i), across(j));
        if (joint > 0.0 && is_joint(joint, min_panel_mm)) least = std::min(least, joint);
      }
    }
  return least;
}

TEST_CASE("random scenes of facets verify with one freedom, in one piece, and nothing too narrow",
          "[property][facets][verify]") {
  const unsigned seed = 20261125;
  std::mt19937 random(seed);
  int stands = 0, strutted = 0;
  const int scenes = testing::rounds(60);
  for (int k = 0; k < scenes; ++k) {
    CAPTURE(seed, k);
    TriangleSoup scene;
    const int things = whole(random, 1, 8);
    for (int i = 0; i < things; ++i) switch (whole(random, 0, 2)) {
        case 0:
          add_box(random, scene);
          break;
        case 1:
          add_gable(random, scene);
          break;
        default:
          add_triangle(random, scene);
      }
    FacetOptions options;
    options.pitch_mm = uniform(random, 1.5, 4);
    options.strip_mm = uniform(random, 1.5, 4);
    options.min_panel_mm = uniform(random, 0.3, 1.4);
    options.margin_mm = uniform(random, 1, 10);
    options.to_mm = uniform(random, 20, 60);
    options.inward = whole(random, 0, 3) == 0;
    if (whole(random, 0, 3) == 0) options.wall_mm = uniform(random, 25, 60);
    if (whole(random, 0, 3) == 0) options.ground_mm = uniform(random, 25, 60);
    const auto made = facet_card(scene, options);
    if (!made) {
      CAPTURE(message(made.error()));
      CHECK(made.error().kind == ErrorKind::Infeasible);
      continue;
    }
    const Pattern& pattern = made->pattern.built.pattern;
    stands += pattern.faces() > 2 ? 1 : 0;
    CHECK(made->pattern.motion.degrees_of_freedom == 1);
    CHECK(made->pattern.motion.pieces == 1);
    CHECK(made->figures.over_least >= 1.0 - 1e-9);
    CHECK(narrowest(made->pattern.strips.strips, options.min_panel_mm) >=
          options.min_panel_mm - 1e-9);
    if (options.wall_mm) CHECK(pattern.wall_mm == *options.wall_mm);
    std::ostringstream fold;
    REQUIRE(write_fold(pattern, {}, fold));
    VerifyOptions how;
    how.degrees_of_freedom = 1;
    const auto report = testing::value(verify_fold(fold.str(), how));
    if (!report.ok()) FAIL(verify_text(report));
    CHECK(report.faces == pattern.faces());
    if (made->repaired.struts.empty()) continue;
    // Without a strut that repair added the verifier finds more freedoms.
    ++strutted;
    const FacetStrut& strut = made->repaired.struts.front();
    LabelImage without = made->labels;
    std::copy(strut.without.begin(), strut.without.end(), without.strip(strut.strip).begin());
    const auto loose =
        testing::value(pattern_of(without, made->planes, made->card, options.min_panel_mm));
    std::ostringstream loose_fold;
    REQUIRE(write_fold(loose.built.pattern, {}, loose_fold));
    const auto judged = testing::value(verify_fold(loose_fold.str(), how));
    CHECK_FALSE(judged.ok());
    if (judged.pieces == 1) CHECK(judged.degrees_of_freedom > 1);  // or a piece falls out
  }
  CHECK(strutted > 0);
  CHECK(stands > scenes / 2);
}

}  // namespace facets_property_test
