// SPDX-License-Identifier: MIT
#include "core/verify/verify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <catch2/catch.hpp>

#include "tests/support/fold_draft.hpp"

using namespace popcut;
using namespace popcut::tests;

namespace {

constexpr double kPi = std::numbers::pi;

VerifyReport verified(const FoldDraft& draft, const VerifyOptions& options = {}) {
  const auto report = verify_fold(draft.text(), options);
  if (!report) FAIL("not read: " << message(report.error()));
  return *report;
}

/// All failures of one check, a line each.
std::string failures(const VerifyReport& report, const std::string& name) {
  std::string lines;
  for (const VerifyCheck& check : report.checks) {
    if (check.name != name) continue;
    for (const VerifyFailure& failure : check.failures)
      lines += failure.place + ": " + failure.detail + "\n";
  }
  return lines;
}

bool passes(const VerifyReport& report, const std::string& name) {
  const auto check = std::find_if(report.checks.begin(), report.checks.end(),
                                  [&](const VerifyCheck& c) { return c.name == name; });
  REQUIRE(check != report.checks.end());
  return check->ok();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t vertex_at(const FoldDraft& draft, double u, double v) {
  for (std::size_t i = 0; i < draft.flat.size(); ++i) {
    if (std::hypot(draft.flat[i][0] - u, draft.flat[i][1] - v) < 1e-9) return i;
  }
  FAIL("no vertex at " << u << ", " << v);
  return 0;
}

std::size_t edge_between(const FoldDraft& draft, std::size_t a, std::size_t b) {
  for (std::size_t e = 0; e < draft.edges.size(); ++e) {
    if (draft.edges[e] == std::array{a, b} || draft.edges[e] == std::array{b, a}) return e;
  }
  FAIL("no edge between " << a << " and " << b);
  return 0;
}

/// One strip of paper, 10 wide, folded across at the places `at` by `turn_deg` each (+ valley),
/// in one pose.
FoldDraft folded_strip(const std::vector<double>& at, const std::vector<double>& turn_deg) {
  FoldDraft draft;
  FoldDraft::Pose pose{1.1, {}, {}};
  double x = 0.0;
  double z = 0.0;
  double heading = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (k > 0) {
      x += (at[k] - at[k - 1]) * std::cos(heading);
      z += (at[k] - at[k - 1]) * std::sin(heading);
    }
    for (const double v : {0.0, 10.0}) {
      draft.flat.push_back({at[k], v});
      pose.at.push_back({x, v, z});
    }
    const bool inner = k > 0 && k + 1 < at.size();
    const double turn = inner ? turn_deg[k - 1] : 0.0;
    draft.edges.push_back({2 * k, 2 * k + 1});
    draft.assignment += !inner ? 'B' : turn > 0.0 ? 'V' : 'M';
    draft.key_angle_deg.push_back(turn);
    heading += turn * kPi / 180.0;
    if (k == 0) continue;
    for (const std::size_t rim : {0, 1}) {
      draft.edges.push_back({2 * k - 2 + rim, 2 * k + rim});
      draft.assignment += 'B';
      draft.key_angle_deg.push_back(0.0);
    }
    draft.faces.push_back({2 * k - 2, 2 * k, 2 * k + 1, 2 * k - 1});
  }
  pose.angle_deg = draft.key_angle_deg;
  draft.poses.push_back(pose);
  return draft;
}

/// A card with one V-fold on its crease (design reference, section 7): apex O, slit B-A-C.
FoldDraft splayed_card(double alpha, double psi) {
  const double w = 10.0;
  const double side = 30.0;
  const double theta = 2.0 * std::atan2(alpha * std::cos(psi / 2.0), 1.0);
  FoldDraft draft;
  FoldDraft::Pose pose{psi, {}, {}};
  const auto on_card = [&](double u, double v) {
    const double along = u - side;
    draft.flat.push_back({u, v});
    pose.at.push_back(along > 0.0 ? std::array{along, v, 0.0}
                                  : std::array{-along * std::cos(psi), v, -along * std::sin(psi)});
  };
  // 0-2 near edge, 3-5 far edge, 6 O, 7 B, 8 C, 9 the crease beyond the slit, 10 A
  for (const double v : {0.0, 40.0}) {
    for (const double u : {0.0, side, 2.0 * side}) on_card(u, v);
  }
  on_card(side, 10.0);
  on_card(side - w * alpha, 10.0 + w);
  on_card(side + w * alpha, 10.0 + w);
  on_card(side, 10.0 + w);
  draft.flat.push_back({side, 10.0 + w});
  pose.at.push_back({w * std::sin(theta) * std::cos(psi / 2.0), 10.0 + w * std::cos(theta),
                     w * std::sin(theta) * std::sin(psi / 2.0)});
  const double crease = (kPi - psi) * 180.0 / kPi;
  const double flank =
      2.0 * std::atan(std::sqrt(1.0 + alpha * alpha) / std::tan(psi / 2.0)) * 180.0 / kPi;
  const auto edge = [&](std::size_t a, std::size_t b, char letter, double angle) {
    draft.edges.push_back({a, b});
    draft.assignment += letter;
    draft.key_angle_deg.push_back(angle);
  };
  for (const auto& [a, b] : {std::pair(0, 1),
                             {1, 2},
                             {2, 5},
                             {5, 4},
                             {4, 3},
                             {3, 0},
                             {7, 9},
                             {9, 8},
                             {7, 10},
                             {10, 8}}) {
    edge(static_cast<std::size_t>(a), static_cast<std::size_t>(b), 'B', 0.0);
  }
  edge(1, 6, 'V', crease);
  edge(9, 4, 'V', crease);
  edge(6, 10, 'M', -crease);
  edge(6, 7, 'V', flank);
  edge(6, 8, 'V', flank);
  draft.faces = {{0, 1, 6, 7, 9, 4, 3}, {1, 2, 5, 4, 9, 8, 6}, {6, 10, 7}, {6, 8, 10}};
  pose.angle_deg = draft.key_angle_deg;
  draft.poses.push_back(pose);
  return draft;
}

}  // namespace

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

