// SPDX-License-Identifier: MIT
// Goldens of the paper's figures by an independent prototype, used where they are at hand.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/curvature/assembly.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/value.hpp"

namespace curvature_goldens_test {

using namespace popcut;
using nlohmann::json;
using popcut::testing::golden;

TEST_CASE("K and H over r, lambda and phi equal the golden values", "[core][curvature][golden]") {
  const auto data = golden("golden_KH.json");
  if (!data) return;
  REQUIRE((*data)["grid"].size() == 240);
  for (const json& row : (*data)["grid"]) {
    const VertexCurvature c = curvature_of({row[1], row[2], row[0]});
    CAPTURE(row.dump());
    REQUIRE(c.K == Approx(row[3].get<double>()).margin(1e-12));
    REQUIRE(c.H == Approx(row[4].get<double>()).margin(1e-12));
  }
  constexpr double kPhi = std::numbers::pi / 4;
  for (const json& target : (*data)["min"]) {
    for (const json& family : target["families_lam_roots_r"])
      for (const json& r : family[1])
        REQUIRE(curvature_of({r, family[0], kPhi}).K ==
                Approx(target["Kt"].get<double>()).margin(1e-9));
    const auto found = testing::value(solve_assembly({target["Kt"], std::nullopt, kPhi}));
    const json& nearest = target["nearest_to_(3/sqrt2,1)"];
    const double away =
        std::hypot(found.assembly.r - 3 / std::numbers::sqrt2, found.assembly.lambda - 1);
    CHECK(away == Approx(nearest[0].get<double>()).margin(1e-7));
  }
  for (const json& joint : (*data)["joint"]) {
    const double K = joint[0][0], H = joint[0][1], lambda = joint[1][1][1];
    CAPTURE(K, H);
    const auto found = solve_assembly({K, H, kPhi});
    if (lambda > 1e6) {  // the prototype runs to infinity there
      CHECK_FALSE(found);
      continue;
    }
    REQUIRE(found);
    CHECK(found->reached.K == Approx(K).margin(1e-9));
    CHECK(found->reached.H == Approx(H).margin(1e-9));
    const auto away = [](double r, double l) {
      return std::hypot(r - 3 / std::numbers::sqrt2, l - 1);
    };
    const double r = joint[1][1][0];
    CHECK(away(found->assembly.r, found->assembly.lambda) <= away(r, lambda) + 1e-7);
  }
}

}  // namespace curvature_goldens_test
