// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace patches_command_test {

using namespace popcut::testing;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

using Bench = CommandBench;

json shipped() { return json::parse(text_of_file(source_file("docs/patches/station.json"))); }

}  // namespace

TEST_CASE("patches that agree are written and planned as one sheet", "[cli][e2e][patches]") {
  const Bench bench;
  bench.write("spec.json", shipped());
  REQUIRE(bench.popcut({"design", "spec.json", "-o", "out", "-q"}).exit == 0);
  CHECK(bench.popcut({"verify", "out/pattern.fold", "--dof", "1"}).exit == 0);
  CHECK_FALSE(fs::exists(bench.temp / "out/part-01"));
  const json report = bench.read_json("out/report.json");
  CHECK(report.at("degrees_of_freedom") == 1);
  CHECK(report.at("patches").size() == 3);
  CHECK(report.at("joins").at(0).at("join") == "sheet");
  CHECK(report.at("joins").at(0).at("misfit_mm") < 1e-9);
  CHECK(report.at("seams").empty());
  CHECK(report.at("bridges").size() == 2);
  CHECK(bench.popcut({"plan", "spec.json", "-o", "plan", "-q"}).exit == 0);
}

TEST_CASE("patches with seams are patterns of their own that verify and plan",
          "[cli][e2e][patches]") {
  const Bench bench;
  json spec = shipped();
  spec["join"] = {"sheet", "seam"};
  bench.write("spec.json", spec);
  REQUIRE(bench.popcut({"design", "spec.json", "-o", "out", "-q"}).exit == 0);
  for (const std::string part : {"part-01", "part-02"}) {
    CAPTURE(part);
    CHECK(bench.popcut({"verify", "out/" + part + "/pattern.fold", "--dof", "1"}).exit == 0);
    CHECK(bench.popcut({"plan", "out/" + part + "/pattern.fold", "-o", "plan", "-q"}).exit == 0);
    CHECK(fs::exists(bench.temp / ("out/" + part + "/report.json")));
    const json fold = bench.read_json("out/" + part + "/pattern.fold");
    REQUIRE(fold.at("popcut:seams").size() == 1);
    CHECK(fold.at("popcut:seams").at(0).at("id") == 1);
  }
  const json report = bench.read_json("out/report.json");
  CHECK(report.at("parts").size() == 2);
  REQUIRE(report.at("seams").size() == 1);
  const json& lines = report.at("seams").at(0).at("lines");
  CHECK(lines.at(0).at("part") == 1);
  CHECK(lines.at(1).at("part") == 2);
  CHECK(lines.at(1).at("v_mm") == 0.0);
  CHECK(bench.popcut({"plan", "spec.json", "-o", "plan", "-q"}).exit == 0);  // glued by tabs there
  check_refused(bench.popcut({"plan", "spec.json", "-o", "plan", "--no-split"}), 4,
                "makes 2 parts with seams");
  // One sheet afterwards: the parts' files go.
  bench.write("spec.json", shipped());
  REQUIRE(bench.popcut({"design", "spec.json", "-o", "out", "-q"}).exit == 0);
  CHECK_FALSE(fs::exists(bench.temp / "out/part-01/pattern.fold"));
}

TEST_CASE("patches that do not fit are refused in one line", "[cli][e2e][patches]") {
  const Bench bench;
  json spec = shipped();
  spec["patches"][2]["regions"][0]["radius"] = "51";
  bench.write("spec.json", spec);
  check_refused(bench.popcut({"design", "spec.json", "-o", "out"}), 4,
                "spec.json: /patches/2: its edge misses that of the patch before by 3 mm");
  CHECK_FALSE(fs::exists(bench.temp / "out"));
  spec = shipped();
  spec["patches"][1]["slices"] = "many";
  bench.write("spec.json", spec);
  check_refused(bench.popcut({"design", "spec.json", "-o", "out"}), 3, "spec.json: /patches/1/");
  spec = shipped();
  spec["join"] = "sheet";
  spec["patches"][0]["card"] = {{"wall_mm", 90}};
  spec["patches"][1]["card"] = {{"wall_mm", 95}};
  bench.write("spec.json", spec);
  check_refused(bench.popcut({"design", "spec.json", "-o", "out"}), 4,
                "/patches/1/card: patches 0 and 1 cannot be one sheet");
}

}  // namespace patches_command_test
