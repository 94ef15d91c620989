// SPDX-License-Identifier: MIT
// Drawings larger than the mat, by the real binary.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace layout_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

const std::string kSphere = source_file("examples/sphere.json");

struct Bench : CommandBench {
  void refused(std::vector<std::string> arguments, int exit, const std::string& part) const {
    check_refused(popcut(std::move(arguments)), exit, part);
  }
};

std::string two_digits(std::size_t n) { return (n < 10 ? "0" : "") + std::to_string(n); }

}  // namespace

TEST_CASE("a design larger than the mat is cut sheet by sheet as it was planned",
          "[cli][e2e][layout]") {
  const Bench bench;
  const std::vector<std::string> words{kSphere, "--machine", "cameo3", "--mat", "110x110"};
  std::vector<std::string> plan{"plan"};
  plan.insert(plan.end(), words.begin(), words.end());
  plan.insert(plan.end(), {"-o", "sheets", "--json", "-q"});
  const Ran planned = bench.popcut(plan);
  CAPTURE(planned.err);
  REQUIRE(planned.exit == 0);
  const json whole = json::parse(planned.out);
  const std::size_t sheets = whole["sheets"].size();
  REQUIRE(sheets > 1);
  CHECK(whole["layout"]["pieces"].get<std::size_t>() >= sheets);
  CHECK(whole["layout"]["least_sheets"].get<std::size_t>() <= sheets);
  std::size_t tabs = 0;
  for (std::size_t k = 0; k < sheets; ++k) {
    const json& sheet = whole["sheets"][k];
    tabs += sheet["tabs"].size();
    CHECK(!sheet["seams"].empty());
    CHECK(!sheet["marks"].empty());
    for (const json& piece : sheet["pieces"]) {
      const json& t = piece["transform"];
      CHECK(t[0][0].get<double>() * t[1][1].get<double>() -
                t[0][1].get<double>() * t[1][0].get<double>() ==
            Approx(1.0));
    }
    const std::string name = "sheets/sheet-" + two_digits(k + 1);
    const Ran simulated = bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--machine",
                                        "cameo3", "--expect", name + ".svg"});
    CAPTURE(simulated.err);
    CHECK(simulated.exit == 0);
    // By the pattern and the plan, which were not made from each other.
    const std::string number = std::to_string(k + 1);
    const Ran by_plan =
        bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--expect", kSphere, "--plan",
                      "sheets/plan.json", "--sheet", number, "-q"});
    CAPTURE(by_plan.err);
    CHECK(by_plan.exit == 0);
    const Ran other =
        bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--expect", kSphere, "--plan",
                      "sheets/plan.json", "--sheet", std::to_string((k + 1) % sheets + 1), "-q"});
    CHECK(other.exit == 6);
  }
  CHECK(tabs == whole["layout"]["tabs"].get<std::size_t>());
  CHECK(text_of_file(bench.temp / "sheets/assembly.svg").find("Glue in this order") !=
        std::string::npos);

  std::vector<std::string> cut{"cut"};
  cut.insert(cut.end(), {kSphere, "--mat", "110x110", "--direct", "--yes", "--device", "sim:cameo3",
                         "-o", "cut"});
  const Ran done = bench.popcut(cut);
  CAPTURE(done.err);
  CHECK(done.exit == 0);
  for (std::size_t k = 0; k < sheets; ++k)
    CHECK(done.err.find("sheet " + std::to_string(k + 1) + " of " + std::to_string(sheets)) !=
          std::string::npos);
  // What the knife did on each sheet is what the plan and the pattern say.
  for (std::size_t k = 0; k < sheets; ++k) {
    const std::string name = "cut/sheet-" + two_digits(k + 1);
    const Ran held =
        bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--expect", kSphere, "--plan",
                      "cut/plan.json", "--sheet", std::to_string(k + 1), "-q"});
    CAPTURE(held.err);
    CHECK(held.exit == 0);
    const json sent = json::parse(text_of_file(bench.temp / "simulated/trace.json"));
    const json knife = json::parse(text_of_file(bench.temp / (name + ".trace.json")));
    CHECK(knife["strokes"] == sent["strokes"]);
  }
}

