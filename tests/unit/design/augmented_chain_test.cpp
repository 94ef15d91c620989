// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "core/curvature/vertex_curvature.hpp"
#include "core/design/chain/augmented_chain.hpp"
#include "core/design/chain/chain.hpp"
#include "tests/support/value.hpp"

namespace augmented_chain_test {

using namespace popcut;

namespace {

/// Slices of a barrel, and chains on them that are not the plain ones.
struct Case {
  std::vector<SliceCurve> curves;
  std::vector<double> v;
  int units{};

  [[nodiscard]] SliceStack stack() const { return {curves, v, units}; }

  /// Points at the plain chains' angles, each moved by up to `most` of the spacing.
  [[nodiscard]] StackPoints moved(double most, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> by(-most, most);
    StackPoints out;
    for (const SliceCurve& curve : curves) {
      const std::vector<double> t = curve.equal_arcs(units);
      for (std::size_t k = 0; k < t.size(); ++k) {
        const bool end = k == 0 || k + 1 == t.size();
        const CurveJet p = curve.at(end ? t[k] : t[k] + by(random) * (t[k + 1] - t[k]));
        out.x.push_back(p.x);
        out.z.push_back(p.z);
      }
    }
    return out;
  }
};

Case barrel(int slices, int units, double scale = 1.0) {
  Case made;
  made.units = units;
  for (int j = 0; j < slices; ++j) {
    const double s = 4.0 * (j - 0.5 * (slices - 1));
    made.v.push_back(scale * s);
    made.curves.emplace_back(scale * std::sqrt(900 - s * s), scale * std::sqrt(900 - s * s));
  }
  return made;
}

/// K, H and forms of every inner vertex of `points`.
AugmentedSpec targets_at(const Case& made, const StackPoints& points) {
  AugmentedSpec out;
  const auto levels = static_cast<std::size_t>(made.units) + 1;
  const auto at = [&](std::size_t i, std::size_t j) {
    return Point3{points.x[j * levels + i], made.v[j], points.z[j * levels + i]};
  };
  for (std::size_t j = 1; j + 1 < made.v.size(); ++j) {
    for (std::size_t i = 1; i + 1 < levels; ++i) {
      const std::array<Point3, 4> ring{at(i + 1, j), at(i, j + 1), at(i - 1, j), at(i, j - 1)};
      const std::array<Point3, 4> diagonals{at(i + 1, j + 1), at(i - 1, j + 1), at(i - 1, j - 1),
                                            at(i + 1, j - 1)};
      const VertexCurvature c = vertex_curvature(at(i, j), ring);
      out.K_area.push_back(c.K_area);
      out.H.push_back(c.H);
      const FundamentalForms f = grid_forms(at(i, j), ring, diagonals);
      out.first.push_back({f.a_ss, f.a_st, f.a_tt});
      out.second.push_back({f.b_ss, f.b_st, f.b_tt});
    }
  }
  return out;
}

AugmentedSpec weighed(AugmentedSpec spec, const std::array<double, 4>& weights) {
  spec.weight_K = weights[0], spec.weight_H = weights[1];
  spec.weight_first = weights[2], spec.weight_second = weights[3];
  return spec;
}

/// One target of K and of H for all.
AugmentedSpec targets(std::vector<double> K_area, std::vector<double> H) {
  AugmentedSpec spec;
  spec.K_area = std::move(K_area), spec.H = std::move(H);
  return spec;
}

}  // namespace

TEST_CASE("without weights the augmented chains equal the plain ones", "[core][curvature][chain]") {
  const Case made = barrel(5, 6);
  const auto solved = testing::value(solve_chain_augmented(made.stack(), {}));
  std::vector<double> x(7), z(7);
  for (std::size_t j = 0; j < 5; ++j) {
    REQUIRE(ChainSolver().solve(made.curves[j], 6, x, z));
    for (std::size_t i = 0; i < 7; ++i) {
      CHECK(solved.points.x[j * 7 + i] == Approx(x[i]).margin(1e-6));
      CHECK(solved.points.z[j * 7 + i] == Approx(z[i]).margin(1e-6));
    }
  }
  CHECK(solved.loss.curvature == 0);
}

TEST_CASE("the augmented loss is the paper's sum", "[core][curvature][chain]") {
  const Case made = barrel(4, 4, 1.0 / 30);  // mean size about 1, where the weights are the paper's
  const StackPoints points = made.moved(0.2, 7);
  AugmentedSpec at = targets_at(made, points);
  const auto zero = testing::value(augmented_loss(made.stack(), points, weighed(at, {1, 1, 1, 1})));
  CHECK(zero.curvature == Approx(0).margin(1e-18));
  for (double& K : at.K_area) K += 0.1;
  for (double& H : at.H) H -= 0.2;
  for (auto& a : at.first) a[1] += 0.01;
  for (auto& b : at.second) b[0] -= 0.02;
  const double count = static_cast<double>(made.stack().inner());
  double size = 0;
  for (const SliceCurve& curve : made.curves) size += curve.h() / 4;
  const auto loss = [&](const std::array<double, 4>& weights) {
    return augmented_loss(made.stack(), points, weighed(at, weights))->curvature;
  };
  CHECK(loss({3, 0, 0, 0}) == Approx(3 * 0.01 * count * std::pow(size, 6)));
  CHECK(loss({0, 2, 0, 0}) == Approx(2 * 0.04 * count * std::pow(size, 4)));
  CHECK(loss({0, 0, 5, 0}) == Approx(5 * 2 * 1e-4 * count / (size * size)));
  CHECK(loss({0, 0, 0, 7}) == Approx(7 * 4e-4 * count));
}

TEST_CASE("reachable targets are reached by K and H and by the forms", "[core][curvature][chain]") {
  const Case made = barrel(6, 5);
  const StackPoints wanted = made.moved(0.15, 11);
  const AugmentedSpec at = targets_at(made, wanted);
  for (const AugmentedSpec& spec :
       {weighed(at, {100, 100, 0, 0}), weighed(at, {0, 0, 1000, 1000})}) {
    const auto solved = testing::value(solve_chain_augmented(made.stack(), spec));
    CAPTURE(spec.weight_K, solved.start.curvature, solved.loss.curvature, solved.loss.chains);
    CHECK(solved.loss.curvature < 0.05 * solved.start.curvature);
    CHECK(solved.loss.total() <= solved.start.total());
    // Every vertex stays on its slice's curve and in order.
    for (std::size_t j = 0; j < 6; ++j) {
      for (std::size_t i = 0; i < 6; ++i) {
        const double x = solved.points.x[j * 6 + i], z = solved.points.z[j * 6 + i];
        CHECK(std::hypot(x, z) == Approx(made.curves[j].h()));
        if (i > 0) {
          CHECK(x > solved.points.x[j * 6 + i - 1]);
          CHECK(z < solved.points.z[j * 6 + i - 1]);
        }
      }
    }
  }
}

TEST_CASE("no small step along the curves improves augmented chains", "[core][curvature][chain]") {
  const Case made = barrel(5, 5);
  const AugmentedSpec spec = weighed(targets({1.0 / 900}, {1.0 / 30}), {1, 1, 0, 0});
  const auto solved = testing::value(solve_chain_augmented(made.stack(), spec));
  const double least = solved.loss.total();
  for (std::size_t j = 0; j < 5; ++j) {
    for (std::size_t i = 1; i < 5; ++i) {
      for (const double by : {-1e-3, 1e-3}) {
        StackPoints other = solved.points;
        const double angle = std::atan2(other.x[j * 6 + i], other.z[j * 6 + i]) + by;
        other.x[j * 6 + i] = made.curves[j].h() * std::sin(angle);
        other.z[j * 6 + i] = made.curves[j].h() * std::cos(angle);
        const auto there = testing::value(augmented_loss(made.stack(), other, spec));
        CHECK(there.total() >= least * (1 - 1e-9));
      }
    }
  }
}

TEST_CASE("a scaled surface has the scaled augmented chains", "[core][curvature][chain]") {
  const Case one = barrel(4, 4), ten = barrel(4, 4, 10.0);
  const auto a = solve_chain_augmented(one.stack(), weighed(targets({2e-3}, {0.04}), {1, 1, 0, 0}));
  const auto b =
      solve_chain_augmented(ten.stack(), weighed(targets({2e-5}, {0.004}), {1, 1, 0, 0}));
  REQUIRE(a);
  REQUIRE(b);
  for (std::size_t k = 0; k < a->points.x.size(); ++k)
    CHECK(b->points.x[k] == Approx(10 * a->points.x[k]).margin(1e-2));
  CHECK(b->loss.total() == Approx(100 * a->loss.total()).epsilon(1e-6));
}

TEST_CASE("wrong targets of augmented chains are refused in one line", "[core][curvature][chain]") {
  const Case made = barrel(4, 4);
  const auto refused = [&](const SliceStack& stack, const AugmentedSpec& spec) {
    const auto solved = solve_chain_augmented(stack, spec);
    return !solved && solved.error().kind == ErrorKind::OutOfRange &&
           !solved.error().detail.empty();
  };
  CHECK(refused(made.stack(), weighed({}, {1, 0, 0, 0})));
  CHECK(refused(made.stack(), weighed(targets({1, 2}, {}), {1, 0, 0, 0})));
  CHECK(refused(made.stack(), weighed(targets({1}, {}), {-1, 0, 0, 0})));
  CHECK(refused(made.stack(), weighed(targets({std::nan("")}, {}), {1, 0, 0, 0})));
  CHECK(refused({std::span(made.curves).first(2), std::span(made.v).first(2), 4}, {}));
  CHECK(refused({made.curves, std::span(made.v).first(3), 4}, {}));
  CHECK(refused({made.curves, made.v, 1}, {}));
  const std::vector<double> falling{3, 2, 1, 0};
  CHECK(refused({made.curves, falling, 4}, {}));
}

}  // namespace augmented_chain_test
