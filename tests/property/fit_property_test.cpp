// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/design/shape_fit.hpp"
#include "core/fit/fit.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace fit_property_test {

using namespace popcut;
using namespace popcut::testing;
using Catch::WithinAbs;
using Catch::WithinRel;

namespace {

constexpr double kPi = std::numbers::pi;

// An independent measure: the target by charts, as a cloud of points with normals, in bins; the
// structure by the faces of the pattern. Both are quadrature on grids, no random samples and no
// triangles of popcut's.

/// A part of the target over 0 <= a, b <= 1, sampled on a grid.
struct Chart {
  std::function<Vec3(double, double)> at;  ///< (x, s, z)
  int count_a{}, count_b{};
};

struct CloudPoint {
  Vec3 p, normal;
  double area{};
  std::size_t chart{};
  double a{}, b{};
};

/// Of plain numbers, here and below, where the test spends its time: it is not optimised.
double squared_between(const double* p, const double* q) {
  const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
  return x * x + y * y + z * z;
}

std::vector<CloudPoint> cloud_of(const std::vector<Chart>& charts) {
  std::vector<CloudPoint> out;
  for (std::size_t c = 0; c < charts.size(); ++c)
    for (int i = 0; i < charts[c].count_a; ++i)
      for (int j = 0; j < charts[c].count_b; ++j) {
        const double da = 1.0 / charts[c].count_a, db = 1.0 / charts[c].count_b;
        const double a = (i + 0.5) * da, b = (j + 0.5) * db;
        const Vec3 along_a = charts[c].at(a + 0.5 * da, b) - charts[c].at(a - 0.5 * da, b);
        const Vec3 along_b = charts[c].at(a, b + 0.5 * db) - charts[c].at(a, b - 0.5 * db);
        const Vec3 square = cross(along_a, along_b);
        out.push_back({charts[c].at(a, b), unit(square), norm(square), c, a, b});
      }
  return out;
}

/// The cloud in bins of 2 mm: the distance to the tangent plane of the nearest point where the foot
/// is beside that point, else the distance to the point.
class Bins {
 public:
  explicit Bins(const std::vector<CloudPoint>& cloud, double beside_mm)
      : cloud_(cloud), beside_mm_(beside_mm) {
    for (std::uint32_t i = 0; i < cloud.size(); ++i) bins_[key(cell(cloud[i].p))].push_back(i);
  }
  [[nodiscard]] double distance(const Vec3& p) const {
    const auto c = cell(p);
    double best = 1e300;
    std::uint32_t nearest = 0;
    for (int ring = 0; ring < 200 && (ring - 1) * kBin < std::sqrt(best); ++ring)
      for (int i = -ring; i <= ring; ++i)
        for (int j = -ring; j <= ring; ++j)
          for (int k = -ring; k <= ring; ++k) {
            if (std::max({std::abs(i), std::abs(j), std::abs(k)}) != ring) continue;
            const auto found = bins_.find(key({c[0] + i, c[1] + j, c[2] + k}));
            if (found == bins_.end()) continue;
            for (const std::uint32_t n : found->second) {
              const double d = squared_between(cloud_[n].p.data(), p.data());
              if (d < best) best = d, nearest = n;
            }
          }
    const double high = dot(p - cloud_[nearest].p, cloud_[nearest].normal);
    const double aside = std::sqrt(std::max(0.0, best - high * high));
    return aside <= beside_mm_ ? std::abs(high) : std::sqrt(best);
  }

