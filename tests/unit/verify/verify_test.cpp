// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_test {

using namespace popcut;
using namespace popcut::testing;

TEST_CASE("a box on a card is four rigid faces with one freedom", "[core][verify]") {
  const VerifyReport report = verified(box_card(), {.degrees_of_freedom = 1});
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.faces == 4);
  CHECK(report.hinges == 4);
  CHECK(report.pieces == 1);
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(report.crossing_method == "exact");
  CHECK(report.sheet_u_mm == 80.0);
  CHECK(report.sheet_v_mm == 50.0);
  CHECK(report.area_mm2 == Approx(4000.0));
  CHECK(report.slits == 2);
  CHECK(report.holes == 0);
  CHECK(report.isometry_mm < 1e-12);
  CHECK(report.gap > 1e9);
}

TEST_CASE("a lattice on a card has exactly one freedom", "[core][verify]") {
  for (int levels = 2; levels <= 5; ++levels) {
    for (int slices = 2; slices <= 4; ++slices) {
      CAPTURE(levels, slices);
      const VerifyReport report = verified(
          draft_of(CylinderCard{.levels = levels, .slices = slices}), {.degrees_of_freedom = 1});
      INFO(verify_text(report));
      CHECK(report.ok());
      CHECK(report.gap > 1e9);
    }
  }
}

TEST_CASE("a lattice without a card has the loose ends that the theory predicts",
          "[core][verify]") {
  for (int levels = 2; levels <= 5; ++levels) {
    for (int slices = 2; slices <= 4; ++slices) {
      CAPTURE(levels, slices);
      const VerifyReport report =
          verified(draft_of(CylinderCard{.levels = levels, .slices = slices, .card = false}));
      INFO(verify_text(report));
      const auto expected = static_cast<std::size_t>(levels == 2 ? 3 * slices - 1 : 1 + 2 * slices);
      CHECK(report.ok());
      CHECK(report.degrees_of_freedom == expected);
    }
  }
}

TEST_CASE("dense and sparse counting agree on a chain of many freedoms", "[core][verify]") {
  std::vector<double> at{0.0};
  std::vector<double> turn;
  for (int k = 0; k < 30; ++k) at.push_back(at.back() + 3.0);
  for (int k = 0; k < 29; ++k) turn.push_back(k % 2 == 0 ? 80.0 : -70.0);
  for (const std::size_t faces : {10U, 30U}) {
    CAPTURE(faces);
    const VerifyReport report =
        verified(folded_strip({at.begin(), at.begin() + static_cast<long>(faces) + 1},
                              {turn.begin(), turn.begin() + static_cast<long>(faces) - 1}));
    INFO(verify_text(report));
    CHECK(report.degrees_of_freedom == faces - 1);
    CHECK(report.ok());
  }
}

TEST_CASE("more freedoms than requested fail with both numbers", "[core][verify]") {
  const VerifyReport report = verified(
      draft_of(CylinderCard{.levels = 3, .slices = 2, .card = false}), {.degrees_of_freedom = 1});
  CHECK_FALSE(report.ok());
  CHECK(has(failures(report, "degrees_of_freedom"), "5 degrees of freedom, but 1 is required"));
}

TEST_CASE("a card with a splayed unit is isometric with one freedom", "[core][verify]") {
  for (const double alpha : {0.3, 0.8, 1.4}) {
    for (const double psi : {0.6, 1.1, 2.0}) {
      CAPTURE(alpha, psi);
      const VerifyReport report = verified(splayed_card(alpha, psi), {.degrees_of_freedom = 1});
      INFO(verify_text(report));
      CHECK(report.ok());
      CHECK(report.crossing_method == "sampled");
      CHECK(report.fold_angle_deg < 1e-9);
    }
  }
}

TEST_CASE("an edge that changes its length is named with both lengths", "[core][verify]") {
  FoldDraft draft = box_card();
  const std::size_t corner = vertex_at(draft, 0.0, 0.0);
  draft.poses[2].at[corner][1] -= 0.25;
  const VerifyReport report = verified(draft);
  CHECK_FALSE(report.ok());
  CHECK(report.isometry_mm == Approx(0.25).epsilon(0.2));
  CHECK(has(failures(report, "isometry"), "mm long on the sheet, but"));
  INFO(failures(report, "isometry"));
  CHECK(has(failures(report, "isometry"), "/file_frames/2"));
}

TEST_CASE("a face that bends is found though its edges keep their lengths", "[core][verify]") {
  // The two flat parts of one wall panel, joined by an F edge, turned against each other.
  FoldDraft draft = folded_strip({0.0, 10.0, 20.0, 30.0}, {60.0, 50.0});
  const std::size_t fold = edge_between(draft, 2, 3);
  draft.assignment[fold] = 'F';
  draft.key_angle_deg[fold] = draft.poses[0].angle_deg[fold] = 0.0;
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "isometry"), "the face is bent or sheared"));
}

