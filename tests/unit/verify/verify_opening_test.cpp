// SPDX-License-Identifier: MIT
// Patterns without an opened pose: the rigid-panel solver opens them.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/motion/sweep.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/value.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_opening_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

constexpr double kPi = std::numbers::pi;

/// A vertex of four creases in the middle of a disc of radius 30, at these directions.
FoldDraft four_folds(const std::vector<double>& at_deg, const std::string& letters) {
  FoldDraft draft;
  draft.flat.push_back({0.0, 0.0});
  const std::size_t n = at_deg.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = at_deg[k] * kPi / 180.0;
    draft.flat.push_back({30.0 * std::cos(angle), 30.0 * std::sin(angle)});
    draft.edges.push_back({0, k + 1});
    draft.assignment += letters[k];
  }
  for (std::size_t k = 0; k < n; ++k) {
    draft.edges.push_back({k + 1, (k + 1) % n + 1});
    draft.assignment += 'B';
    draft.faces.push_back({0, k + 1, (k + 1) % n + 1});
  }
  return draft;
}

FoldDraft without_poses(FoldDraft draft, bool keep_angles) {
  draft.poses.clear();
  if (!keep_angles) draft.key_angle_deg.clear();
  return draft;
}

}  // namespace

TEST_CASE("a flat pattern opens to its designed poses", "[core][verify]") {
  std::vector<FoldDraft> drafts{box_card(), draft_of(CylinderCard{.levels = 4, .slices = 3})};
  for (const double alpha : {0.3, 0.8, 1.4, 2.5}) {
    FoldDraft draft = splayed_card(alpha, 1.1);
    const FoldDraft right = splayed_card(alpha, kPi / 2.0);
    draft.poses.push_back(right.poses[0]);
    draft.key_angle_deg = right.key_angle_deg;
    drafts.push_back(draft);
  }
  for (std::size_t k = 0; k < drafts.size(); ++k) {
    for (const bool angles : {true, false}) {
      CAPTURE(k, angles);
      const auto known = verify::read_fold_model(drafts[k].text());
      auto file = value(verify::read_fold_model(without_poses(drafts[k], angles).text()));
      VerifyCheck check;
      const verify::Sheet sheet = make_sheet(file, check);
      const double psi[] = {kPi / 2.0, 1.1};
      const verify::Trajectory opening = open_sheet(file, sheet, psi, 1e-9);
      INFO(opening.stopped);
      REQUIRE(opening.poses.size() == 2);
      CHECK(opening.gap_mm < 1e-11);
      for (const verify::Pose& pose : known->poses) {
        for (const verify::Pose& opened : opening.poses) {
          if (std::abs(*opened.psi_rad - *pose.psi_rad) > 1e-9) continue;
          CHECK(largest_difference(file, sheet, opened, pose) < 1e-9);
        }
      }
    }
  }
}

TEST_CASE("a pattern without a deployed frame is checked in computed poses", "[core][verify]") {
  for (const bool flat_frame : {true, false}) {
    CAPTURE(flat_frame);
    FoldDraft draft = box_card();
    draft.poses.resize(flat_frame ? 1 : 0);  // psi = pi: flat
    const VerifyReport report = verified(draft, {.degrees_of_freedom = 1});
    INFO(verify_text(report));
    CHECK(report.ok());
    REQUIRE(report.opening);
    CHECK(report.opening->reached_psi_rad == Approx(1.1));
    CHECK(report.opening->driver_length_mm == Approx(50.0));  // the spine, margin to margin
    CHECK(report.crossing_method == "exact");
    CHECK(has(verify_text(report), "opened step by step"));
    CHECK(has(verify_json(report), "\"reached_psi_rad\""));
  }
  CHECK(has(verify_json(verified(box_card())), "\"opening\": null"));
}

TEST_CASE("a crossing that only occurs during opening is found", "[core][verify]") {
  // 40 right, 20 up, 20 left, 30 down, as soon as it is opened to a right angle.
  FoldDraft draft = folded_strip({0.0, 40.0, 60.0, 80.0, 110.0}, {90.0, 90.0, 90.0});
  const VerifyReport report = verified(without_poses(draft, true));
  INFO(verify_text(report));
  CHECK(has(failures(report, "crossing"), "cross near"));
  CHECK(report.degrees_of_freedom == 3U);
  CHECK(has(verify_text(report), "of the many ways to open it"));
}

