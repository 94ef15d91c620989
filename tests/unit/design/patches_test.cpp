// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/strips/strips.hpp"
#include "core/rigid/mobility.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace patches_test {

using namespace popcut;

namespace {

/// A patch of constant radius, `more` after it.
std::string tube(double radius, int units, int slices, const std::string& more = "") {
  return fmt::format(
      R"({{"surface":{{"type":"revolution","radius":"{}"}},"units_per_slice":{},"slices":{},"widths_mm":10{}}})",
      radius, units, slices, more);
}

Result<PatchAssembly> assembled(const std::string& patches, const std::string& more = "") {
  const auto spec =
      parse_design_spec(fmt::format(R"({{"popcut":1,"patches":[{}]{}}})", patches, more));
  if (!spec) return tl::unexpected(spec.error());
  return design_assembly(*spec);
}

Design designed(const std::string& fields) {
  const auto spec = testing::value(parse_design_spec(R"({"popcut":1,)" + fields + "}"));
  return testing::value(design(spec));
}

int freedoms(const Design& part) {
  const auto built =
      build_pattern(part.strips, part.pattern.wall_mm, part.pattern.ground_mm, part.pattern.card);
  return built ? rigid::mobility(built->section()).degrees_of_freedom : -1;
}

}  // namespace

TEST_CASE("patches whose walls and grounds agree become one sheet", "[core][patches]") {
  const auto made =
      testing::value(assembled(tube(40, 3, 4) + "," + tube(40.5, 5, 3) + "," + tube(40, 1, 2)));
  REQUIRE(made.parts.size() == 1);
  const Design& whole = made.parts.front();
  CHECK(freedoms(whole) == 1);
  CHECK(whole.report.degrees_of_freedom == 1);
  CHECK(whole.report.pieces == 1);
  CHECK(whole.report.slices.size() == 9);
  CHECK(whole.report.units_per_slice == std::vector<int>{3, 5, 1});
  CHECK(whole.pattern.seams.empty());
  REQUIRE(made.joins.size() == 2);
  for (const JoinReport& join : made.joins) {
    CHECK_FALSE(join.is_seam);
    CHECK(join.misfit_mm == Approx(0.5).margin(1e-9));
  }
  // The slices go on over the borders as they would in one design.
  for (std::size_t j = 1; j < whole.report.slices.size(); ++j) {
    CHECK(whole.report.slices[j].s_mm - whole.report.slices[j - 1].s_mm == Approx(10.0));
    CHECK(whole.report.slices[j].v_mm - whole.report.slices[j - 1].v_mm == Approx(10.0));
  }
  REQUIRE(made.patches.size() == 3);
  CHECK(made.patches[0].v_begin_mm == 0.0);
  CHECK(made.patches[1].v_begin_mm == made.patches[0].v_end_mm);
  CHECK(made.patches[2].v_end_mm == Approx(whole.pattern.width_mm));
  CHECK(whole.report.bridges.size() == 2);
}

TEST_CASE("patches with different walls keep their sheets and declare a seam on both",
          "[core][patches]") {
  const auto made =
      testing::value(assembled(tube(40, 3, 3, R"(,"card":{"wall_mm":60,"ground_mm":55})") + "," +
                               tube(40, 4, 3, R"(,"card":{"wall_mm":70,"ground_mm":50})")));
  REQUIRE(made.parts.size() == 2);
  for (const Design& part : made.parts) {
    CHECK(freedoms(part) == 1);
    REQUIRE(part.pattern.seams.size() == 1);
  }
  const Pattern &left = made.parts[0].pattern, &right = made.parts[1].pattern;
  // The spines are in line, and the seam is what both edges have in common: 60 up, 50 out.
  CHECK(left.place.u_mm + left.wall_mm == right.place.u_mm + right.wall_mm);
  CHECK(right.place.v_mm == left.place.v_mm + left.width_mm);
  const Seam &a = left.seams.front(), &b = right.seams.front();
  CHECK(a.id == b.id);
  CHECK(a.other == 1);
  CHECK(b.other == 0);
  CHECK(a.v_mm == left.width_mm);
  CHECK(b.v_mm == 0.0);
  CHECK(a.u0_mm == 0.0);
  CHECK(a.u1_mm == Approx(110.0));
  CHECK(b.u0_mm == Approx(10.0));
  CHECK(b.u1_mm == Approx(120.0));
  CHECK(made.joins.front().seam_mm == Approx(110.0));
  CHECK(made.joins.front().reason.find("walls are 60.0000 and 70.0000 mm") != std::string::npos);
}

TEST_CASE("a patch without a card uses its neighbours' if it fits", "[core][patches]") {
  const auto made =
      assembled(tube(40, 3, 3, R"(,"card":{"wall_mm":47,"ground_mm":46})") + "," + tube(40, 4, 3));
  REQUIRE(made);
  REQUIRE(made->parts.size() == 1);
  CHECK(made->parts.front().pattern.wall_mm == 47.0);
  CHECK(made->parts.front().pattern.ground_mm == 46.0);
  // Here it does not: the tall one cannot stand under a wall of 32 mm.
  const auto apart =
      assembled(tube(30, 3, 3, R"(,"card":{"wall_mm":32,"ground_mm":46})") + "," + tube(40, 4, 3),
                R"(,"join_tolerance_mm":11)");
  REQUIRE(apart);
  CHECK(apart->parts.size() == 2);
}

