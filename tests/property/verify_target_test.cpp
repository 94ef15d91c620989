// SPDX-License-Identifier: MIT
// The distance from the target that the verifier finds, from its own reading of the spec, is the
// one that the generator reports from its curves.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/value.hpp"

namespace verify_target_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

namespace {

struct Compared {
  DesignReport report;
  VerifyReport verified;
};

Compared compare(const std::string& spec_text, const std::string& target_text,
                 const std::string& bytes = {}) {
  CAPTURE(spec_text);
  const auto spec = testing::value(parse_design_spec(spec_text));
  const auto made = testing::value(design(spec, {{asset_of(spec.surface), bytes}}));
  std::ostringstream fold;
  REQUIRE(write_fold(made.pattern, {}, fold));
  VerifyOptions options;
  options.target_spec = target_text;
  for (const std::string& name : target_files_of(target_text))
    options.target_files.emplace(name, bytes);
  const auto verified = testing::value(verify_fold(fold.str(), options));
  INFO(verify_text(verified));
  CHECK(verified.ok());
  REQUIRE(verified.target_inner);
  return {made.report, verified};
}

/// Inner and end errors agree to `within_mm`.
void check_agrees(const std::string& spec, double within_mm = 1e-7, const std::string& bytes = {}) {
  CAPTURE(spec);
  const Compared both = compare(spec, spec, bytes);
  const TargetDistance &inner = *both.verified.target_inner, &all = *both.verified.target_all;
  CHECK(inner.vertices > 0);
  CHECK(inner.rms_mm == Approx(both.report.inner_error.rms_mm).margin(within_mm));
  CHECK(inner.max_mm == Approx(both.report.inner_error.max_mm).margin(within_mm));
  CHECK(all.max_mm == Approx(std::max(both.report.inner_error.max_mm, both.report.end_error.max_mm))
                          .margin(10.0 * within_mm));
}

std::string one(const std::string& surface, const std::string& more = "") {
  return fmt::format(
      R"({{"popcut":1,"surface":{},"units_per_slice":5,"slices":6,"widths_mm":7{}}})", surface,
      more);
}

}  // namespace

TEST_CASE("verify finds the error of each kind of target that the design reports",
          "[property][design][verify][target]") {
  check_agrees(
      one(R"j({"type":"implicit","f":"x^2 + z^2 - 1 - 0.1*sin(3*y)"})j", R"(,"scale_mm":40)"));
  check_agrees(one(R"j({"type":"implicit","f":"x^2 + z^2 - 1 - 0.1*sin(3*y)"})j",
                   R"(,"scale_mm":40,"lattice":"slices")"));
  check_agrees(one(R"j({"type":"profile","z":"2 - x - 0.2*x*y"})j",
                   R"(,"scale_mm":40,"rotate_deg":[0,5,0],"translate_mm":[-5,-20,-5])"));
  check_agrees(one(R"j({"type":"profile","z":"2 - x - 0.2*x*y"})j",
                   R"(,"scale_mm":40,"translate_mm":[0,-20,0],"lattice":"branching")"));
  check_agrees(one(R"j({"type":"revolution","radius":"sqrt(4-y^2)"})j",
                   R"(,"scale_mm":40,"translate_mm":[0,-20,0],"lattice":"slices")"));
}

TEST_CASE("verify measures grids and meshes by their triangles",
          "[property][design][verify][target]") {
  std::string csv = ",0,10,20,30,40\n";
  for (int y = 0; y <= 60; y += 20) csv += fmt::format("{},40,37,{},18,0\n", y, 30 + y / 10);
  // The generator rounds what it has placed to single precision, tilts level stretches, and lays a
  // smooth curve through a section's corners.
  check_agrees(one(R"({"type":"grid","file":"h.csv"})"), 1e-3, csv);
  const TriangleMesh ball = testing::sphere_mesh(60.0, 80, 80);
  for (const std::string& bytes : {testing::binary_stl(ball), testing::text_stl(ball)}) {
    check_agrees(one(R"({"type":"mesh","file":"b.stl"})", R"(,"lattice":"slices")"), 1e-3, bytes);
    check_agrees(one(R"({"type":"mesh","file":"b.stl"})",
                     R"(,"translate_mm":[-3,10,-4],"rotate_deg":[0,90,0])"),
                 1e-3, bytes);
  }
  check_agrees(one(R"({"type":"mesh","file":"b.obj"})", R"(,"scale_mm":1.5)"), 5e-3,
               testing::obj(ball));
}

