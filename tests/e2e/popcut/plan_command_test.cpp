// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/small_pdf.hpp"

namespace plan_command_test {

using namespace popcut::testing;
using nlohmann::json;
using Names = std::vector<std::string>;

namespace {

const std::string kExamples = source_file("examples/");
const std::string kBigSvg =
    "<svg xmlns='http://www.w3.org/2000/svg' width='400mm' height='300mm' viewBox='0 0 400 300'>"
    "<path fill='none' stroke='black' d='M10,10H350V50H10'/></svg>";

struct Bench : CommandBench {
  json planned(Names arguments) const {
    arguments.insert(arguments.begin(), "plan");
    arguments.insert(arguments.end(), {"-o", "sheets", "--json", "-q"});
    const Ran ran = popcut(arguments);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    CHECK(ran.err.empty());
    return json::parse(ran.out);
  }
  void refused(Names arguments, int exit, const std::string& part) const {
    arguments.insert(arguments.begin(), "plan");
    arguments.insert(arguments.end(), {"-o", "sheets"});
    check_refused(popcut(arguments), exit, part);
  }
};

}  // namespace

TEST_CASE("a spec and its FOLD and its SVG files plan to the same sheet", "[cli][e2e][plan]") {
  const Bench bench;
  for (const char* example : {"unit", "sphere"}) {
    CAPTURE(example);
    const std::string spec = kExamples + example + ".json";
    REQUIRE(bench.popcut({"design", spec, "-o", "design", "-q"}).exit == 0);
    const json own = bench.planned({spec})["sheets"][0];
    CHECK(own["cut_mm"].get<double>() > 100.0);
    CHECK(own["fold_mm"].get<double>() > 50.0);
    for (const char* file : {"pattern.fold", "pattern.svg", "cut.svg"}) {
      CAPTURE(file);
      const json other = bench.planned({std::string("design/") + file})["sheets"][0];
      CHECK(other["cut_mm"].get<double>() == Approx(own["cut_mm"].get<double>()).margin(0.01));
      CHECK(other["fold_mm"].get<double>() == Approx(own["fold_mm"].get<double>()).margin(0.01));
      CHECK(other["lifts"] == own["lifts"]);
    }
  }
}

TEST_CASE("a drawing that --width or --scale makes larger loses neither corners nor curves",
          "[cli][e2e][plan]") {
  const Bench bench;
  // Corners of 3 mm at 300 mm, and a circle of 0.1 units that becomes 200 mm wide.
  write_file(
      bench.temp / "unit.fold",
      R"({"vertices_coords":[[0,0],[0.99,0],[1,0],[1,0.01],[1,1],[0,1]],)"
      R"("edges_vertices":[[0,1],[1,2],[2,3],[3,4],[4,5],[5,0]],"edges_assignment":["B","B","B","B","B","B"]})");
  write_file(bench.temp / "dot.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='1mm' height='1mm' viewBox='0 0 1 1'>"
             "<circle cx='0.5' cy='0.5' r='0.05' fill='none' stroke='black'/></svg>");
  const auto cut_mm = [&](const Names& arguments) {
    Names all = arguments;
    all.insert(all.end(), {"--machine", "none", "--mat", "400x400", "--overcut", "0"});
    return bench.planned(all)["sheets"][0]["cut_mm"].get<double>();
  };
  for (const char* size : {"--width", "--scale"})
    CHECK(cut_mm({"unit.fold", size, "300"}) == Approx(1200).margin(0.05));
  CHECK(cut_mm({"dot.svg", "--width", "200"}) == Approx(200 * 3.14159265).margin(0.2));
}

TEST_CASE("a drawing that is smaller than anybody cuts is asked about, unless its size was said",
          "[cli][e2e][plan]") {
  const Bench bench;
  write_file(bench.temp / "small.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='4mm' height='4mm' viewBox='0 0 4 4'>"
             "<path d='M0 0h4v4' fill='none' stroke='black'/></svg>");
  const auto small = [&](Names arguments) {
    arguments.insert(arguments.begin(), "small.svg");
    return bench.planned(arguments)["warnings"].dump();
  };
  CHECK(says(small({"--machine", "cameo3"}),
             "only 4 x 4 mm; if it is meant in inches, use --scale 25.4"));
  CHECK_FALSE(says(small({"--machine", "cameo3", "--scale", "25.4"}), "inches"));
  CHECK_FALSE(says(small({"--machine", "cameo3", "--width", "5"}), "inches"));
  // Without a cutter, popcut cannot know that a mat that somebody names is not of the usual cutter.
  const Ran ideal = bench.popcut({"plan", "small.svg", "-o", "sheets", "--mat", "letter"});
  CHECK(says(ideal.err, "name your cutter with --machine"));
}

TEST_CASE("a PDF is planned by its layers, and an Illustrator file by the PDF in it",
          "[cli][e2e][plan][pdf]") {
  const Bench bench;
  const std::string page =
      "/OC /L0 BDC 72 72 144 144 re S EMC /OC /L1 BDC 72 144 m 216 144 l S EMC";
  const std::string pdf = small_pdf({"0 0 m 9 9 l S", page}, {"Cut", "Fold"});
  for (const char* name : {"card.pdf", "card.ai", "card"}) {
    CAPTURE(name);
    write_file(bench.temp / name, pdf);
    const json plan = bench.planned({name, "--pdf-page", "2"});
    CHECK(plan["name"] == "card");
    CHECK(plan["pdf_page"] == 2);
    CHECK(plan["sheets"][0]["fold_line_mm"].get<double>() == Approx(144 * 25.4 / 72).margin(0.01));
    CHECK(plan["sheets"][0]["cut_mm"].get<double>() == Approx(4 * 144 * 25.4 / 72).margin(1.01));
    CHECK(says(plan["warnings"][0].get<std::string>(), "page 2 of 2 is read"));
    const Ran checked = bench.popcut({"simulate", "sheets/sheet-01.gpgl", "-o", "sim", "--expect",
                                      name, "--plan", "sheets/plan.json"});
    CAPTURE(checked.err, checked.out);
    CHECK(checked.exit == 0);
  }
  bench.refused({"card.pdf", "--pdf-page", "3"}, 3,
                "--pdf-page: is 3; the PDF has the pages 1 to 2");
  bench.refused({"card.pdf", "--pdf-page", "0"}, 2, "--pdf-page");
  write_file(bench.temp / "cut short.pdf", pdf.substr(0, pdf.size() / 3));
  bench.refused({"cut short.pdf"}, 3, "cut short.pdf: is a PDF that cannot be read");
  // This one crashes poppler 22.12.
  std::string odd = pdf;
  const std::size_t group = odd.find("<</Type/OCG");
  odd[group + 2] = '\xCA';
  write_file(bench.temp / "odd.pdf", odd);
  std::mt19937 random(37);
  for (int round = 0; round < 12; ++round) {
    const Ran ran = bench.popcut({"plan", "odd.pdf", "-o", "sheets"});
    CAPTURE(round, ran.err);
    CHECK((ran.exit == 0 || ran.exit == 3));
    if (ran.exit != 0) check_refused(ran, 3, "odd.pdf: ");
    std::string changed = pdf;
    for (int k = 0; k < 3; ++k)
      changed[5 + random() % (pdf.size() - 5)] = static_cast<char>(random() % 256);
    write_file(bench.temp / "odd.pdf", changed);
  }
}

TEST_CASE("plan writes the sheets and their programs and nothing else", "[cli][e2e][plan]") {
  const Bench bench;
  const json plan = bench.planned({kExamples + "sphere.json"});
  CHECK(files_below(bench.temp / "sheets") == Names{"assembly.svg", "manifest.json", "plan-01.svg",
                                                    "plan.json", "sheet-01.gpgl", "sheet-01.svg"});
  CHECK(json::parse(text_of_file(bench.temp / "sheets/plan.json")) == plan);
  pugi::xml_document svg;
  REQUIRE(svg.load_string(text_of_file(bench.temp / "sheets/sheet-01.svg").c_str()));
  CHECK(svg.select_nodes("//path").size() == plan["sheets"][0]["lifts"].get<std::size_t>());
  CHECK(svg.select_nodes("//@stroke-dasharray").empty());
  const json roll = bench.planned({kExamples + "sphere.json", "--machine", "hpgl-generic"});
  CHECK(files_below(bench.temp / "sheets") == Names{"assembly.svg", "manifest.json", "plan-01.svg",
                                                    "plan.json", "sheet-01.hpgl", "sheet-01.svg"});
  CHECK(roll["machine"] == "hpgl-generic");
}

TEST_CASE("what is too large and not to be split is refused and clipped only when asked",
          "[cli][e2e][plan]") {
  const Bench bench;
  write_file(bench.temp / "big.svg", kBigSvg);
  bench.refused({"big.svg", "--no-split"}, 4, "pattern is 340.0 x 40.0 mm");
  bench.refused({"big.svg", "--no-split"}, 4, "304.8 x 304.8 mm");
  const json clipped = bench.planned({"big.svg", "--clip"});
  CHECK(clipped["sheets"][0]["cut_mm"].get<double>() == Approx(2 * 294.8));
  // A warning names a larger mat, unless the command names the paper.
  const auto tells_another_mat = [&](const Names& more) {
    Names words{"big.svg", "--machine", "cameo3"};
    words.insert(words.end(), more.begin(), more.end());
    const json warnings = bench.planned(words)["warnings"];
    return std::any_of(warnings.begin(), warnings.end(), [](const json& warning) {
      return says(warning.get<std::string>(), "fits whole on");
    });
  };
  CHECK(tells_another_mat({}));
  CHECK_FALSE(tells_another_mat({"--mat", "A4"}));
  // Lengths may have a unit.
  for (const char* width : {"101.6", "101.6mm", "10.16cm", "4in", "4IN"}) {
    CAPTURE(width);
    CHECK(bench.planned({"big.svg", "--width", width})["sheets"][0]["cut_mm"].get<double>() ==
          Approx(720 * 101.6 / 340));
  }
  bench.refused({"big.svg", "--width", "4ft"}, 2, "--width: is \"4ft\"");
  const auto simulated = [&] {
    return bench
        .popcut({"simulate", "sheets/sheet-01.gpgl", "-o", "sim", "--expect", "big.svg", "--plan",
                 "sheets/plan.json"})
        .exit;
  };
  CHECK(simulated() == 0);
  json unclipped = clipped;
  unclipped["clip"] = false;
  write_file(bench.temp / "sheets/plan.json", unclipped.dump());
  CHECK(simulated() == 6);
  const json whole = bench.planned({"big.svg", "--mat", "400x300"});
  CHECK(whole["sheets"][0]["cut_mm"].get<double>() == Approx(720));
  CHECK(whole["machine"] == "ideal");
  const json turned = bench.planned({"big.svg", "--mat", "12x24"});
  CHECK(turned["machine"] == "cameo3");
  CHECK(turned["sheets"][0]["transform"][0][1] == -1.0);
}

TEST_CASE("a wrong option of plan gets the valid values", "[cli][e2e][plan]") {
  const Bench bench;
  write_file(bench.temp / "big.svg", kBigSvg);
  bench.refused({"big.svg", "--machine", "camoe3"}, 2, "did you mean cameo3?");
  bench.refused({"big.svg", "--material", "paper"}, 2, "paper-220");
  bench.refused({"big.svg", "--order", "fast"}, 2,
                "--order: is \"fast\"; one of quick, best, keep");
  bench.refused({"big.svg", "--at", "1"}, 2, "X,Y");
  bench.refused({"big.svg", "--mat", "huge"}, 2, "300x200");
  bench.refused({"big.svg", "--svg-profile", "x"}, 2, "origami-sim");
  bench.refused({"big.svg", "--machine", "cameo3", "--dialect", "hpgl"}, 2, "speaks gpgl");
  bench.refused({"none.svg"}, 3, "none.svg");
  write_file(bench.temp / "wrong.fold", "{\"vertices_coords\": [[0,0],[1]]}");
  bench.refused({"wrong.fold"}, 3, "wrong.fold: /vertices_coords/1");
  CHECK_FALSE(std::filesystem::exists(bench.temp / "sheets"));
}

TEST_CASE("the tables are listed for people and programs", "[cli][e2e][plan]") {
  const Bench bench;
  const Ran machines = bench.popcut({"machines"});
  CHECK(machines.exit == 0);
  CHECK(machines.out.find("cameo3 ") == 0);
  CHECK(json::parse(bench.popcut({"machines", "--json"}).out)["machines"].size() ==
        static_cast<std::size_t>(std::count(machines.out.begin(), machines.out.end(), '\n')));
  const json materials = json::parse(bench.popcut({"materials", "--json"}).out);
  CHECK(materials["materials"][0]["dashes"]["dash_mm"] == 1.5);
}

}  // namespace plan_command_test
