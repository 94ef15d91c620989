// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/value.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_sheet_test {

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

TEST_CASE("faces that overlap on the sheet are named with the area", "[core][verify]") {
  FoldDraft draft = box_card();
  // The left side of the box (v = 10, between its slit's ends at u = 20 and 65) reaches over the
  // margin.
  for (std::size_t i = 0; i < draft.flat.size(); ++i) {
    if (draft.flat[i][0] == 45.0 && draft.flat[i][1] == 10.0) draft.flat[i][1] = 7.0;
  }
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "tiling"), "it overlaps face"));
  CHECK(has(failures(report, "lines"), "without a vertex"));
}

TEST_CASE("a hole is no slit, however small it is beside its sheet", "[core][verify]") {
  const VerifyReport report = verify_fold(R"({
    "file_spec": 1.2, "frame_classes": ["creasePattern"], "frame_unit": "mm",
    "vertices_coords": [[0,0],[450,0],[900,0],[900,900],[450,900],[0,900],
                        [450,400],[450.4,400],[450.4,406],[450,406]],
    "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,6],[9,4],[6,7],[7,8],[8,9],[9,6]],
    "edges_assignment": ["B","B","B","B","B","B","M","M","B","B","B","B"],
    "faces_vertices": [[0,1,6,9,4,5],[1,2,3,4,9,8,7,6]]})",
                                          {})
                                  .value();
  CHECK(report.slits == 0);
  CHECK(failures(report, "tiling").empty());
}

TEST_CASE("a cut that splits the sheet is reported with the part that falls off",
          "[core][verify]") {
  FoldDraft draft = box_card();
  for (std::size_t e = 0; e < draft.edges.size(); ++e) {
    const auto [a, b] = draft.edges[e];
    const bool seam = draft.flat[a][1] == 40.0 && draft.flat[b][1] == 40.0;
    if (seam && draft.assignment[e] == 'F') draft.assignment[e] = 'C';
  }
  const VerifyReport report = verified(draft);
  CHECK(report.pieces == 2);
  CHECK(has(failures(report, "pieces"), "2 faces are cut off from the rest of the sheet"));
}

TEST_CASE("a cut drawn as one edge separates its faces and a border between two is named",
          "[core][verify]") {
  for (const char letter : {'B', 'C'}) {
    CAPTURE(letter);
    FoldDraft draft = box_card();
    for (std::size_t e = 0; e < draft.edges.size(); ++e) {
      const auto [a, b] = draft.edges[e];
      if (draft.flat[a][1] == 40.0 && draft.flat[b][1] == 40.0 && draft.flat[a][0] < 40.0 &&
          draft.assignment[e] == 'F') {
        draft.assignment[e] = letter;
      }
    }
    const VerifyReport report = verified(draft);
    INFO(verify_text(report));
    CHECK(report.ok() == (letter == 'C'));
    CHECK(has(failures(report, "faces"), "the border has two faces") == (letter == 'B'));
    CHECK(report.faces == 5);  // the wall's margin is a flap of its own now
    CHECK(report.hinges == 5);
    CHECK(report.degrees_of_freedom == 2U);
  }
}

TEST_CASE("a missing face leaves folds with one face", "[core][verify]") {
  FoldDraft draft = box_card();
  draft.faces.erase(draft.faces.begin() + 3);
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "faces"), "has only one face"));
}

TEST_CASE("a face that runs clockwise is named", "[core][verify]") {
  FoldDraft draft = box_card();
  std::reverse(draft.faces[3].begin(), draft.faces[3].end());
  CHECK(has(failures(verified(draft), "faces"), "/faces_vertices/3: the face runs clockwise"));
}

