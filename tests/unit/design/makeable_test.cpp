// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/makeable.hpp"
#include "core/design/patches.hpp"
#include "core/formats/write/report_json.hpp"

namespace makeable_test {

using namespace popcut;

namespace {

Design made(const std::string& fields) {
  const auto spec = parse_design_spec(fmt::format(R"({{"popcut":1,{}}})", fields));
  if (!spec) FAIL(message(spec.error()));
  auto out = design(*spec);
  if (!out) FAIL(message(out.error()));
  return std::move(*out);
}

/// How far from the spine what is not part of wall and ground lies in the pose that is all but
/// shut, from the poses alone.
double reach_when_shut(const Pattern& pattern) {
  const auto poses = posed_vertices(pattern, 1e-7);
  double reach = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (pattern.vertices[i].x != 0.0 && pattern.vertices[i].z != 0.0)
      reach = std::max(reach, std::hypot(poses[i][0], poses[i][2]));
  return reach;
}

bool any_says(const std::vector<std::string>& all, const std::string& part) {
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& one) { return one.find(part) != std::string::npos; });
}

const std::string kSphere =
    R"j("surface":{"type":"revolution","radius":"sqrt(70^2-(y-45)^2)"},"units_per_slice":5,
        "slices":10,"widths_mm":10)j";

}  // namespace

TEST_CASE("the default card holds the shut structure with its margin", "[core][design][closing]") {
  const auto target =
      GENERATE(as<std::string>{}, R"j({"type":"revolution","radius":"sqrt(70^2-(y-45)^2)"})j",
               R"j({"type":"revolution","radius":"sqrt(45^2+(y-45)^2)"})j",
               R"j({"type":"profile","z":"26*(1-x/140)*(1+0.9*x/140)"})j",
               R"j({"type":"profile","z":"75-sqrt(90^2-(y-45)^2-(75-x)^2)"})j");
  const int units = GENERATE(1, 2, 4, 7);
  const auto lattice = GENERATE(as<std::string>{}, "slices", "branching", "conformal", "levels");
  CAPTURE(target, units, lattice);
  const Design d = made(fmt::format(
      R"("surface":{},"units_per_slice":{},"slices":7,"widths_mm":12,"lattice":"{}",
         "card":{{"margin_mm":8}})",
      target, units, lattice));
  const double reach = reach_when_shut(d.pattern);
  CHECK(reach > 0.0);
  CHECK(d.pattern.wall_mm >= reach + 8 - 1e-6);
  CHECK(d.pattern.ground_mm >= reach + 8 - 1e-6);
  CHECK(d.report.sticks_out_mm == 0.0);
  CHECK(d.report.warnings.empty());
}

TEST_CASE("the default card holds the tips of V-folds that reach beyond the strips",
          "[core][design][closing]") {
  const Design d = made(
      R"("surface":{"type":"profile","z":"60-x"},"units_per_slice":5,"slices":4,"widths_mm":60,
         "splay":{"alpha":0.5,"length_mm":20})");
  REQUIRE_FALSE(d.pattern.v_folds.empty());
  double corners = 0.0;  // of the strips alone
  for (const PatternVertex& p : d.pattern.vertices)
    if (p.x > 0.0 && p.z > 0.0) corners = std::max(corners, p.x + p.z);
  const double reach = reach_when_shut(d.pattern);
  CHECK(reach > corners + 1.0);
  CHECK(std::min(d.pattern.wall_mm, d.pattern.ground_mm) >= reach + 15 - 1e-6);
  CHECK(d.report.sticks_out_mm == 0.0);
}

TEST_CASE("with a given card the report says how far the structure sticks out",
          "[core][design][closing]") {
  const Design d = made(kSphere + R"(,"card":{"wall_mm":90,"ground_mm":120})");
  const double reach = reach_when_shut(d.pattern);
  CHECK(d.report.sticks_out_mm == Approx(reach - 90).margin(1e-4));
  REQUIRE(d.report.warnings.size() == 1);
  CHECK(any_says(d.report.warnings, fmt::format("{:.1f} mm from the spine", reach)));
  CHECK(any_says(d.report.warnings, "make wall_mm and ground_mm at least"));
  CHECK(report_json(d.report).find("\"sticks_out_mm\"") != std::string::npos);
  // A card that is free when shut gets 15 mm past the highest fold, and a note.
  const Design free = made(kSphere + R"(,"card":{"shut":"free"})");
  CHECK(free.pattern.wall_mm < 90.0);
  CHECK(free.report.sticks_out_mm > 0.0);
  CHECK(free.report.warnings.empty());
  CHECK(any_says(free.report.notes, "sticks out of the card"));
  CHECK(made(kSphere + R"(,"card":false)").report.sticks_out_mm == 0.0);
}

