// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/process.hpp"

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
                               setting, POPCUT_PROGRAM, "plan"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"-o", "sheets", "--json", "-q"});
  return run_program(all, temp.path(), {.memory_bytes = 2l << 30});
}

void check_refused(const Ran& ran, int exit, const std::string& part) {
  CAPTURE(ran.err);
  CHECK(ran.exit == exit);
  CHECK(ran.err.find(part) != std::string::npos);
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
}

}  // namespace

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

TEST_CASE("how finely curves are cut and how large a unit is can be asked for", "[cli][e2e][svg]") {
  const TempFolder temp;
  write_file(temp / "a.svg", kDrawing);
  const auto bytes = [&](std::vector<std::string> options) {
    options.insert(options.begin(), "a.svg");
    REQUIRE(plan(temp, "A=", options).exit == 0);
    return std::filesystem::file_size(temp / "sheets/sheet-01.gpgl");
  };
  CHECK(bytes({"--curve-tolerance", "0.5"}) < bytes({"--curve-tolerance", "0.01"}));
  check_refused(plan(temp, "A=", {"a.svg", "--curve-tolerance", "0"}), 2, "--curve-tolerance");
  check_refused(plan(temp, "A=", {"a.svg", "--svg-dpi", "0"}), 2, "--svg-dpi");
}

TEST_CASE("a drawing over a limit is refused before it is read and the limits can be raised",
          "[cli][e2e][svg]") {
  const TempFolder temp;
  write_file(temp / "huge.svg", "");
  std::filesystem::resize_file(temp / "huge.svg", 300'000'000);  // no disk is taken
  check_refused(plan(temp, "A=", {"huge.svg"}), 3, "huge.svg: is larger than 100000000 bytes");
  check_refused(plan(temp, "POPCUT_RAISE_LIMITS=4", {"huge.svg"}), 3, "byte 1 is zero");
  check_refused(plan(temp, "POPCUT_RAISE_LIMITS=x", {"huge.svg"}), 2, "POPCUT_RAISE_LIMITS: is");
}
