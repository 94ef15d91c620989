// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/figures/paper_figures.hpp"
#include "core/figures/slice_figures.hpp"
#include "core/figures/splay_patch.hpp"
#include "tests/support/value.hpp"

namespace figures_test {

using namespace popcut;

namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

TEST_CASE("the splay angle is the paper's on the branch past a right angle",
          "[core][curvature][splay]") {
  for (double alpha = 0.05; alpha < 4; alpha += 0.11) {
    for (double psi = 0.0; psi < kPi; psi += 0.07) {
      const double a = alpha * std::cos(psi / 2);
      REQUIRE(splay_angle_rad(alpha, psi) == Approx(std::atan2(2 * a, 1 - a * a)).margin(1e-13));
    }
  }
}

TEST_CASE("a splayed patch turns from a dome into a saddle as it opens",
          "[core][curvature][splay]") {
  SplayPatch patch;
  patch.alpha = 0.8;
  patch.alpha_along = 0.3;
  const auto across = testing::value(alpha_across_for_zero(patch, 0.28 * kPi));
  CHECK(across == Approx(2.796420435733).margin(1e-11));
  patch.alpha_across = across;
  CHECK(curvature_of(patch, 0.16 * kPi).K == Approx(0.05578106942315).margin(1e-12));
  CHECK(std::abs(curvature_of(patch, 0.28 * kPi).K) < 1e-12);
  CHECK(curvature_of(patch, 0.47 * kPi).K == Approx(-0.17575600674481).margin(1e-12));
  patch.alpha_along = 5.0;  // so low on the far side that it is the same there
  patch.alpha = 0.0;
  CHECK_FALSE(alpha_across_for_zero(patch, 0.28 * kPi));
}

TEST_CASE("the loss of a quarter circle falls in proportion to the spacing",
          "[core][curvature][figures]") {
  std::vector<double> spacing, loss;
  for (const int units : {100, 200, 400, 1000}) {
    const auto value = testing::value(quarter_circle_loss(units));
    spacing.push_back(1.0 / units);
    loss.push_back(value);
  }
  CHECK(log_log_slope(spacing, loss) == Approx(1.0).margin(0.01));
  CHECK(loss.back() * 1000 == Approx(kPi * kPi / 4 - 2).epsilon(1e-4));
}

TEST_CASE("the paper's figures are all drawn and all their statements hold",
          "[core][curvature][figures]") {
  const auto figures = testing::value(paper_figures());
  for (const CheckedStatement& statement : figures.statements) {
    CAPTURE(statement.figure, statement.claim, statement.value);
    CHECK(statement.holds);
  }
  for (const std::string name :
       {"fig1c", "fig1d", "fig2c_top", "fig2c_bottom", "fig3c", "fig3d", "figS5"}) {
    for (const std::string ending : {".svg", ".csv"}) {
      CAPTURE(name, ending);
      CHECK(std::any_of(figures.files.begin(), figures.files.end(),
                        [&](const FigureFile& f) { return f.name == name + ending; }));
    }
  }
  for (const FigureFile& file : figures.files) {
    pugi::xml_document document;
    if (file.name.ends_with(".svg")) CHECK(document.load_string(file.content.c_str()));
  }
}

}  // namespace figures_test
