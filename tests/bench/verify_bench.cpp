// SPDX-License-Identifier: MIT
#include <chrono>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/verify/motion/opening.hpp"
#include "core/verify/motion/rigid.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/value.hpp"

namespace verify_bench {

using namespace popcut;
using namespace popcut::testing;

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

/// The same lattice without its poses: the solver opens it.
void report_opening_time(int levels, int slices, bool bent) {
  const CylinderCard card{.levels = levels,
                          .slices = slices,
                          .radius_mm = 100.0,
                          .width_mm = 150.0 / slices,
                          .margin_mm = 15.0};
  FoldDraft draft = draft_of(card);
  draft.poses.clear();
  draft.key_angle_deg.clear();
  auto file = value(verify::read_fold_model(draft.text()));
  VerifyCheck check;
  const verify::Sheet sheet = make_sheet(file, check);
  const double psi[] = {2.6, 2.1, 1.5707963267948966, 1.1};
  const auto start = std::chrono::steady_clock::now();
  const verify::Trajectory opening = open_sheet(file, sheet, psi, 1e-9);
  std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  WARN(fmt::format("{} x {}: {} panels opened in {:.3f} s, {} steps, {} iterations, gap {:.1e} mm",
                   levels, slices, sheet.panels, taken.count(), opening.steps, opening.iterations,
                   opening.gap_mm));
  CHECK(opening.stopped.empty());
  if (!bent) return;
  // One Gauss-Newton correction from a bad guess: what a step costs where nothing is exact.
  const verify::RigidSheet rigid = rigid_sheet(file, sheet, 0);
  auto angles = std::vector<double>(rigid.lines.size());
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const auto letter = file.assignment[sheet.hinges[rigid.lines[k].hinge].edge];
    angles[k] = (letter == verify::Assignment::Valley ? 0.5 : -0.5) * (1.0 + 0.02 * (k % 7));
  }
  auto state = state_from_tree(rigid, angles);
  verify::RigidSolver solver(rigid);
  const verify::AngleGoal goal{0, angles[0], 1.0};
  const auto again = std::chrono::steady_clock::now();
  const auto end = solver.correct(state, {&goal, 1}, 50);
  taken = std::chrono::steady_clock::now() - again;
  WARN(fmt::format("{} x {}: {} Gauss-Newton iterations in {:.3f} s, gap {:.1e} mm", levels, slices,
                   end.iterations, taken.count(), end.gap_mm));
}

}  // namespace

TEST_CASE("time to open a 10 x 10 lattice", "[.][bench][verify]") {
  report_opening_time(10, 10, true);
}
TEST_CASE("time to open a 50 x 200 lattice", "[.][bench][verify]") {
  report_opening_time(50, 200, false);
}
TEST_CASE("time to verify a 100 x 200 lattice", "[.][bench][verify]") { report_time(100, 200); }
TEST_CASE("time to verify a 5 x 10 lattice", "[.][bench][verify]") { report_time(5, 10); }
TEST_CASE("time to verify a 20 x 60 lattice", "[.][bench][verify]") { report_time(20, 60); }
TEST_CASE("time to verify a 50 x 200 lattice", "[.][bench][verify]") { report_time(50, 200); }

}  // namespace verify_bench
