// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "tests/support/at_terminal.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/rounds.hpp"

namespace design_command_test {

using namespace popcut::testing;
using nlohmann::json;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

const std::string kExamples = source_file("examples/");

/// `popcut design ...` in a folder of its own.
struct Bench : CommandBench {
  Ran design(Names arguments, const Limits& limits = {}) const {
    arguments.insert(arguments.begin(), "design");
    return popcut(std::move(arguments), limits);
  }
  [[nodiscard]] Names files(const std::string& folder) const { return files_below(temp / folder); }
};

}  // namespace

TEST_CASE("a design that takes long shows at a terminal what it does and what is left",
          "[cli][e2e][progress]") {
  const Bench bench;
  bench.write("long.json", {{"popcut", 1},
                            {"surface", {{"type", "revolution"}, {"radius", "sqrt(36 - y^2)"}}},
                            {"scale_mm", 60},
                            {"units_per_slice", 120},
                            {"slices", 200},
                            {"widths_mm", 1.2},
                            {"min_panel_mm", 0.1},
                            {"lattice", "conformal"}});
  AtTerminal popcut(popcut_program(), {"design", "long.json", "-o", "card"}, bench.temp);
  CHECK(popcut.shows("laying the lattice: conformal"));
  CHECK(popcut.shows(" left"));
  INFO(popcut.shown);
  CHECK(popcut.shown.find("\n") == std::string::npos);  // one line, drawn in place
  CHECK(popcut.out().empty());
}

TEST_CASE("a design is read from standard input", "[cli][e2e]") {
  const Bench bench;
  const std::string pipe = "'" + std::string(popcut_program()) + "' design --example sphere | '" +
                           popcut_program() + "' design - -o card";
  const Ran ran = run_program({"/bin/sh", "-c", pipe}, bench.temp.path());
  INFO(ran.err);
  CHECK(ran.exit == 0);
  CHECK(fs::exists(bench.temp / "card/pattern.fold"));
  const Ran wrong = run_program(
      {"/bin/sh", "-c",
       "echo '{\"popcut\": 2}' | '" + std::string(popcut_program()) + "' design - -o no"},
      bench.temp.path());
  CHECK(wrong.exit == 3);
  CHECK(says(wrong.err, "/popcut"));
  CHECK(!fs::exists(bench.temp / "no"));
}

TEST_CASE("every shipped example becomes a pattern with one degree of freedom",
          "[cli][e2e][design]") {
  const Bench bench;
  std::istringstream list(bench.design({"--list"}).out);
  int examples = 0;
  for (std::string line; std::getline(list, line); ++examples) {
    if (examples % step_of(1, 3) != 0) continue;  // the next case designs each of them, too
    const std::string name = line.substr(0, line.find(' '));
    CAPTURE(name);
    const Ran ran = bench.design({kExamples + name + ".json", "-o", name, "--json"});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    const json report = json::parse(ran.out);
    if (report.contains("popcut_book")) {
      CHECK(report["degrees_of_freedom"] == json(std::vector<int>(report["cards"], 1)));
      CHECK(json::parse(text_of_file(bench.temp / (name + "/book.json"))) == report);
      continue;
    }
    CHECK(report["degrees_of_freedom"] == 1);
    CHECK(report["name"] == name);
    CHECK(json::parse(text_of_file(bench.temp / (name + "/report.json"))) == report);
    const json fold = json::parse(text_of_file(bench.temp / (name + "/pattern.fold")));
    CHECK(fold["file_frames"].size() == 3);
    CHECK(fold["faces_vertices"].size() == report["faces"]);
  }
  CHECK(examples >= 5);
}

namespace {

/// A design can be made as it is: nothing is warned of, every fold is cut, and shut it lies inside
/// its card, as the poses in its FOLD file show.
void check_makeable(const Bench& bench, const std::string& spec, const std::string& out) {
  const Ran ran = bench.design({spec, "-o", out, "--fold-frames", "90deg,0.0001"});
  CAPTURE(out, ran.err);
  // Of a book one card; the others have the same page.
  const std::string folder = bench.read_json(spec).contains("book") ? out + "/card-01" : out;
  REQUIRE(ran.exit == 0);
  CHECK(ran.err.find("warning") == std::string::npos);
  const json report = bench.read_json(folder + "/report.json");
  CHECK(report["warnings"].empty());
  CHECK(report["sticks_out_mm"] == 0.0);

  const json fold = bench.read_json(folder + "/pattern.fold");
  const json& open = fold["file_frames"][0]["vertices_coords"];
  const json& shut = fold["file_frames"][1]["vertices_coords"];
  double wall = 0.0, ground = 0.0, reach = 0.0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const double x = open[i][0], z = open[i][2];
    ground = std::max(ground, x), wall = std::max(wall, z);
    if (x > 1e-9 && z > 1e-9)
      reach = std::max(reach, std::hypot(shut[i][0].get<double>(), shut[i][2].get<double>()));
  }
  CHECK(reach > 0.0);
  CHECK(reach < std::min(wall, ground));

