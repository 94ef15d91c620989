// SPDX-License-Identifier: MIT
#include <numbers>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/figures/slice_figures.hpp"
#include "core/figures/splay_patch.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/value.hpp"

namespace figures_goldens_test {

using namespace popcut;
using nlohmann::json;
using popcut::testing::golden;

TEST_CASE("the azimuthal error equals the golden values in both conventions",
          "[core][curvature][golden]") {
  const auto data = golden("golden_Lphi.json");
  if (!data) return;
  for (const int units : {3, 5, 7, 9, 20, 50}) {
    for (const auto& [convention, name] :
         {std::pair(AzimuthalConvention::Vertices, "A N+1 vertices, j*dphi"),
          std::pair(AzimuthalConvention::OuterCorners, "D outer corner (x_i,z_{i-1})")}) {
      const json& due = (*data)[std::to_string(units) + "|" + name];
      const auto error = testing::value(azimuthal_error(units, convention));
      CAPTURE(units, name);
      CHECK(error.mean() == Approx(due["mean"].get<double>()).epsilon(1e-9));
      REQUIRE(error.value.size() == due["normalised"].size());
      for (std::size_t k = 0; k < error.value.size(); ++k)
        CHECK(error.value[k] / error.mean() ==
              Approx(due["normalised"][k].get<double>()).margin(1e-7));
    }
  }
}

TEST_CASE("splay angles and patches equal the golden values", "[core][curvature][golden]") {
  const auto data = golden("golden_splay.json");
  if (!data) return;
  for (const json& row : (*data)["theta_table_psi_alpha_theta"])
    REQUIRE(splay_angle_rad(row[1], row[0]) == Approx(row[2].get<double>()).margin(1e-14));
  constexpr double kPi = std::numbers::pi;
  const auto patch_of = [](const json& row) {
    SplayPatch patch;
    patch.w = row["w"];
    patch.pitch_along = patch.pitch_across = row["g"];
    patch.alpha = row["alpha0"];
    patch.alpha_along = row["alpha_x"];
    patch.alpha_across = row["alpha_y"];
    return patch;
  };
  for (const json& row : (*data)["patches"]) {
    const SplayPatch patch = patch_of(row);
    CAPTURE(row.dump());
    CHECK(curvature_of(patch, 0.16 * kPi).K == Approx(row["K"][0].get<double>()).margin(1e-12));
    CHECK(curvature_of(patch, 0.28 * kPi).K == Approx(0).margin(1e-12));
    CHECK(curvature_of(patch, 0.47 * kPi).K == Approx(row["K"][2].get<double>()).margin(1e-12));
    const auto root = testing::value(alpha_across_for_zero(patch, 0.28 * kPi));
    CHECK(root == Approx(patch.alpha_across).margin(1e-9));
  }
  const SplayPatch best = patch_of((*data)["patches"][0]);
  for (const json& row : (*data)["best_trajectory_psi_over_pi_K"])
    CHECK(curvature_of(best, row[0].get<double>() * kPi).K ==
          Approx(row[1].get<double>()).margin(1e-12));
}

}  // namespace figures_goldens_test
