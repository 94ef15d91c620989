// SPDX-License-Identifier: MIT
// Only patterns that the verifier finds sound are given.
#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/strips/pattern_builder.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/judge/pattern_model.hpp"
#include "core/judge/rectangular_motion.hpp"
#include "core/judge/sound_design.hpp"
#include "tests/support/value.hpp"

namespace sound_design_test {

using namespace popcut;
using namespace popcut::judge;

namespace {

PatchAssembly designed(const std::string& fields) {
  const auto spec = testing::value(parse_design_spec(R"({"popcut":1,)" + fields + "}"));
  auto made = sound_design(spec, {});
  if (!made) FAIL(message(made.error().error));
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

TEST_CASE("what is looked at is what the pattern's file says", "[planning][sound]") {
  const std::vector<double> psi{2.6, std::numbers::pi / 2, 1.1};
  for (const std::string& fields :
       {kTwoRegions, kTwoRegions + R"(,"card":false,"lattice":"slices")",
        std::string(R"("surface":{"type":"profile","z":"120 - x"},"units_per_slice":3,"slices":4,
           "widths_mm":20,"splay":{"alpha":0.6})")}) {
    const Pattern pattern = designed(fields).parts.front().pattern;
    std::ostringstream text;
    FoldOptions options;
    options.psi_rad = psi;
    REQUIRE(write_fold(pattern, options, text));
    const auto read = verify::read_fold_model(text.str());
    const auto made = pattern_model(pattern, psi);
    REQUIRE(read);
    REQUIRE(made);
    CHECK(made->flat == read->flat);
    CHECK(made->edges == read->edges);
    CHECK(made->assignment == read->assignment);
    CHECK(made->fold_angle_deg == read->fold_angle_deg);
    CHECK(made->face_first == read->face_first);
    CHECK(made->face_vertices == read->face_vertices);
    CHECK(made->faces_given == read->faces_given);
    CHECK(made->from_popcut == read->from_popcut);
    CHECK(made->assigned == read->assigned);
    CHECK(made->drawn == read->drawn);
    CHECK(made->notes == read->notes);
    REQUIRE(made->poses.size() == read->poses.size());
    for (std::size_t k = 0; k < psi.size(); ++k) {
      CHECK(made->poses[k].place == read->poses[k].place);
      CHECK(made->poses[k].at == read->poses[k].at);
      CHECK(made->poses[k].fold_angle_deg == read->poses[k].fold_angle_deg);
      CHECK(made->poses[k].psi_rad == read->poses[k].psi_rad);
    }
  }
}

TEST_CASE("what the verifier's reader refuses is refused", "[planning][sound]") {
  const Pattern sound = designed(kTwoRegions).parts.front().pattern;
  const auto refused = [](const Pattern& pattern, const char* place) {
    const auto made = pattern_model(pattern, {});
    REQUIRE_FALSE(made);
    CHECK(made.error().place == place);
  };
  Pattern looped = sound;
  looped.edges[3].to = looped.edges[3].from;
  refused(looped, "/edges_vertices/3");
  Pattern twice = sound;
  twice.face_vertices[twice.face_first[2] + 1] = twice.face_vertices[twice.face_first[2]];
  refused(twice, "/faces_vertices/2");
  Pattern far = sound;
  far.vertices[5].v = 2e7;
  refused(far, "/vertices_coords/5");
  far.vertices[5].v = std::numeric_limits<double>::quiet_NaN();
  refused(far, "vertices/5");
}

TEST_CASE("a pattern with a closed slit is not given, and its places are listed",
          "[planning][sound]") {
  PatchAssembly made = designed(kTwoRegions);
  Design& part = made.parts.front();
  // As if a panel and its neighbour in one plane were not known to be: one has a plane of its own.
  // Some panels stay joined to others all the same, or lie beside nothing; one is parted.
  std::optional<DesignFault> unsound;
  for (std::size_t p = 0; p < part.strips.panels() && !unsound; ++p) {
    if (part.strips.plane[p] <= kGroundPlane) continue;
    Strips parted = part.strips;
    parted.plane[p] = 1000;
    auto built = testing::value(
        build_pattern(parted, part.pattern.wall_mm, part.pattern.ground_mm, true, 0.5));
    PatchAssembly broken = made;
    broken.parts.front().pattern = std::move(built.pattern);
    unsound = find_unsound(broken);
  }
  REQUIRE(unsound);
  CHECK(exit_code(unsound->error.kind) == 1);
  CHECK_THAT(unsound->error.detail, Catch::Contains("faces (") && Catch::Contains("near ("));
  const auto report = nlohmann::json::parse(unsound_json(unsound->parts));
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

TEST_CASE("how rectangular units move is proven without measuring poses", "[planning][sound]") {
  const auto is_proven = [](const Pattern& pattern, int freedoms) {
    const auto model = testing::value(pattern_model(pattern, {}));
    VerifyCheck faces;
    return has_rectangular_motion(pattern, verify::make_sheet(model, faces), freedoms);
  };
  // A fine lattice, whose one freedom the verifier's own propagation does not find.
  const std::string sphere =
      R"spec("surface":{"type":"revolution","radius":"sqrt(1.05-y^2)"},"scale_mm":100,)spec";
  for (const std::string& fields :
       {kTwoRegions, kTwoRegions + R"(,"card":false,"lattice":"slices")",
        sphere + R"("units_per_slice":40,"slices":40,"widths_mm":2,"lattice":"slices",
                    "min_panel_mm":0.25)",
        sphere + R"("style":"facets","facets":{"length_mm":80,"strip_mm":4})"}) {
    const PatchAssembly made = designed(fields);
    const Design& part = made.parts.front();
    CHECK(is_proven(part.pattern, part.report.degrees_of_freedom));
    CHECK_FALSE(is_proven(part.pattern, part.report.degrees_of_freedom + 1));
  }
  CHECK_FALSE(
      is_proven(designed(
                    R"("surface":{"type":"profile","z":"120 - x"},"units_per_slice":3,"slices":4,
             "widths_mm":20,"splay":{"alpha":0.6})")
                    .parts.front()
                    .pattern,
                1));

  PatchAssembly made = designed(kTwoRegions);
  Pattern& pattern = made.parts.front().pattern;
  for (PatternEdge& edge : pattern.edges) {
    if (edge.role != EdgeRole::Mountain && edge.role != EdgeRole::Valley) continue;
    const EdgeRole role = edge.role;
    edge.role = role == EdgeRole::Valley ? EdgeRole::Mountain : EdgeRole::Valley;
    CHECK_FALSE(is_proven(pattern, 1));
    edge.role = role;
  }
  const Pattern sound = pattern;
  for (double PatternVertex::*coordinate : {&PatternVertex::x, &PatternVertex::z}) {
    pattern = sound;
    const auto fold =
        std::find_if(pattern.edges.begin(), pattern.edges.end(),
                     [](const PatternEdge& edge) { return edge.role == EdgeRole::Mountain; });
    REQUIRE(fold != pattern.edges.end());
    pattern.vertices[fold->from].*coordinate += 2.0;
    CHECK_FALSE(is_proven(pattern, 1));
    CHECK(find_unsound(made));
  }
}

}  // namespace sound_design_test