 private:
  static constexpr double kBin = 2.0;
  using Cell = std::array<long, 3>;
  static Cell cell(const Vec3& p) {
    return {std::lround(p[0] / kBin), std::lround(p[1] / kBin), std::lround(p[2] / kBin)};
  }
  static long key(const Cell& c) { return ((c[0] + 5000) * 10000 + c[1] + 5000) * 10000 + c[2]; }
  const std::vector<CloudPoint>& cloud_;
  double beside_mm_;
  std::unordered_map<long, std::vector<std::uint32_t>> bins_;
};

/// A face of the opened pattern: an upright or a level polygon.
struct StandingFace {
  std::vector<Vec3> corner;  ///< (x, s, z)
  bool upright{};
  [[nodiscard]] bool contains(double along, double s) const {  // by crossings of a ray
    bool inside = false;
    for (std::size_t i = 0, j = corner.size() - 1; i < corner.size(); j = i++) {
      const double a = upright ? corner[i][2] : corner[i][0],
                   b = upright ? corner[j][2] : corner[j][0];
      if ((corner[i][1] > s) != (corner[j][1] > s) &&
          along < (b - a) * (s - corner[i][1]) / (corner[j][1] - corner[i][1]) + a)
        inside = !inside;
    }
    return inside;
  }
};

struct Rectangle {
  double low[3], high[3];
};

struct Standing {
  std::vector<std::pair<Vec3, double>> points;  ///< with their areas
  std::vector<Vec3> corners;
  std::vector<Rectangle> rectangles;  ///< the same area
  double from_mm{1e300}, to_mm{-1e300};
};

/// Faces that stand, cut at all their corners' places into rectangles.
Standing standing(const Design& made) {
  constexpr double kStep = 0.9;
  Standing out;
  const double shift = made.report.slices.front().v_mm - made.report.slices.front().s_mm;
  for (std::size_t f = 0; f < made.pattern.faces(); ++f) {
    StandingFace face;
    double x = 0.0, z = 0.0;
    for (const std::uint32_t i : made.pattern.face(f)) {
      const PatternVertex& p = made.pattern.vertices[i];
      x = std::max(x, p.x), z = std::max(z, p.z);
      face.corner.push_back({p.x, p.v - shift, p.z});
    }
    if (x < 1e-9 || z < 1e-9) continue;  // in the wall or in the ground
    const double x0 = face.corner.front()[0];
    face.upright = std::all_of(face.corner.begin(), face.corner.end(),
                               [&](const Vec3& p) { return std::abs(p[0] - x0) < 1e-9; });
    std::vector<double> s, along;
    for (const Vec3& p : face.corner)
      s.push_back(p[1]), along.push_back(face.upright ? p[2] : p[0]);
    for (auto* places : {&s, &along}) {
      std::sort(places->begin(), places->end());
      places->erase(std::unique(places->begin(), places->end(),
                                [](double a, double b) { return b - a < 1e-9; }),
                    places->end());
    }
    const auto place = [&](double a, double where) {
      return face.upright ? Vec3(x0, where, a) : Vec3(a, where, face.corner.front()[2]);
    };
    for (std::size_t i = 0; i + 1 < s.size(); ++i)
      for (std::size_t j = 0; j + 1 < along.size(); ++j) {
        if (!face.contains(0.5 * (along[j] + along[j + 1]), 0.5 * (s[i] + s[i + 1]))) continue;
        const Vec3 low = place(along[j], s[i]), high = place(along[j + 1], s[i + 1]);
        out.rectangles.push_back({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
        out.from_mm = std::min(out.from_mm, s[i]), out.to_mm = std::max(out.to_mm, s[i + 1]);
        for (const double a : {along[j], along[j + 1]})
          for (const double b : {s[i], s[i + 1]}) out.corners.push_back(place(a, b));
        const double wide = s[i + 1] - s[i], deep = along[j + 1] - along[j];
        const int m = static_cast<int>(std::ceil(wide / kStep)),
                  n = static_cast<int>(std::ceil(deep / kStep));
        for (int k = 0; k < m; ++k)
          for (int l = 0; l < n; ++l)
            out.points.emplace_back(
                place(along[j] + deep * (l + 0.5) / n, s[i] + wide * (k + 0.5) / m),
                wide * deep / (m * n));
      }
  }
  return out;
}

double distance(const Standing& structure, const Vec3& p) {
  double best = 1e300;
  const double* const at = p.data();
  for (const Rectangle& r : structure.rectangles) {
    double squared = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double below = r.low[i] - at[i], above = at[i] - r.high[i];
      const double off = below > 0.0 ? below : above > 0.0 ? above : 0.0;
      squared += off * off;
    }
    if (squared < best) best = squared;
  }
  return std::sqrt(best);
}

/// Distances with the areas that they stand for.
struct Measured {
  std::vector<std::pair<double, double>> all;
  double most{};
  [[nodiscard]] double area() const {
    double sum = 0.0;
    for (const auto& [d, w] : all) sum += w;
    return sum;
  }
  [[nodiscard]] double moment(int power) const {
    double sum = 0.0;
    for (const auto& [d, w] : all) sum += w * std::pow(d, power);
    return sum / area();
  }
  [[nodiscard]] double share_within(double mm) const {
    double sum = 0.0;
    for (const auto& [d, w] : all) sum += d <= mm ? w : 0.0;
    return sum / area();
  }
  [[nodiscard]] double quantile(double share) {
    std::sort(all.begin(), all.end());
    double sum = 0.0;
    const double wanted = share * area();
    for (const auto& [d, w] : all)
      if ((sum += w) >= wanted) return d;
    return all.back().first;
  }
};

void check_figures(const DistanceFigures& figures, Measured& measured) {
  CHECK_THAT(figures.mean_mm, WithinRel(measured.moment(1), 0.02));
  CHECK_THAT(figures.rms_mm, WithinRel(std::sqrt(measured.moment(2)), 0.02));
  CHECK_THAT(figures.p95_mm, WithinRel(measured.quantile(0.95), 0.02));
  CHECK_THAT(figures.max_mm, WithinRel(measured.most, 0.02));
}

void check_fit(const FitFigures& fit, const Design& made, const std::vector<Chart>& charts) {
  const Standing structure = standing(made);
  const std::vector<CloudPoint> cloud = cloud_of(charts);
  const Bins bins(cloud, 1.0);

  Measured there, back;
  for (const auto& [p, area] : structure.points) there.all.emplace_back(bins.distance(p), area);
  for (const auto& [d, area] : there.all) there.most = std::max(there.most, d);
  for (const Vec3& p : structure.corners) there.most = std::max(there.most, bins.distance(p));
  std::vector<std::pair<double, std::size_t>> far;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    back.all.emplace_back(distance(structure, cloud[i].p), cloud[i].area);
    far.emplace_back(back.all.back().first, i);
  }
  std::sort(far.rbegin(), far.rend());
  for (std::size_t n = 0; n < std::min<std::size_t>(40, far.size());
       ++n) {  // finer about the worst
    const CloudPoint& c = cloud[far[n].second];
    const Chart& chart = charts[c.chart];
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j)
        back.most =
            std::max(back.most, distance(structure, chart.at(c.a + 0.125 * i / chart.count_a,
                                                             c.b + 0.125 * j / chart.count_b)));
  }
  CHECK_THAT(fit.structure_mm2, WithinRel(there.area(), 1e-6));
  CHECK_THAT(fit.target_mm2, WithinRel(back.area(), 0.005));
  {
    INFO("from the structure to the target");
    check_figures(fit.to_target, there);
  }
  INFO("from the target to the structure");
  check_figures(fit.to_structure, back);
  // Shares are steps of distances: either grid is a point or two off along the border of each step.
  for (std::size_t w = 0; w < 3; ++w)
    CHECK_THAT(fit.share_within[w],
               WithinAbs(back.share_within(FitFigures::kWithin[w] * fit.size_mm), 0.015));
}

