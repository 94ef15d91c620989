// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"

namespace figures_command_test {

using namespace popcut::testing;
using nlohmann::json;

TEST_CASE("figures draws every figure and every statement of the paper holds",
          "[cli][e2e][figures]") {
  const TempFolder folder;
  const Ran ran = popcut_in(folder, {"figures", "-o", "out", "--json"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const json summary = json::parse(ran.out);
  CHECK(summary["all_hold"] == true);
  CHECK(summary["statements"].size() > 20);
  const auto files = files_below(folder / "out");
  for (const std::string name :
       {"fig1c", "fig1d", "fig2c_top", "fig2c_bottom", "fig3c", "fig3d", "figS5"}) {
    CHECK(std::find(files.begin(), files.end(), name + ".svg") != files.end());
    CHECK(std::find(files.begin(), files.end(), name + ".csv") != files.end());
  }
  CHECK(json::parse(text_of_file(folder / "out/figures.json")) == summary);
}

TEST_CASE("wrong arguments of figures are one clear error each", "[cli][e2e][figures]") {
  const TempFolder folder;
  write_file(folder / "empty.fold", "");
  for (const auto& [words, exit] : std::vector<std::pair<std::vector<std::string>, int>>{
           {{"figures"}, 2}, {{"figures", "-o", "empty.fold"}, 7}}) {
    const Ran ran = popcut_in(folder, words);
    CAPTURE(words.size(), ran.err);
    CHECK(ran.exit == exit);
    CHECK(ran.out.empty());
    CHECK(ran.err.rfind("popcut: ", 0) == 0);
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  }
}

}  // namespace figures_command_test