  const Ran planned = bench.popcut({"plan", spec, "-o", out + "-plan"});
  CAPTURE(planned.err);
  REQUIRE(planned.exit == 0);
  CHECK(planned.err.find("warning") == std::string::npos);
  const json plan = bench.read_json(out + "-plan/plan.json");
  CHECK(plan["warnings"].empty());
  REQUIRE(plan["sheets"].size() == 1);
  CHECK(plan["sheets"][0]["scored"].empty());
}

}  // namespace

TEST_CASE("README's design and every example can be made as they are, in paper of 220 gsm too",
          "[cli][e2e][design]") {
  const Bench bench;
  const std::string readme = text_of_file(source_file("README.md"));
  const std::size_t from = readme.find("```json\n") + 8;
  const std::string shown = readme.substr(from, readme.find("```", from) - from);
  std::vector<std::pair<std::string, json>> specs{{"readme", json::parse(shown)}};
  std::istringstream list(bench.design({"--list"}).out);
  for (std::string line; std::getline(list, line);) {
    const std::string name = line.substr(0, line.find(' '));
    specs.emplace_back(name, json::parse(text_of_file(kExamples + name + ".json")));
  }
  REQUIRE(specs.size() == 18);
  int heavier = 0;
  for (auto& [name, spec] : specs) {
    bench.write(name + ".json", spec);
    check_makeable(bench, name + ".json", name);
    if (!spec.contains("material") || ++heavier % step_of(1, 3) != 0) continue;
    spec["material"] = "paper-220";
    bench.write(name + "-220.json", spec);
    check_makeable(bench, name + "-220.json", name + "-220");
  }
}

namespace {

/// Cuts a card of parts on the simulated cutter: what the knife did on each sheet is what the plan
/// and the card's file say, and each part is on a sheet.
void check_cut(const Bench& bench, const std::string& fold, std::size_t parts) {
  const Ran cut = bench.popcut(
      {"cut", fold, "--direct", "--yes", "--device", "sim:cameo3", "--mat", "12x12", "-o", "cut"});
  CAPTURE(fold, cut.err);
  REQUIRE(cut.exit == 0);
  const json plan = bench.read_json("cut/plan.json");
  std::set<std::string> names;
  for (std::size_t k = 0; k < plan["sheets"].size(); ++k) {
    for (const json& part : plan["sheets"][k]["parts"]) names.insert(part["name"]);
    const std::string name = "cut/sheet-0" + std::to_string(k + 1);
    const Ran held = bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--expect", fold,
                                   "--plan", "cut/plan.json", "--sheet", std::to_string(k + 1)});
    CAPTURE(held.err);
    CHECK(held.exit == 0);
    CHECK(bench.read_json(name + ".trace.json")["strokes"] ==
          bench.read_json("simulated/trace.json")["strokes"]);
  }
  CHECK(names.size() == parts);
}

}  // namespace

