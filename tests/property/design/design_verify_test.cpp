// SPDX-License-Identifier: MIT
// What the generator makes is checked by the verifier, which shares no code with it.
#include <random>
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/random_lattice.hpp"

namespace design_verify_test {

using namespace popcut;

TEST_CASE("random lattices pass through FOLD and verify with one freedom and no crossing",
          "[property][design][verify]") {
  const unsigned seed = 20261121;
  std::mt19937 random(seed);
  int made = 0;
  for (int k = 0; k < 150; ++k) {
    const std::string text = testing::random_lattice_spec(random);
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

}  // namespace design_verify_test
