// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/makeable.hpp"
#include "core/design/patches.hpp"
#include "core/design/shape_fit.hpp"
#include "core/formats/write/report_json.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/value.hpp"

namespace makeable_test {

using namespace popcut;

namespace {

Design made(const std::string& fields) {
  const auto spec = testing::value(parse_design_spec(fmt::format(R"({{"popcut":1,{}}})", fields)));
  return testing::value(design(spec));
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

bool any_says(const std::vector<Warning>& all, const std::string& part) {
  return std::any_of(all.begin(), all.end(), [&](const Warning& one) {
    return one.message.find(part) != std::string::npos;
  });
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
  const Design d = made(kSphere + R"(,"lattice":"slices","card":{"wall_mm":90,"ground_mm":120})");
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

TEST_CASE("the direct lattice keeps the shut structure inside a given card",
          "[core][design][closing]") {
  const auto with = [](const std::string& card, const char* lattice = "direct", int units = 6) {
    return made(fmt::format(
        R"j("surface":{{"type":"revolution","radius":"sqrt(60^2-(y-20)^2)"}},"units_per_slice":{},
           "slices":6,"widths_mm":8,"lattice":"{}","card":{})j",
        units, lattice, card));
  };
  // Where there is room nothing changes.
  const Design wide = with("true");
  const double whole = reach_when_shut(wide.pattern);
  REQUIRE(whole > 88.0);
  CHECK(reach_when_shut(with(R"({"wall_mm":140,"ground_mm":140})").pattern) == whole);
  // Both measures hold it, or the one that is given; all with the margin.
  double last = surface_fit(wide)->to_target.mean_mm;
  for (const double side : {92.0, 85.0, 75.0}) {
    CAPTURE(side);
    for (const char* card : {R"({{"wall_mm":{0},"ground_mm":{0},"margin_mm":6}})",
                             R"({{"wall_mm":130,"ground_mm":{0},"margin_mm":6}})",
                             R"({{"wall_mm":{0},"margin_mm":6}})"}) {
      const Design held = with(fmt::format(fmt::runtime(card), side));
      CHECK(reach_when_shut(held.pattern) <= side - 6 + 1e-3);
      CHECK(held.report.sticks_out_mm == 0.0);
      CHECK(held.report.degrees_of_freedom == 1);
      // It costs nearness, and the report says what card the shape needs.
      CHECK(surface_fit(held)->to_target.mean_mm > last);
      CHECK(any_says(held.report.warnings, "would hold the shape") == (side < 90.0));
    }
    last =
        surface_fit(with(fmt::format(R"({{"wall_mm":{0},"ground_mm":{0},"margin_mm":6}})", side)))
            ->to_target.mean_mm -
        1e-9;
  }
  // Others stick out and say so, with what would do; auto takes the one that keeps inside.
  const std::string narrow = R"({"wall_mm":85,"ground_mm":85,"margin_mm":6})";
  const Design out = with(narrow, "conformal");
  CHECK(out.report.sticks_out_mm > 1.0);
  CHECK(any_says(out.report.warnings, "use \"lattice\": \"direct\""));
  const Design chosen = with(narrow, "auto");
  CHECK(chosen.report.lattice == "direct");
  CHECK(chosen.report.sticks_out_mm == 0.0);
  // Steps that are too many for the card come first: it sticks out, with a warning.
  const Design many = with(R"({"wall_mm":80,"ground_mm":80,"margin_mm":70})", "direct", 40);
  CHECK(many.report.sticks_out_mm > 1.0);
  CHECK(any_says(many.report.warnings, "make wall_mm and ground_mm at least"));
}

TEST_CASE("a connector between regions is left out where it would reach out of a given card",
          "[core][design][closing]") {
  const auto with = [](const char* card) {
    return made(fmt::format(
        R"j("surface":{{"type":"revolution","radius":"40"}},"lattice":"direct","regions":[
           {{"units_per_slice":3,"slices":2,"width_mm":8}},
           {{"units_per_slice":4,"slices":2,"width_mm":8}}],"card":{})j",
        card));
  };
  CHECK(with("true").report.bridges.size() == 1);
  const Design held = with(R"({"wall_mm":60,"ground_mm":60,"margin_mm":5})");
  CHECK(held.report.bridges.empty());
  CHECK(held.report.sticks_out_mm == 0.0);
  CHECK(held.report.degrees_of_freedom == 1);
}

TEST_CASE("a design of which nothing stands up is refused", "[core][design]") {
  const auto spec = testing::value(parse_design_spec(
      R"({"popcut":1,"surface":{"type":"revolution","radius":"3"},"units_per_slice":8,"slices":1,
          "widths_mm":9,"min_panel_mm":1.2,"lattice":"levels"})"));
  const auto none = design(spec);
  REQUIRE_FALSE(none);
  CHECK(none.error().kind == ErrorKind::Infeasible);
  INFO(message(none.error()));
  CHECK(none.error().place == "/min_panel_mm");
}

TEST_CASE("a longest step that is asked for is kept or the report says where it is not",
          "[core][design]") {
  const auto with = [](const char* lattice, double most) {
    return made(fmt::format(
        R"j("surface":{{"type":"revolution","radius":"sqrt(60^2-(y-20)^2)"}},"units_per_slice":6,
           "slices":8,"widths_mm":6,"lattice":"{}","max_step_over_mean":{})j",
        lattice, most));
  };
  const Design kept = with("conformal", 1.5);
  CHECK(kept.report.lattice == "conformal");
  CHECK(kept.report.step_over_mean_max <= 1.5 + 1e-9);
  CHECK_FALSE(any_says(kept.report.warnings, "max_step_over_mean"));
  const Design longer = with("slices", 1.5);
  CHECK(longer.report.step_over_mean_max > 1.5);
  CHECK(
      any_says(longer.report.warnings, "max_step_over_mean is 1.5, but the longest step, at s = "));
  // The value that it names will do.
  const double enough = std::ceil(1000.0 * longer.report.step_over_mean_max) / 1000.0;
  CHECK(any_says(longer.report.warnings, fmt::format("make it at least {:.4g}", enough)));
  CHECK_FALSE(any_says(with("slices", enough).report.warnings, "max_step_over_mean"));
}

