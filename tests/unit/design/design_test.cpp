// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "tests/support/value.hpp"

namespace design_test {

using namespace popcut;

namespace {

struct Recipe {
  std::string radius{"1"};
  int units{5};
  int slices{8};
  double width{0.1};
  std::string lattice{"conformal"};
  std::string more;
};

/// A revolution of about 100 mm with the measures that the published tables use.
DesignSpec spec_of(const Recipe& r) {
  return testing::value(parse_design_spec(fmt::format(
      R"({{"popcut": 1, "surface": {{"type": "revolution", "radius": "{}"}}, "scale_mm": 100,
          "units_per_slice": {}, "slices": {}, "widths_mm": {}, "lattice": "{}"{}}})",
      r.radius, r.units, r.slices, 100 * r.width, r.lattice, r.more)));
}

Design made(const Recipe& recipe) { return testing::value(design(spec_of(recipe))); }

const std::string kSphere = "sqrt(1.05-y^2)", kSaddle = "sqrt(1+y^2)", kWave = "1+0.15*sin(3*y)";

/// As benches measure: panels of at least a tenth of the mean step, and no upper limit.
std::string bench_limits(int units) {
  return fmt::format(R"(, "min_panel_mm": {}, "max_step_over_mean": null)", 10.0 / units);
}

double face_area(const Pattern& p, std::size_t f) {
  double twice = 0.0;
  const auto face = p.face(f);
  for (std::size_t k = 0; k < face.size(); ++k) {
    const PatternVertex &a = p.vertices[face[k]], &b = p.vertices[face[(k + 1) % face.size()]];
    twice += p.u(a) * b.v - p.u(b) * a.v;
  }
  return 0.5 * twice;
}

}  // namespace

TEST_CASE("with its card a structure has exactly one freedom for any number of units and slices",
          "[core][design]") {
  const int units = GENERATE(1, 2, 3, 4, 5, 6, 7, 8);
  const int slices = GENERATE(1, 2, 3, 5);
  const auto lattice =
      GENERATE(as<std::string>{}, "slices", "branching", "conformal", "levels", "direct");
  CAPTURE(units, slices, lattice);
  const Design d = made({kSaddle, units, slices, 0.1, lattice, ""});
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.pieces == 1);
}

TEST_CASE("without its card the loose ends add the freedoms that the theory predicts",
          "[core][design]") {
  const int units = GENERATE(2, 3, 4, 5, 6);
  const int slices = GENERATE(2, 3, 4, 7);
  CAPTURE(units, slices);
  const Design d = made({"1", units, slices, 0.1, "slices", R"(, "card": false)"});
  CHECK(d.report.degrees_of_freedom == (units == 2 ? 3 * slices - 1 : 1 + 2 * slices));
}

TEST_CASE("a design tells what it is doing and how far it is, and is the same without a listener",
          "[core][design][progress]") {
  const Recipe recipe{kSaddle, 8, 12, 0.08, "auto", ""};
  std::vector<std::pair<std::string, double>> told;
  const auto heard = design(spec_of(recipe), {}, [&](std::string_view what, double done) {
    told.emplace_back(what, done);
  });
  REQUIRE(heard);
  CHECK(heard->pattern.vertices.size() == made(recipe).pattern.vertices.size());
  const auto times = [&](const char* what) {
    return std::count_if(told.begin(), told.end(),
                         [&](const auto& one) { return one.first == what; });
  };
  CHECK(times("cutting the shape into slices") == 12);
  CHECK(times("fitting steps to the slices") == 12);
  CHECK(times("laying the lattice: direct") > 10);
  CHECK(times("laying the lattice: conformal") > 10);
  CHECK(times("building the pattern") >= 1);
  // Often enough to be shown, and never from an inner loop.
  CHECK(told.size() < 1000);
  for (std::size_t k = 0; k < told.size(); ++k) {
    CAPTURE(told[k].first, told[k].second);
    CHECK(told[k].second <= 1.0);
    const bool goes_on = k > 0 && told[k].first == told[k - 1].first;
    if (goes_on) CHECK(told[k].second >= told[k - 1].second);
  }
}

