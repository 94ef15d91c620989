// SPDX-License-Identifier: MIT
#include <chrono>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"

using namespace popcut;
using namespace popcut::tests;

namespace {

void report_time(int levels, int slices) {
  const CylinderCard card{.levels = levels,
                          .slices = slices,
                          .radius_mm = 100.0,
                          .width_mm = 150.0 / slices,
                          .margin_mm = 15.0};
  const std::string text = draft_of(card).text();
  const auto start = std::chrono::steady_clock::now();
  const auto report = verify_fold(text, {.degrees_of_freedom = 1});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  REQUIRE(report);
  WARN(fmt::format("{} x {}: {} rigid faces, {:.1f} MB, {:.2f} s, gap {:.1g} ({:.2g} | {:.2g})",
                   levels, slices, report->faces, static_cast<double>(text.size()) / 1e6,
                   taken.count(), report->gap, report->largest_zero, report->smallest_nonzero));
  CHECK(report->ok());
}

}  // namespace

TEST_CASE("time to verify a 5 x 10 lattice", "[.][bench][verify]") { report_time(5, 10); }
TEST_CASE("time to verify a 20 x 60 lattice", "[.][bench][verify]") { report_time(20, 60); }
TEST_CASE("time to verify a 50 x 200 lattice", "[.][bench][verify]") { report_time(50, 200); }