TEST_CASE("verify finds the slices of regions with their plain cuts and slices alone",
          "[property][design][verify][target]") {
  check_agrees(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(4-y^2)"},"scale_mm":40,"regions":[
          {"units_per_slice":4,"slices":3,"width_mm":6},{"units_per_slice":5,"slices":1,"width_mm":8},
          {"units_per_slice":3,"slices":4,"width_mm":5},{"units_per_slice":2,"slices":1,"width_mm":5},
          {"units_per_slice":1,"slices":2,"width_mm":5}]})j");
  check_agrees(
      R"j({"popcut":1,"scale_mm":10,"regions":[
          {"units_per_slice":4,"slices":3,"width_mm":6,"radius":"5+y/L"},
          {"units_per_slice":4,"slices":4,"widths_mm":[5,7,4,6],"radius":"6-0.5*sin(y)"}]})j");
  check_agrees(
      R"j({"popcut":1,"surface":{"type":"composite","radii":[60,25,40]},"regions":[
          {"units_per_slice":1,"slices":4,"width_mm":12},{"units_per_slice":2,"slices":8,"width_mm":4},
          {"units_per_slice":3,"slices":6,"width_mm":8}]})j");
  for (const int units : {2, 3, 7})
    check_agrees(fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"profile","z":"26*(1 - x/140)*(1 + 0.9*x/140)"}},
            "units_per_slice":{},"slices":1,"widths_mm":20}})j",
        units));
}

TEST_CASE("verify finds slices that the design cut off and laid in halves",
          "[property][design][verify][target]") {
  // Between slices of 8 and 5 mm no connector fits, and the last one stands alone.
  check_agrees(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"59.8906+28.4034*sin(y/5.96136)"},
          "regions":[{"units_per_slice":5,"slices":4,"widths_mm":[20,8,10,8]},
          {"units_per_slice":5,"slices":4,"widths_mm":[10,20,5,8]}],"lattice":"levels",
          "min_panel_mm":1})j");
}

TEST_CASE("verify measures a profile that only touches the ground",
          "[property][design][verify][target]") {
  for (const char* z : {"52*(1-x/37)^2", "52*(1-x/(37+0.1*y))^4", "40*(cos(pi*x/50)+1)/2"})
    for (const char* lattice : {"slices", "conformal"})
      check_agrees(one(fmt::format(R"j({{"type":"profile","z":"{}"}})j", z),
                       fmt::format(R"(,"lattice":"{}")", lattice)),
                   1e-5);
}

TEST_CASE("verify measures a target that ends inside a slice",
          "[property][design][verify][target]") {
  const auto vertices = [](const std::string& text) {
    return compare(text, text).verified.target_inner->vertices;
  };
  for (const char* lattice : {"slices", "conformal", "levels"})
    CHECK(vertices(fmt::format(
              R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"sqrt(40^2-(y-40)^2)"}},
                  "units_per_slice":3,"slices":9,"widths_mm":10,"lattice":"{}"}})j",
              lattice)) > 10);
  // A slice that stands alone in two halves has its curve from all of its width.
  CHECK(vertices(R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(30^2-(y-40)^2)"},
            "regions":[{"units_per_slice":4,"slices":1,"width_mm":12.5},
            {"units_per_slice":8,"slices":2,"width_mm":5},
            {"units_per_slice":7,"slices":1,"width_mm":5}],"lattice":"levels"})j") > 5);
}

TEST_CASE("verify does not fail a pattern whose chosen widths it cannot read",
          "[property][design][verify][target]") {
  const std::string text =
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"20+abs(y-30)"},"units_per_slice":3,
          "slices":9,"widths_mm":{"max_error_mm":2,"length_mm":60}})j";
  const auto made = testing::value(design(testing::value(parse_design_spec(text))));
  std::ostringstream fold;
  REQUIRE(write_fold(made.pattern, {}, fold));
  VerifyOptions options;
  options.target_spec = text;
  const auto verified = testing::value(verify_fold(fold.str(), options));
  INFO(verify_text(verified));
  CHECK(verified.ok());
  CHECK(verify_text(verified).find("give the list of widths") != std::string::npos);
}

