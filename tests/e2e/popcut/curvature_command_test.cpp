// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"

namespace curvature_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

/// One line on standard error that begins with "popcut: " and nothing on standard output.
bool one_clear_line(const Ran& ran) {
  return ran.out.empty() && ran.err.rfind("popcut: ", 0) == 0 &&
         std::count(ran.err.begin(), ran.err.end(), '\n') == 1;
}

void design_example(const TempFolder& folder, const std::string& name) {
  const Ran printed = popcut_in(folder, {"design", "--example", name});
  json spec = json::parse(printed.out);
  spec["lattice"] = "conformal";  // whose fold vertices lie on the shape
  write_file(folder / (name + ".json"), spec.dump());
  const Ran made = popcut_in(folder, {"design", name + ".json", "-o", name, "-q"});
  REQUIRE(made.exit == 0);
}

}  // namespace

TEST_CASE("curvature of a designed pattern distinguishes a sphere from a saddle",
          "[cli][e2e][curvature]") {
  const TempFolder folder;
  for (const std::string name : {"sphere", "saddle", "cylinder"}) {
    design_example(folder, name);
    const Ran ran =
        popcut_in(folder, {"curvature", name + "/pattern.fold", "--psi", "90deg", "--json", "-q"});
    REQUIRE(ran.exit == 0);
    const json values = json::parse(ran.out)["poses"][0]["values"];
    REQUIRE(values.size() == 28);  // (5 - 1) levels x (10 - 3) connectors
    double sum = 0;
    for (const json& value : values) sum += value["K_area"].get<double>();
    CAPTURE(name, sum);
    if (name == "sphere") CHECK(sum > 0);
    if (name == "saddle") CHECK(sum < 0);
    if (name == "cylinder") CHECK(std::abs(sum) < 1e-9);
  }
  const Ran table = popcut_in(
      folder, {"curvature", "sphere/pattern.fold", "--psi", "pi:pi/2:5", "-o", "table.csv"});
  REQUIRE(table.exit == 0);
  const std::string csv = text_of_file(folder / "table.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 5 * 28);
}

TEST_CASE("the multi-state pattern is a dome then flat then a saddle at its middle",
          "[cli][e2e][curvature][splay]") {
  const TempFolder folder;
  design_example(folder, "multistate");
  const auto middle = [&](const std::string& psi) {
    const Ran ran =
        popcut_in(folder, {"curvature", "multistate/pattern.fold", "--psi", psi, "--json", "-q"});
    REQUIRE(ran.exit == 0);
    const json poses = json::parse(ran.out);  // named: a range over a temporary would dangle
    for (const json& value : poses["poses"][0]["values"])
      if (value["i"] == 2 && value["j"] == 1) return value["K"].get<double>();
    FAIL("no vertex in the middle");
    return 0.0;
  };
  CHECK(middle("0.16pi") > 0.01);
  CHECK(std::abs(middle("0.28pi")) < 1e-9);
  CHECK(middle("0.47pi") < -0.01);
}

TEST_CASE("curvature assembly writes its grid as a table and as a picture",
          "[cli][e2e][curvature]") {
  const TempFolder folder;
  const Ran table = popcut_in(folder, {"curvature", "assembly", "--phi", "45deg", "--r", "0.5:5:4",
                                       "--lambda", "0.2:3:3", "-o", "maps.csv"});
  CAPTURE(table.err);
  REQUIRE(table.exit == 0);
  const std::string csv = text_of_file(folder / "maps.csv");
  CHECK(csv.rfind("r,lambda,K,H\n0.5,0.2,1.2280532635563", 0) == 0);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 13);
  const Ran picture = popcut_in(folder, {"curvature", "assembly", "--phi", "pi/4", "--r",
                                         "0.5:5:40", "--lambda", "0.2:3:30", "-o", "maps.svg"});
  REQUIRE(picture.exit == 0);
  CHECK(text_of_file(folder / "maps.svg").find("</svg>") != std::string::npos);
}

TEST_CASE("curvature solve names the assembly or the nearest one", "[cli][e2e][curvature]") {
  const TempFolder folder;
  const Ran saddle = popcut_in(folder, {"curvature", "solve", "--K", "-1"});
  CHECK(saddle.exit == 0);
  CHECK(saddle.out.find("r = 2.692505") != std::string::npos);
  const Ran usual = popcut_in(folder, {"curvature", "solve", "--phi", "--K", "-1"});
  CHECK(usual.out == saddle.out);  // --phi alone is pi/4
  CHECK(saddle.out.find("lambda >= 1.970045 or lambda <= 0.029955") != std::string::npos);
  const Ran both = popcut_in(folder, {"curvature", "solve", "--K", "-1", "--H", "0", "--json"});
  CHECK(json::parse(both.out)["lambda"].get<double>() == Approx(1.970045).margin(1e-6));
  const Ran never = popcut_in(folder, {"curvature", "solve", "--K", "1", "--H", "0"});
  CHECK(never.exit == 4);
  CHECK(one_clear_line(never));
  const Ran beyond = popcut_in(folder, {"curvature", "solve", "--K", "7"});
  CHECK(beyond.exit == 3);
  CHECK(one_clear_line(beyond));
}

TEST_CASE("wrong arguments of curvature give one clear line", "[cli][e2e][curvature]") {
  const TempFolder folder;
  write_file(folder / "empty.fold", "{}");
  write_file(folder / "text.fold", "no json");
  write_file(folder / "square.fold",
             R"({"vertices_coords": [[0,0],[1,0],[1,1],[0,1]],
                 "edges_vertices": [[0,1],[1,2],[2,3],[3,0]],
                 "edges_assignment": ["B","B","B","B"], "faces_vertices": [[0,1,2,3]]})");
  struct Case {
    std::vector<std::string> words;
    int exit;
  };
  const std::vector<std::string> assembly{"curvature", "assembly", "--lambda", "0.2:3:5", "--r"};
  const auto with_r = [&](const std::string& r) {
    std::vector<std::string> words = assembly;
    words.push_back(r);
    return words;
  };
  for (const Case& c : std::vector<Case>{
           {{"curvature"}, 2},
           {{"curvature", "absent.fold"}, 3},
           {{"curvature", "empty.fold"}, 3},
           {{"curvature", "text.fold"}, 3},
           {{"curvature", "square.fold"}, 4},
           {{"curvature", "empty.fold", "--psi", "0:4:9"}, 2},
           {{"curvature", "empty.fold", "--psi", "0:pi"}, 2},
           {{"curvature", "empty.fold", "--psi", "0:pi:1"}, 2},
           {{"curvature", "empty.fold", "--psi", "0:pi:1000001"}, 2},
           {{"curvature", "empty.fold", "--psi", "0:pi:1e3"}, 2},
           {with_r("1:2"), 2},
           {with_r("1:2:3:4"), 2},
           {with_r("2:1:3"), 2},
           {with_r("-1:1:3"), 2},
           {with_r("0:inf:3"), 2},
           {with_r("0:1:99999999999999999999999"), 2},
       }) {
    const Ran ran = popcut_in(folder, c.words);
    CAPTURE(c.words.size(), c.words.back(), ran.err);
    CHECK(ran.exit == c.exit);
    CHECK(one_clear_line(ran));
  }
  const Ran large =
      popcut_in(folder, {"curvature", "assembly", "--r", "0:1:1000000", "--lambda", "0:1:1000000"});
  CHECK(large.exit == 2);
  CHECK(one_clear_line(large));
}

}  // namespace curvature_command_test
