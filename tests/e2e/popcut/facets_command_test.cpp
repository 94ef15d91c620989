// SPDX-License-Identifier: MIT
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/outline/text_outline.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace facets_command_test {

using namespace popcut::testing;
using nlohmann::json;
namespace fs = std::filesystem;

struct Bench : CommandBench {
  Ran design(const json& spec, const std::string& formats = "fold,report") const {
    write("spec.json", spec);
    return popcut({"design", "spec.json", "-o", "out", "--formats", formats});
  }
  [[nodiscard]] json report() const { return json::parse(text_of_file(temp / "out/report.json")); }
};

json house() {
  return {
      {"popcut", 1}, {"style", "facets"}, {"surface", {{"type", "mesh"}, {"file", "house.obj"}}}};
}

/// A house against the wall, its gable in front.
std::string house_obj() {
  return "v 40 10 0\nv 40 60 0\nv 40 60 40\nv 40 10 40\nv 40 35 65\n"
         "v 0 10 40\nv 0 35 65\nv 0 60 40\n"
         "f 1 2 3 4\nf 4 3 5\nf 6 4 5 7\nf 8 7 5 3\n";
}

TEST_CASE("the example of facets is designed, drawn, planned and verified with one freedom",
          "[cli][e2e][facets]") {
  const Bench bench;
  const std::string spec = source_file("examples/village.json");
  const Ran ran =
      bench.popcut({"design", spec, "-o", "out", "--formats",
                    "fold,svg,cut,dxf,csv,glb,png,poster,report,stl,pdf", "--frames", "3"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK_THAT(ran.err, Catch::Contains("opens in one movement"));
  for (const char* file : {"pattern.fold", "pattern.svg", "cut.svg", "pattern.dxf", "segments.csv",
                           "deploy.glb", "deployed.png", "poster.svg", "pattern.pdf"})
    CHECK(fs::file_size(bench.temp / "out" / file) > 100);
  const json report = bench.report();
  CHECK(report["style"] == "facets");
  CHECK(report["degrees_of_freedom"] == 1);
  CHECK(report["pieces"] == 1);
  CHECK(report["facets"]["patches"] == report["faces"]);
  CHECK(report["facets"]["depth_mm"]["mean"] < 0.6);
  CHECK(report["facets"]["over_least"] >= 1.0);
  CHECK_FALSE(report.contains("inner_error_mm"));
  const Ran verified = bench.popcut({"verify", "out/pattern.fold", "--dof", "1", "--json"});
  INFO(verified.out);
  REQUIRE(verified.exit == 0);
  CHECK(json::parse(verified.out)["faces"] == report["faces"]);
  const Ran planned = bench.popcut({"plan", spec, "-o", "plan"});
  INFO(planned.err);
  CHECK(planned.exit == 0);
}

TEST_CASE("a house looks like a house: its roof and its gable are where they were",
          "[cli][e2e][facets]") {
  const Bench bench;
  write_file(bench.temp / "house.obj", house_obj());
  const Ran ran = bench.design(house());
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json report = bench.report();
  CHECK(report["facets"]["depth_mm"]["mean"] < 0.6);
  CHECK(report["facets"]["dropped"] == 0);
  CHECK(bench.popcut({"verify", "out/pattern.fold", "--dof", "1"}).exit == 0);
}

TEST_CASE("the cottage of the examples has a sloped roof that opens, prints and is folded",
          "[cli][e2e][facets]") {
  const Bench bench;
  const std::string spec = source_file("examples/cottage.json");
  const Ran ran =
      bench.popcut({"design", spec, "-o", "out", "--formats", "fold,picture,glb,report"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json report = bench.report();
  CHECK(report["faces"] == 6);
  CHECK(report["wobble"]["loose_panels"] == 0);
  CHECK(bench.popcut({"verify", "out/pattern.fold", "--dof", "1"}).exit == 0);
  // The file alone says how it moves.
  CHECK(bench
            .popcut(
                {"deploy", "out/pattern.fold", "-o", "poses", "--frames", "2", "--to-psi", "20deg"})
            .exit == 0);
  CHECK(bench.popcut({"fold-guide", spec, "-o", "guide"}).exit == 0);
}

TEST_CASE("a roof that is too long for a sloped panel is refused with what would work",
          "[cli][e2e][facets]") {
  const Bench bench;
  std::string spec = text_of_file(source_file("examples/cottage.json"));
  const std::string gentle = "0.55 * abs(x - 35) - 43.75", steep = "1.1 * abs(x - 35) - 57.5";
  spec.replace(spec.find(gentle), gentle.size(), steep);
  write_file(bench.temp / "steep.json", spec);
  const Ran ran = bench.popcut({"design", "steep.json", "-o", "out"});
  CHECK(ran.exit == 4);
  CHECK_THAT(ran.err, Catch::Contains("/facets/sloped") && Catch::Contains("must be at most") &&
                          Catch::Contains("away from the wall"));
}

TEST_CASE(
    "a house has a glued roof that holds, is checked, planned, printed and shown step by step",
    "[cli][e2e][facets]") {
  const Bench bench;
  json spec = json::parse(text_of_file(source_file("docs/facets/chalet.json")));
  bench.write("chalet.json", spec);
  const Ran ran = bench.popcut({"design", "chalet.json", "-o", "out"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK_THAT(ran.err, Catch::Contains("1 glued roof on a card that opens to 90 degrees"));
  const json report = bench.report();
  CHECK(report["panels"] == 6);
  CHECK(report["tabs"] == 3);
  CHECK(report["wobble_mm"].get<double>() <= 1.0);
  CHECK(report["wobble_mm"].get<double>() > 0.1);
  REQUIRE(report["tents"].size() == 1);
  const Ran checked = bench.popcut({"verify", "out/pattern.fold", "--dof", "1", "--json"});
  REQUIRE(checked.exit == 0);
  const json verified = json::parse(checked.out);
  CHECK(verified["degrees_of_freedom"] == 1);
  CHECK(verified["wobble_mm"].get<double>() ==
        Approx(report["wobble_mm"].get<double>()).epsilon(1e-6));
  CHECK(verified["opening_deg"][1] == 90.0);
  CHECK(bench.popcut({"plan", "out/pattern.fold", "-o", "sheets"}).exit == 0);
  CHECK(bench.popcut({"print", "chalet.json", "-o", "pages", "--dpi", "72"}).exit == 0);
  REQUIRE(bench.popcut({"fold-guide", "chalet.json", "-o", "guide"}).exit == 0);
  CHECK(bench.read_json("guide/fold-guide.json")["tabs"].size() == 3);
  // Its sheet says which of its panels are pages; the longest of its folds need not be the spine.
  json file = bench.read_json("out/pattern.fold");
  const json pages = file["popcut:pages"];
  const int level = 2;  // after both pages, from the wall on: it has no fold with the ground
  for (const auto& [wrong, why] :
       {std::pair(json{0, 0}, "two different faces"), std::pair(json{0, 99}, "two different faces"),
        std::pair(json{pages[1], level}, "spine")}) {
    file["popcut:pages"] = wrong;
    bench.write("wrong.fold", file);
    const Ran refused = bench.popcut({"verify", "wrong.fold"});
    CAPTURE(wrong.dump());
    CHECK(refused.exit != 0);
    CHECK_THAT(refused.err, Catch::Contains("/popcut:pages") && Catch::Contains(why));
  }
}

TEST_CASE("the cat of the examples is easy to fold, holds in paper and opens in one movement",
          "[cli][e2e][facets]") {
  const Bench bench;
  const Ran ran = bench.popcut(
      {"design", source_file("examples/cat.json"), "-o", "out", "--formats", "fold,report"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const json report = bench.report();
  CHECK(report["handwork"]["label"] == "easy");
  CHECK(report["wobble"]["loose_panels"] == 0);
  CHECK(bench.popcut({"verify", "out/pattern.fold", "--dof", "1"}).exit == 0);
}

TEST_CASE("a word, a heart and a house with windows open in one movement with all counters cut out",
          "[cli][e2e][facets]") {
  const Bench bench;
  for (const char* example : {"letters", "heart", "house"}) {
    INFO(example);
    fs::remove_all(bench.temp / "out");
    const Ran ran =
        bench.popcut({"design", source_file(std::string("examples/") + example + ".json"), "-o",
                      "out", "--formats", "fold,report"});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    const json report = bench.report();
    CHECK(report["pieces"] == 1);
    CHECK(report["facets"]["depth_mm"]["mean"] < 2.0);
    CHECK(bench.popcut({"verify", "out/pattern.fold", "--dof", "1"}).exit == 0);
    if (example != std::string("letters")) continue;
    // No letter and no counter is off by more than a step; sides that face along the spine are
    // bare.
    const Ran seen = bench.popcut({"compare", "out/pattern.fold",
                                   source_file("examples/letters.json"), "--no-cost", "--json"});
    INFO(seen.err);
    REQUIRE(seen.exit == 0);
    const json figures = json::parse(seen.out);
    INFO(figures.dump());
    CHECK(figures["cover"] > 0.75);
    CHECK(figures["contour"]["mean_mm"] < 2.0);
  }
}

TEST_CASE("a text takes a font from beside the spec, and says what it cannot set",
          "[cli][e2e][facets]") {
  const Bench bench;
  json spec = {{"popcut", 1},
               {"style", "facets"},
               {"surface", {{"type", "text"}, {"text", "Ab"}, {"font", "mine.ttf"}}}};
  check_refused_at(bench.design(spec), 3, "spec.json: /surface/font");
  write_file(bench.temp / "mine.ttf", "no font");
  check_refused_at(bench.design(spec), 3, "spec.json: /surface/font: is no font");
  write_file(bench.temp / "mine.ttf", std::string(popcut::usual_font()));
  const Ran named = bench.design(spec);
  INFO(named.err);
  REQUIRE(named.exit == 0);
  const std::string fold = text_of_file(bench.temp / "out/pattern.fold");
  spec["surface"].erase("font");
  REQUIRE(bench.design(spec).exit == 0);
  CHECK(text_of_file(bench.temp / "out/pattern.fold") == fold);
  spec["surface"]["text"] = "\u3042";
  check_refused_at(bench.design(spec), 3, "spec.json: /surface/text: the font has no");
  spec["surface"] = {{"type", "outline"}, {"file", "line.svg"}};
  write_file(bench.temp / "line.svg",
             "<svg xmlns='http://www.w3.org/2000/svg'><path stroke='red' d='M0 0H9'/></svg>");
  check_refused_at(bench.design(spec), 4, "spec.json: /surface/file: has no closed line");
}

TEST_CASE("what is wrong with a spec of facets is said with its place", "[cli][e2e][facets]") {
  const Bench bench;
  write_file(bench.temp / "house.obj", house_obj());
  const auto refused = [&](const json& changes, const std::string& place) {
    json spec = house();
    spec.merge_patch(changes);
    INFO(spec.dump());
    check_refused_at(bench.design(spec), 3, "spec.json: " + place);
    CHECK_FALSE(fs::exists(bench.temp / "out/pattern.fold"));
  };
  refused({{"slices", 5}}, "/slices: contradicts /style");
  refused({{"facets", {{"strip_mm", 0}}}}, "/facets/strip_mm");
  refused({{"facets", {{"strp_mm", 2}}}}, "/facets/strp_mm");
  refused({{"card", false}}, "/card: is false; facets hang on wall and ground");
  refused({{"design_angle_deg", 60}}, "/design_angle_deg: is 60; facets");
  refused({{"style", "lattice"}, {"facets", json::object()}}, "/facets: is for another style");
  refused({{"style", "origami"}}, "/style");
  refused({{"surface", {{"type", "revolution"}, {"radius", "40"}, {"file", nullptr}}}},
          "/facets/length_mm: is missing");
  refused({{"facets", {{"pitch_mm", 0.1}, {"strip_mm", 0.1}}}, {"scale_mm", 100}},
          "/facets/strip_mm: makes");
  json away = house();
  away["translate_mm"] = {-500, 0, -500};
  check_refused_at(bench.design(away), 4, "spec.json: /translate_mm");
}

}  // namespace facets_command_test
