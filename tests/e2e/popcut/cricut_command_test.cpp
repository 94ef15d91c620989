// SPDX-License-Identifier: MIT
// Machines that popcut does not drive: Cricut through Design Space, and a person with a knife.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace cricut_command_test {

using namespace popcut;
using namespace popcut::testing;
using nlohmann::json;

namespace {

// A heart of 86 x 78 mm whose middle pops up, with a line for the pen.
const std::string kHeart =
    "<svg xmlns='http://www.w3.org/2000/svg' width='90mm' height='80mm' viewBox='0 0 90 80' "
    "fill='none' stroke='black'>"
    "<path data-assignment='B' d='M45 78C10 52 2 38 2 24A21 21 0 0 1 45 18A21 21 0 0 1 88 24"
    "C88 38 80 52 45 78Z'/><path data-assignment='V' d='M45 18V34M45 60V78'/>"
    "<path data-assignment='M' d='M45 34V60'/><path data-assignment='C' d='M33 34H57M33 60H57'/>"
    "<path data-assignment='draw' d='M20 24H28'/></svg>";

struct Bench : CommandBench {
  json planned(const std::string& file, std::vector<std::string> options) const {
    options.insert(options.begin(), {"plan", file, "-o", "sheets", "--json"});
    const Ran ran = popcut(options);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    said = ran.err;
    return json::parse(ran.out);
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return text_of_file(temp / ("sheets/" + name));
  }
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(temp / "sheets"))
      names.insert(entry.path().filename());
    return names;
  }
  mutable std::string said;
};

struct Groups {
  std::vector<std::string> names, colours;
  std::vector<std::vector<std::string>> paths;
};

Groups groups_of(const std::string& svg) {
  pugi::xml_document document;
  REQUIRE(document.load_string(svg.c_str()));
  Groups groups;
  for (const auto& group : document.child("svg").children("g")) {
    groups.names.emplace_back(group.attribute("id").value());
    groups.colours.emplace_back(group.attribute("stroke").value());
    groups.paths.emplace_back();
    for (const auto& path : group.children("path"))
      groups.paths.back().emplace_back(path.attribute("d").value());
  }
  return groups;
}

std::size_t count(const std::string& text, char letter) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), letter));
}

}  // namespace

TEST_CASE("a plan for a Cricut is one drawing with the operations of Design Space",
          "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  const json plan = bench.planned("heart.svg", {"--machine", "cricut-maker"});
  CHECK(bench.files() == std::set<std::string>{"assembly.svg", "manifest.json", "plan.json",
                                               "sheet-01-cricut.svg", "sheet-01.svg"});
  const std::string svg = bench.file("sheet-01-cricut.svg");
  // Inches and points say the same size.
  CHECK(svg.find("width=\"11.5in\" height=\"11.5in\" viewBox=\"0 0 828 828\"") !=
        std::string::npos);
  CHECK(svg.find("dasharray") == std::string::npos);
  const Groups groups = groups_of(svg);
  CHECK(groups.names == std::vector<std::string>{"draw", "score", "cut"});
  CHECK(std::set<std::string>(groups.colours.begin(), groups.colours.end()).size() == 3);
  // One layer to set to Score: the whole folds of both sides, and nothing else.
  REQUIRE(groups.paths.size() == 3);
  REQUIRE(groups.paths[0].size() == 1);
  REQUIRE(groups.paths[1].size() == 1);
  CHECK(count(groups.paths[1][0], 'M') == 3);
  // Two cuts, and the outline as one closed path that comes last.
  REQUIRE(groups.paths[2].size() == 3);
  CHECK(count(groups.paths[2][2], 'M') == 1);
  CHECK(groups.paths[2][2].back() == 'Z');
  // The drawing has its size, and no line is there twice.
  const auto back = value(linework_from_svg(svg, SvgProfile::Popcut));
  CHECK(bounds(back).width() == Approx(86.39).margin(0.02));
  double cut_mm = 0.0;
  for (const DrawnLine& line : back.lines)
    if (is_cut(line.operation)) cut_mm += length(back.points_of(line));
  const json& sheet = plan["sheets"][0];
  CHECK(sheet["cut_mm"].get<double>() == Approx(cut_mm).margin(0.01));
  CHECK(sheet["fold_mm"] == sheet["fold_line_mm"]);
  CHECK(sheet["seconds"].is_null());
  CHECK(sheet["overcut_mm"] == 0.0);
  CHECK(sheet["blade_offset_mm"] == 0.0);
  // What to do next, with the size that Design Space must show.
  CHECK(bench.said.find("86.4 x 78.7 mm (3.401 x 3.099 in)") != std::string::npos);
  CHECK(bench.said.find("sheets/sheet-01-cricut.svg") != std::string::npos);
  CHECK(bench.said.find("red layer to Score") != std::string::npos);
  CHECK(bench.said.find("green layer to Pen") != std::string::npos);
  CHECK(bench.said.find("Attach") != std::string::npos);
}