TEST_CASE("a crossing on one of many motions is not judged", "[core][verify]") {
  // The same strip without its angles: how far each fold turns is popcut's choice.
  FoldDraft draft = folded_strip({0.0, 40.0, 60.0, 80.0, 110.0}, {90.0, 90.0, 90.0});
  const VerifyReport report = verified(without_poses(draft, false));
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.degrees_of_freedom == 3U);
  CHECK(has(verify_text(report), "not judged: with 3 degrees of freedom"));
  const auto check = std::find_if(report.checks.begin(), report.checks.end(),
                                  [](const VerifyCheck& c) { return c.name == "crossing"; });
  REQUIRE(check != report.checks.end());
  CHECK_FALSE(check->ran);
}

TEST_CASE("a sheet is opened as far as its listed angle and no farther", "[core][verify]") {
  FoldDraft draft = folded_strip({0.0, 40.0, 60.0, 80.0, 110.0}, {40.0, 40.0, 40.0});
  const VerifyReport report = verified(without_poses(draft, true));
  INFO(verify_text(report));
  CHECK(report.ok());
  REQUIRE(report.opening);
  CHECK(report.opening->reached_psi_rad == Approx(kPi - 40.0 * kPi / 180.0));
}

TEST_CASE("a flat-foldable vertex opens with the speeds of its half-angle tangents",
          "[core][verify]") {
  // Degree four, opposite angles add up to 180 degrees: tangents of half angles keep their ratio.
  const FoldDraft draft = four_folds({0.0, 70.0, 180.0 - 40.0 + 0.0, 250.0}, "VVVM");
  const VerifyReport report = verified(draft, {.degrees_of_freedom = 1});
  INFO(verify_text(report));
  CHECK(report.degrees_of_freedom == 1U);
  REQUIRE(report.opening);
  CHECK(report.opening->gap_mm < 1e-11);
}

TEST_CASE("assignments that no rigid motion follows are reported as the wrong branch",
          "[core][verify]") {
  // Four valleys about a vertex: one of them must turn the other way.
  const VerifyReport report = verified(four_folds({0.0, 80.0, 170.0, 250.0}, "VVVV"));
  INFO(verify_text(report));
  CHECK_FALSE(report.ok());
  CHECK(has(failures(report, "opening"), "wrong branch"));
}

TEST_CASE("folds that stay flat during the motion are reported", "[core][verify]") {
  // Two straight valleys that cross: either one folds, never both.
  const VerifyReport report = verified(four_folds({0.0, 90.0, 180.0, 270.0}, "VVVV"));
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(has(verify_text(report), "2 folds stay flat in this motion"));
}

TEST_CASE("a sheet that cannot leave the flat state is reported", "[core][verify]") {
  SECTION("three folds about a vertex") {
    const VerifyReport report = verified(four_folds({0.0, 120.0, 240.0}, "VVM"));
    INFO(verify_text(report));
    CHECK_FALSE(report.ok());
    CHECK_FALSE(report.degrees_of_freedom);
    CHECK(has(failures(report, "opening"), "flat sheet does not open"));
  }
  SECTION("no fold at all") {
    const VerifyReport report = verified(four_folds({0.0, 120.0, 240.0}, "FFF"));
    CHECK(has(failures(report, "opening"), "no two rigid faces have a fold between them"));
  }
}

TEST_CASE("a fold that closes early ends the motion and is not a failure", "[core][verify]") {
  // The two short sectors fold onto each other long before the long fold is shut.
  const VerifyReport report = verified(four_folds({0.0, 80.0, 100.0, 230.0}, "VMVV"));
  INFO(verify_text(report));
  REQUIRE(report.opening);
  CHECK(report.opening->reached_psi_rad > 0.0);
  CHECK(report.poses > 0);
}

