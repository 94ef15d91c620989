// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/shape_fit.hpp"
#include "core/design/strips/multi_state.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/value.hpp"

namespace splay_test {

using namespace popcut;

namespace {

constexpr double kPi = std::numbers::pi;

Result<Design> splayed(const std::string& splay, int units = 4, int slices = 4, double size = 122,
                       double width = 26.4) {
  const auto spec = parse_design_spec(fmt::format(
      R"({{"popcut":1,"surface":{{"type":"profile","z":"{0} - x"}},"units_per_slice":{1},"slices":{2},
          "widths_mm":{3},"splay":{4}}})",
      size, units, slices, width, splay));
  if (!spec) return tl::unexpected(spec.error());
  return design(*spec);
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

TEST_CASE("splayed lattices verify as a whole with one freedom", "[core][splay][verify]") {
  const double alpha = GENERATE(0.2, 0.9, 1.8);
  const int units = GENERATE(2, 3, 5);
  CAPTURE(alpha, units);
  const auto d =
      testing::value(splayed(fmt::format(R"({{"alpha":{}}})", alpha), units, 5, 40.0 * units, 20));
  CHECK(d.pattern.v_folds.size() == static_cast<std::size_t>(4 * (units - 1)));
  std::ostringstream fold;
  FoldOptions frames;
  frames.psi_rad = std::vector{kPi, 2.4, kPi / 2, 1.1, 0.3};
  REQUIRE(write_fold(d.pattern, frames, fold));
  VerifyOptions options;
  options.degrees_of_freedom = 1;
  const auto report = testing::value(verify_fold(fold.str(), options));
  if (!report.ok()) FAIL(verify_text(report));
}

TEST_CASE("the tip of a V-fold keeps its distances at every opening", "[core][splay]") {
  const auto d =
      testing::value(splayed(R"({"alpha":[[0,1.1,0],[0.4,0,0.8],[0,2,0]],"length_mm":10})"));
  CHECK(d.pattern.v_folds.size() == 4);
  for (const double psi : {kPi, 2.5, 1.5, 0.4}) {
    const auto places = posed_vertices(d.pattern, psi);
    for (const VFold& fold : d.pattern.v_folds) {
      const auto& tip = places[fold.tip];
      const auto& b = places[d.pattern.edges[fold.edge_b].to];
      const auto& c = places[d.pattern.edges[fold.edge_c].to];
      CHECK_THAT(distance(tip, places[fold.apex]), Catch::WithinAbs(fold.length_mm, 1e-12));
      CHECK_THAT(distance(tip, b), Catch::WithinAbs(fold.length_mm * fold.alpha, 1e-12));
      CHECK_THAT(distance(tip, c), Catch::WithinAbs(fold.length_mm * fold.alpha, 1e-12));
    }
  }
}

TEST_CASE("the fit counts V-folds as they pop", "[core][splay][fit]") {
  const auto plain = splayed(R"({"alpha":0})"), d = splayed(R"({"alpha":0.7})");
  if (!d) FAIL(message(d.error()));
  REQUIRE_FALSE(d->pattern.v_folds.empty());
  // The faces of the pattern that are not wall or ground have the area that was measured.
  const auto places = posed_vertices(d->pattern, d->pattern.design_psi_rad);
  double area = 0.0;
  for (std::size_t f = 0; f < d->pattern.faces(); ++f) {
    const auto face = d->pattern.face(f);
    bool wall = true, ground = true;
    std::array<double, 3> sum{};  // twice the face's area as a vector
    for (std::size_t k = 0; k < face.size(); ++k) {
      const PatternVertex& p = d->pattern.vertices[face[k]];
      wall = wall && p.x == 0.0, ground = ground && p.z == 0.0;
      const auto &a = places[face[k]], &b = places[face[(k + 1) % face.size()]];
      for (std::size_t i = 0; i < 3; ++i)
        sum[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
    if (!wall && !ground) area += 0.5 * distance(sum, {0, 0, 0});
  }
  const FitFigures fit = *surface_fit(*d);
  CHECK(fit.structure_mm2 == Approx(area).epsilon(1e-9));
  // Each tip is a corner of what was measured, two panels have a notch each, and it shows.
  std::vector<double> s_mm;
  for (const SliceReport& slice : d->report.slices) s_mm.push_back(slice.s_mm);
  const TriangleSoup soup = structure_triangles(d->strips, d->pattern, {d->strips, s_mm});
  for (const VFold& fold : d->pattern.v_folds) {
    int corners = 0;
    for (std::size_t k = 0; k < soup.corners.size(); k += 3)
      corners += std::abs(soup.corners[k] - places[fold.tip][0]) < 1e-12 &&
                 std::abs(soup.corners[k + 2] - places[fold.tip][2]) < 1e-12;
    CHECK(corners >= 2);
  }
  if (!plain) FAIL(message(plain.error()));
  const auto whole = structure_triangles(plain->strips, plain->pattern, {plain->strips, s_mm});
  CHECK(soup.size() == whole.size() + 10 * d->pattern.v_folds.size());
  CHECK(fit.to_target.mean_mm != surface_fit(*plain)->to_target.mean_mm);
}

TEST_CASE("the centre fold is highest where alpha cos(psi/2) is one", "[core][splay]") {
  CHECK_THAT(splay_rad(1.0 / std::cos(0.4), 0.8), Catch::WithinAbs(kPi / 2, 1e-15));
  CHECK(splay_rad(3.0, 0.8) > kPi / 2);
  CHECK(splay_rad(3.0, kPi) < 1e-15);
}

TEST_CASE("a single sheet goes from positive through zero to negative curvature", "[core][splay]") {
  // The paper's case: K > 0 at 0.16 pi, 0 at 0.28 pi, < 0 at 0.47 pi.
  const std::string splay = fmt::format(
      R"({{"length_mm":12,"ligament_mm":0.6,"targets":[{{"psi_rad":{},"sign":"+"}},{{"psi_rad":{},"K":0}},
          {{"psi_rad":{},"sign":"-"}}]}})",
      0.16 * kPi, 0.28 * kPi, 0.47 * kPi);
  const auto d = testing::value(splayed(splay));
  std::ostringstream fold;
  REQUIRE(write_fold(d.pattern, {}, fold));
  VerifyOptions options;
  options.degrees_of_freedom = 1;
  const auto report = testing::value(verify_fold(fold.str(), options));
  CHECK(report.ok());
  const auto spec = parse_design_spec(
      R"({"popcut":1,"surface":{"type":"profile","z":"122 - x"},"units_per_slice":4,"slices":4,"widths_mm":26.4})");
  const auto plain = testing::value(design(*spec));
  SplaySpec wanted;
  wanted.length_mm = 12, wanted.ligament_mm = 0.6;
  wanted.targets = {
      {0.16 * kPi, {}, 1, 0.05}, {0.28 * kPi, 0.0, 0, 0.05}, {0.47 * kPi, {}, -1, 0.05}};
  const auto solved = testing::value(solve_multi_state(plain.strips, wanted));
  CHECK(solved.K_rad[0] >= 0.05 - 1e-9);
  CHECK(std::abs(solved.K_rad[1]) < 1e-9);
  CHECK(solved.K_rad[2] <= -0.05 + 1e-9);
}