TEST_CASE("a Cricut without a stylus cuts folds as dashes, and so does one that is told to",
          "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--machine", "cricut-joy"},
        std::vector<std::string>{"--machine", "cricut-explore", "--folds", "perforate"}}) {
    CAPTURE(options);
    const json plan = bench.planned("heart.svg", options);
    const Groups groups = groups_of(bench.file("sheet-01-cricut.svg"));
    CHECK(groups.names == std::vector<std::string>{"draw", "cut"});
    REQUIRE(groups.paths.back().size() > 20);
    for (const std::string& path : groups.paths.back()) CHECK(count(path, 'M') == 1);
    CHECK(plan["sheets"][0]["fold_mm"].get<double>() < 50);
    CHECK(bench.said.find("Score") == std::string::npos);
  }
  const json scored = bench.planned("heart.svg", {"--machine", "cricut-joy", "--folds", "score"});
  CHECK(groups_of(bench.file("sheet-01-cricut.svg")).names[1] == "score");
  check_refused(bench.popcut({"plan", "heart.svg", "-o", "s", "--machine", "cricut-maker",
                              "--folds", "light"}),
                3, "use --folds score or perforate");
  check_refused(
      bench.popcut({"plan", "heart.svg", "-o", "s", "--machine", "cricut-maker", "--marks"}), 2,
      "--marks");
  check_refused(
      bench.popcut({"plan", "heart.svg", "-o", "s", "--machine", "cricut-maker", "--overcut", "2"}),
      2, "--overcut: goes into a program");
  check_refused(
      bench.popcut({"plan", "heart.svg", "-o", "s", "--machine", "none", "--dialect", "gpgl"}), 2,
      "leave --dialect out");
}

TEST_CASE("a design that is too large for a Cricut's mat is split for it", "[cli][e2e][cricut]") {
  const Bench bench;
  const json plan =
      bench.planned(source_file("examples/sphere.json"), {"--machine", "cricut-joy-xtra"});
  REQUIRE(plan["sheets"].size() >= 1);
  const json wide = bench.planned(source_file("examples/facade.json"), {"--machine", "cricut-joy"});
  REQUIRE(wide["sheets"].size() > 1);
  for (std::size_t i = 1; i <= wide["sheets"].size(); ++i) {
    const auto svg = value(linework_from_svg(
        bench.file((i < 10 ? "sheet-0" : "sheet-") + std::to_string(i) + "-cricut.svg"),
        SvgProfile::Popcut));
    CHECK(bounds(svg).width() <= 107.95);
    CHECK(bounds(svg).height() <= 158.75);
  }
}