TEST_CASE("the faces of a pattern tile its sheet counter-clockwise", "[core][design]") {
  const auto lattice =
      GENERATE(as<std::string>{}, "slices", "branching", "conformal", "levels", "direct");
  const int units = GENERATE(1, 2, 5, 12);
  CAPTURE(lattice, units);
  const Design d = made({kSphere, units, 7, 0.08, lattice, ""});
  double sum = 0.0;
  for (std::size_t f = 0; f < d.pattern.faces(); ++f) {
    const double area = face_area(d.pattern, f);
    CHECK(area > 0.0);
    sum += area;
  }
  CHECK_THAT(sum, Catch::WithinRel(d.report.sheet_u_mm * d.report.sheet_v_mm, 1e-12));
}

TEST_CASE("every fold edge lies between two faces and every cut side borders one",
          "[core][design]") {
  const Design d = made({kSphere, 6, 9, 0.08, "conformal", ""});
  std::size_t folds = 0;
  for (const PatternEdge& e : d.pattern.edges) {
    const bool fold = e.role == EdgeRole::Mountain || e.role == EdgeRole::Valley;
    folds += fold;
    CHECK(e.left >= 0);
    CHECK((e.right >= 0) == fold);
    const PatternVertex &a = d.pattern.vertices[e.from], &b = d.pattern.vertices[e.to];
    if (fold) CHECK((a.x == b.x && a.z == b.z));
    if (e.role == EdgeRole::Slit) CHECK(a.v == b.v);
  }
  CHECK(folds == d.report.folds);
  // Euler: one piece without holes, whose slits are the only openings.
  CHECK(d.report.faces + 1 + d.report.cuts + d.pattern.vertices.size() >= d.pattern.edges.size());
}

TEST_CASE("a sheet has the widths and places of the design reference", "[core][design]") {
  const Design d = made(
      {"1", 5, 3, 0.1, "slices", R"(, "card": {"margin_mm": 12, "wall_mm": 130, "shut": "free"})"});
  CHECK_THAT(d.report.sheet_v_mm, Catch::WithinAbs(2 * 12 + 30 - 5, 1e-12));
  CHECK_THAT(d.report.sheet_u_mm, Catch::WithinAbs(130 + 115, 1e-9));
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK_THAT(d.report.slices[j].s_mm, Catch::WithinAbs(10.0 * static_cast<double>(j), 1e-12));
    CHECK_THAT(d.report.slices[j].v_mm,
               Catch::WithinAbs(d.report.slices[j].s_mm + 12 + 2.5, 1e-12));
  }
}

TEST_CASE("uneven widths put each slice at the middle of its strip", "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":4,
          "widths_mm":[4,10,6,12]})"));
  const auto d = testing::value(design(spec));
  const double s[] = {0, 7, 15, 24};
  for (std::size_t j = 0; j < 4; ++j) {
    CHECK_THAT(d.report.slices[j].s_mm, Catch::WithinAbs(s[j], 1e-12));
    CHECK_THAT(d.report.slices[j].v_mm, Catch::WithinAbs(s[j] + 15 + 1, 1e-12));
  }
  CHECK_THAT(d.report.sheet_v_mm, Catch::WithinAbs(30 + 32 - 4, 1e-12));
}

TEST_CASE("a conformal lattice puts every inner connector vertex on the target", "[core][design]") {
  const auto radius = GENERATE(as<std::string>{}, "1", kSphere, kSaddle);
  const int units = GENERATE(4, 5, 8);
  CAPTURE(radius, units);
  const Design d = made({radius, units, 8, 0.1, "conformal", ""});
  CHECK(d.report.inner_error.max_mm <= 1e-6 * 100);
  CHECK(d.report.degrees_of_freedom == 1);
  const Design plain = made({radius, units, 8, 0.1, "slices", ""});
  CHECK(d.report.inner_error.max_mm <= plain.report.inner_error.max_mm + 1e-12);
}

TEST_CASE("a levels lattice is exact and tight on sphere saddle and wave", "[core][design]") {
  const auto radius = GENERATE(as<std::string>{}, kSphere, kSaddle, kWave);
  const auto [units, slices, width] =
      GENERATE(table<int, int, double>({{6, 8, 0.1}, {10, 20, 0.035}, {20, 60, 0.013}}));
  CAPTURE(radius, units, slices);
  const Design d = made({radius, units, slices, width, "levels",
                         fmt::format(R"(, "min_panel_mm": {})", 10.0 / units)});
  CHECK(d.report.inner_error.max_mm <= 1e-12 * 100);
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.end_error.max_mm < 0.1 * 105);
}