TEST_CASE("layers are designed, verified and planned as a card of several pieces",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(source_file("docs/parts/wood.json")));
  bench.write("wood.json", spec);
  const Ran made = bench.design({"wood.json", "-o", "wood"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  const json report = bench.read_json("wood/report.json");
  CHECK(report["layers"].size() == 5);
  CHECK(report["pieces"] == 6);
  CHECK(report["tabs"] == 10);
  for (const char* file : {"pattern.svg", "cut.svg", "pattern.dxf", "pattern.png", "deployed.png"})
    CHECK(fs::exists(bench.temp / "wood" / file));
  const Ran verified = bench.popcut({"verify", "wood/pattern.fold", "--json"});
  CHECK(verified.exit == 0);
  const json sound = json::parse(verified.out);
  CHECK(sound["degrees_of_freedom"] == 1);
  CHECK(sound["opening_deg"][1] == Approx(179.0));
  CHECK(sound["wobble_mm"] < 1.0);
  CHECK(bench.popcut({"verify", "wood/pattern.fold", "--dof", "2"}).exit == 6);

  // The spec and the file of its card are planned alike: each part is a piece of its own.
  for (const char* input : {"wood.json", "wood/pattern.fold"}) {
    const Ran planned = bench.popcut({"plan", input, "-o", "sheets", "--machine", "cameo3"});
    CAPTURE(input, planned.err);
    REQUIRE(planned.exit == 0);
    CHECK(planned.err.find("layer-3") != std::string::npos);
    const json plan = bench.read_json("sheets/plan.json");
    for (const json& sheet : plan["sheets"]) CHECK(sheet["tabs"].empty());
    CHECK(plan["handwork"] == report["handwork"]);  // with 45 s for each glued tab
    CHECK(plan["handwork"]["tabs"] == 10);
  }

  check_cut(bench, "wood/pattern.fold", 6);

  const Ran guided = bench.popcut({"fold-guide", "wood/pattern.fold", "-o", "guide"});
  CAPTURE(guided.err);
  REQUIRE(guided.exit == 0);
  CHECK(guided.out.find("wood: 6 pieces, 10 tabs; 16 folds") == 0);
  CHECK(guided.out.find("layer-5: Fold it flat, and glue tab A on the left page, on outline A.") !=
        std::string::npos);
  const json guide = bench.read_json("guide/fold-guide.json");
  CHECK(guide["steps"].size() == 11);
  CHECK(guide["steps"][6]["tabs"] == json{"A", "B"});
  CHECK(fs::file_size(bench.temp / "guide" / "fold-guide.pdf") > 20'000);

  // The print's program is that of the plan with marks.
  REQUIRE(
      bench.popcut({"plan", "wood/pattern.fold", "-o", "marked", "--machine", "cameo3", "--marks"})
          .exit == 0);
  const Ran printed = bench.popcut(
      {"print", "wood.json", "-o", "pages", "--machine", "cameo3", "--dpi", "60", "--preview"});
  CAPTURE(printed.err);
  REQUIRE(printed.exit == 0);
  CHECK(text_of_file(bench.temp / "pages" / "sheet-01.gpgl") ==
        text_of_file(bench.temp / "marked" / "sheet-01.gpgl"));
  CHECK(fs::exists(bench.temp / "pages" / "preview.png"));
  const Ran flat = bench.popcut({"print", "wood.json", "-o", "flat", "--mode", "lines"});
  CHECK(flat.exit == 2);
  CHECK(flat.err.find("--mode: must be view for a card of layers") != std::string::npos);

  // The same on a card that opens to 90 degrees, with a strut behind each layer.
  spec["layers"]["opens_deg"] = 90;
  bench.write("corner.json", spec);
  const Ran corner = bench.design({"corner.json", "-o", "corner"});
  CAPTURE(corner.err);
  REQUIRE(corner.exit == 0);
  CHECK(corner.err.find("wood: 5 layers on a card that opens to 90 degrees") != std::string::npos);
  CHECK(bench.read_json("corner/report.json")["opens_deg"] == 90);
  CHECK(bench.read_json("corner/report.json")["pieces"] == 11);
  CHECK(bench.popcut({"verify", "corner/pattern.fold"}).exit == 0);
  spec["layers"].erase("opens_deg");

  spec["layers"]["page_mm"] = 40;
  bench.write("small.json", spec);
  const Ran small = bench.design({"small.json", "-o", "small"});
  CHECK(small.exit == 4);
  CHECK(small.err.find("/layers/page_mm: is 40; the layers need pages of at least") !=
        std::string::npos);
  spec["layers"] = {{"layers", 2}};
  bench.write("few.json", spec);
  CHECK(bench.design({"few.json", "-o", "few"}).err.find("/layers/layers") != std::string::npos);
  spec["layers"] = json::object();
  spec["translate_mm"] = {1, 0, 0};
  bench.write("moved.json", spec);
  CHECK(bench.design({"moved.json", "-o", "moved"}).err.find("/translate_mm: contradicts") !=
        std::string::npos);
}

TEST_CASE("boxes are designed, verified, planned, printed and shown step by step",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(source_file("docs/parts/box-house.json")));
  spec["surface"]["file"] = "house.glb";
  bench.write("house.json", spec);
  fs::copy_file(source_file("examples/house.glb"), bench.temp / "house.glb");
  const Ran made = bench.design({"house.json", "-o", "house"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  CHECK(made.err.find("house: 1 box on a card that opens flat, in one movement") !=
        std::string::npos);
  CHECK(made.err.find("gabled roof, 9 panels") != std::string::npos);
  const json report = bench.read_json("house/report.json");
  CHECK(report["style"] == "boxes");
  CHECK(report["panels"] == 9);
  CHECK(report["boxes"][0]["inner_wall_mm"].get<double>() > 30.0);
  CHECK(report["error"] < 0.01);
  CHECK(report["seen"]["error"] < 0.35);
  CHECK(report["boxes"][0]["roof"] == "gabled");
  for (const char* file : {"pattern.svg", "cut.svg", "pattern.dxf", "pattern.png", "deployed.png"})
    CHECK(fs::exists(bench.temp / "house" / file));
  CHECK(bench.popcut({"verify", "house/pattern.fold"}).exit == 0);
  check_cut(bench, "house/pattern.fold", report["pieces"]);
  for (const char* input : {"house.json", "house/pattern.fold"}) {
    const Ran guide = bench.popcut({"fold-guide", input, "-o", "guide"});
    CAPTURE(input, guide.err);
    REQUIRE(guide.exit == 0);
    CHECK(bench.read_json("guide/fold-guide.json")["tabs"].size() == report["tabs"]);
  }
  const Ran printed = bench.popcut({"print", "house.json", "-o", "pages", "--machine", "none",
                                    "--mat", "A4", "--dpi", "75", "--preview"});
  CAPTURE(printed.err);
  REQUIRE(printed.exit == 0);
  CHECK(printed.err.find("in the model's colours") != std::string::npos);
  CHECK(fs::exists(bench.temp / "pages" / "preview.png"));
  const Ran lines = bench.popcut({"print", "house.json", "-o", "flat", "--mode", "lines"});
  CHECK(lines.exit == 2);
  CHECK(lines.err.find("--mode: must be view for a card of boxes") != std::string::npos);
  spec["boxes"] = {{"page_mm", 40}};
  bench.write("small.json", spec);
  const Ran small = bench.design({"small.json", "-o", "small"});
  CHECK(small.exit == 4);
  CHECK(small.err.find("/boxes/page_mm: is 40; the boxes need pages of at least") !=
        std::string::npos);
}

TEST_CASE("slices are designed, verified and planned as a card of several pieces",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(source_file("docs/parts/torus.json")));
  bench.write("torus.json", spec);
  fs::copy_file(source_file("docs/parts/torus.obj"), bench.temp / "torus.obj");
  const Ran made = bench.design({"torus.json", "-o", "torus"});
  CAPTURE(made.err);
  REQUIRE(made.exit == 0);
  CHECK(made.err.find("assembly stand up") != std::string::npos);
  const json report = bench.read_json("torus/report.json");
  CHECK(report["style"] == "slices");
  CHECK(report["tabs"] == 2);
  CHECK(report["kept"] > 0.95);
  CHECK(report["pieces"] == report["slices"].size() + 1);
  for (const char* file : {"pattern.svg", "cut.svg", "pattern.dxf", "pattern.png", "deployed.png"})
    CHECK(fs::exists(bench.temp / "torus" / file));
  CHECK(bench.popcut({"verify", "torus/pattern.fold"}).exit == 0);
  check_cut(bench, "torus/pattern.fold", report["pieces"]);
  for (const char* input : {"torus.json", "torus/pattern.fold"}) {
    const Ran planned = bench.popcut({"plan", input, "-o", "sheets", "--machine", "cameo3"});
    CAPTURE(input, planned.err);
    REQUIRE(planned.exit == 0);
    CHECK(planned.err.find("x3") != std::string::npos);
    const json plan = bench.read_json("sheets/plan.json");
    for (const char* what : {"folds", "tabs", "waste", "fold_s", "label"})
      CHECK(plan["handwork"][what] == report["handwork"][what]);
    CHECK(plan["sheets"].size() >= plan["layout"]["least_sheets"]);
    const json& use = plan["layout"]["use"];
    CHECK((use["share"] > 0.2 && use["share"] <= 1.0));
    CHECK(use["rows_sheets"] >= plan["sheets"].size());
    CHECK(planned.err.find("% of ") != std::string::npos);
  }
  const auto refuses = [&](const Names& arguments, const std::string& words) {
    const Ran ran = bench.popcut(arguments);
    CAPTURE(ran.err);
    CHECK(ran.exit == 4);
    CHECK(ran.err.find(words) != std::string::npos);
  };
  for (const char* page : {"A4", "Letter"})
    for (const char* input : {"torus.json", "torus/pattern.fold"}) {
      const Ran guide = bench.popcut({"fold-guide", input, "--page", page, "-o", "guide"});
      CAPTURE(input, guide.err);
      REQUIRE(guide.exit == 0);
      CHECK(guide.out.find("slide it straight down onto") != std::string::npos);
      CHECK(bench.read_json("guide/fold-guide.json")["steps"].back()["tabs"] == json({"A", "B"}));
      CHECK(text_of_file(bench.temp / "guide" / "fold-guide.pdf").starts_with("%PDF"));
    }
  // By hand with names, letters and a legend; with marks for a cutter; as SVG and PNG for a Cricut.
  const auto printed = [&](const Names& options, const char* folder) {
    Names words{"print", "torus.json", "-o", folder, "--dpi", "100"};
    words.insert(words.end(), options.begin(), options.end());
    const Ran ran = bench.popcut(words);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    CHECK(ran.err.find("of slices, with their names and where tabs go") != std::string::npos);
    CHECK(text_of_file(bench.temp / folder / "sheet-01.pdf").starts_with("%PDF"));
  };
  printed({"--machine", "none", "--mat", "A4"}, "by-hand");
  printed({"--machine", "cameo3", "--mat", "A4", "--cut-lines"}, "marked");
  CHECK(fs::exists(bench.temp / "marked" / "sheet-01.gpgl"));
  const std::string marked = text_of_file(bench.temp / "marked" / "sheet-01.svg");
  CHECK(marked.find("id=\"glue\"") != std::string::npos);
  CHECK(marked.find("id=\"parts\"") != std::string::npos);
  CHECK(marked.find("<image") == std::string::npos);
  printed({"--machine", "cricut-explore"}, "cricut");
  CHECK(fs::exists(bench.temp / "cricut" / "sheet-01.png"));
  const Ran back = bench.popcut({"print", "torus.json", "-o", "back", "--back"});
  CHECK(back.exit == 2);
  CHECK(back.err.find("--back: is for artwork, and slices carry none") != std::string::npos);
  // An envelope and a cover around it are drawings that can be cut.
  const Ran around = bench.design(
      {"torus.json", "-o", "around", "--formats", "dxf,report", "--envelope", "fit", "--cover"});
  CAPTURE(around.err);
  REQUIRE(around.exit == 0);
  CHECK(around.err.find("envelope ") != std::string::npos);
  for (const char* file : {"envelope.svg", "envelope.dxf", "cover.svg", "cover.dxf"}) {
    const Ran planned = bench.popcut({"plan", std::string("around/") + file, "-o", "net",
                                      "--machine", "none", "--mat", "600x600"});
    CAPTURE(file, planned.err);
    CHECK(planned.exit == 0);
    CHECK(bench.read_json("net/plan.json")["handwork"]["folds"] >= 2);
  }
  refuses({"design", "torus.json", "-o", "around", "--envelope", "A2"},
          "--envelope: A2 is 146.0 x 111.1 mm; the shut card");
  CHECK(bench.design({"torus.json", "-o", "around", "--envelope", "A99"}).exit == 2);
  spec["sliceform"]["page_mm"] = 40;
  bench.write("small.json", spec);
  refuses({"design", "small.json", "-o", "small"},
          "/sliceform/page_mm: is 40; the slices need pages of at least");
}

TEST_CASE("panels are long enough to fold flat in the spec's material unless it says otherwise",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(kExamples + "sphere.json"));
  spec.erase("min_panel_mm");
  spec["units_per_slice"] = 9;
  for (const char* material : {"paper-80", "paper-220", "card-300"}) {
    spec["material"] = material;
    bench.write("own.json", spec);
    const Ran ran = bench.design({"own.json", "-o", "own", "--formats", "report"});
    CAPTURE(material, ran.err);
    REQUIRE(ran.exit == 0);
    CHECK(ran.err.find("too short to fold flat") == std::string::npos);
  }
  spec["min_panel_mm"] = 0.5;
  bench.write("own.json", spec);
  const Ran fine = bench.design({"own.json", "-o", "own", "--formats", "report"});
  CHECK(fine.err.find("too short to fold flat") != std::string::npos);
}

TEST_CASE("folds that are not in cut.svg and a sheet that is too large are named",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(kExamples + "cylinder.json"));
  spec["widths_mm"] = 1.2;
  spec["sheet"] = "A6";
  bench.write("fine.json", spec);
  const Ran ran = bench.design({"fine.json", "-o", "fine", "--formats", "cut,report"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const json report = bench.read_json("fine/report.json");
  const std::string said = report["warnings"].dump();
  CHECK(said.find("are not in cut.svg") != std::string::npos);
  CHECK(said.find("larger than a sheet A6 of 105 x 148 mm") != std::string::npos);
  CHECK(said.find("folds are below 1.5 mm") != std::string::npos);
  // The plan cuts them half through, and its sheet and program agree about them.
  REQUIRE(bench.popcut({"plan", "fine.json", "-o", "plan"}).exit == 0);
  const json plan = bench.read_json("plan/plan.json");
  CHECK(plan["warnings"].dump().find("cut half through") != std::string::npos);
  CHECK_FALSE(plan["sheets"][0]["scored"].empty());
  for (const Names& expected :
       {Names{"plan/sheet-01.svg"}, Names{"fine.json", "--plan", "plan/plan.json"}}) {
    Names arguments{"simulate", "plan/sheet-01.gpgl", "-o", "simulated", "--expect"};
    arguments.insert(arguments.end(), expected.begin(), expected.end());
    const Ran simulated = bench.popcut(arguments);
    CAPTURE(simulated.err);
    CHECK(simulated.exit == 0);
  }
}

TEST_CASE("notes about V-folds say what the card looks like, and zero is zero",
          "[cli][e2e][design]") {
  const Bench bench;
  const Ran ran = bench.design({kExamples + "multistate.json", "-o", "out", "--formats", "report"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK_THAT(ran.err,
             Catch::Contains("50.4 degrees the middle is neither dome nor saddle (K = 0 rad)") &&
                 Catch::Contains("like a saddle (K = -0.055 rad)") && !Catch::Contains("e-1"));
}

TEST_CASE("an example is printed as it is shipped", "[cli][e2e][design]") {
  const Bench bench;
  CHECK(bench.design({"--example", "sphere"}).out == text_of_file(kExamples + "sphere.json"));
  check_refused_at(bench.design({"--example", "teapot"}), 2, "--example: 'teapot'");
}

TEST_CASE("the schema is a JSON document", "[cli][e2e][design]") {
  const Bench bench;
  const json schema = json::parse(bench.design({"--schema"}).out);
  CHECK(schema["properties"].contains("widths_mm"));
}

namespace {

/// Width and height of a PNG file, from its header.
std::array<unsigned, 2> png_size(const fs::path& file) {
  const std::string bytes = text_of_file(file);
  REQUIRE(bytes.size() > 100);
  REQUIRE(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  const auto at = [&](std::size_t i) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 4; ++k)
      value = value << 8 | static_cast<unsigned char>(bytes[i + k]);
    return value;
  };
  return {at(16), at(20)};
}

}  // namespace

TEST_CASE("a design comes with its pictures and without meshes", "[cli][e2e][design]") {
  const Bench bench;
  const std::string spec = kExamples + "fig2a.json";
  const Ran ran = bench.design({spec, "-o", "out"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(bench.files("out") == Names{"cut.svg", "deploy.glb", "deployed.png", "manifest.json",
                                    "pattern.dxf", "pattern.fold", "pattern.png", "pattern.svg",
                                    "poster.svg", "report.json", "segments.csv"});
  for (const char* name : {"out/pattern.png", "out/deployed.png"}) {
    const auto [width, height] = png_size(bench.temp / name);
    CHECK(std::max(width, height) == 1200);
    CHECK(std::min(width, height) > 400);
  }
  const std::string first = text_of_file(bench.temp / "out/deployed.png");
  const std::string poster = text_of_file(bench.temp / "out/poster.svg");
  CHECK(poster.find("blue: the shape asked for") != std::string::npos);
  CHECK(poster.find("fill-opacity") != std::string::npos);

  REQUIRE(bench.design({spec, "-o", "out", "--formats", "png"}).exit == 0);
  CHECK(text_of_file(bench.temp / "out/deployed.png") == first);
  REQUIRE(bench.design({spec, "-o", "out", "--formats", "picture,png,poster", "--colour", "error"})
              .exit == 0);
  CHECK(text_of_file(bench.temp / "out/deployed.png") != first);
  for (const char* name : {"out/deployed.svg", "out/poster.svg"}) {
    const std::string text = text_of_file(bench.temp / name);
    CHECK(text.find("mean distance from the shape") != std::string::npos);
    CHECK(text.find("fill-opacity") == std::string::npos);
  }
  const Ran blue = bench.design({spec, "-o", "out", "--colour", "blue"});
  CHECK(blue.exit == 2);
  CHECK(blue.err.find("one of paper, error") != std::string::npos);
}

TEST_CASE("a second run removes only the files that it no longer writes", "[cli][e2e][design]") {
  const Bench bench;
  const std::string spec = kExamples + "unit.json";
  REQUIRE(
      bench.design({spec, "-o", "out", "--formats", "fold,svg,cut,csv,pdf,picture,report"}).exit ==
      0);
  CHECK(bench.files("out") == Names{"cut.svg", "deployed.svg", "manifest.json", "pattern.fold",
                                    "pattern.pdf", "pattern.svg", "report.json", "segments.csv"});
  write_file(bench.temp / "out/mine.txt", "mine");
  REQUIRE(bench.design({spec, "-o", "out", "--formats", "svg"}).exit == 0);
  CHECK(bench.files("out") == Names{"manifest.json", "mine.txt", "pattern.svg"});
}

TEST_CASE("options for all commands may stand before or after the command", "[cli][e2e][design]") {
  const Bench bench;
  const std::string spec = kExamples + "unit.json";
  for (const Names& arguments :
       {Names{popcut_program(), "--json", "-q", "design", spec, "-o", "a"},
        Names{popcut_program(), "design", spec, "-o", "b", "-q", "--json"}}) {
    const Ran ran = run_program(arguments, bench.temp.path());
    CHECK(ran.exit == 0);
    CHECK(ran.err.empty());
    CHECK(json::parse(ran.out).contains("faces"));
  }
}

TEST_CASE("cut.svg of a design has each fold as solid dashes within its line",
          "[cli][e2e][design]") {
  const Bench bench;
  REQUIRE(bench.design({kExamples + "unit.json", "-o", "out"}).exit == 0);
  const std::string cut = text_of_file(bench.temp / "out/cut.svg");
  CHECK(cut.find("stroke-dasharray") == std::string::npos);
  pugi::xml_document document;
  REQUIRE(document.load_string(cut.c_str()));
  double fold_mm = 0;
  int dashes = 0;
  for (const auto& layer : document.child("svg").children("g")) {
    if (std::string(layer.attribute("id").value()).rfind("fold", 0) != 0) continue;
    for (const auto& path : layer.children("path")) {
      double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
      REQUIRE(std::sscanf(path.attribute("d").value(), "M%lf,%lfL%lf,%lf", &x0, &y0, &x1, &y1) ==
              4);
      CHECK(y0 == y1);  // folds run along v, which is the page's x
      CHECK(std::abs(x1 - x0) <= 1.5 + 1e-6);
      fold_mm += std::abs(x1 - x0);
      ++dashes;
    }
  }
  const json report = json::parse(text_of_file(bench.temp / "out/report.json"));
  CHECK(dashes > 30);
  CHECK(fold_mm > 0.4 * report["fold_length_mm"].get<double>());
  CHECK(fold_mm < 0.7 * report["fold_length_mm"].get<double>());
}

TEST_CASE("fold frames are the requested poses", "[cli][e2e][design]") {
  const Bench bench;
  REQUIRE(
      bench.design({kExamples + "unit.json", "-o", "out", "--fold-frames", "90deg,0.25"}).exit ==
      0);
  const json fold = json::parse(text_of_file(bench.temp / "out/pattern.fold"));
  REQUIRE(fold["file_frames"].size() == 2);
  CHECK(fold["file_frames"][1]["frame_popcut:psi_rad"] == 0.25);
}

TEST_CASE("the list of examples is JSON on request", "[cli][e2e][design]") {
  const Bench bench;
  const Ran ran = bench.design({"--list", "--json"});
  CHECK(ran.exit == 0);
  const json list = json::parse(ran.out)["examples"];
  CHECK(list.size() >= 9);
  CHECK(list[3]["name"] == "sphere");
  CHECK_FALSE(list[3]["what"].get<std::string>().empty());
}

TEST_CASE("a wrong design command gives exit code 2", "[cli][e2e][design]") {
  const Bench bench;
  const std::string spec = kExamples + "unit.json";
  check_refused_at(bench.design({}), 2, "command line: SPEC.json is missing");
  check_refused_at(bench.design({spec}), 2, "command line: -o DIR is missing");
  check_refused_at(bench.design({spec, "-o"}), 2, "--output: needs a value");
  check_refused_at(bench.design({spec, "-o", "x", "--formats", "fold,dwg"}), 2, "--formats: 'dwg'");
  check_refused_at(bench.design({spec, "-o", "x", "--fold-frames", "4"}), 2, "--fold-frames: '4'");
  check_refused_at(bench.design({spec, "-o", "x", "--wat"}), 2, "command line: ");
  check_refused_at(bench.design({spec, "more", "-o", "x"}), 2, "command line: ");
  CHECK(files_below(bench.temp.path()).empty());
}

TEST_CASE("an invalid spec gives exit code 3 with its place", "[cli][e2e][design]") {
  const Bench bench;
  write_file(bench.temp / "bad.json", "{\"popcut\": 1,\n  oops");
  write_file(bench.temp / "field.json", "{\"popcut\": 1, \"slises\": 3}");
  write_file(bench.temp / "deep.json", std::string(1'000'000, '['));
  check_refused_at(bench.design({"absent.json", "-o", "out"}), 3, "absent.json: ");
  check_refused_at(bench.design({".", "-o", "out"}), 3, ".: is a folder");
  check_refused_at(bench.design({"bad.json", "-o", "out"}), 3, "bad.json: line 2");
  check_refused_at(bench.design({"field.json", "-o", "out"}), 3, "field.json: /");
  check_refused_at(bench.design({"deep.json", "-o", "out"}), 3, "deep.json: ");
  // A value just beyond a limit does not read like the limit.
  json spec = json::parse(text_of_file(kExamples + "unit.json"));
  spec["design_angle_deg"] = 150.0001;
  write_file(bench.temp / "angle.json", spec.dump());
  check_refused_at(bench.design({"angle.json", "-o", "out"}), 3,
                   "angle.json: /design_angle_deg: is 150.0001; must be a number from 30 to 150");
  spec = json::parse(text_of_file(kExamples + "unit.json"));
  spec["material"] = "papier";
  write_file(bench.temp / "material.json", spec.dump());
  check_refused_at(bench.design({"material.json", "-o", "out"}), 3, "material.json: /material: ");
  check_refused_at(
      run_program({popcut_program(), "plan", "material.json", "-o", "plan"}, bench.temp.path()), 3,
      "material.json: /material: ");
  CHECK_FALSE(fs::exists(bench.temp / "out"));
}

TEST_CASE("design knows the materials of the user's own table", "[cli][e2e][design]") {
  const Bench bench;
  const json known =
      json::parse(run_program({popcut_program(), "materials", "--json"}, bench.temp.path()).out);
  json own = known["materials"][0];
  own["name"] = "felt-3mm", own["thickness_mm"] = 3.0;
  fs::create_directories(bench.temp / "config/popcut");
  write_file(bench.temp / "config/popcut/materials.json",
             json{{"popcut", 1}, {"materials", {own}}}.dump());
  json spec = json::parse(text_of_file(kExamples + "sphere.json"));
  spec["material"] = "felt-3mm";
  write_file(bench.temp / "felt.json", spec.dump());
  const std::string config = "XDG_CONFIG_HOME=" + (bench.temp / "config").string();
  const auto with_table = [&](Names arguments) {
    arguments.insert(arguments.begin(), {"/usr/bin/env", config, popcut_program()});
    return run_program(arguments, bench.temp.path());
  };
  const Ran made = with_table({"design", "felt.json", "-o", "out", "--formats", "cut,report"});
  CAPTURE(made.err);
  CHECK(made.exit == 0);
  CHECK(made.err.find("felt-3mm: ") != std::string::npos);  // too thick for its smallest panel
  check_refused_at(bench.design({"felt.json", "-o", "none"}), 3, "felt.json: /material: ");
  write_file(bench.temp / "config/popcut/materials.json", "{\"materials\": 3}");
  check_refused_at(with_table({"design", "felt.json", "-o", "none"}), 3,
                   (bench.temp / "config/popcut/materials.json").string());
}

TEST_CASE("names with characters that XML forbids still give well-formed drawings",
          "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(kExamples + "unit.json"));
  spec["name"] = "a\x01<b>\xEF\xBF\xBE & \xF0\x9F\x98\x80";
  write_file(bench.temp / "name.json", spec.dump());
  REQUIRE(bench.design({"name.json", "-o", "out", "--formats", "svg,cut,cricut,png,picture,poster"})
              .exit == 0);
  REQUIRE(
      run_program({popcut_program(), "plan", "name.json", "-o", "plan"}, bench.temp.path()).exit ==
      0);
  for (const std::string file :
       {"out/pattern.svg", "out/cut.svg", "out/cricut.svg", "out/deployed.svg", "out/poster.svg",
        "plan/sheet-01.svg", "plan/assembly.svg"}) {
    CAPTURE(file);
    const std::string text = text_of_file(bench.temp / file);
    CHECK(text.find('\x01') == std::string::npos);
    CHECK(text.find("\xEF\xBF\xBE") == std::string::npos);
    pugi::xml_document read;
    CHECK(read.load_string(text.c_str()));
  }
}

TEST_CASE("the name of a spec cannot send escape sequences to the terminal", "[cli][e2e][design]") {
  const Bench bench;
  json spec = json::parse(text_of_file(kExamples + "unit.json"));
  spec["name"] = "a\x1b[31mb\x07\xe2\x80\xae";
  write_file(bench.temp / "name.json", spec.dump());
  for (const char* command : {"design", "plan"}) {
    const Ran ran =
        run_program({popcut_program(), command, "name.json", "-o", command}, bench.temp.path());
    CHECK(ran.exit == 0);
    CHECK(ran.err.rfind("a [31mb", 0) == 0);
    for (const char* raw : {"\x1b", "\x07", "\xe2\x80\xae"})
      CHECK(ran.err.find(raw) == std::string::npos);
  }
}

TEST_CASE("an output that cannot be written gives exit code 7 and changes nothing",
          "[cli][e2e][design]") {
  const Bench bench;
  const std::string spec = kExamples + "fig2a.json";
  write_file(bench.temp / "file", "x");
  check_refused_at(bench.design({spec, "-o", "file"}), 7, "file: is not a folder");
  check_refused_at(bench.design({spec, "-o", "/proc/popcut"}), 7, "/proc/popcut: ");
  REQUIRE(bench.design({spec, "-o", "out"}).exit == 0);
  const std::string before = text_of_file(bench.temp / "out/pattern.fold");
  const Names files = bench.files("out");
  // A limit of 4 kB a file stands in for a full disk.
  check_refused_at(bench.design({spec, "-o", "out"}, {4096, -1}), 7, "out/pattern.fold: ");
  CHECK(text_of_file(bench.temp / "out/pattern.fold") == before);
  CHECK(bench.files("out") == files);
}

TEST_CASE("running out of memory gives one line and exit code 1", "[cli][e2e][design]") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  WARN("skipped: a sanitizer needs all the address space");
#else
  const Bench bench;
  write_file(bench.temp / "large.json", "[" + std::string(60u << 20, ' ') + "]");
  // The libraries that draw pictures take about 80 MB of addresses themselves.
  const Ran ran = bench.design({"large.json", "-o", "out"}, {-1, 120l << 20});
  check_refused_at(ran, 1, "internal fault: ");
#endif
}

}  // namespace design_command_test