TEST_CASE("verify leaves out slices that are blank", "[property][design][verify][target][blank]") {
  const auto spec = [](const std::string& radius, const std::string& slices) {
    return fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"{}"}},"lattice":"slices",{}}})j",
        radius, slices);
  };
  for (const int units : {2, 3, 5}) {
    CAPTURE(units);
    const std::string slices =
        fmt::format(R"("units_per_slice":{},"slices":10,"widths_mm":)", units);
    // At both ends; in the middle; one slice alone between blank ones.
    for (const char* radius : {"y<25 ? 40 : (y<46 ? -1 : 40)", "y<25 ? -1 : (y<46 ? 40 : -1)",
                               "y<36 ? -1 : (y<44 ? 40 : (y<65 ? -1 : 40))"}) {
      CAPTURE(radius);
      check_agrees(spec(radius, slices + "10"));
      check_agrees(spec(radius, slices + "[10,12,8,10,9,11,10,10,12,8]"));
    }
  }
  check_agrees(spec("y<25?40:(y<45?-1:40)", R"("regions":[{"units_per_slice":8,"slices":2,
      "width_mm":9},{"units_per_slice":3,"slices":2,"width_mm":12.5},
      {"units_per_slice":7,"slices":1,"width_mm":5}])"));
}

TEST_CASE("verify measures each part of a design of patches",
          "[property][design][verify][target][patches]") {
  const std::string hall =
      R"j({"name":"hall","regions":[{"radius":"48","units_per_slice":3,"slices":4,"width_mm":14}]})j";
  const std::string dome =
      R"j({"name":"dome","regions":[{"radius":"48+14*sin(pi*y/L)","units_per_slice":6,"slices":8,
          "width_mm":10},{"radius":"48","units_per_slice":4,"slices":1,"width_mm":8}]})j";
  const std::string shed =
      R"j({"name":"shed","surface":{"type":"profile","z":"48*(1-(x/48)^2)"},"units_per_slice":5,
          "slices":3,"widths_mm":[16,12,9]})j";
  const auto agrees = [&](const std::string& join, const std::string& more = "") {
    const std::string text =
        fmt::format(R"({{"popcut":1,"patches":[{},{},{}],"join":{},"join_tolerance_mm":20{}}})",
                    hall, dome, shed, join, more);
    CAPTURE(text);
    const auto made = testing::value(design_assembly(testing::value(parse_design_spec(text))));
    std::string ranges;
    for (const Design& part : made.parts) {
      std::ostringstream fold;
      REQUIRE(write_fold(part.pattern, {}, fold));
      VerifyOptions options;
      options.target_spec = text;
      const auto verified = testing::value(verify_fold(fold.str(), options));
      INFO(verify_text(verified));
      REQUIRE(verified.target_inner);
      CHECK(verified.target_inner->vertices > 0);
      CHECK(verified.target_inner->rms_mm == Approx(part.report.inner_error.rms_mm).margin(1e-6));
      CHECK(verified.target_inner->max_mm == Approx(part.report.inner_error.max_mm).margin(1e-6));
      for (const VerifyCheck& check : verified.checks)
        if (check.name == "target") {
          CHECK(check.ok());
          ranges += check.detail.substr(check.detail.rfind(';'));
        }
    }
    return ranges;
  };
  CHECK(agrees(R"("sheet")") == "; of patches 0 to 2");
  CHECK(agrees(R"(["sheet","seam"])") == "; of patches 0 to 1; of patch 2");
  CHECK(agrees(R"("seam")", R"(,"card":{"margin_mm":9},"lattice":"slices")") ==
        "; of patch 0; of patch 1; of patch 2");
}

TEST_CASE("verify measures the widths that the design chose",
          "[property][design][verify][target]") {
  check_agrees(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(4-y^2)"},"scale_mm":40,
          "units_per_slice":5,"slices":30,"widths_mm":{"max_error_mm":0.2,"length_mm":50}})j");
}

TEST_CASE("verify ignores V-folds and measures the creases below them",
          "[property][design][verify][target]") {
  check_agrees(
      R"j({"popcut":1,"surface":{"type":"profile","z":"75 - x"},"units_per_slice":3,"slices":5,
          "widths_mm":15,"splay":{"alpha":1.5}})j");
}