TEST_CASE("the branching lattice has the published errors on the saddle", "[core][design]") {
  // Relative to the local radius: 2.3 % inside a branch (N = 5) and 4.9 % between branches.
  const Design d = made({kSaddle, 5, 8, 0.1, "branching", R"(, "min_panel_mm": 0.001)"});
  CHECK_THAT(d.report.inner_error.max_mm / 100, Catch::WithinAbs(0.055, 0.001));
}

TEST_CASE("the conformal lattice meets the table of the design reference", "[core][design]") {
  struct Row {
    std::string radius;
    int units, slices;
    double width, inner, ends;
  };
  const auto row = GENERATE(values<Row>({{kSphere, 5, 8, 0.1, 1e-9, 1},
                                         {kSphere, 8, 8, 0.1, 2e-9, 2e-3},
                                         {kSphere, 20, 60, 0.013, 1.1e-8, 1e-2},
                                         {kSaddle, 8, 8, 0.1, 1e-9, 1},
                                         {kSaddle, 20, 60, 0.013, 1e-8, 1},
                                         {kWave, 10, 20, 0.035, 3e-9, 2.4e-3}}));
  CAPTURE(row.radius, row.units, row.slices);
  const Design d =
      made({row.radius, row.units, row.slices, row.width, "conformal", bench_limits(row.units)});
  CHECK(d.report.inner_error.max_mm / 100 <= row.inner);
  CHECK(d.report.end_error.max_mm / 100 <= row.ends);
  CHECK(d.report.step_over_mean_min >= 0.089);
}

TEST_CASE("a slice that stands alone is laid as two halves and has one freedom", "[core][design]") {
  const Design d = made({"1", 7, 1, 0.2, "conformal", ""});
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK_THAT(d.report.sheet_v_mm, Catch::WithinAbs(30 + 15, 1e-12));
  CHECK(d.report.notes.size() == 1);
}

TEST_CASE("a target too steep for its neighbours keeps one freedom and reports the merged place",
          "[core][design]") {
  const auto lattice = GENERATE(as<std::string>{}, "slices", "branching", "levels");
  const Design d = made({"0.3 + 8*y^2", 9, 8, 0.1, lattice, ""});
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK((!d.report.merged.empty() || !d.report.notes.empty()));
}

TEST_CASE("a profile surface is designed as well as a revolution", "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"j({"popcut":1,"surface":{"type":"profile","z":"1.2 - x^2*(1 + 0.3*y)"},"scale_mm":50,
          "units_per_slice":6,"slices":8,"widths_mm":6,"lattice":"conformal"})j"));
  const auto d = testing::value(design(spec));
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.inner_error.max_mm < 0.5);
}

TEST_CASE("regions have their own units and radius and are separated by plain cuts",
          "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"surface":{"type":"composite","radii":[60,25,40]},"regions":[
          {"units_per_slice":1,"slices":11,"width_mm":12},{"units_per_slice":2,"slices":26,"width_mm":4},
          {"units_per_slice":3,"slices":15,"width_mm":8}]})"));
  const auto d = testing::value(design(spec));
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.units_per_slice == std::vector<int>{1, 2, 3});
  CHECK(d.report.slices.size() == 52);
  CHECK_THAT(d.report.notes[0], Catch::Contains("between slices 10 and 11"));
  // The first slice lies half a width into the first region: R1 and half a cosine.
  const double y_over_l = 0.5 / 11;
  const double r = 60 - 35 * 0.5 * (1 - std::cos(M_PI * y_over_l));
  CHECK_THAT(d.strips.x[d.strips.first_point(1) + 2], Catch::WithinAbs(r, 1e-9));
}

TEST_CASE("neighbouring regions with equal units are joined by a connector", "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"regions":[{"radius":"50 + 5*y/L","units_per_slice":4,"slices":3,"width_mm":6},
          {"radius":"55 - 5*y/L","units_per_slice":4,"slices":3,"width_mm":9}]})"));
  const auto d = testing::value(design(spec));
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.notes.empty());
  CHECK(std::count(d.strips.kind.begin(), d.strips.kind.end(), StripKind::Connector) == 5);
}

