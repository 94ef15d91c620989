// SPDX-License-Identifier: MIT
// What the generator makes is checked by the verifier, which shares no code with it.
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/formats/fold_writer.hpp"
#include "core/verify/verify.hpp"

using namespace popcut;

namespace {

/// A lawful spec: a smooth radius or a falling profile, any method, even or uneven widths.
std::string random_spec(std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto whole = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const int units = whole(1, 9), slices = whole(1, 9);
  const double size = real(25, 120);
  std::string surface;
  if (whole(0, 3) > 0)
    surface = fmt::format(
        R"j("type":"revolution","radius":"{:.4f}*(1 + {:.3f}*sin({:.4f}*y + {:.3f}))")j", size,
        real(0, 0.6), real(0, 0.1), real(0, 6));
  else
    surface = fmt::format(
        R"j("type":"profile","z":"{:.4f}*(1 - (x/{:.4f})^{:.3f})*(1 + {:.3f}*cos(y/40))")j", size,
        real(25, 120), real(1, 4), real(0, 0.3));
  std::string widths;
  if (whole(0, 1) == 0) {
    widths = fmt::format("{:.3f}", real(1, 20));
  } else {
    for (int j = 0; j < slices; ++j)
      widths += fmt::format("{}{:.3f}", j == 0 ? "[" : ",", real(1, 20));
    widths += "]";
  }
  const char* lattices[] = {"branching", "slices", "conformal", "levels"};
  return fmt::format(
      R"({{"popcut":1,"surface":{{{}}},"units_per_slice":{},"slices":{},"widths_mm":{},"lattice":"{}",
          "min_panel_mm":{:.3f}}})",
      surface, units, slices, widths, lattices[whole(0, 3)], real(0.05, 0.8));
}

}  // namespace

TEST_CASE("random lattices pass through FOLD and verify with one freedom and no crossing",
          "[property][design][verify]") {
  const unsigned seed = 20261121;
  std::mt19937 random(seed);
  int made = 0;
  for (int k = 0; k < 150; ++k) {
    const std::string text = random_spec(random);
    CAPTURE(seed, k, text);
    const auto spec = parse_design_spec(text);
    REQUIRE(spec);
    const auto result = design(*spec);
    if (!result) {  // too many units for the size: said, not made
      CHECK(result.error().kind == ErrorKind::Infeasible);
      continue;
    }
    ++made;
    std::ostringstream fold;
    REQUIRE(write_fold(result->pattern, {}, fold));
    VerifyOptions options;
    options.degrees_of_freedom = 1;
    const auto report = verify_fold(fold.str(), options);
    if (!report) FAIL(message(report.error()));
    if (!report->ok()) FAIL(verify_text(*report));
    CHECK(report->faces == result->report.faces);
  }
  CHECK(made > 120);
}
