// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

namespace targets_command_test {

using namespace popcut::testing;
using nlohmann::json;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

using Bench = CommandBench;

json mesh_spec(const std::string& file) {
  return {{"popcut", 1},          {"name", "part"}, {"surface", {{"type", "mesh"}, {"file", file}}},
          {"units_per_slice", 5}, {"slices", 9},    {"widths_mm", 6.5}};
}

}  // namespace

TEST_CASE("a model whose numbers are no millimetres says which scale makes a card of it",
          "[cli][e2e][targets]") {
  const Bench bench;
  write_file(bench.temp / "hut.obj",
             popcut::testing::obj(popcut::testing::box_mesh({0, 0, 0}, {6, 8, 5}, false)));
  json spec{
      {"popcut", 1}, {"style", "facets"}, {"surface", {{"type", "mesh"}, {"file", "hut.obj"}}}};
  const auto said = [&] {
    bench.write("hut.json", spec);
    const Ran ran = bench.popcut({"design", "hut.json", "-o", "hut", "--formats", "fold"});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    return ran.err;
  };
  CHECK(says(said(), "is 11.2 mm from corner to corner; \"scale_mm\": 11 makes it about 120 mm"));
  spec["scale_mm"] = 11;
  CHECK_FALSE(says(said(), "from corner to corner"));
}

