// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/spline/loft.hpp"
#include "core/design/spline/monotone_spline.hpp"
#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/monotone_fit.hpp"
#include "core/design/target/surface.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/slice_distance.hpp"
#include "tests/support/value.hpp"

namespace targets_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
}

/// z(x, y) = h (1 + c y) (1 - (x / d)^p)^(1/q), which falls for all p, q > 0.
struct Falling {
  double h, d, c, p, q;
  [[nodiscard]] double at(double x, double y) const {
    return h * (1.0 + c * y) * std::pow(std::max(0.0, 1.0 - std::pow(x / d, p)), 1.0 / q);
  }
  [[nodiscard]] std::string profile() const {
    return fmt::format("{}*(1 + {}*y)*(1 - (x/{})^{})^(1/{})", h, c, d, p, q);
  }
  [[nodiscard]] std::string solid() const {
    return fmt::format("x < {} ? z - {} : 1", d, profile());
  }
};

SliceCurve slice(const SurfaceSpec& spec, const SurfaceAssets& assets, double s) {
  const auto made = value(Surface::make(spec, TargetPlacement{}, FitMode::Exact, assets));
  return value(made.slice(s));
}

/// A noisy outline that falls on the whole.
std::vector<OutlinePoint> noisy(std::mt19937& random, double noise) {
  const double h = uniform(random, 10, 80), d = uniform(random, 10, 80);
  const std::size_t n = 3 + random() % 300;
  std::vector<OutlinePoint> out;
  for (std::size_t k = 0; k <= n; ++k) {
    const double a = 0.5 * 3.14159265358979 * static_cast<double>(k) / static_cast<double>(n);
    const bool end = k == 0 || k == n;
    const double dx = end ? 0.0 : noise * uniform(random, -1, 1);
    const double dz = end ? 0.0 : noise * uniform(random, -1, 1);
    out.push_back({{std::max(0.0, d * std::sin(a) + dx), std::max(0.0, h * std::cos(a) + dz)},
                   uniform(random, 0.1, 1.0)});
  }
  out.front().p.x = 0.0, out.back().p.z = 0.0;
  return out;
}

}  // namespace

TEST_CASE("the same shape as profile and solid and grid and mesh has the same slices",
          "[core][target]") {
  constexpr unsigned kSeed = 51;
  std::mt19937 random(kSeed);
  for (int k = 0; k < 12; ++k) {
    const Falling shape{uniform(random, 20, 60), uniform(random, 20, 60),
                        uniform(random, -0.01, 0.01), uniform(random, 1.2, 3.0),
                        uniform(random, 1.0, 2.5)};
    const double s = uniform(random, 1.0, 19.0);
    CAPTURE(kSeed, k, shape.profile(), s);
    const SliceCurve profile = slice(ProfileSpec{shape.profile()}, {}, s);
    CHECK(apart(slice(ImplicitSpec{shape.solid()}, {}, s), profile) < 1e-3);

    const auto point = [&](double a, double b) {  // closer together where it is steep
      const double x = a == 1.0 ? shape.d : shape.d * std::sin(1.5707963267949 * a);
      return Point{x, 20.0 * b, shape.at(x, 20.0 * b)};
    };
    const TriangleMesh shell = shell_of(point, 400, 10);
    CHECK(apart(slice(MeshSpec{"m.stl"}, {{"m.stl", binary_stl(shell)}}, s), profile) < 0.05);

    std::string csv;
    for (int j = -1; j <= 10; ++j)
      for (int i = -1; i <= 400; ++i) {
        const double x = point(std::max(0, i) / 400.0, 0.0)[0], y = 2.0 * j;
        if (j < 0)
          csv += i < 0 ? "" : fmt::format(",{}", x);
        else
          csv += i < 0 ? fmt::format("{}", y) : fmt::format(",{}", shape.at(x, y));
        if (i == 400) csv += "\n";
      }
    CHECK(apart(slice(GridSpec{"h.csv"}, {{"h.csv", csv}}, s), profile) < 0.05);
  }
}