TEST_CASE("verify reports a pattern that does not belong to its target",
          "[property][design][verify][target]") {
  const auto spec = parse_design_spec(one(R"({"type":"revolution","radius":"50"})"));
  const auto made = testing::value(design(*spec));
  std::ostringstream fold;
  REQUIRE(write_fold(made.pattern, {}, fold));
  VerifyOptions options;
  options.target_spec =
      R"({"popcut":1,"surface":{"type":"revolution","radius":"50"},"units_per_slice":5,"slices":9,"widths_mm":7})";
  const auto other = testing::value(verify_fold(fold.str(), options));
  CHECK_FALSE(other.ok());
  CHECK(verify_text(other).find("is it the spec of this pattern?") != std::string::npos);

  const auto refused = [&](const std::string& surface, const std::string& bytes) {
    options.target_spec = one(surface);
    options.target_files.clear();
    for (const std::string& name : target_files_of(one(surface)))
      options.target_files.emplace(name, bytes);
    const auto result = verify_fold(fold.str(), options);
    REQUIRE_FALSE(result);
    CHECK(exit_code(result.error().kind) == 3);
    return message(result.error());
  };
  using Catch::Matchers::Contains;
  const std::string grid = R"({"type":"grid","file":"h.csv"})",
                    mesh = R"({"type":"mesh","file":"m.stl"})";
  CHECK_THAT(refused(grid, ",0,10\n0,5,\n80,5,0\n"), Contains("line 2, column 3: is empty"));
  CHECK_THAT(refused(grid, ",0,10\n0,5,0\n0,5,0\n"),
             Contains("line 3, column 1: y is 0 after 0; values of y must grow"));
  CHECK_THAT(refused(grid, ""), Contains("x values are needed"));
  CHECK_THAT(refused(mesh, "solid\nvertex 1 2\n"), Contains("line 2: "));
  CHECK_THAT(refused(mesh, "solid\nfacet\nvertex 1 2\n"),
             Contains("line 3: has \"\" where a number is needed"));
  CHECK_THAT(refused(mesh, ""), Contains("m.stl: is not an STL file"));
  CHECK_THAT(refused(mesh, "solid\n"), Contains("no triangle"));
  CHECK_THAT(refused(R"({"type":"mesh","file":"m.obj"})", "v 0 0 0\nf 1 2 3\n"),
             Contains("line 2: names vertex \"2\""));
  CHECK_THAT(refused(R"({"type":"blob"})", ""), Contains("is \"blob\"; must be one of"));
  CHECK_THAT(refused(R"({"type":"implicit","f":"x+"})", ""), Contains("/surface/f"));
}

/// Points as JSON.
std::string listed(const std::vector<std::array<double, 2>>& points) {
  std::string text;
  for (const auto& [a, b] : points) text += fmt::format("{}[{},{}]", text.empty() ? "" : ",", a, b);
  return "[" + text + "]";
}

TEST_CASE("random drawn radii design, and verify finds what the design reports",
          "[property][design][verify][target][drawn]") {
  constexpr unsigned kSeed = 18;
  std::mt19937 random(kSeed);
  static constexpr std::array kLattices{"slices", "levels", "conformal", "direct"};
  int agreed = 0;
  for (int round = 0; round < 120; ++round) {
    CAPTURE(kSeed, round);
    std::vector<std::array<double, 2>> points;
    const int count = whole(random, 2, 6);  // bumps are longer than a slice is wide
    for (int k = 0; k < count; ++k)
      points.push_back({k == 0           ? -1.0
                        : k + 1 == count ? 41.0
                                         : 40.0 * k / (count - 1),
                        uniform(random, 35, 60)});
    const std::string spec = fmt::format(
        R"({{"popcut":1,"surface":{{"type":"revolution","radius":{{"points":{}}}}},
            "units_per_slice":{},"slices":5,"widths_mm":10,"lattice":"{}"}})",
        listed(points), whole(random, 2, 4),
        kLattices.at(static_cast<std::size_t>(whole(random, 0, 3))));
    const auto made = design(testing::value(parse_design_spec(spec)));
    if (!made) FAIL(spec << message(made.error()));
    if (made->report.inner_error.count == 0) continue;
    check_agrees(spec);
    ++agreed;
  }
  CHECK(agreed >= 100);
}