/// Quarter circles of a radius from one place to another.
Chart bands(const std::function<double(double)>& radius, double from, double to) {
  return {[=](double a, double b) {
            const double s = from + (to - from) * b, r = radius(s);
            return Vec3(r * std::sin(0.5 * kPi * a), s, r * std::cos(0.5 * kPi * a));
          },
          130, static_cast<int>(std::ceil(1.4 * (to - from)))};
}

struct Case {
  const char* name;
  std::string spec;                                          ///< the middle of the JSON
  std::function<std::vector<Chart>(double, double)> charts;  ///< over a stretch of the spine
  SurfaceAssets assets;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  const auto revolution = [&](const char* name, const char* formula, const char* more,
                              const std::function<double(double)>& radius) {
    out.push_back(
        {name,
         fmt::format(R"("surface":{{"type":"revolution","radius":"{}"}},{})", formula, more),
         [=](double from, double to) { return std::vector{bands(radius, from, to)}; },
         {}});
  };
  revolution("cylinder", "50", R"("units_per_slice":3,"slices":6,"widths_mm":10)",
             [](double) { return 50.0; });
  revolution("sphere", "sqrt(70^2-(y-30)^2)", R"("units_per_slice":6,"slices":10,"widths_mm":6)",
             [](double y) { return std::sqrt(4900.0 - (y - 30.0) * (y - 30.0)); });
  revolution("saddle", "sqrt(45^2+(y-30)^2)",
             R"("units_per_slice":5,"slices":8,"widths_mm":8,"lattice":"slices")",
             [](double y) { return std::sqrt(2025.0 + (y - 30.0) * (y - 30.0)); });
  revolution("wave", "55+8*sin(2*pi*y/50)",
             R"("units_per_slice":8,"slices":16,"widths_mm":4,"lattice":"levels")",
             [](double y) { return 55.0 + 8.0 * std::sin(2.0 * kPi * y / 50.0); });
  out.push_back(
      {"profile",
       R"_("surface":{"type":"profile","z":"(50+0.2*y)*(1-(x/60)^2)"},"units_per_slice":4,"slices":8,"widths_mm":8)_",
       [](double from, double to) {
         const auto at = [=](double a, double b) {
           const double y = from + (to - from) * b;
           return Vec3(60 * a, y, (50 + 0.2 * y) * (1 - a * a));
         };
         return std::vector{Chart{at, 150, 90}};
       },
       {}});
  out.push_back(
      {"solid",
       R"_("surface":{"type":"implicit","f":"(x/60)^4+(z/50)^4+((y-30)/90)^2-1"},"units_per_slice":5,"slices":8,"widths_mm":8)_",
       [](double from, double to) {
         const auto at = [=](double a, double b) {
           const double y = from + (to - from) * b, q = (y - 30) / 90;
           const double sine = std::sin(0.5 * kPi * a), cosine = std::cos(0.5 * kPi * a);
           const double t =
               std::pow((1 - q * q) / (std::pow(sine / 60, 4) + std::pow(cosine / 50, 4)), 0.25);
           return Vec3(t * sine, y, t * cosine);
         };
         return std::vector{Chart{at, 180, 90}};
       },
       {}});
  out.push_back(
      {"turned cone",
       R"("surface":{"type":"revolution","radius":"40-y/8"},"rotate_deg":[0,0,180],"translate_mm":[0,60,0],"units_per_slice":4,"slices":7,"widths_mm":8)",
       [](double from, double to) {
         return std::vector{bands([](double y) { return 40.0 - (60.0 - y) / 8.0; }, from, to)};
       },
       {}});
  // A roof of two planes: what triangles a grid is cut into makes no difference.
  out.push_back(
      {"grid",
       R"("surface":{"type":"grid","file":"roof.csv"},"units_per_slice":4,"slices":6,"widths_mm":9)",
       [](double, double) {
         const auto plane = [](double x0, double z0, double x1, double z1) {
           return Chart{[=](double a, double b) {
                          return Vec3(x0 + a * (x1 - x0), -10 + 80 * b, z0 + a * (z1 - z0));
                        },
                        60, 100};
         };
         return std::vector{plane(0, 50, 30, 40), plane(30, 40, 60, 0)};
       },
       {{"roof.csv", ",0,30,60\n-10,50,40,0\n70,50,40,0\n"}}});
  out.push_back(
      {"regions",
       R"_("regions":[{"radius":"40+4*sin(pi*y/L)","units_per_slice":3,"slices":4,"width_mm":8}, {"radius":"40+y/4","units_per_slice":3,"slices":4,"width_mm":6}])_",
       [](double from, double to) {  // a region reaches half a width beyond its slices
         return std::vector{
             bands([](double y) { return 40.0 + 4.0 * std::sin(kPi * (y + 4.0) / 32.0); }, from,
                   28.0),
             bands([](double y) { return 40.0 + (y - 28.0) / 4.0; }, 28.0, to)};
       },
       {}});
  out.push_back(
      {"patches",
       R"("patches":[{"surface":{"type":"revolution","radius":"45"},"units_per_slice":4,"slices":4,"widths_mm":8},
                               {"surface":{"type":"revolution","radius":"45+(y+4)/5"},"units_per_slice":4,"slices":4,"widths_mm":8}])",
       [](double from, double to) {  // the second one's own place 0 is at 32 mm
         return std::vector{bands([](double) { return 45.0; }, from, 28.0),
                            bands([](double y) { return 45.0 + (y - 28.0) / 5.0; }, 28.0, to)};
       },
       {}});
  return out;
}

