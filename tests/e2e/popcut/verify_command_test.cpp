// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/paths.hpp"

namespace verify_command_test {

using namespace popcut::testing;
using nlohmann::json;
using popcut::testing::box_card;
using popcut::testing::FoldDraft;

TEST_CASE("verify of a sound pattern reports its figures and ends with 0", "[cli][e2e][verify]") {
  const TempFolder folder;
  write_file(folder / "box.fold", box_card().text());
  const Ran ran = popcut_in(folder, {"verify", "box.fold", "--dof", "1"});
  CAPTURE(ran.err);
  CHECK(ran.exit == 0);
  CHECK(ran.err.empty());
  CHECK(ran.out.find("1 degree of freedom") != std::string::npos);
  CHECK(ran.out.find("FAILED") == std::string::npos);
}

TEST_CASE("verify of an unsound pattern ends with 6 and lists what fails", "[cli][e2e][verify]") {
  const TempFolder folder;
  FoldDraft draft = box_card();
  draft.poses[1].at[0][1] -= 0.5;
  write_file(folder / "bad.fold", draft.text());
  const Ran ran = popcut_in(folder, {"verify", "bad.fold", "--dof", "2", "--json"});
  CHECK(ran.exit == 6);
  CHECK(ran.err.rfind("popcut: bad.fold: the pattern fails checks: isometry", 0) == 0);
  const json report = json::parse(ran.out);
  CHECK(report["ok"] == false);
  CHECK(report["failed"].get<int>() > 1);
  for (const json& check : report["checks"]) {
    const bool fails = check["name"] == "isometry" || check["name"] == "degrees_of_freedom" ||
                       check["name"] == "fold_angles";
    CAPTURE(check.dump());
    if (!fails) CHECK(check["ok"] == true);
    if (check["name"] == "isometry") CHECK(check["failures"].size() > 0);
  }
}

TEST_CASE("verify of invalid input ends with 3 and one line", "[cli][e2e][verify]") {
  const TempFolder folder;
  write_file(folder / "deep.fold", std::string(200'000, '['));
  write_file(folder / "half.fold", box_card().text().substr(0, 500));
  write_file(folder / "none.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
  write_file(folder / "broken.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L'");
  for (const char* name : {"deep.fold", "half.fold", "none.svg", "broken.svg", "absent.fold"}) {
    CAPTURE(name);
    const Ran ran = popcut_in(folder, {"verify", name});
    CAPTURE(ran.err);
    CHECK(ran.exit == 3);
    CHECK(ran.out.empty());
    CHECK(ran.err.find(name) != std::string::npos);
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  }
}

TEST_CASE("verify opens a pattern without frames and says how", "[cli][e2e][verify]") {
  const TempFolder folder;
  FoldDraft flat = box_card();
  flat.poses.clear();
  write_file(folder / "flat.fold", flat.text());
  const Ran ran = popcut_in(folder, {"verify", "flat.fold", "--dof", "1"});
  CAPTURE(ran.out, ran.err);
  CHECK(ran.exit == 0);
  CHECK(ran.out.find("opened step by step to psi 1.1000 rad") != std::string::npos);
  CHECK(ran.out.find("driven by edge") != std::string::npos);
}

TEST_CASE("popcut's own drawings verify with the same freedoms as its FOLD file",
          "[cli][e2e][verify]") {
  const std::string examples = source_file("examples/");
  for (const std::string name :
       {"unit", "sphere", "composite", "airfoil", "facade", "multistate"}) {
    const TempFolder folder;
    REQUIRE(popcut_in(folder, {"design", examples + name + ".json", "-o", "out", "-q"}).exit == 0);
    const Ran fold = popcut_in(folder, {"verify", "out/pattern.fold", "--json"});
    REQUIRE(fold.exit == 0);
    const json listed = json::parse(fold.out);
    // V-folds part the creases of cut.svg into more hinges.
    const bool splayed = name == "facade" || name == "multistate";
    for (const std::string drawing : {"out/pattern.svg", "out/cut.svg", "out/pattern.dxf"}) {
      CAPTURE(name, drawing);
      if (splayed && drawing == "out/cut.svg") continue;
      const Ran ran = popcut_in(folder, {"verify", drawing, "--dof", "1", "--json"});
      CAPTURE(ran.out, ran.err);
      CHECK(ran.exit == 0);
      const json traced = json::parse(ran.out);
      for (const char* figure : {"degrees_of_freedom", "faces", "hinges", "slits", "holes"}) {
        CAPTURE(figure);
        CHECK(traced[figure] == listed[figure]);
      }
      CHECK(traced["opening"]["reached_psi_rad"].get<double>() == Approx(1.1));
      CHECK(traced["area_mm2"].get<double>() == Approx(listed["area_mm2"].get<double>()));
    }
  }
}

TEST_CASE("verify reads drawings in any encoding and crease patterns, as plan does",
          "[cli][e2e][verify]") {
  const TempFolder folder;
  const std::string svg =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="80mm" viewBox="0 0 90 80">)"
      R"(<g fill="none" stroke="#000"><path id="outline" d="M0 0h90v80H0z"/>)"
      R"(<path id="mountain" d="M0 40h90"/></g></svg>)";
  std::string wide = "\xFF\xFE";
  for (const char c : svg) wide += {c, '\0'};
  write_file(folder / "plain.svg", svg);
  write_file(folder / "wide.svg", wide);
  write_file(folder / "a.cp", "1 0 0 90 0\n1 90 0 90 80\n1 90 80 0 80\n1 0 80 0 0\n2 0 40 90 40\n");
  const auto faces = [&](const std::string& name) {
    const Ran ran = popcut_in(folder, {"verify", name, "--json"});
    CAPTURE(name, ran.err);
    const json report = json::parse(ran.out, nullptr, false);
    return report.is_object() ? report["faces"] : json();
  };
  CHECK(faces("plain.svg") == 2);
  CHECK(faces("wide.svg") == 2);
  CHECK(faces("a.cp") == 2);
}

TEST_CASE("slices of a tenth of a millimetre pass through all checks", "[cli][e2e][verify]") {
  const TempFolder folder;
  write_file(folder / "thin.json",
             R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(200^2-(y-125)^2)"},
                 "units_per_slice":1,"slices":2500,"widths_mm":0.1,"min_panel_mm":0.05,
                 "lattice":"slices"})j");
  REQUIRE(popcut_in(folder, {"design", "thin.json", "-o", "out", "-q", "--formats", "fold"}).exit ==
          0);
  const Ran ran = popcut_in(folder, {"verify", "out/pattern.fold", "--dof", "1", "--json"});
  CAPTURE(ran.err);
  CHECK(ran.exit == 0);
  const json report = json::parse(ran.out);
  for (const json& check : report["checks"]) {
    CAPTURE(check.dump());
    CHECK(check["ok"] == true);
    CHECK(check["ran"] == (check["name"] != "opening"));
  }
}

TEST_CASE("every shipped example is designed and verified as sound", "[cli][e2e][verify]") {
  const std::string examples = source_file("examples/");
  for (const std::string name : {"unit", "fig2a", "cylinder", "sphere", "saddle", "composite",
                                 "airfoil", "packaging", "facade", "multistate"}) {
    CAPTURE(name);
    const TempFolder folder;
    const std::string spec = examples + name + ".json";
    REQUIRE(popcut_in(folder, {"design", spec, "-o", "out", "-q"}).exit == 0);
    const Ran ran =
        popcut_in(folder, {"verify", "out/pattern.fold", "--dof", "1", "--target", spec, "--json"});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    const json verified = json::parse(ran.out);
    const json made = json::parse(text_of_file(folder / "out/report.json"));
    CHECK(verified["faces"] == made["faces"]);
    CHECK(verified["pieces"] == made["pieces"]);
    if (name != "facade" && name != "multistate") CHECK(verified["crossing"] == "exact");
    CHECK(verified["isometry_mm"].get<double>() < 1e-9);
    // Measured from the file alone, the distances are those that the generator reports.
    for (const char* figure : {"rms", "max"}) {
      CHECK(verified["target"]["inner_mm"][figure].get<double>() ==
            Approx(made["inner_error_mm"][figure].get<double>()).margin(1e-9));
    }
  }
}

}  // namespace verify_command_test
