// SPDX-License-Identifier: MIT
// What is designed is sound: the verifier, which shares no code with it, says so.
#include <map>
#include <random>
#include <regex>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/random_lattice.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace soundness_property_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

namespace {

/// By the rank and the whole motion, and by the quick way that `design` itself goes.
void check_sound(const Pattern& pattern, int freedoms = 1) {
  std::ostringstream fold;
  REQUIRE(write_fold(pattern, {}, fold));
  VerifyOptions options{.degrees_of_freedom = static_cast<std::size_t>(freedoms)};
  for (const bool quick : {false, true}) {
    options.quick = quick;
    const auto report = testing::value(verify_fold(fold.str(), options));
    if (!report.ok()) FAIL_CHECK(verify_text(report));
  }
}

const char* any_lattice(std::mt19937& random) {
  const char* names[] = {"branching", "slices", "conformal", "levels"};
  return names[whole(random, 0, 3)];
}

/// A radius over y, of which every second one leaves slices blank: a sphere that ends, a wave that
/// goes through zero, or nothing between two bodies.
std::string any_radius(std::mt19937& random, double size, double length) {
  const double a = uniform(random, 0.0, 0.5);
  switch (whole(random, 0, 5)) {
    case 0:
      return fmt::format("{:.3f}", size);
    case 1:
      return fmt::format("{:.3f}*(1+{:.3f}*sin({:.4f}*y+{:.3f}))", size, a,
                         uniform(random, 0, 8) / length, uniform(random, 0, 6));
    case 2:
      return fmt::format("sqrt({0:.3f}^2+(y-{1:.3f})^2)", size, 0.5 * length);
    case 3:
      return fmt::format("sqrt({:.3f}^2-(y-{:.3f})^2)", uniform(random, 0.3, 0.7) * length,
                         uniform(random, 0.3, 0.7) * length);
    case 4:
      return fmt::format("{:.3f}*sin({:.4f}*y+{:.3f})", size, uniform(random, 3, 9) / length,
                         uniform(random, 0, 3));
    default:
      return fmt::format("y < {0:.3f} ? {2:.3f} : (y < {1:.3f} ? -1 : {2:.3f})",
                         uniform(random, 0.1, 0.5) * length, uniform(random, 0.5, 0.9) * length,
                         size);
  }
}

/// One design without "popcut": regions on a common or on their own radii, or one with splay.
std::string any_design(std::mt19937& random, double size) {
  if (whole(random, 0, 5) == 0) {
    const int units = whole(random, 2, 4);
    const double width = uniform(random, 0.15, 0.4) * size / units;
    const int slices = whole(random, 2, 4);
    return fmt::format(
        R"j("surface":{{"type":"revolution","radius":"{}"}},"units_per_slice":{},"slices":{},
            "widths_mm":{:.3f},"lattice":"slices","splay":{{"alpha":{:.3f},"ligament_mm":0.2}})j",
        any_radius(random, size, 2 * width * slices), units, slices, 2 * width,
        uniform(random, 0.1, 0.6));
  }
  if (whole(random, 0, 9) == 0)  // without a card, or with widths that follow the curvature
    return fmt::format(
        R"j("surface":{{"type":"revolution","radius":"{:.3f}*(1+{:.3f}*sin({:.4f}*y))"}},
            "units_per_slice":{},"slices":{},{},"lattice":"slices")j",
        size, uniform(random, 0, 0.2), uniform(random, 0.02, 0.1), whole(random, 2, 6),
        whole(random, 2, 6),
        whole(random, 0, 1) == 0 ? R"("widths_mm":8,"card":false)"
                                 : R"("widths_mm":{"max_error_mm":1})");
  const bool common = whole(random, 0, 1) == 0;
  double length = 0.0;
  std::string regions;
  for (int r = whole(random, 1, 3); r > 0; --r) {
    const int slices = whole(random, 1, 4);
    const double width = uniform(random, 2, 20);
    length += slices * width;
    regions += fmt::format(R"j({}{{"units_per_slice":{},"slices":{},"width_mm":{:.3f})j",
                           regions.empty() ? "" : ",", whole(random, 1, 8), slices, width);
    if (!common)
      regions += fmt::format(R"j(,"radius":"{}")j", any_radius(random, size, slices * width));
    regions += "}";
  }
  std::string text = fmt::format(R"("regions":[{}],"lattice":"{}")", regions, any_lattice(random));
  if (common)
    text += fmt::format(R"j(,"surface":{{"type":"revolution","radius":"{}"}})j",
                        any_radius(random, size, length));
  return text;
}

