// SPDX-License-Identifier: MIT
// Only patterns that the verifier finds sound are given.
#include <algorithm>
#include <optional>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/strips/pattern_builder.hpp"
#include "daemon/planning/sound_design.hpp"

namespace sound_design_test {

using namespace popcut;
using namespace popcut::planning;

namespace {

PatchAssembly designed(const std::string& fields) {
  const auto spec = parse_design_spec(R"({"popcut":1,)" + fields + "}");
  if (!spec) FAIL(message(spec.error()));
  std::string report;
  auto made = sound_design(*spec, {}, &report);
  if (!made) FAIL(message(made.error()));
  CHECK(report.empty());
  return std::move(*made);
}

const std::string kTwoRegions =
    R"("surface":{"type":"revolution","radius":"60"},"regions":[
       {"units_per_slice":1,"slices":2,"width_mm":9},{"units_per_slice":2,"slices":2,"width_mm":9}])";

}  // namespace

TEST_CASE("sound designs of every kind are given", "[planning][sound]") {
  designed(kTwoRegions);
  designed(kTwoRegions + R"(,"card":false,"lattice":"slices")");
  designed(
      R"("surface":{"type":"profile","z":"120 - x"},"units_per_slice":3,"slices":4,"widths_mm":20,
         "splay":{"alpha":0.6})");
  designed(
      R"("patches":[{"surface":{"type":"revolution","radius":"40"},"units_per_slice":3,"slices":3,
         "widths_mm":10},{"surface":{"type":"revolution","radius":"40"},"units_per_slice":5,
         "slices":3,"widths_mm":10}],"join":"seam")");
}

TEST_CASE("a pattern with a closed slit is not given, and its places are listed",
          "[planning][sound]") {
  PatchAssembly made = designed(kTwoRegions);
  Design& part = made.parts.front();
  // As if a panel and its neighbour in one plane were not known to be: one has a plane of its own.
  // Some panels stay joined to others all the same, or lie beside nothing; one is parted.
  std::optional<Unsound> unsound;
  for (std::size_t p = 0; p < part.strips.panels() && !unsound; ++p) {
    if (part.strips.plane[p] <= kGroundPlane) continue;
    Strips parted = part.strips;
    parted.plane[p] = 1000;
    auto built = build_pattern(parted, part.pattern.wall_mm, part.pattern.ground_mm, true, 0.5);
    REQUIRE(built);
    PatchAssembly broken = made;
    broken.parts.front().pattern = std::move(built->pattern);
    unsound = find_unsound(broken);
  }
  REQUIRE(unsound);
  CHECK(exit_code(unsound->error.kind) == 1);
  CHECK_THAT(unsound->error.detail, Catch::Contains("faces (") && Catch::Contains("near ("));
  const auto report = nlohmann::json::parse(unsound->report);
  CHECK(report["sound"] == false);
  REQUIRE(report["parts"].size() == 1);
  CHECK(report["parts"][0]["part"] == 1);
  const auto& checks = report["parts"][0]["verify"]["checks"];
  bool says_where = false;
  for (const auto& check : checks)
    for (const auto& failure : check["failures"])
      says_where = says_where || failure["place"].get<std::string>().find("near (") == 0 ||
                   failure["place"].get<std::string>().find(" near (") != std::string::npos;
  CHECK(says_where);
}

TEST_CASE("other freedoms than reported and faces through others are found too",
          "[planning][sound]") {
  PatchAssembly made = designed(kTwoRegions);
  made.parts.front().report.degrees_of_freedom = 2;
  auto unsound = find_unsound(made);
  REQUIRE(unsound);
  CHECK_THAT(unsound->error.detail, Catch::Contains("degrees_of_freedom (1)"));
  made.parts.front().report.degrees_of_freedom = 1;
  CHECK_FALSE(find_unsound(made));
  Pattern& pattern = made.parts.front().pattern;
  const auto fold = std::find_if(pattern.edges.begin(), pattern.edges.end(),
                                 [](const auto& edge) { return edge.role == EdgeRole::Mountain; });
  REQUIRE(fold != pattern.edges.end());
  pattern.vertices[fold->from].x += 2.0;  // no longer square
  unsound = find_unsound(made);
  REQUIRE(unsound);
  CHECK_THAT(unsound->error.detail, Catch::Contains("isometry"));
}

}  // namespace sound_design_test