TEST_CASE("a mesh from elsewhere becomes a sound pattern with its error in the report",
          "[cli][e2e][target]") {
  const fs::path teapot = source_file("../shared/data/meshes/teapot.obj");
  if (!fs::exists(teapot)) {
    WARN("skipped: the public mesh is not here");
    return;
  }
  const Bench bench;
  fs::create_directory(bench.temp / "meshes");
  fs::copy_file(teapot, bench.temp / "meshes/teapot.obj");
  json spec = mesh_spec("meshes/teapot.obj");
  spec["scale_mm"] = 20;
  bench.write("teapot.json", spec);
  const std::string stand = GENERATE(as<std::string>{}, "whole", "quarter");
  CAPTURE(stand);
  const Ran placed = bench.popcut({"design", "teapot.json", "--place", stand});
  CAPTURE(placed.err);
  REQUIRE(placed.exit == 0);
  write_file(bench.temp / "placed.json", placed.out);
  CHECK(json::parse(placed.out)["fit"] == "nearest");
  double after = 0.0, before = 0.0;
  REQUIRE(std::sscanf(placed.err.c_str(),
                      "placed: the structure reaches %lf %% of the shape's area within 2 %% of its "
                      "size; as given it is %lf %%",
                      &after, &before) == 2);
  CHECK(after > before + 1.0);

  const Ran made = bench.popcut({"design", "placed.json", "-o", "out", "--json"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  const json report = json::parse(made.out);
  CHECK(report["degrees_of_freedom"] == 1);
  const json curves = report["inner_vertices"]["curves"];
  const double share = curves["unreachable_share"];
  CHECK(share > (stand == "whole" ? 0.5 : 0.05));
  CHECK(share < 0.9);
  CHECK(curves["rms_mm"] < 3.0);
  CHECK(curves["max_mm"] < 15.0);
  // The whole target, with what the slices do not even meet.
  const json fit = report["fit"];
  CHECK(fit["structure_to_target_mm"]["mean"] < 5.0);
  CHECK(fit["share_within"]["5_percent"] > (stand == "whole" ? 0.2 : 0.1));
  CHECK(fit["out_of_reach"]["outside_of_the_corner"] < (stand == "whole" ? 0.001 : 0.9));
  CHECK(fit["out_of_reach"]["share"] > 0.4);
  CHECK(made.err.find(" mm off on average (95 %: ") != std::string::npos);
  CHECK(report["slices"][0]["fit"].contains("unreachable_share"));
  const Ran verified = bench.popcut(
      {"verify", "out/pattern.fold", "--dof", "1", "--target", "placed.json", "--json"});
  CAPTURE(verified.err);
  CHECK(verified.exit == 0);
  // From the mesh itself, the fold vertices are not farther off than the two errors together.
  const json inner = json::parse(verified.out)["target"]["inner_mm"];
  CHECK(inner["vertices"] >= 20);
  CHECK(inner["rms"] <
        report["inner_error_mm"]["max"].get<double>() + curves["max_mm"].get<double>() + 0.1);
  fs::remove(bench.temp / "meshes/teapot.obj");
  check_refused(
      bench.popcut({"verify", "out/pattern.fold", "--dof", "1", "--target", "placed.json"}), 3,
      "teapot.obj");
}

TEST_CASE("a placement is tried with the smallest panel of its material", "[cli][e2e][target]") {
  const Bench bench;
  write_file(bench.temp / "ball.stl",
             popcut::testing::binary_stl(popcut::testing::sphere_mesh(9, 24, 24)));
  json spec = mesh_spec("ball.stl");
  spec["units_per_slice"] = 18, spec["slices"] = 5, spec["widths_mm"] = 3;
  spec["lattice"] = "conformal";  // whose levels cannot end
  bench.write("ball.json", spec);
  // As it is given, panels of half a millimetre fit, but the default material's are 0.81 mm long.
  const std::string limit = "18 units of at least 0.81 mm";
  const Ran placed = bench.popcut({"design", "ball.json", "--place", "quarter"});
  CAPTURE(placed.err);
  REQUIRE(placed.exit == 0);
  CHECK(placed.err.find(limit) != std::string::npos);
  write_file(bench.temp / "placed.json", placed.out);
  CHECK(bench.popcut({"design", "placed.json", "-o", "out", "--formats", "report"}).exit == 0);
  spec["min_panel_mm"] = 0.5;
  bench.write("ball.json", spec);
  const Ran fine = bench.popcut({"design", "ball.json", "--place", "quarter"});
  CHECK(fine.exit == 0);
  CHECK(fine.err.find(limit) == std::string::npos);
}

TEST_CASE("grids and solids become sound patterns from the command line", "[cli][e2e][target]") {
  const Bench bench;
  std::string csv = ",0,10,20,30,40\n";
  for (int y = 0; y <= 60; y += 20)
    csv += std::to_string(y) + ",40,37," + std::to_string(30 + y / 10) + ",18,0\n";
  write_file(bench.temp / "heights.csv", csv);
  json spec = mesh_spec("");
  spec["surface"] = {{"type", "grid"}, {"file", "heights.csv"}};
  bench.write("grid.json", spec);
  spec["surface"] = {{"type", "implicit"}, {"f", "x^2 + z^2 - 1 - 0.1*sin(3*y)"}};
  spec["scale_mm"] = 40;
  bench.write("solid.json", spec);
  for (const char* name : {"grid", "solid"}) {
    const Ran made = bench.popcut({"design", std::string(name) + ".json", "-o", name});
    CAPTURE(name, made.err);
    REQUIRE(made.exit == 0);
    CHECK(bench.popcut({"verify", std::string(name) + "/pattern.fold", "--dof", "1"}).exit == 0);
    CHECK(bench.popcut({"plan", std::string(name) + ".json", "-o", "plan"}).exit == 0);
  }
}

TEST_CASE("unusable targets are refused in one line", "[cli][e2e][target]") {
  using popcut::testing::binary_stl;
  const Bench bench;
  const auto design = [&](const json& spec) {
    bench.write("spec.json", spec);
    return bench.popcut({"design", "spec.json", "-o", "out"});
  };
  check_refused(design(mesh_spec("absent.stl")), 3, "spec.json: /surface/file: ");
  write_file(bench.temp / "hole.stl",
             binary_stl(popcut::testing::box_mesh({-5, -5, -5}, {40, 90, 40}, true)));
  check_refused(design(mesh_spec("hole.stl")), 4, "has a hole there");
  write_file(bench.temp / "away.stl",
             binary_stl(popcut::testing::box_mesh({-9, 0, -9}, {-5, 90, -5}, false)));
  check_refused(design(mesh_spec("away.stl")), 4, "no part of the mesh is in the corner");
  std::string cut = binary_stl(popcut::testing::icosphere(30, 2));
  cut.resize(cut.size() / 2);
  write_file(bench.temp / "cut.stl", cut);
  check_refused(design(mesh_spec("cut.stl")), 3, "is the file whole?");
  json grid = mesh_spec("");
  grid["surface"] = {{"type", "grid"}, {"file", "gap.csv"}};
  write_file(bench.temp / "gap.csv", ",0,10\n0,5,\n80,5,0\n");
  check_refused(design(grid), 3, "gap.csv: line 2, column 3: is empty");
  json contradictory = mesh_spec("hole.stl");
  contradictory["surface"]["f"] = "x";
  check_refused(design(contradictory), 3, "/surface/f: is not known");
  const Ran place = bench.popcut({"design", "spec.json", "--place", "sideways"});
  CHECK(place.exit == 2);
}

}  // namespace targets_command_test