TEST_CASE("a limit that cannot be met is refused with the value that can", "[core][design]") {
  const auto refusal = [](const std::string& more) {
    const auto spec = testing::value(parse_design_spec(fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"60"}},"units_per_slice":5,
            "slices":4,"widths_mm":8{}}})j",
        more)));
    const auto out = design(spec);
    return out ? std::string("made") : message(out.error());
  };
  // As asked; and with the value that the refusal names.
  const std::string low = refusal(R"(,"card":{"wall_mm":40})");
  CHECK_THAT(low, Catch::StartsWith("/card/wall_mm: is 40 mm; the structure reaches 60.0"));
  const std::string least = "so at least ";
  const double enough = std::stod(low.substr(low.find(least) + least.size()));
  CHECK(enough == Approx(60.5).margin(0.01));
  CHECK(refusal(fmt::format(R"(,"card":{{"wall_mm":{:.4f}}})", enough)) == "made");
  CHECK_THAT(refusal(R"(,"splay":{"alpha":0.1,"ligament_mm":30})"),
             Catch::Contains("connector 0, 4 mm wide: use a ligament_mm under 2 mm"));
  CHECK(refusal(R"(,"splay":{"alpha":0.1,"ligament_mm":1.9})") == "made");
  CHECK_THAT(refusal(R"(,"splay":{"alpha":0.1,"length_mm":50,"ligament_mm":1})"),
             Catch::Contains("length_mm is 50 mm, at most 2 mm fits"));
  CHECK(refusal(R"(,"splay":{"alpha":0.1,"length_mm":2,"ligament_mm":1})") == "made");
}

TEST_CASE("a target that is wholly out of reach is infeasible and names what to move",
          "[core][design]") {
  const auto refusal = [](const std::string& surface, const std::string& more = "") {
    const auto spec = testing::value(parse_design_spec(fmt::format(
        R"j({{"popcut":1,"surface":{},"units_per_slice":5,"slices":4,"widths_mm":8{}}})j", surface,
        more)));
    const auto out = design(
        spec, {{"b.stl", testing::binary_stl(testing::box_mesh({0, -5, 0}, {30, 50, 30}, false))}});
    REQUIRE_FALSE(out);
    CHECK(out.error().kind == ErrorKind::Infeasible);
    return message(out.error());
  };
  const std::string behind = R"j({"type":"implicit","f":"(x+20)^2+z^2+y^2-100"})j";
  for (const char* fit : {"", R"(,"fit":"nearest")"})
    CHECK_THAT(refusal(behind, fit), Catch::Contains("no part of the solid is in the corner") &&
                                         Catch::Contains("move it with translate_mm"));
  CHECK_THAT(refusal(R"j({"type":"implicit","f":"(x-40)^2+(z-40)^2+(y-12)^2-400"})j"),
             Catch::Contains("use \"fit\": \"nearest\" or another placement"));
  const std::string box = R"({"type":"mesh","file":"b.stl"})";
  CHECK_THAT(refusal(box, R"(,"translate_mm":[-40,0,0])"),
             Catch::Contains("it spans x = -40 to -10") && Catch::Contains("translate_mm"));
  CHECK_THAT(refusal(box, R"(,"translate_mm":[20,0,20])"),
             Catch::Contains("\"fit\": \"nearest\"") && Catch::Contains("design --place"));
}

TEST_CASE("patches in one sheet are held by their common card when shut",
          "[core][design][closing]") {
  const auto spec = testing::value(parse_design_spec(
      R"j({"popcut":1,"patches":[
            {"surface":{"type":"revolution","radius":"50"},"units_per_slice":3,"slices":4,
             "widths_mm":12},
            {"surface":{"type":"revolution","radius":"50+8*sin((y+6)/30)"},"units_per_slice":4,
             "slices":4,"widths_mm":12}],"join_tolerance_mm":5})j"));
  const auto assembly = testing::value(design_assembly(spec));
  for (const Design& part : assembly.parts) {
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