TEST_CASE("a lattice without a card has the loose ends that theory counts", "[core][verify]") {
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

TEST_CASE("more freedoms than demanded fail with both numbers", "[core][verify]") {
  const VerifyReport report = verified(
      draft_of(CylinderCard{.levels = 3, .slices = 2, .card = false}), {.degrees_of_freedom = 1});
  CHECK_FALSE(report.ok());
  CHECK(has(failures(report, "degrees_of_freedom"), "5 degrees of freedom where 1 is demanded"));
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

TEST_CASE("a cut that parts the sheet is reported with what falls off", "[core][verify]") {
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

TEST_CASE("a cut drawn as one edge parts its faces as B and as C", "[core][verify]") {
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
    CHECK(report.ok());
    CHECK(report.faces == 5);  // the wall's margin is a flap of its own now
    CHECK(report.hinges == 5);
    CHECK(report.degrees_of_freedom == 2U);
  }
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
    CHECK(
        has(failures(report, "fold_angles"), "/edges_foldAngle/" + std::to_string(spine) +
                                                 ": 45 degrees are listed, but the fold makes 90"));
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
    CHECK(has(failures(report, "crossing"), "faces 0 and 4 lie on each other"));
  }
}

TEST_CASE("a missing face leaves folds with one face", "[core][verify]") {
  FoldDraft draft = box_card();
  draft.faces.erase(draft.faces.begin() + 3);
  const VerifyReport report = verified(draft);
  CHECK(has(failures(report, "faces"), "has a face on one side only"));
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

TEST_CASE("a fold that a vertex interrupts must end there", "[core][verify]") {
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
  CHECK(has(failures(verified(draft), "lines"), "lies inside this fold; it must end there"));
}

TEST_CASE("a notch that a cut makes into one face is lawful", "[core][verify]") {
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
    std::string text = draft.text();
    if (!faces_given) text.replace(text.find("\"faces_vertices\""), 16, "\"faces_none:here\"");
    const auto report = verify_fold(text);
    REQUIRE(report);
    INFO(verify_text(*report));
    CHECK(report->ok());
    CHECK(report->faces == 2);
    CHECK(report->area_mm2 == Approx(200.0));
  }
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
