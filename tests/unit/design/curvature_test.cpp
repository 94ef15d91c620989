// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include "core/curvature/assembly.hpp"
#include "core/curvature/vertex_curvature.hpp"
#include "tests/support/value.hpp"

namespace curvature_test {

using namespace popcut;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kQuarter = kPi / 4;

/// A regular pyramid: `sides` corners on the unit circle below a tip at `height`.
std::vector<Point3> circle(int sides) {
  std::vector<Point3> ring;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * kPi * k / sides;
    ring.push_back({std::cos(angle), std::sin(angle), 0.0});
  }
  return ring;
}

}  // namespace

TEST_CASE("a vertex in its ring's plane has no curvature", "[core][curvature]") {
  const std::vector<Point3> ring{{2, 0, 1}, {0.5, 1, 1}, {-1, 0.2, 1}, {-0.3, -2, 1}};
  const VertexCurvature flat = vertex_curvature({0, 0, 1}, ring);
  CHECK(flat.K == Approx(0).margin(1e-14));
  CHECK(flat.H == Approx(0).margin(1e-14));
  // Area of the quadrilateral by its diagonals' crossing, over three.
  CHECK(flat.A > 0);
}

TEST_CASE("a regular pyramid has the angle defect of its isosceles sides", "[core][curvature]") {
  for (const int sides : {3, 4, 5, 6, 12}) {
    const double height = 0.7, slant = std::hypot(1.0, height);
    const double side = 2 * std::sin(kPi / sides);
    const double angle = 2 * std::asin(side / (2 * slant));
    const VertexCurvature tip = vertex_curvature({0, 0, height}, circle(sides));
    CAPTURE(sides);
    CHECK(tip.K == Approx(2 * kPi - sides * angle).margin(1e-13));
    const double area = sides * 0.5 * slant * slant * std::sin(angle) / 3;
    CHECK(tip.A == Approx(area).margin(1e-13));
    CHECK(tip.K_area == Approx(tip.K / area).margin(1e-12));
    // Each edge has the cotangent of the base angles twice; the sum of the edges is upward.
    const double cot = std::tan(angle / 2);
    const double apothem = std::cos(kPi / sides);
    const double normal_z =
        apothem / std::hypot(apothem, height);  // of one side; the sum is upright
    CHECK(normal_z > 0);
    CHECK(tip.H == Approx(0.25 * sides * 2 * cot * height / area).margin(1e-12));
  }
}

