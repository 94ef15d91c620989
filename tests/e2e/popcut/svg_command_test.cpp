// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace svg_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

const std::string kDrawing =
    "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>"
    "<path fill='none' stroke='#c00' d='M10 10H60'/><circle cx='50' cy='50' r='20' fill='none' "
    "stroke='#00f'/></svg>";

// popcut plan with settings of the environment; the folder's own config/ is the user's.
Ran plan(const TempFolder& temp, const std::string& setting, std::vector<std::string> arguments) {
  std::vector<std::string> all{"/usr/bin/env", "XDG_CONFIG_HOME=" + (temp / "config").string(),
                               setting, popcut_program(), "plan"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"-o", "sheets", "--json", "-q"});
  return run_program(all, temp.path(), {.memory_bytes = 2l << 30});
}

}  // namespace

TEST_CASE("units are for files that may not name theirs", "[cli][e2e]") {
  const CommandBench bench;
  write_file(bench.temp / "a.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'/>");
  check_refused(bench.popcut({"plan", "a.svg", "--units", "in", "-o", "o"}), 2,
                "--units: is for DXF and FOLD files; for an SVG use --svg-dpi");
  write_file(bench.temp / "a.fold",
             R"({"vertices_coords":[[0,0],[1,0],[1,2]],"edges_vertices":[[0,1],[1,2]],)"
             R"("edges_assignment":["C","V"]})");
  const Ran ran = bench.popcut({"plan", "a.fold", "--units", "in", "-o", "o", "-q"});
  CHECK(ran.exit == 0);
  CHECK(bench.read_json("o/plan.json")["sheets"][0]["cut_mm"].get<double>() == Approx(25.4));
  const Ran held = bench.popcut(
      {"simulate", "o/sheet-01.gpgl", "-o", "sim", "--expect", "a.fold", "--plan", "o/plan.json"});
  INFO(held.err);
  CHECK(held.exit == 0);
}