namespace {

/// Two V-folds back to back on the crease of a card, the apexes 10 mm apart: with alpha 2 the tips
/// draw back past the apexes, and into each other where the card is nearly shut.
FoldDraft two_back_to_back(double apart, double psi) {
  const double w = 10.0;
  const double alpha = 2.0;
  const double side = 30.0;
  const double theta = 2.0 * std::atan2(alpha * std::cos(psi / 2.0), 1.0);
  FoldDraft draft;
  FoldDraft::Pose pose{psi, {}, {}};
  const auto on_card = [&](double u, double v) {
    const double x = u - side;
    draft.flat.push_back({u, v});
    pose.at.push_back(x > 0.0 ? std::array{x, v, 0.0}
                              : std::array{-x * std::cos(psi), v, -x * std::sin(psi)});
  };
  const auto edge = [&](std::size_t a, std::size_t b, char letter, double angle) {
    draft.edges.push_back({a, b});
    draft.assignment += letter;
    draft.key_angle_deg.push_back(angle);
  };
  const double crease = (kPi - psi) * 180.0 / kPi;
  const double flank =
      2.0 * std::atan(std::sqrt(1.0 + alpha * alpha) / std::tan(psi / 2.0)) * 180.0 / kPi;
  for (const double v : {0.0, 60.0}) {
    for (const double u : {0.0, side, 2.0 * side}) on_card(u, v);
  }
  // From 6 and from 11: O, B, C, the crease beyond the slit, A.
  for (const double way : {-1.0, 1.0}) {
    const double o = 30.0 + way * apart / 2.0;
    on_card(side, o);
    on_card(side - w * alpha, o + way * w);
    on_card(side + w * alpha, o + way * w);
    on_card(side, o + way * w);
    draft.flat.push_back({side, o + way * w});
    pose.at.push_back({w * std::sin(theta) * std::cos(psi / 2.0), o + way * w * std::cos(theta),
                       w * std::sin(theta) * std::sin(psi / 2.0)});
  }
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 5}, {5, 4}, {4, 3}, {3, 0}})
    edge(static_cast<std::size_t>(a), static_cast<std::size_t>(b), 'B', 0.0);
  for (const std::size_t o : {6U, 11U}) {
    for (const std::size_t middle : {o + 3, o + 4}) {
      edge(o + 1, middle, 'B', 0.0);
      edge(middle, o + 2, 'B', 0.0);
    }
    edge(o, o + 4, 'M', -crease);
    edge(o, o + 1, 'V', flank);
    edge(o, o + 2, 'V', flank);
  }
  edge(1, 9, 'V', crease);
  edge(6, 11, 'V', crease);
  edge(14, 4, 'V', crease);
  draft.faces = {{0, 1, 9, 7, 6, 11, 12, 14, 4, 3},
                 {1, 2, 5, 4, 14, 13, 11, 6, 8, 9},
                 {6, 7, 10},
                 {6, 10, 8},
                 {11, 15, 12},
                 {11, 13, 15}};
  pose.angle_deg = draft.key_angle_deg;
  draft.poses.push_back(pose);
  return draft;
}

}  // namespace

TEST_CASE("a crossing is found between and beyond the poses that a file shows", "[core][verify]") {
  // Tips meet where 2 w cos(theta) = -apart: at psi 1.67 rad for 6 mm, beyond 1.9 for none.
  const VerifyReport open = verified(two_back_to_back(6.0, 2.5), {.degrees_of_freedom = 1});
  INFO(verify_text(open));
  CHECK_FALSE(passes(open, "crossing"));
  CHECK(open.crossing_method == "sampled");
  CHECK(has(failures(open, "crossing"), "moved to psi"));
  const VerifyReport far = verified(two_back_to_back(13.0, 2.5), {.degrees_of_freedom = 1});
  INFO(verify_text(far));
  CHECK(far.ok());
  CHECK(has(verify_text(far), "of the whole motion, psi from 3.12 to 0.02 rad"));
}

TEST_CASE("the motion of a splayed card equals the closed form in every pose", "[core][verify]") {
  const auto file = value(verify::read_fold_model(splayed_card(1.4, 2.5).text()));
  VerifyCheck check;
  const verify::Sheet sheet = make_sheet(file, check);
  const auto pose = std::find_if(file.poses.begin(), file.poses.end(),
                                 [](const verify::Pose& p) { return p.psi_rad.has_value(); });
  REQUIRE(pose != file.poses.end());
  const verify::Panels panels = make_panels(file, sheet);
  const verify::Sweep sweep =
      sweep_motion(file, sheet, measure(file, sheet, panels, *pose), kPi / 60.0, 1e-9);
  CHECK(sweep.stopped.empty());
  CHECK(sweep.poses.size() >= 60);
  for (const verify::Pose& moved : sweep.poses) {
    const auto known = value(verify::read_fold_model(splayed_card(1.4, *moved.psi_rad).text()));
    CAPTURE(*moved.psi_rad);
    CHECK(largest_difference(file, sheet, moved, known.poses.back()) < 1e-9);
  }
}

}  // namespace verify_opening_test
