// SPDX-License-Identifier: MIT
// popcut calibrate as a person uses it: the program cuts on a machine that is not as its row says,
// and the answers are those of a ruler.
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace calibrate_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

const std::string kHidden = R"({"popcut": 1, "machines": [
  {"name": "hidden", "like": "vevor-cutter", "axes": "carriage-feed", "margin_left_mm": 3.2,
   "margin_top_mm": 1.7, "scale": {"carriage": 1.004, "feed": 0.9965}}]})";

struct Bench : CommandBench {
  Bench() {
    std::filesystem::create_directories(temp / "config/popcut");
    write_file(table(), kHidden);
  }
  [[nodiscard]] std::filesystem::path table() const {
    return temp.path() / "config/popcut/machines.json";
  }
  /// With `answers` on standard input.
  [[nodiscard]] Ran calibrate(const std::string& arguments, const std::string& answers) const {
    return run_program({"/bin/sh", "-c",
                        "printf '" + answers + "' | XDG_CONFIG_HOME=\"$PWD/config\" '" +
                            popcut_program() + "' calibrate " + arguments},
                       temp.path());
  }
  [[nodiscard]] json row(const std::string& name) const {
    const json whole = json::parse(text_of_file(table()));
    for (const json& one : whole["machines"])
      if (one["name"] == name) return one;
    return nullptr;
  }
};

const std::string kOnHidden = "--device sim:hidden --machine vevor-cutter --as mine ";

}  // namespace

TEST_CASE("a ruler and a look at the sheet correct axes, margins and scale", "[cli][calibrate]") {
  const Bench bench;
  // By hand, for an A4 sheet: lines of 170 and 200 mm; the corner's 20 mm along the carriage come
  // out at 20 * 1.004 - 3.2 = 16.9 mm; along the feed, which counts from the sheet's end,
  // 277 * 0.9965 - 1.7 = 274.3 mm from there, 22.7 mm from the upper edge.
  const Ran ran =
      bench.calibrate(kOnHidden + "--steps axes,ruler -o kept",
                      "\\nup\\nright\\n\\n170.7\\n199.3\\n16.9\\n22.7\\n\\n10\\n10\\ny\\n");
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.err, "carriage-feed; popcut thought feed-carriage"));
  CHECK(says(ran.err, "square   0.0 mm off"));
  const json mine = bench.row("mine");
  CHECK(mine["like"] == "vevor-cutter");
  CHECK(mine["axes"] == "carriage-feed");
  CHECK(mine["mirrored"] == false);
  CHECK(mine["margin_left_mm"].get<double>() == Approx(3.2).margin(0.06));
  CHECK(mine["margin_top_mm"].get<double>() == Approx(1.7).margin(0.06));
  CHECK(mine["scale"]["carriage"].get<double>() == Approx(1.004).margin(0.0004));
  CHECK(mine["scale"]["feed"].get<double>() == Approx(0.9965).margin(0.0004));
  CHECK_FALSE(mine.contains("motion"));                 // was not measured
  CHECK(bench.row("hidden")["margin_left_mm"] == 3.2);  // other rows stay
  for (const char* file : {"axes.hpgl", "axes.svg", "ruler.svg", "square.svg"})
    CHECK(std::filesystem::exists(bench.temp / ("kept/" + std::string(file))));
}

TEST_CASE("a cutter that answers is timed by popcut, and its row says calibrated",
          "[cli][calibrate]") {
  const Bench bench;
  const Ran ran = bench.calibrate("--device sim:cameo3 --steps time,force", "\\n\\n4\\ny\\n");
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const json row = bench.row("cameo3");
  CHECK(row["motion"]["travel_mm_s"].get<double>() == Approx(110).epsilon(0.03));
  CHECK(row["motion"]["spread"].get<double>() == Approx(0.05).margin(0.03));
  CHECK(row["forces"][0]["material"] == "paper-220");
  CHECK(row["forces"][0]["cut_gf"] == 182);
  const std::string date = row["calibrated"];
  CHECK(date.size() == 10);
  const Ran shown =
      run_program({"/usr/bin/env", "XDG_CONFIG_HOME=" + (bench.temp / "config").string(),
                   popcut_program(), "machines", "cameo3"},
                  bench.temp.path());
  CHECK(says(shown.out, "calibrated on " + date));
  CHECK(says(shown.out, "paper-220 with 182 gf"));
  // And again, on its own row: the newer force replaces the older.
  const Ran again = bench.calibrate("--device sim:cameo3 --steps force", "\\n2\\ny\\n");
  CAPTURE(again.err);
  REQUIRE(again.exit == 0);
  CHECK(bench.row("cameo3")["forces"].size() == 1);
  CHECK(bench.row("cameo3")["forces"][0]["cut_gf"] != 182);
  CHECK(bench.row("cameo3")["motion"]["travel_mm_s"] == row["motion"]["travel_mm_s"]);
}