TEST_CASE("the fit of a noisy outline falls and is its own fit again", "[core][fit]") {
  constexpr unsigned kSeed = 52;
  std::mt19937 random(kSeed);
  for (int k = 0; k < 200; ++k) {
    CAPTURE(kSeed, k);
    const auto outline = noisy(random, k % 2 == 0 ? 0.3 : 3.0);
    const FallingFit fit = nearest_falling(outline);
    REQUIRE(fit.points.size() >= 2);
    CHECK(fit.points.front().x == 0.0);
    CHECK(fit.points.back().z == 0.0);
    std::vector<OutlinePoint> again;
    for (std::size_t i = 0; i < fit.points.size(); ++i) {
      again.push_back({fit.points[i], 1.0});
      if (i == 0) continue;
      CHECK(fit.points[i].x >= fit.points[i - 1].x);
      CHECK(fit.points[i].z <= fit.points[i - 1].z);
    }
    CHECK(nearest_falling(again).max_moved_mm < 1e-9);
    const SliceCurve curve = strictly_falling(fit.points);
    CHECK_THAT(curve.h(), Catch::WithinAbs(fit.points.front().z, 1e-12));
    for (int i = 0; i <= 100; ++i) {
      const CurveJet p = curve.at(-1.0 + 0.02 * i);
      CHECK(p.dx >= -1e-9);
      CHECK(p.dz <= 1e-9);
    }
  }
}

TEST_CASE("no falling curve lies nearer to a noisy outline than its fit", "[core][fit]") {
  // Against random falling curves and small valid changes of the fit itself.
  constexpr unsigned kSeed = 53;
  std::mt19937 random(kSeed);
  for (int k = 0; k < 50; ++k) {
    const auto outline = noisy(random, 2.0);
    std::vector<double> x, z;
    const FallingFit fit = nearest_falling(outline);
    double best = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i)
      best += outline[i].weight_mm * fit.moved_mm[i] * fit.moved_mm[i];
    for (int other = 0; other < 20; ++other) {
      x.clear(), z.clear();
      double at_x = 0.0, at_z = 0.0, sum = 0.0;
      for (std::size_t i = 0; i < outline.size(); ++i)  // running maxima of the noisy outline
        at_x = std::max(at_x, outline[i].p.x + uniform(random, -2, 1)), x.push_back(at_x);
      for (std::size_t i = outline.size(); i-- > 0;)
        at_z = std::max(at_z, outline[i].p.z + uniform(random, -2, 1)), z.push_back(at_z);
      std::reverse(z.begin(), z.end());
      for (std::size_t i = 0; i < outline.size(); ++i)
        sum += outline[i].weight_mm *
               (std::pow(x[i] - outline[i].p.x, 2.0) + std::pow(z[i] - outline[i].p.z, 2.0));
      CAPTURE(kSeed, k, other);
      CHECK(sum >= best);
    }
  }
}

TEST_CASE("random segments have the outline that a search by hand finds", "[core][section]") {
  constexpr unsigned kSeed = 54;
  std::mt19937 random(kSeed);
  for (int k = 0; k < 100; ++k) {
    CAPTURE(kSeed, k);
    Section section;
    const std::size_t n = 1 + random() % 40;
    for (std::size_t i = 0; i < n; ++i)
      section.segments.push_back({{uniform(random, 0, 50), uniform(random, 0, 50)},
                                  {uniform(random, 0, 50), uniform(random, 0, 50)}});
    const Outline outline = seen_from_outside(section);
    for (std::size_t i = 1; i < outline.points.size(); ++i) {
      const SectionPoint a = outline.points[i - 1].p, b = outline.points[i].p;
      CHECK(b.x - b.z >= a.x - a.z - 1e-9);
    }
    for (const OutlinePoint& p : outline.points) {
      const double t = p.p.x - p.p.z;
      for (const SectionSegment& s : section.segments) {
        const double t0 = s.a.x - s.a.z, t1 = s.b.x - s.b.z;
        if (!(std::min(t0, t1) < t - 1e-6 && std::max(t0, t1) > t + 1e-6)) continue;
        const double share = (t - t0) / (t1 - t0);
        const double r = s.a.x + s.a.z + share * (s.b.x + s.b.z - s.a.x - s.a.z);
        // At a jump the lower side is a point of the outline too: it must not lie deep inside.
        if (r > p.p.x + p.p.z + 1e-6) {
          const bool at_jump =
              std::any_of(outline.points.begin(), outline.points.end(), [&](const OutlinePoint& q) {
                return std::abs(q.p.x - q.p.z - t) < 1e-6 && q.p.x + q.p.z >= r - 1e-5;
              });
          CHECK(at_jump);
        }
      }
    }
  }
}