TEST_CASE("a line outside the sheet and a doubled cut are named", "[core][verify]") {
  FoldDraft draft = box_card();
  SECTION("a cut outside") {
    draft.flat.push_back({100.0, 0.0});
    draft.flat.push_back({120.0, 0.0});
    for (auto& pose : draft.poses) pose.at.insert(pose.at.end(), 2, {0.0, 0.0, 0.0});
    draft.edges.push_back({draft.flat.size() - 2, draft.flat.size() - 1});
  }
  SECTION("a cut along the side of a slit") {
    const std::size_t a = vertex_at(draft, 20.0, 10.0);
    const std::size_t b = vertex_at(draft, 40.0, 10.0);
    draft.edges.push_back({a, b});
  }
  draft.assignment += 'C';
  draft.key_angle_deg.push_back(0.0);
  for (auto& pose : draft.poses) pose.angle_deg.push_back(0.0);
  const VerifyReport report = verified(draft);
  CHECK_FALSE(passes(report, "faces"));
  const std::string found = failures(report, "faces") + failures(report, "lines");
  CHECK(has(found, "/edges_vertices/" + std::to_string(draft.edges.size() - 1)));
}

TEST_CASE("a fold must end at a vertex that interrupts it", "[core][verify]") {
  FoldDraft draft = folded_strip({0.0, 10.0, 20.0}, {70.0});
  // A slit from the rim of face 0 ends on the middle of the fold, which knows nothing of it.
  const std::size_t rim = draft.flat.size();
  draft.flat.push_back({0.0, 5.0});
  draft.flat.push_back({10.0, 5.0});
  draft.poses[0].at.push_back({0.0, 5.0, 0.0});
  draft.poses[0].at.push_back({10.0, 5.0, 0.0});
  draft.edges.push_back({rim, rim + 1});
  draft.assignment += 'C';
  draft.key_angle_deg.push_back(0.0);
  draft.poses[0].angle_deg.push_back(0.0);
  CHECK(has(failures(verified(draft), "lines"), "lies inside this fold; split the line there"));
}

TEST_CASE("a cut may make a notch into one face", "[core][verify]") {
  FoldDraft draft = folded_strip({0.0, 10.0, 20.0}, {70.0});
  const std::size_t rim = draft.flat.size();
  draft.flat.push_back({0.0, 5.0});
  draft.flat.push_back({6.0, 5.0});
  draft.poses[0].at.push_back({0.0, 5.0, 0.0});
  draft.poses[0].at.push_back({6.0, 5.0, 0.0});
  draft.edges[0] = {0, rim};
  draft.edges.push_back({rim, 1});
  draft.edges.push_back({rim, rim + 1});
  draft.assignment += "BC";
  draft.key_angle_deg.insert(draft.key_angle_deg.end(), 2, 0.0);
  draft.poses[0].angle_deg = draft.key_angle_deg;
  draft.faces[0] = {0, 2, 3, 1, rim, rim + 1, rim};
  for (const bool faces_given : {true, false}) {
    CAPTURE(faces_given);
    if (!faces_given) draft.faces.clear();
    const auto report = value(verify_fold(draft.text()));
    INFO(verify_text(report));
    CHECK(report.ok());
    CHECK(report.faces == 2);
    CHECK(report.area_mm2 == Approx(200.0));
  }
}

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
    const auto report = value(verify_fold(foreign(draft)));
    INFO(verify_text(report));
    CHECK(report.ok());
    CHECK(has(verify_text(report), "1 unassigned edge with a face on one side only counts"));
  }
}

TEST_CASE("an unused vertex does not loosen the limits", "[core][verify]") {
  for (const double far : {0.0, 1e6}) {
    CAPTURE(far);
    FoldDraft draft = box_card();
    draft.flat.push_back({far, far});
    for (auto& pose : draft.poses) pose.at.push_back({far, far, 0.0});
    const auto sound = value(verify_fold(foreign(draft)));
    INFO(verify_text(sound));
    CHECK(sound.ok());
    CHECK(sound.sheet_u_mm == 80.0);
    draft.poses[2].at[0][1] -= 0.05;  // a corner, half a tenth of a millimetre
    const auto report = value(verify_fold(foreign(draft)));
    CHECK_FALSE(report.ok());
    CHECK(has(failures(report, "isometry"), "/file_frames/2"));
  }
}

}  // namespace verify_sheet_test