TEST_CASE("a changed split plan is reported and a missing tab is found", "[cli][e2e][layout]") {
  const Bench bench;
  REQUIRE(bench
              .popcut({"plan", kSphere, "--machine", "cameo3", "--mat", "110x110", "-o", "sheets",
                       "-q"})
              .exit == 0);
  const json plan = json::parse(text_of_file(bench.temp / "sheets/plan.json"));
  const auto with = [&](const char* pointer, const json& value, int exit, const std::string& part) {
    json other = plan;
    other[json::json_pointer(pointer)] = value;
    write_file(bench.temp / "other.json", other.dump());
    const Ran ran = bench.popcut({"simulate", "sheets/sheet-01.gpgl", "-o", "simulated", "--expect",
                                  kSphere, "--plan", "other.json", "-q"});
    CAPTURE(pointer, ran.err);
    CHECK(ran.exit == exit);
    CHECK(ran.err.find(part) != std::string::npos);
  };
  with("/sheets/0/pieces/0/share", json::array(), 3, "/sheets/0/pieces/0/share");
  with("/sheets/0/pieces/0/transform/1/1", "one", 3, "/sheets/0/pieces/0/transform/1/1");
  with("/sheets/0/seams/0/piece", -4, 3, "/sheets/0/seams/0/piece");
  with("/sheets/0/seams", 7, 3, "/sheets/0/seams");
  with("/sheets/0/tabs/0/points", json::array({json::array({1, "x"})}), 3, "/sheets/0/tabs/0");
  with("/sheets/0/tabs", json::array(), 6, "where nothing should be drawn");  // they were cut
  with("/sheets/0/seams/0/glued", json::array(), 6, "where nothing should be drawn");
}

TEST_CASE("a drawing that cannot be split is refused in one line", "[cli][e2e][layout]") {
  const Bench bench;
  const auto with = [](std::vector<std::string> more) {
    std::vector<std::string> all{"plan", kSphere, "-o", "sheets", "--machine", "cameo3"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  bench.refused(with({"--mat", "110x110", "--no-split"}), 4, "omit --no-split");
  bench.refused(with({"--mat", "8x8"}), 4, "no seams split the drawing");
  bench.refused(with({"--mat", "110x110", "--labels", "ink"}), 2, "one of auto, pen, cut, none");
  bench.refused(with({"--mat", "110x110", "--no-split", "--seam-x", "60"}), 2, "contradicts");
  bench.refused(with({"--mat", "110x110", "--seam-x", "nan"}), 2, "--seam-x");
  bench.refused(with({"--mat", "110x110", "--seam-y", "-5"}), 3, "is outside the drawing");
  bench.refused(with({"--mat", "110x110", "--seam-x", "300"}), 3, "between 0 and 125.0 mm");
  bench.refused(with({"--mat", "110x110", "--seam-y", "10,10.5"}), 4, "besides the requested ones");
  bench.refused(with({"--mat", "110x110", "--at", "100,100"}), 4, "at most 10.0 x 10.0 mm");
  // A seam of the user's own is refused where a fold or a narrow panel lies, with the nearest
  // place.
  bench.refused(with({"--mat", "110x110", "--seam-y", "126"}), 4, "the nearest valid place is");
  CHECK(files_below(bench.temp.path()).empty());
}

TEST_CASE("patches with a declared seam are planned as pieces that are glued there",
          "[cli][e2e][layout]") {
  const Bench bench;
  write_file(bench.temp / "two.json", R"j({"popcut": 1, "name": "two", "join": "seam", "patches": [
      {"name": "a", "regions": [{"radius": "40", "units_per_slice": 3, "slices": 4, "width_mm": 10}]},
      {"name": "b", "card": {"wall_mm": 70}, "regions": [{"radius": "40", "units_per_slice": 2, "slices": 4, "width_mm": 10}]}]})j");
  const Ran ran =
      bench.popcut({"plan", "two.json", "-o", "sheets", "--machine", "cameo3", "--json"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const json plan = json::parse(ran.out);
  CHECK(plan["layout"]["pieces"] == 2);
  CHECK(plan["layout"]["seams"].size() == 1);
  CHECK(plan["layout"]["seams"][0]["glue_mm"].get<double>() > 90.0);
  CHECK(plan["layout"]["tabs"].get<int>() >= 2);
  for (std::size_t k = 1; k <= plan["sheets"].size(); ++k) {
    const std::string name = "sheets/sheet-" + two_digits(k);
    const Ran held = bench.popcut({"simulate", name + ".gpgl", "-o", "simulated", "--machine",
                                   "cameo3", "--expect", name + ".svg"});
    CAPTURE(held.err);
    CHECK(held.exit == 0);
  }
  bench.refused({"plan", "two.json", "-o", "other", "--no-split"}, 4, "--no-split forbids");
}

}  // namespace layout_command_test