TEST_CASE("random lofts design, and verify finds what the design reports",
          "[property][design][verify][target][drawn]") {
  constexpr unsigned kSeed = 19;
  std::mt19937 random(kSeed);
  int agreed = 0;
  for (int round = 0; round < 40; ++round) {
    CAPTURE(kSeed, round);
    const int count = whole(random, 3, 7), last = whole(random, 2, 4);
    std::string stations;
    for (int k = 0; k <= last; ++k) {
      // Arcs of different bulge, whose points wander along them.
      const double h = uniform(random, 40, 60), d = uniform(random, 40, 60);
      const double power = uniform(random, 0.7, 1.6);
      std::vector<std::array<double, 2>> points;
      for (int i = 0; i < count; ++i) {
        const double share = i == 0           ? 0.0
                             : i + 1 == count ? 1.0
                                              : (i + uniform(random, -0.2, 0.2)) / (count - 1);
        const double angle = 1.5707963267948966 * share;
        points.push_back({i == 0 ? 0.0 : d * std::pow(std::sin(angle), power),
                          i + 1 == count ? 0.0 : h * std::pow(std::cos(angle), power)});
      }
      stations += fmt::format(R"({}{{"y":{},"curve":{}}})", k == 0 ? "" : ",", 42.0 * k / last - 1,
                              listed(points));
    }
    const std::string spec = fmt::format(
        R"({{"popcut":1,"surface":{{"type":"loft","stations":[{}]}},"units_per_slice":{},
            "slices":5,"widths_mm":10,"lattice":"{}"}})",
        stations, whole(random, 2, 4), whole(random, 0, 1) == 0 ? "slices" : "conformal");
    const auto made = design(testing::value(parse_design_spec(spec)));
    if (!made) continue;  // steep ones have no lattice
    if (made->report.inner_error.count == 0) continue;
    check_agrees(spec, 1e-6);
    ++agreed;
  }
  CHECK(agreed >= 25);
}

TEST_CASE("verify measures drawn shapes of regions, and those that are not upright",
          "[property][design][verify][target][drawn]") {
  check_agrees(
      R"j({"popcut":1,"scale_mm":10,"regions":[
          {"units_per_slice":4,"slices":3,"width_mm":6,"radius":{"points":[[0,5],[1,5.5],[2,6]]}},
          {"units_per_slice":4,"slices":4,"widths_mm":[5,7,4,6],"radius":"6-0.5*sin(y)"}]})j");
  const std::string profile =
      R"({"type":"profile","z":{"points":[[0,1.2],[0.4,1.1],[0.9,0.5],[1.1,0]]}})";
  check_agrees(one(profile, R"(,"scale_mm":40)"), 1e-6);
  check_agrees(one(profile, R"(,"scale_mm":40,"lattice":"slices","translate_mm":[0,0,-4])"), 1e-5);
}

TEST_CASE("a sphere through 40 points is that of the formula to a hundredth of the radius",
          "[property][design][drawn]") {
  std::vector<std::array<double, 2>> points;
  for (int k = 0; k < 40; ++k) {
    const double y = 90.0 * k / 39;
    points.push_back({y, std::sqrt(70.0 * 70.0 - (y - 45) * (y - 45))});
  }
  for (const char* lattice : {"slices", "levels", "conformal", "direct"}) {
    CAPTURE(lattice);
    const auto designed = [&](const std::string& radius) {
      const auto spec = testing::value(parse_design_spec(fmt::format(
          R"({{"popcut":1,"surface":{{"type":"revolution","radius":{}}},"units_per_slice":5,
              "slices":10,"widths_mm":10,"lattice":"{}"}})",
          radius, lattice)));
      return testing::value(design(spec));
    };
    const Design drawn = designed(fmt::format(R"({{"points":{}}})", listed(points)));
    const Design formula = designed(R"j("sqrt(70^2 - (y - 45)^2)")j");
    REQUIRE(drawn.strips.x.size() == formula.strips.x.size());
    double most = 0.0;
    for (std::size_t q = 0; q < drawn.strips.x.size(); ++q)
      most = std::max({most, std::abs(drawn.strips.x[q] - formula.strips.x[q]),
                       std::abs(drawn.strips.z[q] - formula.strips.z[q])});
    CHECK(most < 0.7);
  }
}

}  // namespace verify_target_test