TEST_CASE("patches in one sheet are held by their common card when shut",
          "[core][design][closing]") {
  const auto spec = parse_design_spec(
      R"j({"popcut":1,"patches":[
            {"surface":{"type":"revolution","radius":"50"},"units_per_slice":3,"slices":4,
             "widths_mm":12},
            {"surface":{"type":"revolution","radius":"50+8*sin((y+6)/30)"},"units_per_slice":4,
             "slices":4,"widths_mm":12}],"join_tolerance_mm":5})j");
  REQUIRE(spec);
  const auto assembly = design_assembly(*spec);
  REQUIRE(assembly);
  for (const Design& part : assembly->parts) {
    CHECK(part.report.sticks_out_mm == 0.0);
    CHECK(std::min(part.pattern.wall_mm, part.pattern.ground_mm) >=
          reach_when_shut(part.pattern) + 15 - 1e-6);
  }
}

TEST_CASE("what is too fine or too large is named with its place and value",
          "[core][design][makeable]") {
  const Design d = made(
      R"("surface":{"type":"revolution","radius":"60"},"units_per_slice":4,"slices":6,
         "widths_mm":2.9,"lattice":"slices")");
  const auto warnings = [&](const MakeLimits& limits) {
    return make_warnings(d.strips, d.pattern, limits);
  };
  CHECK(warnings({}).empty());
  CHECK(warnings({1.4, 0.5, {400, 400}, "a sheet"}).empty());
  const auto folds = warnings({1.5, 0.0, {}, {}});
  REQUIRE(folds.size() == 1);
  CHECK(any_says(folds, "folds are below 1.5 mm; the least is 1.45 mm, at u = "));
  const auto strips = warnings({0.0, 1.6, {}, {}});
  CHECK(any_says(strips, "strips are below 1.6 mm; the least is 1.45 mm, at u = 0.0, v = 15.7 mm"));
  CHECK(any_says(warnings({0.0, 40.0, {}, {}}), "necks of paper between two slits are below 40"));
  CHECK(any_says(warnings({0.0, 40.0, {}, {}}), "slits are below 40 mm"));
  // Either way round.
  const double u = d.report.sheet_u_mm, v = d.report.sheet_v_mm;
  CHECK(warnings({0.0, 0.0, {v, u}, "a sheet"}).empty());
  CHECK(warnings({0.0, 0.0, {u, v}, "a sheet"}).empty());
  CHECK(any_says(warnings({0.0, 0.0, {u - 1, v}, "a sheet A9"}), "larger than a sheet A9 of"));
}

TEST_CASE("a spec names its sheet by a paper's name or by its sides", "[core][spec]") {
  const auto parse = [](const std::string& sheet) {
    return parse_design_spec(fmt::format(R"({{"popcut":1,"sheet":{},{}}})", sheet, kSphere));
  };
  REQUIRE(parse("\"A3\""));
  CHECK(parse("\"A3\"")->sheet->width_mm == 297.0);
  CHECK(parse("[200, 300.5]")->sheet->height_mm == 300.5);
  CHECK_FALSE(parse("\"A3\"")->min_panel_asked);
  for (const char* bad : {"\"A33\"", "[200]", "[200, 0]", "[1, 2, 3]", "7", "{}"}) {
    CAPTURE(bad);
    const auto refused = parse(bad);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().place.rfind("/sheet", 0) == 0);
  }
  CHECK_THAT(parse("\"A33\"").error().detail, Catch::Contains("A3"));
  const auto shut =
      parse_design_spec(fmt::format(R"({{"popcut":1,"card":{{"shut":"open"}},{}}})", kSphere));
  REQUIRE_FALSE(shut);
  CHECK(shut.error().place == "/card/shut");
}

}  // namespace makeable_test
