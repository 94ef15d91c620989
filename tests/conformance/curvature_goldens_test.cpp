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

#include "core/figures/assembly.hpp"
#include "core/figures/slice_figures.hpp"
#include "core/figures/splay_patch.hpp"
#include "tests/support/paths.hpp"

namespace curvature_goldens_test {

using namespace popcut;
using nlohmann::json;

namespace {

std::optional<json> golden(const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(popcut::testing::source_file("../shared/data/paper")) / name;
  std::ifstream in(path);
  if (!in) {
    WARN("skipped: no " << name);
    return std::nullopt;
  }
  return json::parse(in);
}

}  // namespace

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
    const auto found = solve_assembly({target["Kt"], std::nullopt, kPhi});
    REQUIRE(found);
    const json& nearest = target["nearest_to_(3/sqrt2,1)"];
    const double away =
        std::hypot(found->assembly.r - 3 / std::numbers::sqrt2, found->assembly.lambda - 1);
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

TEST_CASE("the azimuthal error equals the golden values in both conventions",
          "[core][curvature][golden]") {
  const auto data = golden("golden_Lphi.json");
  if (!data) return;
  for (const int units : {3, 5, 7, 9, 20, 50}) {
    for (const auto& [convention, name] :
         {std::pair(AzimuthalConvention::Vertices, "A N+1 vertices, j*dphi"),
          std::pair(AzimuthalConvention::OuterCorners, "D outer corner (x_i,z_{i-1})")}) {
      const json& due = (*data)[std::to_string(units) + "|" + name];
      const auto error = azimuthal_error(units, convention);
      REQUIRE(error);
      CAPTURE(units, name);
      CHECK(error->mean() == Approx(due["mean"].get<double>()).epsilon(1e-9));
      REQUIRE(error->value.size() == due["normalised"].size());
      for (std::size_t k = 0; k < error->value.size(); ++k)
        CHECK(error->value[k] / error->mean() ==
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
    const auto root = alpha_across_for_zero(patch, 0.28 * kPi);
    REQUIRE(root);
    CHECK(*root == Approx(patch.alpha_across).margin(1e-9));
  }
  const SplayPatch best = patch_of((*data)["patches"][0]);
  for (const json& row : (*data)["best_trajectory_psi_over_pi_K"])
    CHECK(curvature_of(best, row[0].get<double>() * kPi).K ==
          Approx(row[1].get<double>()).margin(1e-12));
}

}  // namespace curvature_goldens_test
