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
#include "tests/support/random_numbers.hpp"

namespace soundness_property_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

namespace {

/// By the rank and the whole motion, and by the quick way that `design` itself goes.
void check_sound(const Pattern& pattern) {
  std::ostringstream fold;
  REQUIRE(write_fold(pattern, {}, fold));
  VerifyOptions options{.degrees_of_freedom = 1};
  for (const bool quick : {false, true}) {
    options.quick = quick;
    const auto report = verify_fold(fold.str(), options);
    if (!report) FAIL(message(report.error()));
    if (!report->ok()) FAIL_CHECK(verify_text(*report));
  }
}

}  // namespace

TEST_CASE("a cylinder in two regions is sound for all units beside each other",
          "[property][design][bridge]") {
  for (int left = 1; left <= 8; ++left)
    for (int right = 1; right <= 8; ++right)
      for (int slices = 1; slices <= 3; ++slices) {
        const std::string text = fmt::format(
            R"({{"popcut":1,"surface":{{"type":"revolution","radius":"60"}},"regions":[
               {{"units_per_slice":{0},"slices":{2},"width_mm":9}},
               {{"units_per_slice":{1},"slices":{2},"width_mm":9}}]}})",
            left, right, slices);
        CAPTURE(left, right, slices);
        const auto spec = parse_design_spec(text);
        REQUIRE(spec);
        const auto made = design(*spec);
        REQUIRE(made);
        check_sound(made->pattern);
      }
}

}  // namespace soundness_property_test
