// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_angles_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// The text of a draft without what makes it popcut's own: the opening angles of its frames.
std::string foreign(const FoldDraft& draft) {
  std::string text = draft.text();
  const std::string name = "frame_popcut:psi_rad";
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
    text.replace(at, name.size(), "frame_other:psi_rad_");
  return text;
}

}  // namespace

TEST_CASE("an opening angle that the pose does not show is named", "[core][verify]") {
  for (const double told : {1.2, 0.0, -1.0, 7.0, 3.14159}) {
    CAPTURE(told);
    FoldDraft draft = box_card();
    draft.poses[2].psi_rad = told;
    const VerifyReport report = verified(draft);
    INFO(verify_text(report));
    CHECK_FALSE(report.ok());
    CHECK(has(failures(report, "fold_angles"), "/file_frames/2/frame_popcut:psi_rad"));
    CHECK(has(failures(report, "fold_angles"), "is open to 1.1 rad"));
  }
  CHECK(verified(box_card()).ok());
}

TEST_CASE("a fold that is called a border is named whatever the freedoms", "[core][verify]") {
  FoldDraft draft = box_card();
  std::size_t fold = draft.assignment.find('M');
  draft.assignment[fold] = 'B';
  draft.key_angle_deg[fold] = 0.0;
  for (auto& pose : draft.poses) pose.angle_deg[fold] = 0.0;
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "faces"), "/edges_vertices/" + std::to_string(fold)));
}

TEST_CASE("a border that is called unassigned is named or noted", "[core][verify]") {
  FoldDraft draft = box_card();
  const std::size_t border = draft.assignment.find('B');
  draft.assignment[border] = 'U';
  SECTION("in popcut's own file it fails") {
    const VerifyReport report = verified(draft);
    CHECK(has(failures(report, "faces"), "/edges_vertices/" + std::to_string(border)));
    CHECK(has(failures(report, "faces"), "unassigned edge has only one face"));
  }
  SECTION("elsewhere it counts as a border and the report says so") {
    const auto report = verify_fold(foreign(draft));
    REQUIRE(report);
    INFO(verify_text(*report));
    CHECK(report->ok());
    CHECK(has(verify_text(*report), "1 unassigned edge with a face on one side only counts"));
  }
}

TEST_CASE("an unused vertex does not loosen the limits", "[core][verify]") {
  for (const double far : {0.0, 1e6}) {
    CAPTURE(far);
    FoldDraft draft = box_card();
    draft.flat.push_back({far, far});
    for (auto& pose : draft.poses) pose.at.push_back({far, far, 0.0});
    const auto sound = verify_fold(foreign(draft));
    REQUIRE(sound);
    INFO(verify_text(*sound));
    CHECK(sound->ok());
    CHECK(sound->sheet_u_mm == 80.0);
    draft.poses[2].at[0][1] -= 0.05;  // a corner, half a tenth of a millimetre
    const auto report = verify_fold(foreign(draft));
    REQUIRE(report);
    CHECK_FALSE(report->ok());
    CHECK(has(failures(*report, "isometry"), "/file_frames/2"));
  }
}

}  // namespace verify_angles_test