TEST_CASE("adaptive widths keep to their error with fewer slices than equal ones",
          "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"40 + 15*exp(-((y-60)/12)^2)"},
          "units_per_slice":4,"slices":200,"widths_mm":{"max_error_mm":0.4,"length_mm":120}})j"));
  const auto d = testing::value(design(spec));
  CHECK(d.report.degrees_of_freedom == 1);
  const auto r = [](double y) { return 40 + 15 * std::exp(-(y - 60) * (y - 60) / 144); };
  const auto& slices = d.report.slices;
  double total = 0.5 * (slices.front().width_mm + slices.back().width_mm);
  for (std::size_t j = 0; j + 1 < slices.size(); ++j) {
    const double a = slices[j].s_mm, b = slices[j + 1].s_mm;
    CHECK(std::abs(r(0.5 * (a + b)) - 0.5 * (r(a) + r(b))) <= 0.4 + 1e-9);
    total += b - a;
  }
  CHECK(total >= 120);
  int uniform = 0, chosen = 0;
  REQUIRE(sscanf(d.report.notes.at(0).c_str(), "%d slices of chosen widths; equal ones would be %d",
                 &chosen, &uniform) == 2);
  CHECK(chosen == static_cast<int>(slices.size()));
  CHECK(uniform > chosen);
}

TEST_CASE("contradictory regions are refused", "[core][spec]") {
  const auto [text, place] = GENERATE(table<std::string, std::string>(
      {{R"({"popcut":1,"slices":3,"regions":[{"radius":"9","units_per_slice":2,"slices":3,"width_mm":6}]})",
        "/slices"},
       {R"({"popcut":1,"regions":[{"units_per_slice":2,"slices":3,"width_mm":6}]})",
        "/regions/0/radius"},
       {R"({"popcut":1,"regions":[]})", "/regions"},
       {R"({"popcut":1,"regions":[{"radius":"9","units_per_slice":2,"slices":3,"width_mm":-6}]})",
        "/regions/0/width_mm"},
       {R"({"popcut":1,"surface":{"type":"composite","radii":[1,2,3]},"regions":[{"units_per_slice":2,"slices":3,"width_mm":6}]})",
        "/surface/radii"},
       {R"({"popcut":1,"surface":{"type":"composite","radii":[3,1,2]},"regions":[{"units_per_slice":2,"slices":3,"width_mm":6}]})",
        "/regions"}}));
  CAPTURE(text);
  const auto spec = parse_design_spec(text);
  REQUIRE_FALSE(spec);
  CHECK(spec.error().place == place);
}

TEST_CASE("an invalid spec is refused with the place", "[core][spec]") {
  struct Bad {
    const char* text;
    ErrorKind kind;
    const char* place;
    const char* says;
  };
  const auto bad = GENERATE(values<Bad>({
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":4,"widths_mm":5,"widht":3})",
       ErrorKind::Malformed, "/widht", "not known"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"unit_per_slice":4,"slices":4,"widths_mm":5})",
       ErrorKind::Malformed, "/units_per_slice", "missing"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":"4","slices":4,"widths_mm":5})",
       ErrorKind::Malformed, "/units_per_slice", "whole number"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":0,"slices":4,"widths_mm":5})",
       ErrorKind::OutOfRange, "/units_per_slice", "from 1"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":1000000000,"widths_mm":5})",
       ErrorKind::OutOfRange, "/slices", "20000"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":4,"widths_mm":-5})",
       ErrorKind::OutOfRange, "/widths_mm", "above 0"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":2,"widths_mm":[5,"a"]})",
       ErrorKind::Malformed, "/widths_mm/1", "must be a number"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":3,"widths_mm":[5,6]})",
       ErrorKind::OutOfRange, "/widths_mm", "2 widths for 3"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":60},"units_per_slice":4,"slices":4,"widths_mm":5})",
       ErrorKind::Malformed, "/surface/radius", "text"},
      {R"({"popcut":1,"surface":{"type":"sphere","radius":"60"},"units_per_slice":4,"slices":4,"widths_mm":5})",
       ErrorKind::OutOfRange, "/surface/type", "revolution"},
      {R"({"popcut":2,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":4,"widths_mm":5})",
       ErrorKind::OutOfRange, "/popcut", "from 1 to 1"},
      {R"({"popcut":1,"surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":4,"widths_mm":1e400})",
       ErrorKind::OutOfRange, "line 1, column 102", "1e400 is too large"},
      {"{\"popcut\":1,\n \"surface\":", ErrorKind::Malformed, "line 2", "too early"},
      {"{\"popcut\":1, \"popcut\":1}", ErrorKind::Malformed, "/popcut", "twice"},
      {R"({"a":[1,[],{"b":{"x/y":{"k":2},"x/y":3}}]})", ErrorKind::Malformed, "/a/2/b/x~1y",
       "twice"},
      {"[]", ErrorKind::Malformed, "/", "object"},
      {"", ErrorKind::Malformed, "line 1", "too early"},
  }));
  CAPTURE(bad.text);
  const auto spec = parse_design_spec(bad.text);
  REQUIRE_FALSE(spec);
  CHECK(spec.error().kind == bad.kind);
  CHECK_THAT(spec.error().place, Catch::StartsWith(bad.place));
  CHECK_THAT(spec.error().detail, Catch::Contains(bad.says));
}

