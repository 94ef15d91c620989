// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/monotone_fit.hpp"
#include "core/design/target/surface.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/slice_distance.hpp"

namespace targets_property_test {

using namespace popcut;
using namespace popcut::testing;
using namespace popcut::tests;

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
  const auto made = Surface::make(spec, TargetPlacement{}, FitMode::Exact, assets);
  if (!made) FAIL(message(made.error()));
  auto cut = made->slice(s);
  if (!cut) FAIL(message(cut.error()));
  return *cut;
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

}  // namespace targets_property_test