Result<Design> designed(const std::string& middle, const SurfaceAssets& assets) {
  const auto spec = parse_design_spec(fmt::format(R"({{"popcut":1,{}}})", middle));
  if (!spec) return tl::unexpected(spec.error());
  auto made = design_assembly(*spec, assets);
  if (!made) return tl::unexpected(made.error());
  if (made->parts.size() != 1) return fail(ErrorKind::Internal, "", "is not one part");
  return std::move(made->parts.front());
}

}  // namespace

TEST_CASE("the fit of targets of all kinds agrees with an independent measure", "[core][fit]") {
  const std::vector<Case> all = cases();
  for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(testing::step_of(1, 3))) {
    const Case& one = all[k];
    DYNAMIC_SECTION(one.name) {
      const auto made = value(designed(one.spec, one.assets));
      const auto fit = value(surface_fit(made));
      const Standing structure = standing(made);
      check_fit(fit, made, one.charts(structure.from_mm, structure.to_mm));
    }
  }
}

TEST_CASE("the fit of a ball that is half out of reach agrees with an independent measure",
          "[core][fit]") {
  constexpr double kRadius = 30.0, kX = 28.0, kY = 20.0;
  const TriangleMesh ball = icosphere(kRadius, 3);
  const auto made = value(designed(
      R"("surface":{"type":"mesh","file":"ball.stl"},"fit":"nearest","translate_mm":[28,20,28],"units_per_slice":5,"slices":7,"widths_mm":6)",
      {{"ball.stl", binary_stl(ball)}}));
  const FitFigures fit = surface_fit(made).value();
  const Standing structure = standing(made);
  std::vector<Chart> charts;  // a triangle each, drawn together at one corner
  for (std::size_t t = 0; t < ball.size(); ++t) {
    std::array<Vec3, 3> c;
    for (std::size_t k = 0; k < 9; ++k)
      c[k / 3][static_cast<int>(k % 3)] =
          static_cast<double>(ball.corners[9 * t + k]) + (k % 3 == 1 ? kY : kX);
    charts.push_back(
        {[=](double a, double b) { return Vec3(c[0] + a * (c[1] - c[0]) + a * b * (c[2] - c[1])); },
         3, 3});
  }
  check_fit(fit, made, charts);

  // What is out of reach, by the circles that are the ball's sections.
  double outside = 0.0, beyond = 0.0, overhang = 0.0, all = 0.0;
  const double behind = 0.01 * fit.size_mm;
  for (const CloudPoint& c : cloud_of(charts)) {
    all += c.area;
    const double rho2 = kRadius * kRadius - (c.p[1] - kY) * (c.p[1] - kY);
    const double dx = std::max(0.0, c.p[0] + behind - kX), dz = std::max(0.0, c.p[2] + behind - kX);
    if (c.p[0] < 0 || c.p[2] < 0)
      outside += c.area;
    else if (c.p[1] < structure.from_mm || c.p[1] > structure.to_mm)
      beyond += c.area;
    else if (dx * dx + dz * dz < rho2)
      overhang += c.area;
  }
  CHECK_THAT(fit.out_of_reach.outside_of_the_corner, WithinAbs(outside / all, 0.01));
  CHECK_THAT(fit.out_of_reach.beyond_the_slices, WithinAbs(beyond / all, 0.01));
  CHECK_THAT(fit.out_of_reach.overhang, WithinAbs(overhang / all, 0.01));
  CHECK(fit.out_of_reach.share() > 0.5);
}