TEST_CASE("a mesh slice meets exactly the triangles that span its plane", "[core][mesh]") {
  constexpr unsigned kSeed = 55;
  std::mt19937 random(kSeed);
  TriangleMesh soup;
  for (int k = 0; k < 9 * 5000; ++k)
    soup.corners.push_back(static_cast<float>(uniform(random, 1.0, 50.0)));
  const MeshSlicer slicer(soup);
  for (int k = 0; k < 50; ++k) {
    const double s = uniform(random, 1.5, 49.5);
    std::size_t spanning = 0;
    for (std::size_t t = 0; t < soup.size(); ++t) {
      int above = 0;
      for (std::size_t c = 0; c < 3; ++c)
        above += static_cast<double>(soup.corners[9 * t + 3 * c + 1]) >= s;
      spanning += above == 1 || above == 2;
    }
    CAPTURE(kSeed, s);
    CHECK(slicer.cut(s).segments.size() == spanning);
    // Two ends may meet by chance.
    CHECK(slicer.cut(s).open_ends.size() + 10 >= 2 * spanning);
  }
}

/// Points by growing place; values with plateaus, turns and long jumps.
CurvePoints random_graph(std::mt19937& random) {
  CurvePoints points;
  double place = uniform(random, -50, 50);
  for (std::size_t k = 0, n = 2 + random() % 14; k < n; ++k) {
    const bool again = k > 0 && random() % 5 == 0;
    points.push_back({place, again ? points.back()[1] : uniform(random, 0.0, 90.0)});
    place += random() % 4 == 0 ? uniform(random, 0.01, 0.1) : uniform(random, 1.0, 40.0);
  }
  return points;
}

TEST_CASE("a spline goes through its points, smoothly, and turns only where they do",
          "[core][target][drawn]") {
  constexpr unsigned kSeed = 57;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    CAPTURE(kSeed, round);
    const CurvePoints points = random_graph(random);
    const MonotoneSpline spline(points);
    const double before = std::nextafter(points.front()[0], -1e9) - 1e-6;
    CHECK(std::isnan(spline(before)));
    CHECK(std::isnan(spline(points.back()[0] + 1e-6)));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto [place, value] = points[k];
      CHECK(spline(place) == Approx(value).margin(1e-12));
      if (k + 1 == points.size()) continue;
      const auto [next, end] = points[k + 1];
      double last = value;
      for (int i = 1; i <= 50; ++i) {
        const double here = spline(place + (next - place) * i / 50);
        CHECK((end >= value ? here >= last - 1e-12 : here <= last + 1e-12));
        CHECK(here >= std::min(value, end) - 1e-12);
        CHECK(here <= std::max(value, end) + 1e-12);
        last = here;
      }
      if (k == 0) continue;
      // One slope on both sides: the two chords differ by the curvature times their length.
      const double step = 1e-5 * std::min(next - place, place - points[k - 1][0]);
      const double left = (spline(place) - spline(place - step)) / step;
      const double right = (spline(place + step) - spline(place)) / step;
      const double steepest = std::abs(end - value) / (next - place) +
                              std::abs(value - points[k - 1][1]) / (place - points[k - 1][0]);
      CHECK(left == Approx(right).margin(1e-3 * steepest + 1e-9));
    }
  }
}

TEST_CASE("a spline through the points of a parabola is near it", "[core][target][drawn]") {
  CurvePoints points;
  for (int k = 0; k <= 20; ++k) points.push_back({0.1 * k, 3.0 + 0.1 * k + 0.01 * k * k});
  const MonotoneSpline spline(points);
  for (double y = 0.0; y <= 2.0; y += 0.013)
    CHECK(spline(y) ==
          Approx(3.0 + y + y * y).margin(2e-4));  // third order: 0.1^3 times less than 1
}