TEST_CASE("a fold of the wrong sign is named in its pose and in the list", "[core][verify]") {
  FoldDraft draft = box_card();
  const std::size_t spine =
      edge_between(draft, vertex_at(draft, 40.0, 0.0), vertex_at(draft, 40.0, 10.0));
  draft.assignment[spine] = 'M';
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "fold_angles"), "the mountain fold turns as a valley"));
  CHECK(has(failures(report, "fold_angles"), "90 degrees are listed for a mountain"));
}

TEST_CASE("a listed fold angle that the pose does not make is named", "[core][verify]") {
  SECTION("in a frame") {
    FoldDraft draft = box_card();
    const std::size_t spine =
        edge_between(draft, vertex_at(draft, 40.0, 0.0), vertex_at(draft, 40.0, 10.0));
    draft.poses[2].angle_deg[spine] += 1.5;
    const VerifyReport report = verified(draft);
    INFO(verify_text(report));
    CHECK(report.fold_angle_deg == Approx(1.5));
    CHECK(has(failures(report, "fold_angles"),
              "/file_frames/2/edges_foldAngle/" + std::to_string(spine)));
  }
  SECTION("in the key frame") {
    FoldDraft draft = box_card();
    const std::size_t spine =
        edge_between(draft, vertex_at(draft, 40.0, 0.0), vertex_at(draft, 40.0, 10.0));
    draft.key_angle_deg[spine] = 45.0;
    const VerifyReport report = verified(draft);
    CHECK(has(failures(report, "fold_angles"), "/edges_foldAngle/" + std::to_string(spine) +
                                                   ": 45 degrees are listed, but the fold has 90"));
  }
}

TEST_CASE("a face through another is found in the section and in space", "[core][verify]") {
  // 40 right, 20 up, 20 left, 30 down: the last panel passes through the first.
  FoldDraft draft = folded_strip({0.0, 40.0, 60.0, 80.0, 110.0}, {90.0, 90.0, 90.0});
  SECTION("all folds parallel: a section") {
    const VerifyReport report = verified(draft);
    CHECK(has(failures(report, "crossing"), "faces 0 and 3 cross near"));
  }
  SECTION("a slanted edge: in space") {
    draft.flat[0][0] -= 5.0;
    draft.poses[0].at[0][0] -= 5.0;
    const VerifyReport report = verified(draft);
    CHECK(passes(report, "isometry"));
    CHECK(report.crossing_method == "sampled");
    CHECK(has(failures(report, "crossing"), "faces 0 and 3 cross near (20,"));
  }
  SECTION("short of the first panel it is sound") {
    for (const double slant : {0.0, 5.0}) {
      CAPTURE(slant);
      FoldDraft apart = folded_strip({0.0, 40.0, 60.0, 80.0, 95.0}, {90.0, 90.0, 90.0});
      apart.flat[0][0] -= slant;
      apart.poses[0].at[0][0] -= slant;
      CHECK(verified(apart).ok());
    }
  }
}

TEST_CASE("faces that lie on each other in a pose are found", "[core][verify]") {
  // 40 right, 10 up, 20 left, 10 down, then right along the first panel.
  for (const double slant : {0.0, 5.0}) {
    CAPTURE(slant);
    FoldDraft draft = folded_strip({0.0, 40.0, 50.0, 70.0, 80.0, 90.0}, {90.0, 90.0, 90.0, 90.0});
    draft.flat[0][0] -= slant;
    draft.poses[0].at[0][0] -= slant;
    const VerifyReport report = verified(draft);
    CHECK(has(failures(report, "crossing"), "faces 0 and 4 overlap"));
  }
}

TEST_CASE("a target's formula that sets a variable is refused", "[core][verify]") {
  const auto with = [](const std::string& radius) {
    VerifyOptions options;
    options.target_spec = R"({"popcut": 1, "name": "t", "units_per_slice": 1, "slices": 2,
      "widths_mm": 10, "surface": {"type": "revolution", "radius": ")" +
                          radius + "\"}}";
    return verify_fold(box_card().text(), options);
  };
  for (const char* wrong : {"y=3", "20 + (y = 3)", "x<y=3"}) {
    CAPTURE(wrong);
    const auto report = with(wrong);
    REQUIRE_FALSE(report);
    CHECK(has(message(report.error()), "/surface/radius"));
    CHECK(has(message(report.error()), "sets a variable"));
  }
  CHECK(with("y >= 3 ? 20 : 25"));
  CHECK(with("y == 3 ? 20 : 25"));
}

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

}  // namespace verify_test