TEST_CASE("the splays of the geometry reference give its curvatures", "[core][splay]") {
  // docs/geometry.md, section 7: pitch 2.2 w along, a = 1.15 w max(alpha); centre 0.7, along 0,
  // across 2.18294652.
  const double across = 2.1829465169852584, w = 10.0, a = 1.15 * w * across;
  const auto spec = parse_design_spec(fmt::format(
      R"({{"popcut":1,"surface":{{"type":"profile","z":"{} - x"}},"units_per_slice":4,"slices":4,"widths_mm":22,
          "lattice":"conformal"}})",
      4 * a));
  const auto d = testing::value(design(*spec));
  SplaySpec splay;
  splay.length_mm = w, splay.ligament_mm = 0.5;
  splay.alpha = {{0, across, 0}, {0, 0.7, 0}, {0, across, 0}};
  CHECK_THAT(splayed_curvature(d.strips, splay, 2, 1, 0.16 * kPi), Catch::WithinAbs(0.0580, 1e-4));
  CHECK_THAT(splayed_curvature(d.strips, splay, 2, 1, 0.28 * kPi), Catch::WithinAbs(0.0, 1e-9));
  CHECK_THAT(splayed_curvature(d.strips, splay, 2, 1, 0.47 * kPi), Catch::WithinAbs(-0.0608, 1e-4));
}

TEST_CASE("V-folds that do not fit are refused with values that would", "[core][splay]") {
  const auto [splay, kind, place, says] =
      GENERATE(table<std::string, ErrorKind, std::string, std::string>(
          {{R"({"alpha":9})", ErrorKind::Infeasible, "/splay/alpha", "at most"},
           {R"({"alpha":0.5,"length_mm":14})", ErrorKind::Infeasible, "/splay/length_mm",
            "does not fit"},
           {R"({"alpha":0.5,"ligament_mm":30})", ErrorKind::Infeasible, "/splay/ligament_mm",
            "use a ligament_mm under"},
           {R"({"alpha":[[0,0,0],[0,7,0],[0,0,0]]})", ErrorKind::Infeasible, "/splay/alpha/1/1",
            "at most"},
           {R"({"alpha":[[0,0,0],[0,1,0]]})", ErrorKind::OutOfRange, "/splay/alpha",
            "2 rows for 3"},
           {R"({"alpha":[[0,0],[0,1],[0,0]]})", ErrorKind::OutOfRange, "/splay/alpha/0",
            "2 values for 3"},
           {R"({"alpha":-1})", ErrorKind::Malformed, "/splay/alpha", "number"},
           {R"({"targets":[{"psi_rad":0.5,"K":6.1}]})", ErrorKind::Infeasible, "/splay/targets",
            "miss by"},
           {R"({"targets":[{"psi_rad":0.5}]})", ErrorKind::Malformed, "/splay/targets/0", "either"},
           {R"({"alpha":1,"targets":[]})", ErrorKind::Malformed, "/splay/alpha", "contradicts"}}));
  CAPTURE(splay);
  const auto d = splayed(splay);
  REQUIRE_FALSE(d);
  CHECK(d.error().kind == kind);
  CHECK(d.error().place == place);
  CHECK_THAT(d.error().detail, Catch::Contains(says));
}

}  // namespace splay_test