TEST_CASE("a material that is cut twice is on another program's sheet once", "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  const json one = bench.planned("heart.svg", {"--machine", "cricut-maker"});
  const json all = json::parse(bench.popcut({"materials", "--json"}).out);
  for (const json& material : all["materials"]) {
    if (material["cut"]["passes"] == 1) continue;
    const std::string name = material["name"];
    CAPTURE(name);
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--material", name, "--machine", "cricut-maker"},
          std::vector<std::string>{"--material", name, "--svg-profile", "cricut"}}) {
      bench.planned("heart.svg", options);
      const auto svg =
          value(linework_from_svg(bench.file("sheet-01-cricut.svg"), SvgProfile::Popcut));
      double cut_mm = 0.0;
      for (const DrawnLine& line : svg.lines)
        if (line.operation == Operation::Cut && line.count > 6)
          cut_mm += length(svg.points_of(line));
      CHECK(cut_mm == Approx(one["sheets"][0]["cut_mm"].get<double>() - 48).margin(0.5));
    }
  }
}

TEST_CASE("a sheet whose folds are whole lines is planned again as folds and not cut through",
          "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  const double dashes = bench.planned("heart.svg", {})["sheets"][0]["fold_mm"];
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--machine", "none"},
        std::vector<std::string>{"--machine", "cricut-maker"},
        std::vector<std::string>{"--folds", "score"},
        std::vector<std::string>{"--folds", "perforate"}}) {
    CAPTURE(options);
    bench.planned("heart.svg", options);
    std::filesystem::copy_file(bench.temp / "sheets/sheet-01.svg", bench.temp / "again.svg",
                               std::filesystem::copy_options::overwrite_existing);
    if (options[0] == "--folds") {
      const Ran held = bench.popcut({"simulate", "sheets/sheet-01.gpgl", "-o", "cut", "--expect",
                                     "sheets/sheet-01.svg", "-q"});
      CAPTURE(held.err);
      CHECK(held.exit == 0);
    }
    const json again = bench.planned("again.svg", {})["sheets"][0];
    CHECK(again["fold_mm"].get<double>() == Approx(dashes).margin(0.01));
    CHECK(again["cut_mm"].get<double>() > 300);
  }
}

TEST_CASE("folds are never cut through because a machine lacks a tool or its force",
          "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  const auto refused = [&](const std::string& machine, const std::string& folds) {
    const Ran ran = bench.popcut(
        {"plan", "heart.svg", "--machine", machine, "--folds", folds, "-o", "refused"});
    CAPTURE(machine, folds, ran.err);
    CHECK(ran.exit != 0);
    CHECK(ran.err.find("would cut the folds through") != std::string::npos);
    CHECK(ran.err.find("--folds perforate") != std::string::npos);
    CHECK(!std::filesystem::exists(bench.temp / "refused"));
  };
  for (const char* machine : {"hpgl-generic", "hpgl-clone", "hpgl-ud", "mh-721", "camm-1"}) {
    refused(machine, "light");
    refused(machine, "score");
  }
  refused("cameo", "score");
  bench.planned("heart.svg", {"--machine", "cameo", "--folds", "light"});
  bench.planned("heart.svg", {"--machine", "cameo3", "--folds", "score"});
}

TEST_CASE("lines that are scored are named in the steps for a Cricut, also if no fold is",
          "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  bench.planned("heart.svg", {"--machine", "cricut-maker"});
  std::filesystem::copy_file(bench.temp / "sheets/sheet-01-cricut.svg", bench.temp / "again.svg");
  for (const char* file : {"heart.svg", "again.svg"}) {
    const Ran ran = bench.popcut({"plan", file, "--machine", "cricut-maker", "-o", "told"});
    CAPTURE(file, ran.err);
    CHECK(ran.exit == 0);
    CHECK(ran.err.find("set the red layer to Score") != std::string::npos);
  }
}