TEST_CASE("patches that do not fit are refused with the place and the misfit", "[core][patches]") {
  const auto refused = assembled(tube(40, 3, 3) + "," + tube(43.2, 3, 3));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK(refused.error().place == "/patches/1");
  CHECK(refused.error().detail.find("by 3.2 mm") != std::string::npos);
  const auto allowed =
      assembled(tube(40, 3, 3) + "," + tube(43.2, 3, 3), R"(,"join_tolerance_mm":3.3)");
  REQUIRE(allowed);
  CHECK(allowed->joins.front().misfit_mm == Approx(3.2));
  const auto no_sheet = assembled(tube(40, 3, 3, R"(,"card":{"wall_mm":60})") + "," +
                                      tube(40, 3, 3, R"(,"card":{"wall_mm":61})"),
                                  R"(,"join":"sheet")");
  REQUIRE_FALSE(no_sheet);
  CHECK(no_sheet.error().kind == ErrorKind::Infeasible);
  CHECK(no_sheet.error().place == "/patches/1/card");
}

TEST_CASE("an error inside a patch names the patch", "[core][patches]") {
  struct Row {
    std::string patches, more, place;
    ErrorKind kind;
  };
  const std::string good = tube(40, 3, 3);
  const Row row = GENERATE_COPY(values<Row>({
      {good, "", "/patches", ErrorKind::Malformed},
      {good + ",3", "", "/patches/1", ErrorKind::Malformed},
      {good + "," + tube(40, 0, 3), "", "/patches/1/units_per_slice", ErrorKind::OutOfRange},
      {good + "," + tube(40, 3, 3, R"(,"material":"x")"), "", "/patches/1/material",
       ErrorKind::Malformed},
      {good + "," + tube(40, 3, 3, R"(,"card":false)"), "", "/patches/1/card",
       ErrorKind::Malformed},
      {good + "," + good, R"(,"card":false)", "/card", ErrorKind::Malformed},
      {good + "," + good, R"(,"slices":3)", "/slices", ErrorKind::Malformed},
      {good + "," + good, R"(,"join":"glue")", "/join", ErrorKind::Malformed},
      {good + "," + good, R"(,"join":["seam","seam"])", "/join", ErrorKind::OutOfRange},
      {good + "," + good, R"(,"join":[7])", "/join/0", ErrorKind::Malformed},
      {good + "," + good, R"(,"join_tolerance_mm":-1)", "/join_tolerance_mm",
       ErrorKind::OutOfRange},
      {good + "," + good, R"(,"joint":"seam")", "/joint", ErrorKind::Malformed},
      {good + "," + tube(40, 2000, 3, R"(,"lattice":"conformal")"), "",
       "/patches/1/units_per_slice", ErrorKind::Infeasible},
  }));
  CAPTURE(row.patches, row.more);
  const auto refused = assembled(row.patches, row.more);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place.rfind(row.place, 0) == 0);
  CHECK(refused.error().kind == row.kind);
}

TEST_CASE("V-folds of a patch stay in its part of the sheet", "[core][patches]") {
  const std::string splayed =
      R"({"surface":{"type":"profile","z":"60-x"},"units_per_slice":4,"slices":3,"widths_mm":16,
          "splay":{"alpha":0.5}})";
  const std::string plain =
      R"({"surface":{"type":"profile","z":"60-x"},"units_per_slice":4,"slices":3,"widths_mm":16})";
  const auto made = testing::value(assembled(plain + "," + splayed));
  REQUIRE(made.parts.size() == 1);
  const Pattern& pattern = made.parts.front().pattern;
  CHECK(pattern.v_folds.size() == 6);  // three inner levels on two connectors
  for (const VFold& fold : pattern.v_folds)
    CHECK(pattern.vertices[fold.apex].v > made.patches[1].v_begin_mm);
}

TEST_CASE("slices of any N are connected to slices of any other", "[core][bridge]") {
  for (int left = 1; left <= 9; ++left)
    for (int right = 1; right <= 9; ++right) {
      if (left == right) continue;
      // With a sanitizer a fifth of them, so that each number comes on both sides.
      if (testing::fewer_rounds() && (left + 2 * right) % 5 != 1) continue;
      CAPTURE(left, right);
      const Design d = designed(fmt::format(
          R"j("surface":{{"type":"revolution","radius":"sqrt(3600-y^2)"}},"regions":[
             {{"units_per_slice":{},"slices":3,"width_mm":8}},
             {{"units_per_slice":{},"slices":2,"width_mm":6}}])j",
          left, right));
      CHECK(d.report.degrees_of_freedom == 1);
      REQUIRE(d.report.bridges.size() == 1);
      const BridgeReport& bridge = d.report.bridges.front();
      CHECK(bridge.slice == 2);
      CHECK(bridge.left_planes > 0);
      CHECK(bridge.right_planes > 0);
      // Within one mean step of the coarser side.
      CHECK(bridge.off_mm <= 60.0 / std::min(std::max(left, 2), std::max(right, 2)));
      // Distances on the target are distances on the sheet, over the bridge too.
      CHECK(d.report.slices[3].v_mm - d.report.slices[2].v_mm == Approx(7.0));
    }
}