TEST_CASE("the corner of a cube has a quarter turn of curvature", "[core][curvature]") {
  const std::vector<Point3> ring{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK(vertex_curvature({0, 0, 0}, ring).K == Approx(kPi / 2).margin(1e-14));
}

TEST_CASE("on a fine sphere K over the area and H tend to the sphere's", "[core][curvature]") {
  const double radius = 3.0;
  for (const double step : {0.1, 0.01}) {
    const auto at = [&](double a, double b) {
      const double length = std::hypot(std::hypot(a, b), 1.0);
      return Point3{radius * a / length, radius * b / length, radius / length};
    };
    const std::array<Point3, 4> ring{at(step, 0), at(0, step), at(-step, 0), at(0, -step)};
    const std::array<Point3, 4> diagonals{at(step, step), at(-step, step), at(-step, -step),
                                          at(step, -step)};
    const VertexCurvature c = vertex_curvature(at(0, 0), ring);
    const double bound = 3 * step * step;
    CHECK(c.K_area == Approx(1.5 / (radius * radius)).epsilon(bound));  // A is 2/3 of a cell here
    CHECK(c.H == Approx(1.5 / radius).epsilon(bound));
    const FundamentalForms f = grid_forms(at(0, 0), ring, diagonals);
    CHECK(f.gaussian() == Approx(1 / (radius * radius)).epsilon(bound));
    CHECK(f.mean() == Approx(1 / radius).epsilon(bound));
  }
}

TEST_CASE("the forms of a skewed saddle need the diagonals and have its curvatures",
          "[core][curvature]") {
  // z = x v: K = -1, H = 0 at the origin, in parameters along x and along x + v.
  const double step = 0.01;
  const auto at = [&](double s, double t) {
    const double x = step * (s + t), v = step * t;
    return Point3{x, v, x * v};
  };
  const std::array<Point3, 4> ring{at(1, 0), at(0, 1), at(-1, 0), at(0, -1)};
  const std::array<Point3, 4> diagonals{at(1, 1), at(-1, 1), at(-1, -1), at(1, -1)};
  const FundamentalForms f = grid_forms(at(0, 0), ring, diagonals);
  CHECK(f.gaussian() == Approx(-1).epsilon(1e-3));
  CHECK(f.mean() == Approx(0).margin(1e-3));
  CHECK(star_forms(at(0, 0), ring).b_st == 0);
}

TEST_CASE("K of the assembly vanishes on both published lines and H on its own",
          "[core][curvature][assembly]") {
  for (int k = 0; k <= 1000; ++k) {
    const double lambda = 0.01 + 6.0 * k / 1000;
    CAPTURE(lambda);
    REQUIRE(std::abs(curvature_of({(1 + 2 * lambda) / std::numbers::sqrt2, lambda, kQuarter}).K) <=
            1e-12);
    REQUIRE(std::abs(curvature_of({3 / std::numbers::sqrt2, lambda, kQuarter}).K) <= 1e-12);
    REQUIRE(std::abs(curvature_of({(2 + lambda) / std::numbers::sqrt2, lambda, kQuarter}).H) <=
            1e-12);
    REQUIRE(std::abs(forms_of({3 / std::numbers::sqrt2, lambda, kQuarter}).gaussian()) <= 1e-12);
  }
}

// From an independent prototype in Python (NumPy, law of cosines), to four decimals.
TEST_CASE("the assembly has the prototype's K and H at r = 2.5", "[core][curvature][assembly]") {
  const std::array<double, 8> lambda{.25, .5, .8, 1, 1.2, 1.5, 2, 3};
  const std::array<double, 8> K{.9292, .8137, .5876, .3671, .0972, -.3221, -.7927, -1.0817};
  const std::array<double, 8> H{.7594, .8173, .8063, .6955, .4778, .0481, -.3952, -.4226};
  for (std::size_t k = 0; k < lambda.size(); ++k) {
    const VertexCurvature c = curvature_of({2.5, lambda[k], kQuarter});
    CHECK(c.K == Approx(K[k]).margin(5.1e-5));
    CHECK(c.H == Approx(H[k]).margin(5.1e-5));
  }
}

// Targets and their minimisers from docs/geometry.md, section 6, and the same prototype.
TEST_CASE("solving for K takes the nearest assembly and names its mirror",
          "[core][curvature][assembly]") {
  struct Golden {
    double K, r, lambda;
  };
  for (const Golden& g :
       {Golden{-1, 2.69251, 1.99794}, Golden{0, 2.12132, 1.0}, Golden{1, 2.66621, 0.75464}}) {
    const auto found = testing::value(solve_assembly({g.K, std::nullopt, kQuarter}));
    CAPTURE(g.K);
    CHECK(found.assembly.r == Approx(g.r).margin(6e-6));
    CHECK(found.assembly.lambda == Approx(g.lambda).margin(6e-6));
    CHECK(std::abs(found.reached.K - g.K) < 1e-8);
    CHECK(found.mirror.has_value() == (g.K != 0));
    if (found.mirror) {
      CHECK(std::abs(curvature_of(*found.mirror).K - g.K) < 1e-8);
      CHECK(curvature_of(*found.mirror).H == Approx(-found.reached.H));
    }
  }
}

TEST_CASE("no nearer assembly has the K that was solved for", "[core][curvature][assembly]") {
  for (const double K : {-2.0, -0.4, 0.5, 2.5}) {
    for (const double phi : {kQuarter, 0.6}) {
      const auto found = testing::value(solve_assembly({K, std::nullopt, phi}));
      CAPTURE(K, phi);
      CHECK(std::abs(found.reached.K - K) < 1e-10);
      const double centre = 3 / std::numbers::sqrt2;
      const double reach =
          std::hypot(found.assembly.r - centre, found.assembly.lambda - 1.0) * (1 - 1e-6);
      const bool below = curvature_of({centre, 1.0, phi}).K < K;
      for (int ray = 0; ray < 720; ++ray) {
        for (int part = 1; part <= 40; ++part) {
          const double r = centre + reach * part / 40 * std::cos(ray * kPi / 360);
          const double lambda = 1 + reach * part / 40 * std::sin(ray * kPi / 360);
          if (r > 0 && lambda > 0) REQUIRE((curvature_of({r, lambda, phi}).K < K) == below);
        }
      }
    }
  }
}

TEST_CASE("K and H together are solved for or reported as out of reach",
          "[core][curvature][assembly]") {
  const auto saddle = testing::value(solve_assembly({-1.0, 0.0, kQuarter}));
  CHECK(saddle.assembly.lambda == Approx(1.970044753845).margin(1e-9));
  REQUIRE(saddle.mirror);
  CHECK(saddle.mirror->lambda == Approx(0.029955246155).margin(1e-9));
  CHECK(saddle.mirror->r == Approx(1.43540).margin(1e-5));
  const auto bent = testing::value(solve_assembly({1.0, 0.3, kQuarter}));
  CHECK(bent.assembly.r == Approx(7.12386861).margin(1e-6));
  CHECK(bent.assembly.lambda == Approx(4.30999091).margin(1e-6));
  const auto half = testing::value(solve_assembly({-0.5, 0.0, kQuarter}));
  REQUIRE(half.mirror);
  CHECK(half.mirror->lambda == Approx(0.36315713).margin(1e-7));

  const auto never = solve_assembly({1.0, 0.0, kQuarter});
  REQUIRE_FALSE(never);
  CHECK(never.error().kind == ErrorKind::Infeasible);
  const auto too_much = solve_assembly({6.5, std::nullopt, kQuarter});
  REQUIRE_FALSE(too_much);
  CHECK(too_much.error().kind == ErrorKind::OutOfRange);
  CHECK_FALSE(solve_assembly({std::nan(""), std::nullopt, kQuarter}));
}

TEST_CASE("K = -1 needs lambda of at least 1.970045", "[core][curvature][assembly]") {
  CHECK(assembly_lambda_for(-1.0) == Approx(1.970044753845).margin(1e-11));
  // Independent of the solver: below it K stays above -1 for every r, above it does not.
  const auto least = [](double lambda) {
    double K = 10;
    for (int k = 1; k <= 4000; ++k) K = std::min(K, curvature_of({k * 2e-3, lambda, kQuarter}).K);
    return K;
  };
  CHECK(least(1.9695) > -1);
  CHECK(least(1.9705) < -1);
  CHECK(assembly_lambda_for(-kPi / 3) == Approx(2.0).margin(1e-9));
}

}  // namespace curvature_test