/// A falling curve of `n` points with upright and level stretches.
CurvePoints random_fall(std::mt19937& random, std::size_t n) {
  std::vector<double> right(n - 1), down(n - 1);
  double x = 0.0, z = 0.0;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const auto kind = random() % 5;
    right[k] = kind == 0 ? 0.0 : uniform(random, 1.0, 20.0);
    down[k] = kind == 1 ? 0.0 : uniform(random, 1.0, 20.0);
    x += right[k], z += down[k];
  }
  if (x == 0.0) right.back() = 10.0;
  if (z == 0.0) down.back() = 10.0, z = 10.0;
  CurvePoints points{{0.0, z}};
  for (std::size_t k = 0; k + 1 < n; ++k)
    points.push_back({points.back()[0] + right[k], points.back()[1] - down[k]});
  points.back()[1] = 0.0;
  return points;
}

TEST_CASE("a loft meets the curves of its stations and falls between them",
          "[core][target][drawn]") {
  constexpr unsigned kSeed = 58;
  std::mt19937 random(kSeed);
  for (int round = 0; round < testing::rounds(60); ++round) {
    CAPTURE(kSeed, round);
    const std::size_t n = 2 + random() % 8;
    LoftSpec spec;
    double y = uniform(random, -20, 0);
    for (std::size_t k = 0, count = 2 + random() % 5; k < count; ++k) {
      spec.stations.push_back({y, random_fall(random, n)});
      y += uniform(random, 5, 40);
    }
    for (const LoftStation& station : spec.stations) {
      const SliceCurve curve = slice(spec, {}, station.y);
      CHECK(curve.h() == Approx(station.curve.front()[1]));
      CHECK(curve.d() == Approx(station.curve.back()[0]));
      for (const auto& [x, z] : station.curve) {
        const CurveJet p = curve.at(x / curve.d() - z / curve.h());
        CHECK(std::hypot(p.x - x, p.z - z) < 1e-6);
      }
    }
    const double first = spec.stations.front().y, last = spec.stations.back().y;
    for (int k = 0; k < 12; ++k) {
      const double s = uniform(random, first, last);
      CAPTURE(s);
      const SliceCurve curve = slice(spec, {}, s);
      const auto after = std::find_if(spec.stations.begin() + 1, spec.stations.end(),
                                      [&](const LoftStation& station) { return station.y >= s; });
      const auto [low, high] =
          std::minmax({after->curve.front()[1], (after - 1)->curve.front()[1]});
      CHECK(curve.h() >= low * (1 - 1e-12));
      CHECK(curve.h() <= high * (1 + 1e-12));
      for (int i = 0; i <= 60; ++i) {
        const CurveJet p = curve.at(-1.0 + i / 30.0);
        CHECK(p.dx >= -1e-6 * curve.d());
        CHECK(p.dz <= 1e-6 * curve.h());
      }
    }
    const auto made = value(Surface::make(spec, {}, FitMode::Exact));
    CHECK(made.slice(last + 1.0).error().reason == ErrorReason::Misplaced);
    CHECK(made.slice(first - 1.0).error().kind == ErrorKind::OutOfRange);
  }
}

TEST_CASE("drawn quarter circles are the circles of a revolution", "[core][target][drawn]") {
  const auto circle = [](double r) {
    CurvePoints points;
    for (int k = 0; k <= 24; ++k) {
      const double a = 1.5707963267948966 * k / 24;
      points.push_back({k == 0 ? 0.0 : r * std::sin(a), k == 24 ? 0.0 : r * std::cos(a)});
    }
    return points;
  };
  const SliceCurve round = slice(RevolutionSpec{"50"}, {}, 3.0);
  CHECK(apart(slice(ProfileSpec{circle(50)}, {}, 3.0), round) < 0.02);
  const LoftSpec cone{{{0.0, circle(40)}, {10.0, circle(60)}}};
  CHECK(apart(slice(cone, {}, 5.0), round) < 0.02);
  // The same solid, where the placement is not upright: by marching squares.
  const auto moved =
      Surface::make(ProfileSpec{circle(50)}, {1.0, {0, 0, 0}, {0, 0, 1e-9}}, FitMode::Exact);
  REQUIRE(moved);
  const auto curve = value(moved->slice(3.0));
  CHECK(apart(curve, round) < 0.05);
}

}  // namespace targets_property_test
