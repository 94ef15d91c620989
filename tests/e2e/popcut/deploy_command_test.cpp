// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace deploy_command_test {

using namespace popcut::testing;
using nlohmann::json;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

const std::string kExamples = source_file("examples/");
const std::string kSupport = source_file("tests/support/");

struct Bench : CommandBench {
  /// A design of an example in the folder of its name.
  void design(const std::string& name, const Names& options = {}) const {
    Names arguments{"design", kExamples + name + ".json", "-o", name, "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Ran ran = popcut(arguments);
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
  }
};

std::size_t triangles(const fs::path& stl) { return (fs::file_size(stl) - 84) / 50; }

}  // namespace

TEST_CASE("a design comes with sixty meshes when they are asked for", "[cli][e2e][deploy]") {
  const Bench bench;
  bench.design("unit");
  CHECK_FALSE(fs::exists(bench.temp / "unit/deploy"));
  bench.design("unit", {"--formats", "stl,report"});
  const Names files = files_below(bench.temp / "unit");
  for (const char* name : {"deploy/psi_001.stl", "deploy/psi_060.stl"})
    CHECK(std::count(files.begin(), files.end(), name) == 1);
  const json report = json::parse(text_of_file(bench.temp / "unit/report.json"));
  CHECK(triangles(bench.temp / "unit/deploy/psi_001.stl") ==
        2 * report["panels"].get<std::size_t>());
  // Fewer frames take the others away.
  bench.design("unit",
               {"--formats", "stl", "--frames", "3", "--from-psi", "90deg", "--to-psi", "0.5"});
  CHECK(files_below(bench.temp / "unit/deploy") ==
        Names{"psi_001.stl", "psi_002.stl", "psi_003.stl"});
}