std::string any_spec(std::mt19937& random) {
  const double size = uniform(random, 25, 100), least = uniform(random, 0.05, 0.8);
  if (whole(random, 0, 4) > 0)
    return fmt::format(R"({{"popcut":1,{},"min_panel_mm":{:.3f}}})", any_design(random, size),
                       least);
  // Patches agree at their borders, so they are pieces of one target.
  const int count = whole(random, 2, 3);
  std::string patches;
  for (int p = 0; p < count; ++p)
    patches += fmt::format(
        R"j({}{{"surface":{{"type":"revolution","radius":"{:.3f}+{:.3f}*sin(pi*y/30)"}},
              "units_per_slice":{},"slices":{},"widths_mm":{:.3f},"lattice":"{}"}})j",
        p == 0 ? "" : ",", size, uniform(random, 0.0, 0.02) * size, whole(random, 1, 8),
        whole(random, 1, 4), uniform(random, 2, 20), any_lattice(random));
  return fmt::format(R"({{"popcut":1,"patches":[{}],"join_tolerance_mm":8,"min_panel_mm":{:.3f}}})",
                     patches, least);
}

/// A refusal without its numbers.
std::string reason_of(const Error& error) {
  static const std::regex number("[-+]?[0-9][0-9.e+-]*");
  return std::regex_replace(error.place + ": " + error.detail, number, "#");
}

}  // namespace

TEST_CASE("a cylinder in two regions is sound for all units beside each other",
          "[property][design][bridge]") {
  for (int left = 1; left <= 8; ++left)
    for (int right = 1; right <= 8; ++right)
      for (int slices = 1; slices <= testing::rounds(3, 3); ++slices) {
        const std::string text = fmt::format(
            R"({{"popcut":1,"surface":{{"type":"revolution","radius":"60"}},"regions":[
               {{"units_per_slice":{0},"slices":{2},"width_mm":9}},
               {{"units_per_slice":{1},"slices":{2},"width_mm":9}}]}})",
            left, right, slices);
        CAPTURE(left, right, slices);
        const auto made = testing::value(design(testing::value(parse_design_spec(text))));
        check_sound(made.pattern);
      }
}

TEST_CASE("500 random designs are sound, and few are refused", "[property][design]") {
  const unsigned seed = 20261127;
  std::mt19937 random(seed);
  int made = 0, refused = 0, blank = 0, splayed = 0, sheets = 0, loose = 0;
  std::map<std::string, int> reasons;
  const int specs = testing::rounds(500);
  for (int k = 0; k < specs; ++k) {
    const std::string text = any_spec(random);
    CAPTURE(seed, k, text);
    const auto spec = testing::value(parse_design_spec(text));
    const auto designed = design_assembly(spec);
    if (!designed) {
      CHECK(designed.error().kind == ErrorKind::Infeasible);
      ++reasons[reason_of(designed.error())], ++refused;
      continue;
    }
    ++made;
    for (const Design& part : designed->parts) {
      check_sound(part.pattern, spec.card ? 1 : part.report.degrees_of_freedom);
      loose += spec.card ? 0 : 1;
      splayed += part.pattern.v_folds.empty() ? 0 : 1;
      sheets += designed->patches.empty() ? 0 : 1;
      for (const SliceReport& slice : part.report.slices) blank += slice.blank ? 1 : 0;
    }
  }
  std::string said;
  for (const auto& [reason, count] : reasons) said += fmt::format("\n{:4} {}", count, reason);
  WARN(
      fmt::format("{} made, {} slices of them blank, {} splayed, {} of patches, {} without a card; "
                  "{} refused:{}",
                  made, blank, splayed, sheets, loose, refused, said));
  CHECK(refused < specs / 10);
  CHECK(blank > specs / 5);
  CHECK(splayed > specs / 20);
  CHECK(sheets > specs / 10);
  CHECK(loose > 0);
}

TEST_CASE("random lattices pass through FOLD and verify with one freedom and no crossing",
          "[property][design][verify]") {
  const unsigned seed = 20261121;
  std::mt19937 random(seed);
  int made = 0;
  for (int k = 0; k < 150; ++k) {
    const std::string text = testing::random_lattice_spec(random);
    CAPTURE(seed, k, text);
    const auto result = design(testing::value(parse_design_spec(text)));
    if (!result) {  // too many units for the size: said, not made
      CHECK(result.error().kind == ErrorKind::Infeasible);
      continue;
    }
    ++made;
    std::ostringstream fold;
    REQUIRE(write_fold(result->pattern, {}, fold));
    VerifyOptions options;
    options.degrees_of_freedom = 1;
    const auto report = testing::value(verify_fold(fold.str(), options));
    if (!report.ok()) FAIL(verify_text(report));
    CHECK(report.faces == result->report.faces);
  }
  CHECK(made > 120);
}

}  // namespace soundness_property_test
