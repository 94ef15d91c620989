// SPDX-License-Identifier: MIT
// Slices where the target is not, or too small: plain card.
#include <algorithm>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/value.hpp"

namespace blank_slices_test {

using namespace popcut;

namespace {

Result<Design> designed(const std::string& radius, const std::string& fields) {
  const auto spec = testing::value(parse_design_spec(fmt::format(
      R"({{"popcut":1,"surface":{{"type":"revolution","radius":"{}"}},{}}})", radius, fields)));
  return design(spec);
}

std::vector<int> blanks_of(const DesignReport& report) {
  std::vector<int> out;
  for (std::size_t j = 0; j < report.slices.size(); ++j)
    if (report.slices[j].blank) out.push_back(static_cast<int>(j));
  return out;
}

void check_sound(const Pattern& pattern) {
  std::ostringstream fold;
  REQUIRE(write_fold(pattern, {}, fold));
  const auto report = testing::value(verify_fold(fold.str(), {.degrees_of_freedom = 1}));
  if (!report.ok()) FAIL(verify_text(report));
}

bool says(const DesignReport& report, const std::string& what) {
  return std::any_of(report.notes.begin(), report.notes.end(),
                     [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE("slices beyond the end of the target are plain card", "[core][design][blank]") {
  const int units = GENERATE(1, 2, 5);
  CAPTURE(units);
  // A sphere from y = 10 to 70: slices at 0, 10, .. 90, each over 5 mm to both sides.
  const auto made = testing::value(designed(
      "sqrt(30^2-(y-40)^2)",
      fmt::format(R"("units_per_slice":{},"slices":10,"widths_mm":10,"lattice":"slices")", units)));
  CHECK(blanks_of(made.report) == std::vector<int>{0, 8, 9});
  CHECK(says(made.report, "slice 0 is blank"));
  CHECK(says(made.report, "slice 1: the target ends there"));
  CHECK(says(made.report, "slice 7: the target ends there"));
  CHECK(says(made.report, "slices 8 to 9 are blank"));
  check_sound(made.pattern);
  // All slices have the places that they would have without blank ones.
  for (std::size_t j = 1; j < 10; ++j)
    if (!made.report.slices[j].blank && !made.report.slices[j - 1].blank)
      CHECK(made.report.slices[j].v_mm - made.report.slices[j - 1].v_mm == Approx(10.0));
}

TEST_CASE("a blank slice between others keeps their distance", "[core][design][blank]") {
  const auto made = testing::value(
      designed("y < 25 ? 40 : (y < 45 ? -1 : 40)",
               R"("units_per_slice":3,"slices":8,"widths_mm":10,"lattice":"slices")"));
  CHECK(blanks_of(made.report) == std::vector<int>{3, 4});
  CHECK(made.report.slices[5].v_mm - made.report.slices[2].v_mm == Approx(30.0));
  CHECK(made.report.bridges.empty());
  check_sound(made.pattern);
}

TEST_CASE("a slice too small for panels is plain card", "[core][design][blank]") {
  const auto made = testing::value(designed(
      "y < 45 ? 40 : 0.7", R"("units_per_slice":2,"slices":6,"widths_mm":10,"lattice":"slices")"));
  CHECK(blanks_of(made.report) == std::vector<int>{5});
  CHECK(says(made.report, "slice 5 is blank, plain card: the target spans only"));
  check_sound(made.pattern);
}

TEST_CASE("a design whose slices are mostly blank says so in a warning", "[core][design][blank]") {
  const std::string fields = R"("units_per_slice":5,"slices":10,"widths_mm":10,"min_panel_mm":2.5)";
  const auto typed = designed("sqrt(70 - (y - 45)^2)", fields);  // for 70^2
  if (!typed) FAIL(message(typed.error()));
  CHECK_THAT(messages_of(typed->report.warnings).front(),
             Catch::StartsWith("8 of 10 slices are blank, plain card: the radius is not a number"));
  const auto meant = testing::value(designed("sqrt(70^2 - (y - 45)^2)", fields));
  for (const Warning& one : meant.report.warnings) CHECK(one.code != "mostly_blank");
}

TEST_CASE("where every slice would be blank there is no design", "[core][design][blank]") {
  const std::string fields = R"("units_per_slice":2,"slices":6,"widths_mm":10)";
  for (const char* radius : {"-5", "sqrt(-1 - y^2)", "0.1"}) {
    CAPTURE(radius);
    const auto made = designed(radius, fields);
    REQUIRE_FALSE(made);
    CHECK(made.error().kind == ErrorKind::Infeasible);
    CHECK_THAT(made.error().detail, Catch::Contains("all 6 slices"));
  }
}

TEST_CASE("without a card and at the edge of a patch no slice can be blank",
          "[core][design][blank]") {
  const auto loose =
      designed("35 - y", R"("units_per_slice":2,"slices":6,"widths_mm":10,"card":false)");
  REQUIRE_FALSE(loose);
  CHECK_THAT(loose.error().detail, Catch::Contains("must be positive"));
  const std::string patch =
      R"({"surface":{"type":"revolution","radius":"35 - y"},"units_per_slice":2,"slices":6,"widths_mm":10})";
  const auto spec =
      parse_design_spec(fmt::format(R"({{"popcut":1,"patches":[{},{}]}})", patch, patch));
  REQUIRE(spec);
  const auto made = design_assembly(*spec);
  REQUIRE_FALSE(made);
  CHECK(made.error().kind == ErrorKind::Infeasible);
  CHECK_THAT(made.error().detail, Catch::Contains("last slice would be blank"));
}

TEST_CASE("a gap of the target between two slices is a plain cut or a bridge",
          "[core][design][blank]") {
  // Nothing from y = 22 to 28: between the slices at 20 and 30, where their connector would be.
  const auto made = testing::value(
      designed("y < 22 ? 40 : (y < 28 ? -1 : 40)",
               R"("units_per_slice":3,"slices":6,"widths_mm":10,"lattice":"slices")"));
  CHECK(blanks_of(made.report).empty());
  CHECK(says(made.report, "with a gap of the target between them"));
  check_sound(made.pattern);
}

}  // namespace blank_slices_test