TEST_CASE("a cut on a machine with a scale of its own is as planned, with marks too",
          "[cli][calibrate]") {
  const Bench bench;
  write_file(bench.table(), R"({"popcut": 1, "machines": [
      {"name": "mine", "like": "cameo3", "margin_left_mm": 3.2, "margin_top_mm": 1.7,
       "scale": {"carriage": 1.004, "feed": 0.996}}]})");
  write_file(bench.temp / "rings.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg" width="120mm"
      height="120mm" viewBox="0 0 120 120"><g fill="none" stroke="#000"><circle cx="70" cy="60"
      r="31.7"/><circle cx="70" cy="60" r="17.3"/><path d="M37.493 93.7L80.1 110.3"/></g></svg>)x");
  for (const std::string options : {"", "--marks", "--mat roll"}) {
    CAPTURE(options);
    const Ran ran =
        run_program({"/bin/sh", "-c",
                     "XDG_CONFIG_HOME=\"$PWD/config\" '" + std::string(popcut_program()) +
                         "' cut rings.svg --direct --yes --device sim:mine -o cut " + options},
                    bench.temp.path());
    INFO(ran.err);
    CHECK(ran.exit == 0);
  }
}

TEST_CASE("nothing is written before a person agrees", "[cli][calibrate]") {
  const Bench bench;
  for (const std::string& answers : std::vector<std::string>{
           "", "\\n", "\\nup\\n", "\\nright\\ndown\\n", "\\nright\\ndown\\nn\\n", "q\\n"}) {
    CAPTURE(answers);
    const Ran ran = bench.calibrate("--device sim:cameo3 --steps axes", answers);
    CAPTURE(ran.err);
    CHECK(ran.exit == (answers == "\\nright\\ndown\\nn\\n" ? 0 : 5));
    CHECK(text_of_file(bench.table()) == kHidden);
  }
}

TEST_CASE("an answer that cannot be is asked for again", "[cli][calibrate]") {
  const Bench bench;
  const Ran ran =
      bench.calibrate("--device sim:cameo3 --as c --steps axes,ruler",
                      "\\nright\\nleft\\nsideways\\nright\\ndown\\n\\nabc\\n20\\n200\\n20\\n20\\n"
                      "200\\n200\\n20\\n20\\n\\n10\\n10\\ny\\n");
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.err, "cannot run the same way or opposite ways"));
  CHECK(says(ran.err, "answer right, left, up or down"));
  CHECK(says(ran.err, "give a number from"));
  CHECK(says(ran.err, "is 20 mm, where 200 mm were sent"));
  CHECK(bench.row("c")["scale"]["feed"] == 1);
}

TEST_CASE("what cannot be calibrated is refused before anything is cut", "[cli][calibrate]") {
  const Bench bench;
  const auto refused = [&](const std::string& arguments, int exit, const std::string& part) {
    const Ran ran = bench.calibrate(arguments, "\\n");
    CAPTURE(arguments, ran.err);
    CHECK(ran.exit == exit);
    CHECK(says(ran.err, part));
  };
  refused("--device file:a.gpgl", 2, "calibrate needs a cutter");
  refused("--device sim:cameo3 --machine hpgl-generic", 2, "does not understand");
  refused("--as \"my cutter\"", 2, "is not a valid name");
  refused("--steps axes,taste", 2, "\"taste\" is not a step");
  refused("--material wood", 2, "wood");
  refused("--device sim:cameo3 --mat 60x60 --steps ruler", 4, "too small to measure");
  refused("--device sim:cameo2 --autoblade", 2, "cannot hold one");
  write_file(bench.table(), "{\"popcut\": 1, \"machines\": 7}");
  refused("--device sim:cameo3", 3, "machines.json");
}

TEST_CASE("a person's times for the strip are what design and plan count with",
          "[cli][calibrate][hands]") {
  const Bench bench;
  CHECK(bench.calibrate("--hands -o strip", "").exit == 0);
  CHECK(text_of_file(bench.temp / "strip/folding-test.pdf").starts_with("%PDF"));
  CHECK(says(text_of_file(bench.temp / "strip/folding-test.svg"), "mountain fold"));
  Ran ran = bench.calibrate("--hands --json", "200\n200\nmany\n300\n300\nn\n");
  CAPTURE(ran.err);
  CHECK(ran.exit == 0);
  CHECK(says(ran.err, "Seconds for the 2 folds of 30 mm:"));
  CHECK(says(ran.err, "Nothing was written."));
  CHECK(json::parse(ran.out)["hands"]["folds"][3]["fold_s"] == 100);
  const auto folding = [&](const std::string& command, const std::string& file) {
    const Ran made = run_program({"/bin/sh", "-c",
                                  std::string("XDG_CONFIG_HOME=\"$PWD/config\" '") +
                                      popcut_program() + "' " + command + " unit.json -q -o made"},
                                 bench.temp.path());
    CAPTURE(made.err);
    REQUIRE(made.exit == 0);
    return bench.read_json("made/" + file)["handwork"];
  };
  write_file(bench.temp / "unit.json", bench.popcut({"design", "--example", "unit"}).out);
  const json before = folding("design", "report.json");
  CHECK(before["folds"] == 5);
  CHECK(before["fold_s"] == 50);
  CHECK(folding("plan", "plan.json") == before);
  ran = bench.calibrate("--hands --times 200,200,300,300", "");
  CHECK(ran.exit == 0);
  CHECK(says(ran.err, "hands.json; design, plan, auto and fold-guide count with it."));
  const json after = folding("design", "report.json");
  CHECK(after["fold_s"] == 500);
  CHECK(folding("plan", "plan.json") == after);
  check_refused(bench.calibrate("--hands --times 1,2,3", ""), 2, "--times");
  check_refused(bench.calibrate("--hands --times 1,2,3,4,5", ""), 2, "too many");
  check_refused(bench.calibrate("--times 1,2,3,4", ""), 2, "--hands");
  check_refused(bench.calibrate("--hands --device sim:cameo3", ""), 2, "--hands");
}

}  // namespace calibrate_command_test