TEST_CASE("the poses of a design for another angle end at that angle",
          "[cli][e2e][deploy][angle]") {
  const Bench bench;
  write_file(bench.temp / "barrel.json",
             R"j({"popcut":1,"surface":{"type":"revolution","radius":"50"},"design_angle_deg":60,
                 "units_per_slice":3,"slices":3,"widths_mm":20})j");
  const Ran ran = bench.popcut(
      {"design", "barrel.json", "-o", "barrel", "--frames", "3", "--formats", "fold,stl,report"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK_THAT(ran.err, Catch::Contains("right when the card is open to 60 degrees"));
  constexpr double kSixty = 1.0471975511965976;
  const json fold = json::parse(text_of_file(bench.temp / "barrel/pattern.fold"));
  CHECK(fold["popcut:design_psi_rad"] == kSixty);
  CHECK(fold["file_frames"][1]["frame_popcut:psi_rad"] == kSixty);
  CHECK(json::parse(text_of_file(bench.temp / "barrel/report.json"))["design_angle_deg"] == 60);
  // What is read back from the FOLD file ends there too, and is the same mesh.
  const Ran again =
      bench.popcut({"deploy", "barrel/pattern.fold", "-o", "again", "--frames", "3", "--json"});
  REQUIRE(again.exit == 0);
  CHECK(json::parse(again.out)["psi_to_rad"] == kSixty);
  CHECK_THAT(text_of_file(bench.temp / "barrel/deploy/psi_003.stl").substr(0, 80),
             Catch::Contains("psi 1.047198 rad"));
}

TEST_CASE("the option for solids takes an optional thickness before or after the file",
          "[cli][e2e][deploy]") {
  const Bench bench;
  const std::string spec = kExamples + "unit.json";
  for (const Names& words : {Names{"design", "--thickness", spec, "-o", "a"},
                             Names{"design", spec, "--thickness", "-o", "a"},
                             Names{"design", spec, "-o", "a", "--thickness", "0.27"},
                             Names{"design", spec, "-o", "a", "--thickness=0.27"}}) {
    Names asked = words;
    asked.insert(asked.end(), {"--formats", "stl"});
    const Ran ran = bench.popcut(asked);
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    // Four faces of 4 to 8 corners: prisms of 4 n - 4 triangles.
    CHECK(triangles(bench.temp / "a/deploy/psi_001.stl") > 40);
  }
  check_refused_at(bench.popcut({"design", spec, "-o", "a", "--thickness", "-1"}), 2,
                   "--thickness: ");
  check_refused_at(bench.popcut({"design", spec, "-o", "a", "--thickness", "thick"}), 2,
                   "--thickness: is \"thick\"");
}

TEST_CASE("deploying the FOLD file gives the meshes of the design", "[cli][e2e][deploy]") {
  const Bench bench;
  bench.design("sphere", {"--frames", "5", "--formats", "fold,csv,stl"});
  const Ran ran = bench.popcut({"deploy", "sphere/pattern.fold", "-o", "poses", "--frames", "5",
                                "--glb", "--poster", "--film", "--json"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(json::parse(ran.out)["frames"] == 5);
  const Names files = files_below(bench.temp / "poses");
  CHECK(files == Names{"deploy.glb", "film.svg", "manifest.json", "poster.svg", "psi_001.stl",
                       "psi_002.stl", "psi_003.stl", "psi_004.stl", "psi_005.stl"});
  for (const char* name : {"psi_001.stl", "psi_005.stl"})
    CHECK(triangles(bench.temp / "poses" / name) == triangles(bench.temp / "sphere/deploy" / name));
  REQUIRE(
      bench.popcut({"deploy", "sphere/segments.csv", "-o", "poses", "--no-stl", "--glb"}).exit ==
      0);
  CHECK(files_below(bench.temp / "poses") == Names{"deploy.glb", "manifest.json"});
}

TEST_CASE("input that cannot be deployed is refused in one line", "[cli][e2e][deploy]") {
  const Bench bench;
  bench.design("unit", {"--formats", "fold,csv"});
  const std::string fold = "unit/pattern.fold";
  for (const Names& options :
       {Names{"--frames", "0"}, Names{"--frames", "10001"}, Names{"--frames", "many"},
        Names{"--from-psi", "4"}, Names{"--to-psi", "up"}, Names{"--convention", "mine"},
        Names{"--material", "felt"}}) {
    Names words{"deploy", fold, "-o", "out"};
    words.insert(words.end(), options.begin(), options.end());
    check_refused_at(bench.popcut(words), 2, words[words.size() - 2] + ": ");
  }
  // What is lawful alone and not together with the rest.
  for (const Names& options :
       {Names{"--from-psi", "1.5707963267948966"}, Names{"--convention", "paper"}}) {
    Names words{"deploy", fold, "-o", "out"};
    words.insert(words.end(), options.begin(), options.end());
    check_refused_at(bench.popcut(words), 2, "command line: ");
  }
  check_refused_at(bench.popcut({"deploy", "-o", "out"}), 2, "command line: ");
  check_refused_at(bench.popcut({"deploy", fold}), 2, "command line: ");
  check_refused_at(bench.popcut({"deploy", "absent.fold", "-o", "out"}), 3, "absent.fold: ");
  check_refused_at(bench.popcut({"deploy", "unit", "-o", "out"}), 3,
                   "unit: is the folder of one card");
  write_file(bench.temp / "bad.csv", "0,5,30,10,5,30,10,7,1,1,0,8\n0,5,30,10,5,inf,10,7,1,1,0,8\n");
  check_refused_at(bench.popcut({"deploy", "bad.csv", "-o", "out"}), 3,
                   "bad.csv: line 2: column 6");
  write_file(bench.temp / "bad.fold", "{\"vertices_coords\": [[0,0],[1,0]");
  check_refused_at(bench.popcut({"deploy", "bad.fold", "-o", "out"}), 3, "bad.fold: line 1");
  write_file(bench.temp / "flat.fold",
             R"({"vertices_coords": [[0,0],[1,0],[1,1]], "faces_vertices": [[0,1,2]],
                 "edges_vertices": [[0,1],[1,2],[2,0]]})");
  check_refused_at(bench.popcut({"deploy", "flat.fold", "-o", "out"}), 3,
                   "flat.fold: /edges_assignment: no fold joins two faces");
  write_file(bench.temp / "folded.fold",
             R"({"vertices_coords": [[0,0,0],[9,0,0],[9,5,1]], "faces_vertices": [[0,1,2]],
                 "edges_vertices": [[0,1],[1,2],[2,0]]})");
  check_refused_at(bench.popcut({"deploy", "folded.fold", "-o", "out"}), 3,
                   "folded.fold: /vertices_coords: no frame lies flat");
  const std::string spec = kExamples + "unit.json";
  for (const Names& words : {Names{"deploy", spec, "-o", "out"}, Names{"verify", spec}}) {
    const Ran ran = bench.popcut(words);
    check_refused_at(ran, 3, spec + ": is a design spec");
    CHECK_THAT(ran.err, Catch::Contains("'popcut design " + spec + " -o unit', then 'popcut " +
                                        words[0] + " unit/pattern.fold"));
  }
  const Ran twice = bench.popcut({"design", fold, "-o", "out"});
  check_refused_at(twice, 3, fold + ": is a pattern or a drawing already");
  CHECK_THAT(twice.err, Catch::Contains("'popcut verify " + fold + "'"));
  write_file(bench.temp / "empty.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
  check_refused_at(bench.popcut({"deploy", "empty.svg", "-o", "out"}), 3,
                   "empty.svg: has no line to cut or fold");
  CHECK_FALSE(fs::exists(bench.temp / "out"));
}

TEST_CASE("deploy takes the drawing of a pattern as well as its FOLD file", "[cli][e2e][deploy]") {
  const Bench bench;
  bench.design("sphere", {"--formats", "fold,svg"});
  const auto meshes = [&](const std::string& file, const std::string& folder) {
    const Ran ran =
        bench.popcut({"deploy", file, "-o", folder, "--frames", "2", "--poster", "--glb"});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    return ran.err;
  };
  CHECK_THAT(meshes("sphere/pattern.fold", "fold"), !Catch::Contains("note"));
  CHECK_THAT(meshes("sphere/pattern.svg", "svg"),
             Catch::Contains("the panels were found from the lines of the flat sheet"));
  CHECK(files_below(bench.temp / "fold") == files_below(bench.temp / "svg"));
  CHECK(triangles(bench.temp / "fold/psi_002.stl") == triangles(bench.temp / "svg/psi_002.stl"));
}

TEST_CASE("a pattern of another kind is opened with rigid panels, as far as it goes",
          "[cli][e2e][deploy]") {
  const Bench bench;
  // A valley along the page and a reverse fold at its end.
  write_file(bench.temp / "beak.svg",
             R"(<svg xmlns="http://www.w3.org/2000/svg" width="50mm" height="50mm"
  viewBox="0 0 50 50" fill="none"><path stroke="#000" d="M0,0H50V40H0Z"/>
  <path stroke="#00f" d="M0,20H36"/><path stroke="#f00" d="M36,20H50M36,20L30,0M36,20L30,40"/></svg>)");
  const Ran ran = bench.popcut({"deploy", "beak.svg", "-o", "beak", "--frames", "3", "--glb"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK_THAT(ran.err, Catch::Contains("not all parallel to wall or ground") &&
                          Catch::Contains("4 rigid faces"));
  CHECK(files_below(bench.temp / "beak") ==
        Names{"deploy.glb", "manifest.json", "psi_001.stl", "psi_002.stl", "psi_003.stl"});
  check_refused_at(bench.popcut({"deploy", "beak.svg", "-o", "drawn", "--poster"}), 2,
                   "--poster: draws only patterns whose panels are all parallel");
  const Ran shut = bench.popcut({"deploy", "beak.svg", "-o", "shut", "--to-psi", "0"});
  check_refused_at(shut, 3, "beak.svg: opens only to psi = ");
  CHECK_THAT(shut.err, Catch::Contains("give --to-psi "));
  CHECK_FALSE(fs::exists(bench.temp / "shut"));
}

TEST_CASE("a design has a drawing for a Cricut if it fits the mat", "[cli][e2e][deploy]") {
  const Bench bench;
  bench.design("unit", {"--formats", "cricut"});
  CHECK(text_of_file(bench.temp / "unit/cricut.svg").find("width=\"11.5in\"") != std::string::npos);
}

TEST_CASE("ezdxf reads the DXF of every example with the sheet's extents", "[cli][e2e][dxf]") {
  const Bench bench;
  for (const auto& entry : fs::directory_iterator(kExamples)) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    bench.design(name, {"--formats", "dxf,report"});
    const bool is_book = fs::exists(bench.temp / (name + "/book.json"));
    const std::string folder = is_book ? name + "/card-01" : name;
    const Ran read = run_program(
        {"/usr/bin/python3", kSupport + "read_dxf.py", bench.path(folder + "/pattern.dxf")},
        bench.temp.path());
    if (read.exit == 127 || read.out.rfind("skip", 0) == 0) {
      WARN("skipped: python3-ezdxf is not installed");
      return;
    }
    INFO(read.err);
    REQUIRE(read.exit == 0);
    const json dxf = json::parse(read.out);
    const json report = json::parse(text_of_file(bench.temp / (folder + "/report.json")));
    CHECK(dxf["errors"] == 0);
    CHECK(dxf["version"] == "AC1009");
    CHECK(dxf["units"] == 4);
    for (const char* prefix : {"", "header_"}) {
      const json low = dxf[std::string(prefix) + "min"], high = dxf[std::string(prefix) + "max"];
      CHECK(low[0].get<double>() == Approx(0).margin(1e-6));
      CHECK(high[0].get<double>() == Approx(report["sheet_mm"][1].get<double>()));
      CHECK(low[1].get<double>() == Approx(-report["sheet_mm"][0].get<double>()));
      CHECK(high[1].get<double>() == Approx(0).margin(1e-6));
    }
    CHECK(dxf["colours"]["CUT"] == 7);
    CHECK(dxf["colours"]["FOLD_M"] == 1);
    CHECK(dxf["colours"]["FOLD_V"] == 5);
    CHECK(dxf["colours"]["MARK"] == 8);
    CHECK(dxf["lines"]["FOLD_M"].get<int>() + dxf["lines"]["FOLD_V"].get<int>() ==
          report["folds"].get<int>());
  }
}

TEST_CASE("the Khronos validator finds no fault in any animation", "[cli][e2e][glb]") {
  const std::string npm = source_file("build/npm");
  if (!fs::exists(npm + "/node_modules/gltf-validator")) {
    WARN("skipped: build/npm has no gltf-validator ('./run test' puts it there where npm is)");
    return;
  }
  const Bench bench;
  Names words{"/usr/bin/env", "node", kSupport + "validate_glb.js", npm};
  for (const auto& entry : fs::directory_iterator(kExamples)) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    bench.design(name, {"--formats", "glb,csv"});
    if (fs::exists(bench.path(name + "/book.glb"))) {
      words.push_back(bench.path(name + "/book.glb"));
      continue;
    }
    words.push_back(bench.path(name + "/deploy.glb"));
    const Ran loose = bench.popcut({"deploy", name + "/segments.csv", "-o", name + "/loose",
                                    "--glb", "-q", "--no-stl", "--thickness", "0.2"});
    // Segments are those of level and upright panels; the pattern of a sloped roof says how it
    // moves.
    if (name == "cottage") {
      check_refused(loose, 3, "is neither level nor upright");
      continue;
    }
    REQUIRE(loose.exit == 0);
    words.push_back(bench.path(name + "/loose/deploy.glb"));
  }
  const Ran ran = run_program(words, bench.temp.path());
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json reports = json::parse(ran.out);
  CHECK(reports.size() == words.size() - 4);
  for (const json& report : reports) {
    CAPTURE(report["issues"].dump());
    CHECK(report["issues"]["numErrors"] == 0);
    CHECK(report["issues"]["numWarnings"] == 0);
    CHECK(report["info"]["animationCount"] == 1);
  }
}

}  // namespace deploy_command_test
