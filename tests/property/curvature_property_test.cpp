// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "core/curvature/assembly.hpp"
#include "core/curvature/star.hpp"
#include "core/curvature/vertex_curvature.hpp"

namespace curvature_property_test {

using namespace popcut;

namespace {

constexpr double kPi = std::numbers::pi;

struct Star {
  Point3 centre;
  std::vector<Point3> ring;
};

/// A star of 3 to 9 triangles, none of them thin.
Star random_star(std::mt19937& random) {
  std::uniform_real_distribution<double> by(-0.2, 0.2), height(-0.8, 0.8);
  const int sides = std::uniform_int_distribution<int>(3, 9)(random);
  Star star{{by(random), by(random), by(random)}, {}};
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * kPi * (k + by(random)) / sides, reach = 1 + by(random);
    star.ring.push_back({reach * std::cos(angle), reach * std::sin(angle), height(random)});
  }
  return star;
}

Star mapped(const Star& star, const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift) {
  const auto map = [&](const Point3& p) {
    const Eigen::Vector3d q = turn * Eigen::Vector3d(p[0], p[1], p[2]) + shift;
    return Point3{q[0], q[1], q[2]};
  };
  Star out{map(star.centre), {}};
  for (const Point3& p : star.ring) out.ring.push_back(map(p));
  return out;
}

double law_of_cosines(const Point3& c, const Point3& p, const Point3& q) {
  const auto square = [](const Point3& a, const Point3& b) {
    return std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2);
  };
  return std::acos((square(c, p) + square(c, q) - square(p, q)) /
                   (2 * std::sqrt(square(c, p)) * std::sqrt(square(c, q))));
}

}  // namespace

TEST_CASE("curvature is invariant under rigid motion and scales correctly",
          "[core][curvature][property]") {
  const unsigned seed = 20261121;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-5, 5);
  for (int round = 0; round < 2000; ++round) {
    CAPTURE(seed, round);
    const Star star = random_star(random);
    const VertexCurvature c = vertex_curvature(star.centre, star.ring);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(
        any(random), Eigen::Vector3d(any(random), any(random), any(random)).normalized()));
    const Eigen::Vector3d shift(any(random), any(random), any(random));
    const Star moved = mapped(star, turn.toRotationMatrix(), shift);
    const VertexCurvature m = vertex_curvature(moved.centre, moved.ring);
    REQUIRE(m.K == Approx(c.K).margin(1e-11));
    REQUIRE(m.H == Approx(c.H).margin(1e-10));
    REQUIRE(m.A == Approx(c.A).margin(1e-11));
    const double scale = std::exp(any(random));
    const Star large = mapped(star, scale * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
    const VertexCurvature l = vertex_curvature(large.centre, large.ring);
    REQUIRE(l.K == Approx(c.K).margin(1e-11));
    REQUIRE(l.H * scale == Approx(c.H).margin(1e-10));
    REQUIRE(l.K_area * scale * scale == Approx(c.K_area).margin(1e-9));
    Star back = star;  // seen from the other side
    std::reverse(back.ring.begin(), back.ring.end());
    const VertexCurvature b = vertex_curvature(back.centre, back.ring);
    REQUIRE(b.K == Approx(c.K).margin(1e-12));
    REQUIRE(b.H == Approx(-c.H).margin(1e-11));
  }
}

TEST_CASE("the angle defect agrees with the law of cosines", "[core][curvature][property]") {
  const unsigned seed = 7;
  std::mt19937 random(seed);
  for (int round = 0; round < 2000; ++round) {
    CAPTURE(seed, round);
    const Star star = random_star(random);
    double angles = 0;
    for (std::size_t k = 0; k < star.ring.size(); ++k)
      angles += law_of_cosines(star.centre, star.ring[k], star.ring[(k + 1) % star.ring.size()]);
    REQUIRE(vertex_curvature(star.centre, star.ring).K == Approx(2 * kPi - angles).margin(1e-11));
  }
}

TEST_CASE("the half turn of the assembly's plane keeps K and flips H",
          "[core][curvature][property]") {
  const unsigned seed = 3;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> r(-3, 8), lambda(-4, 6);
  for (int round = 0; round < 5000; ++round) {
    CAPTURE(seed, round);
    const Assembly here{r(random), lambda(random), kPi / 4};
    const Assembly there{3 * std::numbers::sqrt2 - here.r, 2 - here.lambda, kPi / 4};
    REQUIRE(curvature_of(here).K == Approx(curvature_of(there).K).margin(1e-12));
    REQUIRE(curvature_of(here).H == Approx(-curvature_of(there).H).margin(1e-12));
  }
}

TEST_CASE("forward differentiation gives the slopes of curvature", "[core][curvature][property]") {
  using Number = star::Dual<1>;
  const unsigned seed = 5;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(seed, round);
    const Star star = random_star(random);
    const Point3 way{any(random), any(random), any(random)};
    const std::size_t which = round % star.ring.size();
    std::vector<star::Vec<Number>> ring;
    for (const Point3& p : star.ring) ring.push_back({p[0], p[1], p[2]});
    ring[which].x.by[0] = way[0];
    ring[which].v.by[0] = way[1];
    ring[which].z.by[0] = way[2];
    const star::Vec<Number> centre{star.centre[0], star.centre[1], star.centre[2]};
    const auto c = star::curvature<Number>(centre, ring);
    const double h = 1e-6;
    const auto at = [&](double step) {
      Star other = star;
      for (std::size_t k = 0; k < 3; ++k) other.ring[which][k] += step * way[k];
      return vertex_curvature(other.centre, other.ring);
    };
    const VertexCurvature up = at(h), down = at(-h);
    REQUIRE(c.defect.by[0] == Approx((up.K - down.K) / (2 * h)).margin(1e-7));
    REQUIRE(c.mean.by[0] == Approx((up.H - down.H) / (2 * h)).margin(1e-6));
    REQUIRE(c.area.by[0] == Approx((up.A - down.A) / (2 * h)).margin(1e-7));
  }
}

}  // namespace curvature_property_test