TEST_CASE("a plain cut stays if no connector is near the target", "[core][bridge]") {
  const Design d = designed(
      R"("regions":[{"units_per_slice":5,"slices":3,"width_mm":8,"radius":"20"},
                    {"units_per_slice":6,"slices":3,"width_mm":8,"radius":"70"}])");
  CHECK(d.report.degrees_of_freedom == 1);
  CHECK(d.report.bridges.empty());
  bool said = false;
  for (const std::string& note : d.report.notes)
    said = said || note.rfind("plain cut between slices 2 and 3, 5 and 6 units a slice", 0) == 0;
  CHECK(said);
}

TEST_CASE("regions take a width for each slice", "[core][regions]") {
  const Design d = designed(
      R"("surface":{"type":"revolution","radius":"40"},"regions":[
         {"units_per_slice":3,"slices":3,"widths_mm":[8,10,12]},
         {"units_per_slice":3,"slices":2,"widths_mm":6}])");
  std::vector<double> widths;
  for (const SliceReport& slice : d.report.slices) widths.push_back(slice.width_mm);
  CHECK(widths == std::vector<double>{8, 10, 12, 6, 6});
}

TEST_CASE("contradictory regions give one error with the place", "[core][regions]") {
  struct Row {
    const char *fields, *place;
  };
  const Row row = GENERATE(values<Row>({
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2,"width_mm":8,"widths_mm":8}])",
       "/regions/0/width_mm"},
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2,"widths_mm":[8]}])",
       "/regions/0/widths_mm"},
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2,"widths_mm":[8,-1]}])",
       "/regions/0/widths_mm/1"},
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2,"widths_mm":{"max_error_mm":1}}])",
       "/regions/0/widths_mm"},
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2}])",
       "/regions/0/width_mm"},
      {R"("surface":{"type":"revolution","radius":"40"},"regions":[
          {"units_per_slice":3,"slices":2,"width_mm":8,"radius":"30"}])",
       "/surface"},
      {R"("surface":{"type":"revolution","radius":"40"},"slices":4,"regions":[
          {"units_per_slice":3,"slices":2,"width_mm":8}])",
       "/slices"},
  }));
  CAPTURE(row.fields);
  const auto spec = parse_design_spec(std::string(R"({"popcut":1,)") + row.fields + "}");
  REQUIRE_FALSE(spec);
  CHECK(spec.error().place == row.place);
}

TEST_CASE("a region that is too narrow to cut is refused with its place", "[core][regions]") {
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"surface":{"type":"revolution","radius":"40"},"regions":[
         {"units_per_slice":3,"slices":2,"width_mm":8},
         {"units_per_slice":3,"slices":2,"widths_mm":[8,1e-5]}]})"));
  const auto refused = design(spec);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place == "/regions/1");
}

TEST_CASE("places that differ by rounding are merged and others keep their order",
          "[core][strips]") {
  std::vector<double> values{0.0, 54.57, 54.570000000000036, 12.0, 12.0 + 2e-9, 1e-10};
  std::vector<double*> places;
  for (double& value : values) places.push_back(&value);
  unify_places(places);
  CHECK(values == std::vector<double>{0.0, 54.57, 54.57, 12.0, 12.0 + 2e-9, 1e-10});
}

TEST_CASE("neighbours that differ by rounding get no slit between them", "[core][strips]") {
  // A bump that is symmetric about the middle slice: slices 1 and 3 have radii that differ in the
  // last digits.
  const Design d = designed(
      R"j("surface":{"type":"revolution","radius":"59.52+297.6*exp(-((y-33.65)/9.712)^2)"},
         "units_per_slice":1,"slices":5,"widths_mm":13.46,"lattice":"slices","min_panel_mm":1.26)j");
  const Pattern& p = d.pattern;
  for (const PatternEdge& e : p.edges) {
    const double along = p.u(p.vertices[e.to]) - p.u(p.vertices[e.from]);
    CHECK(std::hypot(along, p.vertices[e.to].v - p.vertices[e.from].v) > kSamePlace_mm);
  }
}

TEST_CASE("long loose chains have the degrees of freedom of their constraints",
          "[core][mobility]") {
  // Counted by the singular values of the hinge constraints (popcut verify): 15, with a gap of 1e9.
  const Design d = designed(
      R"("units_per_slice":33,"slices":10,"widths_mm":1.091,"card":false,"min_panel_mm":0.00124,
         "surface":{"type":"revolution","radius":"5.884+-0.3098*y"},"lattice":"conformal")");
  CHECK(d.report.degrees_of_freedom == 15);
}

}  // namespace patches_test
