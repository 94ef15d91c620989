// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/chain/chain.hpp"
#include "core/design/design.hpp"
#include "core/design/target/expression.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/value.hpp"

namespace augmented_design_test {

using namespace popcut;

namespace {

constexpr const char* kSphere = "sqrt(60^2-(y-30)^2)";
constexpr const char* kSaddle = "sqrt(40^2+(y-30)^2)";

std::string spec_of(const std::string& radius, const std::string& more, int units = 6,
                    int slices = 8) {
  return fmt::format(
      R"({{"popcut":1,"surface":{{"type":"revolution","radius":"{}"}},"units_per_slice":{},"slices":{},
          "widths_mm":8{}}})",
      radius, units, slices, more);
}

Result<Design> designed(const std::string& text) {
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(spec.error());
  return design(*spec);
}

const CurvatureFigures& figures_of(const DesignReport& report, const std::string& name) {
  REQUIRE(report.curvature);
  for (const CurvatureFigures& f : report.curvature->figures)
    if (f.name == name) return f;
  FAIL("no figures of " + name);
  return report.curvature->figures.front();
}

void check_sound(const Design& made) {
  std::ostringstream fold;
  REQUIRE(write_fold(made.pattern, {}, fold));
  const auto report = testing::value(verify_fold(fold.str(), {.degrees_of_freedom = 1}));
  INFO(verify_text(report));
  CHECK(report.ok());
}

}  // namespace

TEST_CASE("requested curvature brings a saddle and a sphere nearer to it than plain chains",
          "[core][design][curvature]") {
  struct Row {
    const char* radius;
    const char* curvature;
    double share;  ///< of the plain chains' miss that is left at most
  };
  // On an even grid a star of four triangles has a third of its area for A, so K_area is 3/2 of the
  // smooth surface's.
  const Row row =
      GENERATE(Row{kSaddle, R"({"K_area":-0.000625,"weights":{"K":100}})", 0.25},
               Row{kSphere, R"({"K_area":0.0002777777777777778,"weights":{"K":100}})", 0.9},
               Row{kSaddle, R"({"K_area":-0.000625,"H":0.0,"weights":{"K":30,"H":30}})", 0.9});
  CAPTURE(row.curvature);
  const std::string lattice = GENERATE(as<std::string>{}, "", R"(,"lattice":"branching")");
  const auto made =
      designed(spec_of(row.radius, fmt::format(R"(,"curvature":{}{})", row.curvature, lattice)));
  REQUIRE(made);
  CHECK(made->report.lattice == (lattice.empty() ? "slices" : "branching"));
  const CurvatureFigures& K = figures_of(made->report, "K_area");
  CHECK(K.asked);
  CHECK(K.miss.rms < row.share * K.plain_miss.rms);
  CHECK(K.miss.max >= K.miss.rms);
  CHECK(made->report.curvature->end_mm2 < made->report.curvature->start_mm2);
  CHECK(made->report.degrees_of_freedom == 1);
  check_sound(*made);
}

TEST_CASE("the fundamental forms can be requested instead of the curvatures",
          "[core][design][curvature]") {
  const auto asked = [](const std::string& forms) {
    auto made =
        testing::value(designed(spec_of(kSaddle, fmt::format(R"(,"curvature":{{{}}})", forms))));
    check_sound(made);
    return std::move(made.report);
  };
  const std::string first = R"("first":[120,0,66])", second = R"("second":[[2.4,0.2,-1.2]])";
  for (const auto& [form, name] : {std::pair{first, "first"}, std::pair{second, "second"}}) {
    const DesignReport report = asked(form);
    const CurvatureFigures& f = figures_of(report, name);
    CHECK(f.miss.rms < f.plain_miss.rms);
    CHECK_FALSE(figures_of(report, "K_area").asked);
    const auto json = nlohmann::json::parse(report_json(report));
    CHECK(json["curvature"][name]["miss"]["rms"] == f.miss.rms);
    CHECK(json["curvature"]["H"]["reached"].contains("least"));
  }
  const DesignReport both = asked(first + "," + second + R"(,"weights":{"second":50})");
  CHECK(both.curvature->end_mm2 < both.curvature->start_mm2);
}

TEST_CASE("targets vertex by vertex lead back to the chains that have them",
          "[core][design][curvature]") {
  // What the plain chains have is asked of them: then nothing is to be gained, and nothing moves.
  const auto plain = designed(spec_of("60", R"(,"lattice":"slices")", 4, 5));
  const auto probe = designed(spec_of("60", R"(,"curvature":{"K_area":0,"H":0.0125})", 4, 5));
  REQUIRE(plain);
  REQUIRE(probe);
  const CurvatureFigures& H = figures_of(probe->report, "H");
  CHECK(probe->report.curvature->vertices == 3 * 3);
  CHECK(H.least > 0.0);
  std::string list;
  for (int k = 0; k < 9; ++k) list += fmt::format("{}0.0", k == 0 ? "" : ",");
  const auto flat =
      designed(spec_of("60", fmt::format(R"(,"curvature":{{"K_area":[{}]}})", list), 4, 5));
  REQUIRE(flat);
  CHECK(figures_of(flat->report, "K_area").miss.max < 1e-12);
  for (std::size_t j = 0; j < plain->report.slices.size(); ++j)
    CHECK(flat->report.slices[j].loss == Approx(plain->report.slices[j].loss).epsilon(1e-6));
}

