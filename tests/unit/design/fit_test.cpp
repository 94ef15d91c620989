// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "core/fit/fit.hpp"

namespace fit_test {

using namespace popcut;
using Catch::WithinAbs;
using Catch::WithinRel;

namespace {

constexpr double kLength_mm = 80.0;

/// A line of a section from one point to the other, drawn out along the spine.
void add_wide(TriangleSoup& soup, double x0, double z0, double x1, double z1, double v_mm = 0.0) {
  soup.add({x0, v_mm, z0}, {x1, v_mm, z1}, {x1, v_mm + kLength_mm, z1},
           {x0, v_mm + kLength_mm, z0});
}

TriangleSoup quarter_cylinder(double radius_mm, int pieces) {
  TriangleSoup soup;
  const auto at = [&](int k) { return 0.5 * std::numbers::pi * k / pieces; };
  for (int k = 0; k < pieces; ++k)
    add_wide(soup, radius_mm * std::cos(at(k)), radius_mm * std::sin(at(k)),
             radius_mm * std::cos(at(k + 1)), radius_mm * std::sin(at(k + 1)));
  return soup;
}

/// Steps `a` wide and `a` high that begin and end on the chord from (0, n a) to (n a, 0).
TriangleSoup stairs(int n, double a_mm) {
  TriangleSoup soup;
  for (int k = 0; k < n; ++k) {
    const double x = a_mm * k, z = a_mm * (n - k);
    add_wide(soup, x, z, x + a_mm, z);
    add_wide(soup, x + a_mm, z, x + a_mm, z - a_mm);
  }
  return soup;
}

}  // namespace

TEST_CASE("a plane beside a plane is off by their distance everywhere", "[core][fit]") {
  TriangleSoup target, structure;
  add_wide(target, 0, 50, 40, 10);
  const double shift = 3.0 / std::sqrt(2.0);
  add_wide(structure, shift, 50 + shift, 40 + shift, 10 + shift);
  const FitFigures fit = FitTarget(target).measure(structure);
  for (const DistanceFigures& way : {fit.to_target, fit.to_structure}) {
    CHECK(way.samples >= 4096);
    for (const double figure : {way.mean_mm, way.rms_mm, way.p95_mm, way.max_mm})
      CHECK_THAT(figure, WithinAbs(3.0, 1e-9));
  }
  CHECK_THAT(fit.two_sided_rms_mm(), WithinAbs(3.0, 1e-9));
  CHECK_THAT(fit.size_mm, WithinAbs(std::hypot(40.0, 40.0, kLength_mm), 1e-9));
  CHECK_THAT(fit.target_mm2, WithinRel(40.0 * std::sqrt(2.0) * kLength_mm, 1e-12));
  CHECK(fit.share_within == std::array{0.0, 0.0, 1.0});  // the size is 98 mm
  CHECK(fit.out_of_reach.share() == 0.0);
}

TEST_CASE("a cylinder about another one's axis is off by the difference of their radii",
          "[core][fit]") {
  const FitFigures fit = FitTarget(quarter_cylinder(60, 300)).measure(quarter_cylinder(57.5, 300));
  for (const DistanceFigures& way : {fit.to_target, fit.to_structure}) {
    CHECK_THAT(way.mean_mm, WithinRel(2.5, 1e-3));
    CHECK_THAT(way.rms_mm, WithinRel(2.5, 1e-3));
    CHECK_THAT(way.p95_mm, WithinRel(2.5, 1e-3));
    CHECK_THAT(way.max_mm, WithinRel(2.5, 1e-3));
  }
}

TEST_CASE("a staircase and its chord are apart as the triangles between them say", "[core][fit]") {
  for (const int n : {1, 4, 25}) {
    CAPTURE(n);
    const double a = 50.0 / n;
    TriangleSoup chord;
    add_wide(chord, 0, 50, 50, 0);
    const FitFigures fit = FitTarget(chord).measure(stairs(n, a));
    // Along a step the height over the chord grows evenly to a / sqrt 2; along the chord the nearer
    // step is off by up to a / 2.
    const double high = a / std::sqrt(2.0), far = a / 2.0;
    CHECK_THAT(fit.to_target.mean_mm, WithinRel(0.5 * high, 0.01));
    CHECK_THAT(fit.to_target.rms_mm, WithinRel(high / std::sqrt(3.0), 0.01));
    CHECK_THAT(fit.to_target.p95_mm, WithinRel(0.95 * high, 0.01));
    CHECK_THAT(fit.to_target.max_mm, WithinRel(high, 0.005));
    CHECK_THAT(fit.to_structure.mean_mm, WithinRel(0.5 * far, 0.01));
    CHECK_THAT(fit.to_structure.rms_mm, WithinRel(far / std::sqrt(3.0), 0.01));
    CHECK_THAT(fit.to_structure.p95_mm, WithinRel(0.95 * far, 0.01));
    CHECK_THAT(fit.to_structure.max_mm, WithinRel(far, 0.005));
  }
}

TEST_CASE("a fit says which share of the target is out of reach and why", "[core][fit]") {
  TriangleSoup target;              // four stretches of the same area, 40 mm wide along the section
  add_wide(target, 0, 60, 40, 60);  // a roof over
  add_wide(target, 0, 20, 40, 20);  // what lies under it
  add_wide(target, -40, 60, 0, 60);             // goes on behind the wall
  add_wide(target, 0, 60, 40, 60, kLength_mm);  // goes on along the spine
  TriangleSoup structure;
  add_wide(structure, 0, 60, 40, 60);
  const FitFigures fit = FitTarget(target).measure(structure);
  const double size = fit.size_mm, hidden = (40.0 - 0.01 * size) / 40.0;
  CHECK_THAT(size, WithinAbs(std::hypot(80.0, 40.0, 2 * kLength_mm), 1e-9));
  CHECK_THAT(fit.out_of_reach.outside_of_the_corner, WithinAbs(0.25, 1e-3));
  CHECK_THAT(fit.out_of_reach.beyond_the_slices, WithinAbs(0.25, 1e-3));
  CHECK_THAT(fit.out_of_reach.overhang, WithinAbs(0.25 * hidden, 1e-3));
  const auto near = [&](double share) {
    return 0.25 + 0.25 * share * size * (1 / 40.0 + 1 / kLength_mm);
  };
  for (std::size_t w = 0; w < 3; ++w)
    CHECK_THAT(fit.share_within[w], WithinAbs(near(FitFigures::kWithin[w]), 2e-3));
}

TEST_CASE("a fit without a structure or without a target has no figures", "[core][fit]") {
  TriangleSoup plane, line;
  add_wide(plane, 0, 50, 40, 10);
  line.add({0, 0, 1}, {0, 0, 2}, {0, 0, 3});
  for (const TriangleSoup& nothing : {TriangleSoup(), line}) {
    const FitFigures none = FitTarget(plane).measure(nothing);
    CHECK(none.to_target.samples + none.to_structure.samples == 0);
    CHECK(none.share_within == std::array{0.0, 0.0, 0.0});
    CHECK(FitTarget(nothing).is_empty());
    CHECK(FitTarget(nothing).measure(plane).to_target.samples == 0);
  }
}

TEST_CASE("samples stand for equal areas and their number is bounded", "[core][fit]") {
  CHECK(samples_of(1.0, {}) == 4096);
  CHECK(samples_of(39998.0, {}) == 10000);
  CHECK(samples_of(1e12, {}) == 16384);
  TriangleSoup soup;
  soup.add({0, 0, 0}, {30, 0, 0}, {0, 0, 30});
  soup.add({100, 0, 0}, {110, 0, 0}, {100, 0, 30});  // a third of it
  std::size_t small = 0;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : area_samples(soup, 4000)) {
    if (p[0] > 99) ++small;
    if (p[0] < 99) middle += p;
  }
  CHECK(small == 1000);
  CHECK_THAT(middle[0] / 3000, WithinAbs(10.0, 0.05));
  CHECK_THAT(middle[2] / 3000, WithinAbs(10.0, 0.05));
}

}  // namespace fit_test