TEST_CASE("moving a structure changes no distance by more than the way", "[core][fit]") {
  constexpr unsigned kSeed = 14;
  std::mt19937 random(kSeed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  const auto anywhere = [&](double size) {
    return Vec3(uniform(0, size), uniform(0, size), uniform(0, size));
  };
  for (int round = 0; round < 10; ++round) {
    CAPTURE(kSeed, round);
    TriangleSoup target, structure;
    for (int k = 0; k < 150; ++k) {
      const Vec3 a = anywhere(60), b = anywhere(60);
      target.add(a, a + anywhere(20), a + anywhere(20));
      structure.add(b, b + anywhere(20), b + anywhere(20));
    }
    const Vec3 way = std::pow(10.0, uniform(-3, 1)) * unit(Vec3(anywhere(2) - Vec3(1, 1, 1)));
    TriangleSoup moved = structure;
    for (std::size_t k = 0; k < moved.corners.size(); ++k)
      moved.corners[k] += way[static_cast<int>(k % 3)];

    // 1. Of points, and the tree finds what looking at every triangle alone finds.
    const TriangleTree tree(structure), moved_tree(moved), target_tree(target);
    for (int n = 0; n < 20; ++n) {
      const Vec3 p = anywhere(80);
      const double before = std::sqrt(tree.nearest(p).squared);
      CHECK(std::abs(std::sqrt(moved_tree.nearest(p).squared) - before) <= norm(way) + 1e-9);
      double least = 1e300;
      for (std::size_t t = 0; t < structure.size(); ++t) {
        TriangleSoup one;
        one.add(structure.corner(t, 0), structure.corner(t, 1), structure.corner(t, 2));
        least = std::min(least, std::sqrt(TriangleTree(one).nearest(p).squared));
      }
      CHECK_THAT(before, WithinAbs(least, 1e-9));
    }
    // 2. Of the figures: samples move with the structure.
    const FitTarget aim(target);
    const FitFigures a = aim.measure(structure), b = aim.measure(moved);
    const double most = norm(way) + 1e-6;
    CHECK(std::abs(a.to_target.mean_mm - b.to_target.mean_mm) <= most);
    CHECK(std::abs(a.to_target.rms_mm - b.to_target.rms_mm) <= most);
    CHECK(std::abs(a.to_target.p95_mm - b.to_target.p95_mm) <= most);
    CHECK(std::abs(a.to_structure.mean_mm - b.to_structure.mean_mm) <= most);
    CHECK(std::abs(a.to_structure.rms_mm - b.to_structure.rms_mm) <= most);
    CHECK(std::abs(a.to_structure.p95_mm - b.to_structure.p95_mm) <= most);
    CHECK(std::abs(a.two_sided_rms_mm() - b.two_sided_rms_mm()) <= most);
  }
}

}  // namespace fit_property_test