TEST_CASE("a spec nested without end is refused before it is parsed", "[core][spec]") {
  CHECK_FALSE(parse_design_spec(std::string(200'000, '[')));
}

TEST_CASE("an invalid radius is refused with its place along the spine", "[core][spec]") {
  const auto [radius, kind, says] = GENERATE(table<std::string, ErrorKind, std::string>(
      {{"sqrt(", ErrorKind::Malformed, "does not parse"},
       {"foo + 1", ErrorKind::Malformed, "does not parse"},
       {"", ErrorKind::Malformed, "parse"},
       {"sqrt(-0.01 - y^2)", ErrorKind::Infeasible, "not a number"},
       {"-0.2 - y", ErrorKind::Infeasible, "positive"},
       {"1/(y-y)", ErrorKind::OutOfRange, "not a number"},
       {"0.005", ErrorKind::Infeasible, "no room"}}));
  CAPTURE(radius);
  const auto result = design(spec_of({radius, 5, 8, 0.1, "conformal", ""}));
  REQUIRE_FALSE(result);
  CHECK(result.error().kind == kind);
  CHECK_THAT(result.error().place, Catch::StartsWith("/surface"));
  CHECK_THAT(result.error().detail, Catch::Contains(says));
}

TEST_CASE("a profile that rises or never reaches the ground is refused with its place",
          "[core][spec]") {
  const auto [z, kind, says] = GENERATE(table<std::string, ErrorKind, std::string>(
      {{"1 + 0.5*sin(6*x) - 0.3*x", ErrorKind::Infeasible, "rises"},
       {"exp(-x)", ErrorKind::Infeasible, "above the ground"},
       {"1 - x + (x > 0.5 ? sqrt(-1) : 0)", ErrorKind::Infeasible, "breaks off"},
       {"0 - x", ErrorKind::Infeasible, "start above"}}));
  CAPTURE(z);
  const auto spec = testing::value(parse_design_spec(fmt::format(
      R"({{"popcut":1,"surface":{{"type":"profile","z":"{}"}},"scale_mm":50,"units_per_slice":4,"slices":3,"widths_mm":5}})",
      z)));
  const auto result = design(spec);
  REQUIRE_FALSE(result);
  CHECK(result.error().kind == kind);
  CHECK_THAT(result.error().detail, Catch::Contains(says));
}

TEST_CASE("more units than fit are refused instead of making slivers", "[core][design]") {
  const auto result = design(spec_of({"0.1", 40, 6, 0.1, "conformal", ""}));
  REQUIRE_FALSE(result);
  CHECK(result.error().kind == ErrorKind::Infeasible);
  CHECK_THAT(result.error().detail, Catch::Contains("do not fit"));
}

TEST_CASE("a wall lower than the structure is refused with the height it needs", "[core][design]") {
  const auto result = design(spec_of({"1", 4, 4, 0.1, "slices", R"(, "card": {"wall_mm": 90})"}));
  REQUIRE_FALSE(result);
  CHECK(result.error().place == "/card/wall_mm");
  CHECK_THAT(result.error().detail, Catch::Contains("100.5"));
}

}  // namespace design_test
