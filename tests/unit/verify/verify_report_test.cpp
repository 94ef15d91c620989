// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_report_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("the distance from a target is measured at the connectors", "[core][verify]") {
  const FoldDraft draft =
      draft_of(CylinderCard{.levels = 5, .slices = 4, .radius_mm = 30.0, .width_mm = 10.0});
  const auto spec = [](const std::string& surface) {
    return R"({"popcut":1,"surface":)" + surface +
           R"(,"scale_mm":10,"units_per_slice":5,"slices":4,"widths_mm":10})";
  };
  SECTION("a cylinder of the pattern's radius") {
    for (const char* surface : {R"j({"type":"revolution","radius":"3"})j",
                                R"j({"type":"profile","z":"sqrt(abs(9-x^2))*(x<3)"})j"}) {
      CAPTURE(surface);
      const VerifyReport report =
          verified(draft, {.degrees_of_freedom = 1, .target_spec = spec(surface)});
      REQUIRE(report.target_inner);
      CHECK(report.ok());
      CHECK(report.target_inner->vertices == 3 * 4);
      CHECK(report.target_all->vertices == 3 * 6);
      CHECK(report.target_inner->max_mm < 1e-6);
      CHECK(report.target_all->max_mm < 1e-5);
    }
  }
  SECTION("a cylinder a millimetre larger") {
    const VerifyReport report = verified(
        draft,
        {.degrees_of_freedom = 1, .target_spec = spec(R"({"type":"revolution","radius":"3.1"})")});
    CHECK(report.target_inner->rms_mm == Approx(1.0));
    CHECK(report.target_inner->max_mm == Approx(1.0));
  }
  SECTION("a cone: y is the place along the spine") {
    const VerifyReport report =
        verified(draft, {.degrees_of_freedom = 1,
                         .target_spec = spec(R"({"type":"revolution","radius":"3+y/10"})")});
    // connectors at s = 5, 15 and 25 mm: 0.5, 1.5 and 2.5 mm off
    CHECK(report.target_inner->max_mm == Approx(2.5));
    CHECK(report.target_inner->rms_mm == Approx(std::sqrt((0.25 + 2.25 + 6.25) / 3.0)));
  }
  SECTION("a spec that cannot be used") {
    const auto bad = verify_fold(
        draft.text(),
        {.degrees_of_freedom = 1, .target_spec = spec(R"({"type":"revolution","radius":"3+"})")});
    REQUIRE_FALSE(bad);
    CHECK(has(message(bad.error()), "target: /surface/radius"));
    CHECK(exit_code(bad.error().kind) == 3);
  }
}

TEST_CASE("the report is one JSON document with every figure", "[core][verify]") {
  const std::string json = verify_json(verified(box_card()));
  for (const char* member :
       {"\"ok\": true", "\"degrees_of_freedom\": 1", "\"singular_values\"", "\"pieces\": 1",
        "\"faces\": 4", "\"isometry_mm\"", "\"checks\"", "\"crossing\": \"exact\""}) {
    CAPTURE(member);
    CHECK(has(json, member));
  }
}

}  // namespace verify_report_test