TEST_CASE("a profile in the user's folder says what colours mean", "[cli][e2e][svg]") {
  const TempFolder temp;
  write_file(temp / "a.svg", kDrawing);
  std::filesystem::create_directories(temp / "config/popcut");
  const auto profile = temp / "config/popcut/svg_profiles.json";
  write_file(
      profile,
      R"j({"popcut": 1, "svg_profiles": [{"name": "ours", "like": "plain", "colours": "nearest",
    "rules": [{"colour": "red", "use": "fold-valley"}, {"colour": "blue", "use": "cut"}]}]})j");
  const Ran ran = plan(temp, "A=", {"a.svg", "--svg-profile", "ours"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const json sheet = json::parse(ran.out)["sheets"][0];
  CHECK(sheet["fold_line_mm"].get<double>() == Approx(50));
  check_refused(plan(temp, "A=", {"a.svg", "--svg-profile", "outs"}), 2, "did you mean ours");
  write_file(profile,
             R"j({"popcut": 1, "svg_profiles": [{"name": "ours", "otherwise": "burn"}]})j");
  check_refused(plan(temp, "A=", {"a.svg"}), 3, "svg_profiles.json: /svg_profiles/0/otherwise");
}

TEST_CASE("the tolerance of curves and the size of a unit can be set", "[cli][e2e][svg]") {
  const TempFolder temp;
  write_file(temp / "a.svg", kDrawing);
  const auto bytes = [&](std::vector<std::string> options) {
    options.insert(options.begin(), "a.svg");
    REQUIRE(plan(temp, "A=", options).exit == 0);
    return std::filesystem::file_size(temp / "sheets/sheet-01.gpgl");
  };
  CHECK(bytes({"--svg-profile", "popcut", "--curve-tolerance", "0.5"}) <
        bytes({"--svg-profile", "popcut", "--curve-tolerance", "0.01"}));
  check_refused(plan(temp, "A=", {"a.svg", "--curve-tolerance", "0"}), 2, "--curve-tolerance");
  check_refused(plan(temp, "A=", {"a.svg", "--svg-dpi", "0"}), 2, "--svg-dpi");
}

TEST_CASE("a drawing over a limit is refused before it is parsed and the limits can be raised",
          "[cli][e2e][svg]") {
  const TempFolder temp;
  // 2^40 paths by two uses of two uses of ...
  std::string bomb = "<svg xmlns='http://www.w3.org/2000/svg'><g id='g0'><path d='M0 0h1'/></g>";
  for (int i = 1; i <= 40; ++i) {
    const std::string use = "<use href='#g" + std::to_string(i - 1) + "'/>";
    bomb += "<g id='g" + std::to_string(i) + "'>" + use + use + "</g>";
  }
  write_file(temp / "bomb.svg", bomb + "</svg>");
  check_refused(plan(temp, "A=", {"bomb.svg"}), 3, "or set POPCUT_RAISE_LIMITS=4");
  write_file(temp / "huge.svg", "");
  std::filesystem::resize_file(temp / "huge.svg", 300'000'000);  // no disk is taken
  check_refused(plan(temp, "A=", {"huge.svg"}), 3, "huge.svg: is larger than 100000000 bytes");
  check_refused(plan(temp, "POPCUT_RAISE_LIMITS=4", {"huge.svg"}), 3, "byte 1 is zero");
  for (const char* name : {"huge.dxf", "huge.fold", "huge.json", "huge"}) {
    std::filesystem::copy_file(temp / "huge.svg", temp / name);
    std::filesystem::resize_file(temp / name, 300'000'000);
    check_refused(plan(temp, "A=", {name}), 3, "is larger than 268435456 bytes");
    CHECK(plan(temp, "POPCUT_RAISE_LIMITS=4", {name}).err.find("is larger than") ==
          std::string::npos);
  }
  check_refused(plan(temp, "POPCUT_RAISE_LIMITS=x", {"huge.svg"}), 2, "POPCUT_RAISE_LIMITS: is");
}

TEST_CASE("sheets for other programs are as large as the mat and every dash is a path",
          "[cli][e2e][svg]") {
  const TempFolder temp;
  write_file(temp / "a.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' "
             "viewBox='0 0 100 80' fill='none' stroke='#000'>"
             "<path data-assignment='B' d='M0 0H100V80H0Z'/><path data-assignment='C' "
             "d='M20 20V60'/><path data-assignment='M' d='M20 30H80'/><path data-assignment='V' "
             "d='M20 50H80'/></svg>");
  struct Expected {
    const char *profile, *size, *outline, *mountain, *valley;
  };
  const Expected all[] = {
      {"cricut", "width=\"11.5in\" height=\"11.5in\"", "", "", ""},
      {"lightburn", "width=\"304.8mm\" height=\"304.8mm\"", "stroke=\"#000000\"",
       "stroke=\"#ff0000\"", "stroke=\"#0000ff\""},
      {"origami-sim", "viewBox=\"0 0 ", "stroke=\"#000000\"", "stroke=\"#ff0000\"",
       "stroke=\"#0000ff\""},
  };
  for (const Expected& expected : all) {
    CAPTURE(expected.profile);
    const Ran ran = plan(temp, "A=", {"a.svg", "--svg-profile", expected.profile});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    const json sheet = json::parse(ran.out)["sheets"][0];
    const std::string text =
        text_of_file(temp / (std::string("sheets/sheet-01-") + expected.profile + ".svg"));
    const auto count = [&](const std::string& part) {
      std::size_t found = 0;
      for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++found;
      return found;
    };
    CHECK(count(expected.size) == 1);
    CHECK(count("stroke-dasharray") == 0);
    const bool whole = std::string(expected.profile) == "origami-sim";
    if (whole)
      CHECK(count("<line ") == 4 + 1 + 2);  // there folds stay lines
    else
      CHECK(count("<path ") == sheet["lifts"].get<std::size_t>());
    for (const char* colour : {expected.outline, expected.mountain, expected.valley})
      if (*colour != '\0') CHECK(count(colour) >= 1);
    // It reads back to the same lengths.
    const Ran again = plan(temp, "A=",
                           {"sheets/sheet-01-" + std::string(expected.profile) + ".svg",
                            "--svg-profile", expected.profile});
    CAPTURE(again.err);
    CHECK(again.exit == 0);
  }
}

TEST_CASE("a DXF drawing is planned and its sheet is what the program cuts", "[cli][e2e][dxf]") {
  const TempFolder temp;
  std::string dxf =
      "  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n 70\n4\n  0\nENDSEC\n"
      "  0\nSECTION\n  2\nENTITIES\n";
  const auto line = [&](const char* layer, const char* ends) {
    dxf += std::string("  0\nLINE\n  8\n") + layer + "\n" + ends;
  };
  line("CUT", " 10\n0\n 20\n0\n 11\n60\n 21\n0\n");
  line("CUT", " 10\n60\n 20\n0\n 11\n60\n 21\n40\n");
  line("CUT", " 10\n60\n 20\n40\n 11\n0\n 21\n0\n");
  line("FOLD_V", " 10\n30\n 20\n5\n 11\n50\n 21\n5\n");
  write_file(temp / "a.dxf", dxf +
                                 "  0\nCIRCLE\n  8\nCUT\n 10\n50\n 20\n15\n 40\n4\n"
                                 "  0\nENDSEC\n  0\nEOF\n");
  for (const char* machine : {"cameo3", "hpgl-generic"}) {
    CAPTURE(machine);
    const Ran ran = plan(temp, "A=", {"a.dxf", "--machine", machine});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    const json sheet = json::parse(ran.out)["sheets"][0];
    CHECK(sheet["fold_line_mm"].get<double>() == Approx(20.0));
    CHECK(sheet["paths"].get<int>() == 3);
    CHECK(sheet["cut_mm"].get<double>() > 172.0);
    const char* program = machine == std::string("cameo3") ? "sheet-01.gpgl" : "sheet-01.hpgl";
    for (const std::vector<std::string>& expect :
         {std::vector<std::string>{"sheets/sheet-01.svg"},
          std::vector<std::string>{"a.dxf", "--plan", "sheets/plan.json"}}) {
      std::vector<std::string> all{
          popcut_program(), "simulate", "sheets/" + std::string(program), "-o", "cut", "--machine",
          machine,          "--expect"};
      all.insert(all.end(), expect.begin(), expect.end());
      const Ran held = run_program(all, temp.path());
      CAPTURE(held.err);
      CHECK(held.exit == 0);
    }
  }
}

namespace {

// A card of 100 x 80 mm with one box, in the colours of Origami Simulator and without names.
const std::string kCard =
    "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' viewBox='0 0 100 80' "
    "fill='none'><rect width='100' height='80' stroke='black'/>"
    "<path d='M0 40H30M70 40H100M30 20H70M30 60H70' stroke='blue'/>"
    "<path d='M30 20V60M70 20V60' stroke='#0f0'/><path d='M30 40H70' stroke='red'/></svg>";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

json verified(const TempFolder& temp, const std::string& file,
              const std::vector<std::string>& options = {}) {
  std::vector<std::string> all{popcut_program(), "verify", file, "--json"};
  all.insert(all.end(), options.begin(), options.end());
  const Ran ran = run_program(all, temp.path(), {.memory_bytes = 2l << 30});
  CAPTURE(ran.err);
  REQUIRE((ran.exit == 0 || ran.exit == 6));
  return json::parse(ran.out);
}

}  // namespace

TEST_CASE("several colours without names are not cut before somebody says what they mean",
          "[cli][e2e][svg][reading]") {
  const TempFolder temp;
  write_file(temp / "card.svg", kCard);
  const Ran asked = plan(temp, "A=", {"card.svg"});
  check_refused(asked, 3, "4 colours (#000000, #0000ff, #00ff00, #ff0000)");
  CHECK(asked.err.find("card.svg: line 1") != std::string::npos);
  CHECK(asked.err.find("--svg-profile origami-sim") != std::string::npos);
  CHECK(asked.err.find("--svg-profile popcut") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(temp / "sheets"));
  // Both ways that it names work, and mean what it says.
  const Ran folded = plan(temp, "A=", {"card.svg", "--svg-profile", "origami-sim"});
  REQUIRE(folded.exit == 0);
  CHECK(json::parse(folded.out)["sheets"][0]["fold_line_mm"].get<double>() == Approx(180));
  const Ran cut = plan(temp, "A=", {"card.svg", "--svg-profile", "popcut"});
  REQUIRE(cut.exit == 0);
  CHECK(json::parse(cut.out)["sheets"][0]["fold_line_mm"].get<double>() == 0.0);
  CHECK(asked.err.find("--colors such as \"#") != std::string::npos);
  const Ran said = plan(temp, "A=", {"card.svg", "--colors", "blue=valley; #0f0=cut; red=ignore"});
  REQUIRE(said.exit == 0);
  const json of_colours = json::parse(said.out);
  CHECK(of_colours["sheets"][0]["fold_line_mm"].get<double>() > 0.0);
  CHECK(of_colours["colors"] == "blue=valley; #0f0=cut; red=ignore");
  // A name for all but one colour is enough.
  const std::string layers =
      replaced(replaced(kCard, "stroke='blue'", "stroke='blue' data-assignment='V'"),
               "stroke='red'", "stroke='red' data-assignment='M'");
  write_file(temp / "named.svg", replaced(layers, "#0f0", "black"));
  CHECK(plan(temp, "A=", {"named.svg"}).exit == 0);
  // Dashes say what to do with a line whatever its colour.
  write_file(temp / "dashes.svg",
             replaced(replaced(kCard, "'blue'", "'blue' stroke-dasharray='2 1'"), "'red'",
                      "'red' stroke-dasharray='3 1'"));
  check_refused(plan(temp, "A=", {"dashes.svg"}), 3, "2 colours (#000000, #00ff00)");
  write_file(temp / "half.svg", layers);
  check_refused(plan(temp, "A=", {"half.svg"}), 3, "2 colours (#000000, #00ff00)");
}

TEST_CASE("plan, verify and simulate read a drawing in one way", "[cli][e2e][svg][reading]") {
  const TempFolder temp;
  write_file(temp / "card.svg", kCard);
  // Colours: verify says how it reads them, and plan reads them so when told.
  const json coloured = verified(temp, "card.svg");
  CHECK(coloured.dump().find("--svg-profile origami-sim") != std::string::npos);
  const Ran planned = plan(temp, "A=", {"card.svg", "--svg-profile", "origami-sim"});
  REQUIRE(planned.exit == 0);
  const auto expected = [&](const std::string& file) {
    return run_program({popcut_program(), "simulate", "sheets/sheet-01.gpgl", "-o", "cut",
                        "--expect", file, "--plan", "sheets/plan.json", "-q"},
                       temp.path(), {.memory_bytes = 2l << 30});
  };
  const Ran same = expected("card.svg");
  CAPTURE(same.err);
  CHECK(same.exit == 0);  // plan.json says how the drawing was read
  // The same drawing with names, and with one colour.
  std::string named = kCard;
  for (const auto& [colour, letter] : std::vector<std::pair<std::string, std::string>>{
           {"'black'", "B"}, {"'blue'", "V"}, {"'#0f0'", "C"}, {"'red'", "M"}})
    named = replaced(named, "stroke=" + colour, "stroke='#123' data-assignment='" + letter + "'");
  write_file(temp / "named.svg", named);
  for (const char* profile : {"auto", "popcut", "origami-sim"}) {
    CAPTURE(profile);
    const json by_name = verified(temp, "named.svg", {"--svg-profile", profile});
    CHECK(by_name["ok"] == coloured["ok"]);
    CHECK(by_name["hinges"] == coloured["hinges"]);
    const Ran again = plan(temp, "A=", {"named.svg", "--svg-profile", profile});
    REQUIRE(again.exit == 0);
    CHECK(json::parse(again.out)["sheets"][0]["fold_line_mm"].get<double>() == Approx(180));
    CHECK(expected("named.svg").exit == 0);
  }
  for (const char* colour : {"black", "red", "blue"}) {
    CAPTURE(colour);
    std::string one = kCard;
    for (const char* other : {"black", "blue", "#0f0", "red"})
      one = replaced(one, std::string("stroke='") + other + "'",
                     std::string("stroke='") + colour + "'");
    write_file(temp / "one.svg", one);
    const Ran cut = plan(temp, "A=", {"one.svg"});
    REQUIRE(cut.exit == 0);
    CHECK(json::parse(cut.out)["sheets"][0]["fold_line_mm"].get<double>() == 0.0);
    CHECK(verified(temp, "one.svg")["hinges"] == 0);
  }
}

}  // namespace svg_command_test