TEST_CASE("the report gives the curvature of a lattice that does not keep the chains",
          "[core][design][curvature]") {
  const std::string asked = R"(,"curvature":{"K_area":-0.000625},"lattice":)";
  const auto said = [&](const std::string& lattice, const std::string& words) {
    const auto made = testing::value(designed(spec_of(kSaddle, asked + lattice)));
    for (const std::string& note : made.report.notes)
      if (note.find(words) != std::string::npos) return true;
    return false;
  };
  CHECK(said(R"("conformal")", "only starts from the chains"));
  CHECK(said(R"("levels")", "takes no chains"));
  CHECK(said(R"("slices")", "the nearest K_area that chains on this target reach misses"));
}

TEST_CASE("runs that are too small keep plain chains and the others are solved",
          "[core][design][curvature]") {
  const auto made = testing::value(designed(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(60^2-(y-30)^2)"},"regions":[
          {"units_per_slice":1,"slices":2,"width_mm":6},{"units_per_slice":4,"slices":4,"width_mm":6},
          {"units_per_slice":3,"slices":3,"width_mm":6}],
          "curvature":{"K_area":[1e-4,2e-4,3e-4,1e-4,2e-4,3e-4,1e-4,2e-4]}})j"));
  CHECK(made.report.curvature->vertices == 2 * 3 + 1 * 2);
  CHECK(made.report.curvature->slices_left_out == 2);
  check_sound(made);
}

TEST_CASE("curvature that cannot be requested is refused with its place",
          "[core][design][curvature]") {
  struct Row {
    const char* curvature;
    const char* says;
    int exit;
  };
  for (const Row& row :
       {Row{"{}", "/curvature: asks for nothing", 3}, Row{"[]", "/curvature: is a list", 3},
        Row{R"({"K_area":[1,2]})", "/curvature/K_area: has 2 values; must have one for all, or 30",
            3},
        Row{R"({"first":[[1,0,1],[1,0,1]]})", "/curvature/first: has 2 values", 3},
        Row{R"({"K_area":0,"weights":{"K":-1}})", "/curvature/weights/K: is -1", 3},
        Row{R"({"K_area":0,"weights":{"H":1}})", "give /curvature/H too", 3},
        Row{R"({"H":0,"weights":{"H":0}})", "are all 0", 3},
        Row{R"({"first":[1,2,1]})", "measures no area", 3},
        Row{R"({"second":[1,2]})", "/curvature/second: is a list of 2", 3},
        Row{R"({"K_area":"flat"})", "/curvature/K_area: is a text", 3},
        Row{R"({"K_area":[]})", "/curvature/K_area: is a list of 0", 3}}) {
    CAPTURE(row.curvature);
    const auto made = designed(spec_of(kSphere, fmt::format(R"(,"curvature":{})", row.curvature)));
    REQUIRE_FALSE(made);
    CHECK(message(made.error()).find(row.says) != std::string::npos);
    CHECK(exit_code(made.error().kind) == row.exit);
  }
  for (const auto& [units, slices] : {std::pair{1, 9}, std::pair{5, 2}}) {
    const auto made = designed(spec_of(kSphere, R"(,"curvature":{"H":0.01})", units, slices));
    REQUIRE_FALSE(made);
    CHECK(message(made.error()).find("3 slices or more of 2 units or more") != std::string::npos);
    CHECK(exit_code(made.error().kind) == 4);
  }
  const auto many = designed(spec_of("60", R"(,"curvature":{"H":0.01})", 200, 200));
  REQUIRE_FALSE(many);
  CHECK(message(many.error()).find("at most 20000") != std::string::npos);
}

TEST_CASE("SLSQP shares one time between all slices", "[core][design][chain]") {
  const SliceCurve circle(50.0, 50.0);
  std::vector<double> x(10), z(10);
  SlsqpBudget budget{60.0};
  REQUIRE(solve_chain_slsqp(circle, 9, x, z, budget));
  const double left = budget.left_s;
  CHECK(left < 60.0);
  REQUIRE(solve_chain_slsqp(circle, 9, x, z, budget));
  CHECK(budget.left_s < left);
  budget.left_s = 0.0;
  const auto late = solve_chain_slsqp(circle, 9, x, z, budget);
  REQUIRE_FALSE(late);
  CHECK(late.error().kind == ErrorKind::Timeout);
  CHECK(late.error().detail.find("for all slices together") != std::string::npos);
}

TEST_CASE("an expression that assigns is refused with the column", "[core][design][expression]") {
  for (const auto& [text, column] :
       {std::pair{"y=3", 2}, std::pair{"1+(x=2)", 5}, std::pair{"x+=1", 3}}) {
    CAPTURE(text);
    const auto parsed = Expression::parse(text, {"x", "y"});
    REQUIRE_FALSE(parsed);
    CHECK(parsed.error().detail.find(fmt::format("at column {}", column)) != std::string::npos);
  }
  for (const char* valid : {"y==3 ? 1 : 2", "x<=1", "x>=1", "x!=y"}) {
    CAPTURE(valid);
    CHECK(Expression::parse(valid, {"x", "y"}));
  }
}

}  // namespace augmented_design_test