TEST_CASE("a fold that is also a cut, or has no name where others have one, is told before the cut",
          "[cli][e2e][reading]") {
  const Bench bench;
  const auto warnings = [&](const std::string& shapes) {
    write_file(bench.temp / "d.svg",
               "<svg xmlns='http://www.w3.org/2000/svg' "
               "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' width='100mm' "
               "height='80mm' viewBox='0 0 100 80' fill='none' stroke='black'>" +
                   shapes + "</svg>");
    return bench.planned("d.svg", {})["warnings"].dump();
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const std::string card = "<path data-assignment='B' d='M5 5H95V75H5Z'/>";
  const std::string fold = "<path data-assignment='M' stroke='red' d='M20 40H80'/>";
  CHECK(warnings(card + fold) == "[]");
  CHECK(has(warnings(card + fold + "<path data-assignment='C' d='M5 40H95'/>"),
            "1 place is both fold and cut"));
  CHECK(warnings(card + fold + "<path data-assignment='C' d='M20 10V70'/>") == "[]");
  CHECK(has(warnings(card + "<path stroke='red' d='M20 40H80'/>"),
            "the #ff0000 strokes have none that popcut knows"));
  CHECK(warnings(card + fold + "<path d='M20 50H80'/>") == "[]");
  CHECK(warnings(fold + "<path d='M5 5H95V75H5Z'/>") == "[]");
  CHECK(has(warnings(fold + "<path stroke='red' d='M5 5H95V75H5Z'/>"),
            "the #ff0000 strokes have none that popcut knows"));
}

TEST_CASE("nothing of popcut moves a machine that popcut does not drive", "[cli][e2e][cricut]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  for (const std::string machine : {"cricut-maker", "none"}) {
    CAPTURE(machine);
    check_refused(bench.popcut({"cut", "heart.svg", "--direct", "--device", "sim:" + machine}), 2,
                  "popcut plan FILE -o sheets --machine " + machine);
    CHECK(bench.popcut({"doctor", "--treat-as", machine}).exit == 2);
    const Ran listed = bench.popcut({"devices"});
    CHECK(listed.out.find("sim:" + machine) == std::string::npos);
    CHECK(bench.popcut({"machines"}).out.find(machine) != std::string::npos);
    bench.planned("heart.svg", {"--machine", machine});
    CHECK_FALSE(std::filesystem::exists(bench.temp / "sheets/sheet-01.gpgl"));
  }
  bench.planned("heart.svg", {});
  CHECK(std::filesystem::exists(bench.temp / "sheets/sheet-01.gpgl"));
  check_refused(
      bench.popcut({"simulate", "sheets/sheet-01.gpgl", "-o", "cut", "--machine", "none"}), 2,
      "takes no programs");
}

TEST_CASE("one plan is written for Silhouette Studio, lasers and Design Space",
          "[cli][e2e][formats]") {
  const Bench bench;
  write_file(bench.temp / "heart.svg", kHeart);
  const json plan = bench.planned("heart.svg", {"--formats", "dxf,laser,cricut", "--overcut", "0"});
  CHECK(bench.files() == std::set<std::string>{"manifest.json", "plan.json", "sheet-01-cricut.svg",
                                               "sheet-01-lightburn.svg", "sheet-01.dxf"});
  CHECK_THAT(bench.said, Catch::Contains("86.4 x 78.7 mm"));
  const auto sheet = value(linework_from_dxf(bench.file("sheet-01.dxf")));
  double cut = 0.0, folds = 0.0;
  bool cutting = false;
  for (const DrawnLine& line : sheet.lines) {
    const double mm = length(sheet.points_of(line));
    if (is_cut(line.operation)) {
      cutting = true;
      cut += mm;
    } else if (is_fold(line.operation)) {
      CHECK_FALSE(cutting);  // folds first
      CHECK(mm < 2.0);       // dashes
      folds += mm;
    }
  }
  const json& row = plan["sheets"][0];
  CHECK(folds == Approx(row["fold_mm"].get<double>()).epsilon(1e-6));
  CHECK(cut == Approx(row["cut_mm"].get<double>()).epsilon(1e-5));
}

}  // namespace cricut_command_test
