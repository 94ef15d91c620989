// SPDX-License-Identifier: MIT
// Cards of several parts, and the faults that verify must find in them.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/boxes/boxed_report.hpp"
#include "core/design/layers/layer_masks.hpp"
#include "core/design/layers/layer_outline.hpp"
#include "core/design/layers/layered_report.hpp"
#include "core/design/slices/sliced_report.hpp"
#include "core/design/slices/thin_walls.hpp"
#include "core/design/spec/spec.hpp"
#include "core/geometry/angle.hpp"
#include "core/judge/boxes_likeness.hpp"
#include "core/judge/glue_guide.hpp"
#include "core/judge/glue_order.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/judge/parts_motion.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/parts/elements.hpp"
#include "core/parts/structure_fold.hpp"
#include "core/verify/parts/parts.hpp"
#include "tests/support/paths.hpp"

namespace verify_parts_test {

using namespace popcut;
using Json = nlohmann::ordered_json;

namespace {

std::string text_of(const Structure& card) {
  const auto text = structure_fold(card, "test");
  if (!text) FAIL(message(text.error()));
  return *text;
}

PartsVerifyReport judged(const std::string& text, std::size_t freedoms = 1) {
  PartsVerifyOptions options;
  options.degrees_of_freedom = freedoms;
  options.openings = 15;
  auto report = verify_parts(text, options);
  if (!report) FAIL(message(report.error()));
  return std::move(*report);
}

/// Two V-folds of 75 degrees, upright on open pages.
Structure two_v_folds() {
  Structure card = plain_card(120.0, 150.0);
  for (const double at : {75.0, 100.0}) {
    VFoldElement one;
    one.name = at < 80.0 ? "front" : "back";
    one.at_mm = at;
    one.left_crease_rad = one.right_crease_rad = radians(75.0);
    one.left_panel_rad = one.right_panel_rad = radians(90.0);
    one.crease_mm = 50.0, one.ridge_mm = 60.0;
    REQUIRE(add(card, spine_of(card), one));
  }
  return card;
}

Structure double_corner(bool has_locks) {
  Structure card = plain_card(120.0, 200.0);
  DoubleCornerElement corner;
  corner.from_mm = 60.0, corner.to_mm = 140.0, corner.height_mm = 60.0;
  corner.steps = {{true, 70.0, 130.0, 40.0, 30.0}, {false, 70.0, 130.0, 35.0, 30.0}};
  corner.has_locks = has_locks;
  REQUIRE(add(card, spine_of(card), corner));
  return card;
}

/// The failures of a check, one a line.
std::string failures(const PartsVerifyReport& report, const std::string& name) {
  std::string out;
  for (const VerifyCheck& check : report.checks)
    if (check.name == name)
      for (const VerifyFailure& one : check.failures) out += one.place + ": " + one.detail + "\n";
  return out;
}

std::string changed(const std::string& text, const std::function<void(Json&)>& change) {
  Json json = Json::parse(text);
  change(json);
  return json.dump();
}

void refused(const std::string& text, const std::string& place, const std::string& what) {
  const auto report = verify_parts(text);
  REQUIRE_FALSE(report);
  CAPTURE(message(report.error()));
  CHECK(report.error().place == place);
  CHECK(report.error().detail.find(what) != std::string::npos);
  CHECK(exit_code(report.error().kind) == 3);
}

}  // namespace

TEST_CASE("a card of several parts is judged from its file: parts, joints, motion, stack",
          "[core][verify][parts]") {
  const PartsVerifyReport report = judged(text_of(two_v_folds()));
  INFO(verify_text(report));
  CHECK(report.ok());
  CHECK(report.names == std::vector<std::string>{"card", "front", "back"});
  CHECK(report.joints == 4);
  CHECK(report.tabs == 4);
  CHECK(report.degrees_of_freedom == 1U);
  CHECK(report.smallest_nonzero > 1e-3);
  CHECK(report.from_deg == Approx(1.0));
  CHECK(report.to_deg == Approx(179.0));
  CHECK(report.page_mm == Approx(120.0).margin(1e-6));
  // 50 mm along the crease and 60 mm up the ridge: 50 sin 75 + 60 sin 165.
  CHECK(report.closed_mm == Approx(63.825).margin(0.01));
  // Two pages, two panels of each V-fold, and a tab on each page where they are.
  CHECK(report.stack_layers >= 6);
  CHECK(report.stack_mm == Approx(0.3 * static_cast<double>(report.stack_layers)));
  REQUIRE(report.wobble_mm);
  CHECK(*report.wobble_mm < 1.0);
  const Json json = Json::parse(verify_json(report));
  CHECK(json["degrees_of_freedom"] == 1);
  CHECK(json["parts"].size() == 3);
}

TEST_CASE("planted faults of a card of several parts are found", "[core][verify][parts]") {
  const std::string sound = text_of(two_v_folds());
  SECTION("a joint missing: the part swings on its other tab") {
    const auto report = judged(changed(sound, [](Json& json) { json["popcut:joints"].erase(0); }));
    CHECK_FALSE(report.ok());
    CHECK(failures(report, "degrees_of_freedom").find("is required") != std::string::npos);
  }
  SECTION("all joints of a part missing: it hangs on nothing") {
    const auto report = judged(changed(sound, [](Json& json) {
      json["popcut:joints"].erase(0);
      json["popcut:joints"].erase(0);
    }));
    CHECK(failures(report, "joints").find("\"front\" hangs on nothing") != std::string::npos);
  }
  SECTION("a tab too wide: it leaves the page") {
    const auto report = judged(changed(sound, [](Json& json) {
      // Corners of the tab on the left page, which end inside the page.
      auto& frame = json["file_frames"][1];
      for (const std::size_t v : frame["faces_vertices"][2])
        if (frame["vertices_coords"][v][1].get<double>() < -1.0)
          frame["vertices_coords"][v][0] = frame["vertices_coords"][v][0].get<double>() - 90.0;
    }));
    CHECK(failures(report, "tabs").find("not on paper") != std::string::npos);
  }
  SECTION("two tabs in one place") {
    const auto report = judged(changed(sound, [](Json& json) {
      // The back V-fold stands 3 mm behind the front one, less than a tab is deep.
      for (auto& joint : json["popcut:joints"])
        if (joint["a"]["part"] == "back")
          for (const int k : {1, 3})
            joint["b"]["line_mm"][k] = joint["b"]["line_mm"][k].get<double>() - 22.0;
    }));
    CHECK(failures(report, "tabs").find("lies on that of") != std::string::npos);
  }
  SECTION("a page too small") {
    const auto report = judged(changed(sound, [](Json& json) {
      for (auto& at : json["file_frames"][0]["vertices_coords"]) at[0] = 0.5 * at[0].get<double>();
    }));
    CHECK(failures(report, "closed").find("sticks out of the pages by 3.8") != std::string::npos);
  }
  SECTION("one crease 2 degrees off its place") {
    const auto report = judged(changed(sound, [](Json& json) {
      auto& line = json["popcut:joints"][0]["b"]["line_mm"];
      const double length = std::hypot(line[2].get<double>() - line[0].get<double>(),
                                       line[3].get<double>() - line[1].get<double>());
      line[2] = line[0].get<double>() - length * std::sin(radians(73.0));
      line[3] = line[1].get<double>() + length * std::cos(radians(73.0));
    }));
    CHECK_FALSE(report.ok());
  }
  SECTION("a lock left out: two freedoms") {
    const auto locked = judged(text_of(double_corner(true)));
    INFO(verify_text(locked));
    CHECK(locked.ok());
    CHECK(locked.degrees_of_freedom == 1U);
    const auto report = judged(text_of(double_corner(false)));
    CHECK(report.degrees_of_freedom == 2U);
    CHECK(failures(report, "degrees_of_freedom") == ": 2 degrees of freedom, but 1 is required\n");
  }
  SECTION("a lock whose tent has no slit") {
    const auto report = judged(changed(text_of(double_corner(true)), [](Json& json) {
      for (auto& frame : json["file_frames"])
        for (auto& letter : frame["edges_assignment"])
          if (letter == "C") letter = "M";
    }));
    CHECK(failures(report, "slots").find("it must be cut") != std::string::npos);
  }
  SECTION("a lock whose slit is narrower than what slides in it") {
    Structure card = double_corner(true);
    for (Vec2& at : card.parts[1].vertices)
      if (at.x() > 150.0) at.x() += 2.0;
    const auto report = judged(text_of(card));
    CHECK(failures(report, "slots").find("wider than the slit") != std::string::npos);
  }
}

TEST_CASE("a file of several parts that cannot be read says where and what",
          "[core][verify][parts]") {
  const std::string sound = text_of(two_v_folds());
  const auto with = [&](const std::function<void(Json&)>& change) {
    return changed(sound, change);
  };
  refused("{\"popcut:joints\"", "line 1, column 16", "");
  refused(with([](Json& j) { j["popcut:joints"][1]["type"] = "nail"; }), "/popcut:joints/1/type",
          "nail");
  refused(with([](Json& j) { j["popcut:joints"][1]["b"]["part"] = "lid"; }),
          "/popcut:joints/1/b/part", "names no part");
  refused(with([](Json& j) { j["popcut:joints"][1]["b"]["face"] = 2; }), "/popcut:joints/1/b/face",
          "0 to 1");
  refused(with([](Json& j) {
            j["popcut:joints"][0]["a"]["line_mm"] = {0, 0, 1};
          }),
          "/popcut:joints/0/a/line_mm", "");
  refused(with([](Json& j) {
            j["popcut:joints"][0]["a"]["line_mm"] = {0, 0, 1, 0};
          }),
          "/popcut:joints/0/b/line_mm", "they are one line");
  refused(with([](Json& j) { j["popcut:joints"] = 5; }), "/popcut:joints", "");
  refused(with([](Json& j) { j["file_frames"][2]["frame_title"] = "front"; }),
          "/file_frames/2/frame_title", "different names");
  refused(with([](Json& j) { j["file_frames"][2].erase("edges_foldAngle"); }),
          "/file_frames/2/edges_foldAngle", "is missing");
  refused(with([](Json& j) { j["file_frames"][2]["faces_vertices"][0][0] = 99; }),
          "/file_frames/2/faces_vertices/0/0", "no vertex 99");
  refused(with([](Json& j) { j["file_frames"] = Json::array(); }), "/file_frames", "no frame");
}

TEST_CASE("an element that cannot move says what would have to change, and by how much",
          "[core][parts]") {
  const auto says = [](const Result<void>& result, const std::string& what) {
    REQUIRE_FALSE(result);
    CAPTURE(message(result.error()));
    CHECK(result.error().kind == ErrorKind::Infeasible);
    CHECK(result.error().detail.find(what) != std::string::npos);
  };
  Structure card = plain_card(80.0, 100.0);
  const Seat spine = spine_of(card);
  TentElement tent;
  tent.to_mm = 30.0;
  tent.left_foot_mm = tent.right_foot_mm = 20.0, tent.left_panel_mm = 40.0;
  tent.right_panel_mm = 41.0;
  says(add(card, spine, tent), "make the right panel 40 mm long");
  tent.right_panel_mm = 40.0, tent.left_panel_mm = 40.0;
  CHECK(add(card, spine, tent));
  tent.left_panel_mm = tent.right_panel_mm = 70.0;
  says(add(card, spine, tent), "sticks out of the open edge by 10 mm; make the pages 90 mm wide");
  tent.left_panel_mm = tent.right_panel_mm = 19.0;
  says(add(card, spine, tent), "cannot open flat");
  CHECK(card.parts.size() == 2);
  VFoldElement v_fold;
  v_fold.left_crease_rad = v_fold.right_crease_rad = radians(60.0);
  v_fold.left_panel_rad = radians(90.0), v_fold.right_panel_rad = radians(88.0);
  says(can_move(v_fold), "make the right panel 90 degrees");
  v_fold.left_panel_rad = v_fold.right_panel_rad = radians(59.0);
  says(can_move(v_fold), "wider by more than 1 degrees");
  v_fold.left_panel_rad = v_fold.right_panel_rad = radians(121.0);
  says(can_move(v_fold), "less than 180");
  CHECK(panel_of_tilt(radians(60.0), radians(90.0)) == Approx(radians(90.0)));
  BoxElement house;
  house.to_mm = 40.0, house.half_mm = 15.0, house.height_mm = 20.0;
  house.lid = BoxLid::Gabled, house.rise_mm = 20.0;
  CHECK(can_move(house));
  house.eaves_mm = 13.0;  // of 20 * 25 / (25 + 15)
  says(can_move(house),
       "its eaves would pass through the pages as the card shuts: they are 13 mm; "
       "make them less than 12.5 mm");
  house.eaves_mm = 0.0, house.inner_mm = 15.0;
  says(can_move(house), "let one end fold outward and the other one inward");
  house.ends_out = {true, false};
  CHECK(can_move(house));
  house.inner_mm = 25.0;
  CHECK(can_move(house).error().kind == ErrorKind::OutOfRange);  // through the roof
}

TEST_CASE("a gabled house of eight panels has the walls, gables and slopes of its model",
          "[core][parts]") {
  Structure card = plain_card(120.0, 140.0);
  BoxElement house;
  house.name = "house";
  house.from_mm = 35.0, house.to_mm = 105.0, house.half_mm = 24.0, house.height_mm = 30.0;
  house.lid = BoxLid::Gabled, house.rise_mm = 20.0, house.eaves_mm = 5.0;
  house.verge_mm = {3.0, 3.0};
  REQUIRE(add(card, spine_of(card), house));
  const PartsVerifyReport report = judged(text_of(card));
  if (!report.ok()) FAIL(verify_text(report));
  CHECK(report.degrees_of_freedom == 1U);
  std::size_t panels = 0;
  for (std::size_t p = 1; p < card.parts.size(); ++p)
    panels += card.parts[p].faces.size() - card.parts[p].tabs.size();
  CHECK(panels == 8);
  // On open pages all of the house is there: places of its walls, gables and slopes lie on panels.
  const PartPoses pose = posed(card, radians(179.99));
  const auto off = [&](const Vec3& at) {
    double least = 1e9;
    for (std::size_t p = 1; p < card.parts.size(); ++p) {
      const SheetPart& part = card.parts[p];
      for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
        if (std::find(part.tabs.begin(), part.tabs.end(), f) != part.tabs.end()) continue;
        const Vec3 flat = pose[p][f].inverse() * at;
        bool is_inside = true;  // faces are convex
        for (std::size_t k = 0; k < part.faces[f].size(); ++k) {
          const Vec2 a = part.vertices[part.faces[f][k]],
                     b = part.vertices[part.faces[f][(k + 1) % part.faces[f].size()]];
          is_inside = is_inside && cross(Vec2(b - a), Vec2(flat.head<2>() - a)) > -0.05;
        }
        if (is_inside) least = std::min(least, std::abs(flat.z()));
      }
    }
    return least;
  };
  constexpr double kOnePercent_mm = 0.7;  // of the house's length
  double most = 0.0;
  for (double t = 0.01; t < 1.0; t += 0.07)
    for (double s = 0.01; s < 1.0; s += 0.07)
      for (const double side : {-1.0, 1.0}) {
        const double y = 35.0 + 70.0 * t, x = side * 24.0 * (1.0 - s);
        most = std::max({most, off({side * 24.0, y, 30.0 * s}),  // walls, slopes
                         off({x, y, 30.0 + 20.0 * s})});
        for (const double end : {35.0, 105.0})  // ends with their gables
          most = std::max(most, off({x, end, t * (30.0 + 20.0 * s)}));
      }
  CHECK(most < 0.05 * kOnePercent_mm);
}

TEST_CASE("a layer with a part in the air and a hole becomes one piece that stands",
          "[core][parts][layers]") {
  LayerGrid grid{1.0, 120, 60};
  LayerMask mask(grid.cells(), 0);
  const auto disc = [&](double x, double z, double from, double to) {
    for (std::size_t r = 0; r < grid.rows; ++r)
      for (std::size_t c = 0; c < grid.columns; ++c) {
        const double off =
            std::hypot(static_cast<double>(c) - 59.5 - x, static_cast<double>(r) - z);
        if (off >= from && off <= to) mask[grid.at(c, r)] = 1;
      }
  };
  disc(30.0, 40.0, 6.0, 12.0);   // a ring on the right, in the air
  disc(-25.0, 20.0, 0.0, 12.0);  // a disc on the left
  disc(-50.0, 50.0, 0.0, 2.3);   // a speck
  const LayerMask hidden(grid.cells(), 0);
  const LayerPaper paper;
  const LayerChanges changes = make_one_piece(grid, hidden, paper, mask);
  CHECK(changes.dropped == 1);
  CHECK(changes.filled == 0);
  CHECK(changes.bridges >= 1);
  CHECK(changes.shown_mm2 > 20.0);
  CHECK(mask[grid.at(89, 40)] == 0);  // the hole of the ring
  for (const bool is_right : {false, true}) {
    const auto outlines = half_outlines(grid, mask, is_right);
    CHECK(outlines.size() == (is_right ? 2U : 1U));  // the hole parts the half
    double twice = 0.0;
    std::size_t on_page = 0, on_ridge = 0, paper_cells = 0;
    for (const std::vector<Vec2>& outline : outlines)
      for (std::size_t k = 0; k < outline.size(); ++k) {
        twice += cross(outline[k], outline[(k + 1) % outline.size()]);
        on_page += outline[k].y() == 0.0 ? 1 : 0, on_ridge += outline[k].x() == 0.0 ? 1 : 0;
      }
    for (std::size_t r = 0; r < grid.rows; ++r)
      for (std::size_t c = 0; c < 60; ++c) paper_cells += mask[grid.at(is_right ? 60 + c : c, r)];
    CHECK(0.5 * twice == Approx(static_cast<double>(paper_cells)).epsilon(0.03));
    CHECK(on_page >= 2);
    CHECK(on_ridge >= 2);
    CHECK(foot_mm(grid, mask, is_right) >= paper.least_foot_mm);
  }
}

namespace {

/// Whether a way of 25 mm from a point goes through a face of a part, by its plane and its polygon.
bool is_in_the_way(const SheetPart& part, const std::vector<Eigen::Isometry3d>& pose,
                   const Vec3& from, const Vec3& way) {
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const Eigen::Isometry3d to_sheet = pose[f].inverse();
    const Vec3 at = to_sheet * from, d = to_sheet.linear() * way;
    if (std::abs(d.z()) < 1e-9) continue;
    const double far = -at.z() / d.z();
    if (far < 0.3 || far > 25.0) continue;
    const Vec3 hit = at + far * d;
    bool inside = false;
    const auto& corners = part.faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2 p = part.vertices[corners[k]],
                 q = part.vertices[corners[(k + 1) % corners.size()]];
      if ((p.y() > hit.y()) != (q.y() > hit.y()) &&
          hit.x() < p.x() + (hit.y() - p.y()) / (q.y() - p.y()) * (q.x() - p.x()))
        inside = !inside;
    }
    if (inside) return true;
  }
  return false;
}

/// Follows the steps of a guide as a person does who has nothing but the parts.
///
/// @param reaches  whether a finger must come to each tab on the pages, on a slant from beyond it
void check_guide(const Structure& card, bool reaches) {
  const auto guide = judge::glue_guide(text_of(card));
  if (!guide) FAIL(message(guide.error()));
  std::string words;
  for (const judge::GlueStep& step : guide->steps) words += step.words + "\n";
  CAPTURE(words);
  const PartPoses half = posed(card, radians(100.0)), open = posed(card, radians(165.0));
  std::vector<bool> is_there(card.parts.size(), false), is_glued(card.joints.size(), false);
  std::vector<std::vector<bool>> is_creased;
  for (const judge::GluePart& part : guide->parts)
    is_creased.emplace_back(part.folds.folds.size(), false);
  is_there[0] = true;
  std::string letters;
  for (const judge::GlueStep& step : guide->steps) {
    if (step.kind == judge::GlueStepKind::Fold) {
      CHECK(letters.empty());
      for (const std::uint32_t k : step.folds) {
        CHECK_FALSE(is_creased[step.part][k]);
        is_creased[step.part][k] = true;
      }
      continue;
    }
    if (step.part != 0) CHECK_FALSE(is_there[step.part]);
    is_there[step.part] = true;
    for (const std::size_t t : step.tabs) {
      const judge::GlueTab& tab = guide->tabs[t];
      letters += tab.letter;
      const PartJoint& joint = card.joints[tab.joint];
      REQUIRE(joint.kind == PartJointKind::Glue);
      CHECK_FALSE(is_glued[tab.joint]);
      is_glued[tab.joint] = true;
      CHECK((tab.part == step.part || tab.on_part == step.part));
      CHECK((is_there[tab.part] && is_there[tab.on_part]));
      // What is printed on both is in one place once it is glued.
      Vec2 middle{0.0, 0.0};
      for (std::size_t k = 0; k < tab.outline.size(); ++k) {
        const auto at = [](const Eigen::Isometry3d& pose, Vec2 p) {
          return Vec3(pose * Vec3{p.x(), p.y(), 0.0});
        };
        CHECK(norm(Vec3(at(open[tab.part][tab.face], tab.outline[k]) -
                        at(open[tab.on_part][tab.on_face], tab.place[k]))) < 1e-6);
        middle += tab.place[k] / static_cast<double>(tab.place.size());
      }
      if (!reaches || tab.on_part != 0) continue;
      const Eigen::Isometry3d& page = open[0][tab.on_face];
      const Vec2 outward = middle - 0.5 * (joint.b.line[0] + joint.b.line[1]);
      const Vec3 way =
          unit(Vec3(page.linear() * unit(Vec3{outward.x(), outward.y(), norm(outward)})));
      for (std::size_t q = 1; q < card.parts.size(); ++q)
        if (is_there[q] && q != step.part)
          CHECK_FALSE(
              is_in_the_way(card.parts[q], open[q], page * Vec3{middle.x(), middle.y(), 0.0}, way));
    }
  }
  CHECK(std::count(is_there.begin(), is_there.end(), false) == 0);
  std::size_t tabs = 0;
  for (std::size_t j = 0; j < card.joints.size(); ++j)
    if (card.joints[j].kind == PartJointKind::Glue) {
      CHECK(is_glued[j]);
      ++tabs;
    }
  CHECK(guide->tabs.size() == tabs);
  CHECK(std::is_sorted(letters.begin(),
                       letters.begin() + std::min<std::ptrdiff_t>(26, std::ssize(letters))));
  // Every fold once, in its sense: lengths of mountains and valleys are those of the closed form.
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    CHECK(std::count(is_creased[p].begin(), is_creased[p].end(), false) == 0);
    double mountains = 0.0, valleys = 0.0, guided_mountains = 0.0, guided_valleys = 0.0;
    for (const PartFold& fold : folds_of(card.parts[p], half[p])) {
      if (std::abs(fold.angle_rad) < 1e-9 || card.parts[p].is_slit(fold.from, fold.to)) continue;
      (fold.angle_rad < 0.0 ? mountains : valleys) +=
          norm(Vec2(card.parts[p].vertices[fold.to] - card.parts[p].vertices[fold.from]));
    }
    for (const hands::GuideFold& fold : guide->parts[p].folds.folds)
      (fold.is_mountain() ? guided_mountains : guided_valleys) += fold.length_mm();
    CHECK(guided_mountains == Approx(mountains).margin(1e-6));
    CHECK(guided_valleys == Approx(valleys).margin(1e-6));
  }
  const hands::Handwork work = judge::handwork(*guide);
  CHECK(work.tabs == tabs);
  CHECK(Json::parse(judge::glue_guide_json(*guide))["steps"].size() == guide->steps.size());
}

/// What a page shows of a card: sheets apart, panels rigid and joined at every opening, nothing
/// below the table.
///
/// @param part_x  receives how far each part reaches on the open card toward who looks at it
judge::PartsMotion check_shown(const Structure& card, std::vector<double>& part_x) {
  const auto shown = judge::parts_motion(text_of(card));
  if (!shown) FAIL(message(shown.error()));
  CHECK(shown->stopped.empty());
  const Pattern& flat = shown->pattern;
  REQUIRE(shown->parts.size() == card.parts.size());
  REQUIRE(shown->motion.psi_rad.size() >= 7);
  CHECK(shown->motion.psi_rad.front() == Approx(radians(card.opens_deg)));
  CHECK(std::is_sorted(shown->motion.psi_rad.rbegin(), shown->motion.psi_rad.rend()));
  std::vector<std::size_t> part_of_vertex(flat.vertices.size());
  std::size_t tabs = 0;
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    const judge::ShownPart& part = shown->parts[p];
    CHECK(part.name == card.parts[p].name);
    REQUIRE(part.faces == card.parts[p].faces.size());
    tabs += part.tabs;
    for (std::uint32_t f = 0; f < part.faces; ++f) {
      const auto face = flat.face(part.first_face + f);
      const auto& own = card.parts[p].faces[f];
      REQUIRE(face.size() == own.size());
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec2 at = card.parts[p].vertices[own[k]];
        const PatternVertex& vertex = flat.vertices[face[k]];
        CHECK(flat.u(vertex) == Approx(part.shift_mm[0] - at.y()));
        CHECK(vertex.v == Approx(part.shift_mm[1] + at.x()));
        CHECK(vertex.v >= part.box_mm[0] - 1e-6);
        CHECK(vertex.v <= part.box_mm[0] + part.box_mm[2] + 1e-6);
        CHECK(flat.u(vertex) >= part.box_mm[1] - 1e-6);
        CHECK(flat.u(vertex) <= part.box_mm[1] + part.box_mm[3] + 1e-6);
        part_of_vertex[face[k]] = p;
      }
    }
  }
  CHECK(tabs == static_cast<std::size_t>(std::count_if(
                    card.joints.begin(), card.joints.end(),
                    [](const PartJoint& joint) { return joint.kind == PartJointKind::Glue; })));
  const auto on_sheet = [&](std::uint32_t i) {
    return Vec2{flat.u(flat.vertices[i]), flat.vertices[i].v};
  };
  for (const auto& places : shown->motion.places) {
    double stretched_mm = 0.0, lowest_mm = 0.0;
    for (std::size_t f = 0; f < flat.faces(); ++f) {
      const auto face = flat.face(f);
      for (std::size_t k = 1; k < face.size(); ++k)
        stretched_mm =
            std::max(stretched_mm, std::abs(norm(Vec3(places[face[k]] - places[face[0]])) -
                                            norm(Vec2(on_sheet(face[k]) - on_sheet(face[0])))));
    }
    for (const Vec3& at : places) lowest_mm = std::min(lowest_mm, at.z());
    CHECK(stretched_mm < 1e-6);
    CHECK(lowest_mm > -0.3);  // with a tab, which is shown above or below its bed
  }
  part_x.assign(card.parts.size(), -1e9);
  for (std::size_t i = 0; i < flat.vertices.size(); ++i)
    part_x[part_of_vertex[i]] =
        std::max(part_x[part_of_vertex[i]], shown->motion.places.front()[i].x());
  return *shown;
}

}  // namespace

TEST_CASE("every front of a shape is in a layer, and the card of them is sound",
          "[core][parts][layers]") {
  const auto spec_of = [](const std::string& layers) {
    const std::string ball = "sqrt((x-60)^2+(y-30)^2+(z-20)^2)-18",
                      wall = "max(abs(x-25)-5,max(abs(y-45)-30,z-50))";
    auto spec = parse_design_spec(R"({"popcut":1,"name":"two","style":"layers",)"
                                  R"x("surface":{"type":"implicit","f":"min()x" +
                                  ball + "," + wall + R"x()"},"layers":)x" + layers + "}");
    if (!spec) FAIL(message(spec.error()));
    return *spec;
  };
  const auto sound = judge::sound_layers(spec_of(R"({"layers":4,"length_mm":80})"), {}, "test");
  if (!sound) FAIL(message(sound.error()));
  CHECK(sound->made.layers.size() >= 3);
  CHECK(sound->report.degrees_of_freedom == 1U);
  CHECK(sound->made.tabs == 2 * sound->made.layers.size());
  // As it stands on the card: u across, v along the spine; the front is at x = 0 of the shape.
  TriangleSoup shape = sound->made.target;
  for (std::size_t k = 0; k < shape.corners.size(); k += 3) {
    const double along = sound->made.looks_along_spine ? 1.0 : -1.0;
    std::swap(shape.corners[k], shape.corners[k + 1]);
    shape.corners[k] *= -along, shape.corners[k + 1] *= along;
  }
  std::vector<double> depths;
  for (const CardLayer& layer : sound->made.layers) depths.push_back(layer.depth_mm);
  const DepthStacks stacks = depth_stacks(shape, {}, 1.0);
  const std::vector<LayerMask> masks = layer_masks(stacks, depths);
  for (std::size_t cell = 0; cell < stacks.grid.cells(); ++cell) {
    if (stacks.crossings[cell].empty()) continue;
    const bool any = std::any_of(masks.begin(), masks.end(),
                                 [&](const LayerMask& mask) { return mask[cell] != 0; });
    if (!any) FAIL_CHECK("cell " << cell << " is in no layer");
  }
  check_guide(sound->made.card, true);
  std::vector<double> part_x;
  const judge::PartsMotion shown = check_shown(sound->made.card, part_x);
  double high = 0.0, highest = 0.0;
  for (const Vec3& at : shown.motion.places.front()) high = std::max(high, at.z());
  for (const CardLayer& layer : sound->made.layers) highest = std::max(highest, layer.height_mm);
  CHECK(high == Approx(highest).epsilon(0.01));
  // The foremost layer is nearest to who looks.
  CHECK(std::is_sorted(part_x.rbegin(), part_x.rend() - 1));
  CHECK(std::all_of(shown.parts.begin() + 1, shown.parts.end(), [](const judge::ShownPart& part) {
    return part.tabs == 2 && part.folds == 3;
  }));
  const likeness::PrintedFigures printed = judge::layers_likeness(sound->made, {}, 96);
  CHECK(printed.cover > 0.5);
  CHECK(printed.error() < 0.5);
  LayeredCard bare = sound->made;  // with a layer fewer less of the shape is there
  bare.layers.pop_back(), bare.card.parts.pop_back(), bare.card.elements.pop_back();
  CHECK(judge::layers_likeness(bare, {}, 96).cover < printed.cover);
  const Json report = Json::parse(layered_report_json(sound->made, printed, 0.0));
  CHECK(report["printed"]["error"] == Approx(printed.error()));
  CHECK(report["pieces"] == sound->made.layers.size() + 1);

  const auto narrow = judge::sound_layers(spec_of(R"({"length_mm":80,"spine_mm":50})"), {}, "test");
  REQUIRE_FALSE(narrow);
  CHECK(narrow.error().place == "/layers/spine_mm");
  CHECK(narrow.error().detail.find("at least") != std::string::npos);
}

TEST_CASE("layers on a card that opens to 90 degrees stay parallel to its wall",
          "[core][parts][layers]") {
  const auto spec_of = [](const std::string& layers) {
    auto spec = parse_design_spec(
        R"({"popcut":1,"name":"two","style":"layers","surface":{"type":"implicit",)"
        R"x("f":"min(sqrt((x-60)^2+(y-30)^2+(z-20)^2)-18,max(abs(x-25)-5,max(abs(y-45)-30,z-50)))"})x"
        R"(,"layers":)" +
        layers + "}");
    return spec;
  };
  const auto spec = spec_of(R"({"layers":4,"length_mm":80,"opens_deg":90})");
  if (!spec) FAIL(message(spec.error()));
  const auto sound = judge::sound_layers(*spec, {}, "test");
  if (!sound) FAIL(message(sound.error()));
  const LayeredCard& made = sound->made;
  const std::size_t count = made.layers.size();
  CHECK(count >= 3);
  CHECK(sound->report.degrees_of_freedom == 1U);
  CHECK(sound->report.to_deg == Approx(90.0));
  CHECK(made.card.parts.size() == 1 + 2 * count);
  CHECK(made.tabs == 3 * count);
  REQUIRE(sound->report.wobble_mm);
  CHECK(*sound->report.wobble_mm < 1.0);
  for (const double opening_deg : {20.0, 63.0, 90.0}) {
    const PartPoses pose = posed(made.card, radians(opening_deg));
    const Vec3 wall = pose[0][0].linear().col(2), ground = pose[0][1].linear().col(2);
    for (std::size_t j = 0; j < count; ++j) {
      CHECK(norm(cross(wall, Vec3(pose[1 + j][0].linear().col(2)))) < 1e-9);
      CHECK(norm(cross(ground, Vec3(pose[1 + count + j][0].linear().col(2)))) < 1e-9);
    }
  }
  // The layers stand as far apart as they lie in the shape.
  for (std::size_t j = 0; j + 1 < count; ++j)
    CHECK(made.layers[j].at_mm - made.layers[j + 1].at_mm ==
          Approx(made.layers[j + 1].depth_mm - made.layers[j].depth_mm));
  check_guide(made.card, true);
  std::vector<double> part_x;
  check_shown(made.card, part_x);
  for (std::size_t j = 1; j < count; ++j) CHECK(part_x[j] > part_x[j + 1]);
  const likeness::PrintedFigures printed = judge::layers_likeness(made, {}, 96);
  CHECK(printed.cover > 0.4);
  CHECK(Json::parse(layered_report_json(made, printed, 0.0))["opens_deg"] == 90.0);

  // Planted faults: a strut that nothing holds behind, and one that is too long.
  Structure loose = made.card;
  std::erase_if(loose.joints, [&](const PartJoint& joint) {
    return joint.a.part == count + 1 && joint.b.part != 1;
  });
  CHECK(failures(judged(text_of(loose)), "degrees_of_freedom").find("3 degrees of freedom") !=
        std::string::npos);
  Structure long_strut = made.card;
  for (Vec2& p : long_strut.parts[count + 1].vertices) p.x() *= 1.1;
  for (PartJoint& joint : long_strut.joints)
    if (joint.a.part == count + 1)
      for (Vec2& p : joint.a.line) p.x() *= 1.1;
  CHECK(failures(judged(text_of(long_strut)), "opening").find("gaps of") != std::string::npos);
  refused(changed(sound->fold, [](Json& json) { json["popcut:opens_deg"] = 10; }),
          "/popcut:opens_deg", "must be");

  const auto other = spec_of(R"({"length_mm":80,"opens_deg":120})");
  REQUIRE_FALSE(other);
  CHECK(other.error().place == "/layers/opens_deg");
}

TEST_CASE("the fold of a layer has no slot too narrow to cut, and is nowhere too short to crease",
          "[core][parts][layers]") {
  LayerGrid grid{0.5, 160, 160};
  LayerMask mask(grid.cells(), 0);
  const auto box = [&](std::size_t from, std::size_t to, std::size_t low, std::size_t high) {
    for (std::size_t r = low; r < high; ++r)
      for (std::size_t c = from; c < to; ++c) mask[grid.at(c, r)] = 1;
  };
  const std::size_t middle = grid.columns / 2;
  box(middle - 40, middle + 40, 0, 50);
  box(middle - 14, middle - 2, 50, 90), box(middle + 2, middle + 14, 50, 90);      // 2 mm apart
  box(middle - 30, middle - 16, 90, 120), box(middle + 16, middle + 30, 90, 120);  // far apart,
  box(middle - 30, middle + 30, 112, 117);  // with a bar of 2.5 mm between them
  const LayerMask hidden(grid.cells(), 0);
  static_cast<void>(make_one_piece(grid, hidden, LayerPaper{}, mask));
  std::vector<std::size_t> folds;  // rows of each
  for (std::size_t r = 0; r < grid.rows; ++r) {
    const bool is_fold = mask[grid.at(middle - 1, r)] != 0 && mask[grid.at(middle, r)] != 0;
    if (is_fold && (r == 0 || mask[grid.at(middle, r - 1)] == 0)) folds.push_back(0);
    if (is_fold) ++folds.back();
  }
  REQUIRE(folds.size() == 1);
  CHECK(folds[0] >= 85);
}

TEST_CASE("a guide folds every fold once and glues every tab once, on what is there and in reach",
          "[core][parts][guide]") {
  check_guide(two_v_folds(), true);
  Structure turned = two_v_folds();
  const PartPoses before = posed(turned, 2.0);
  const Vec2 corner = turned.parts[1].vertices[3];
  turn_over(turned, 1);
  const Vec2 back = turned.parts[1].vertices[3];
  CHECK(norm(Vec3(before[1][0] * Vec3{corner.x(), corner.y(), 0.0} -
                  posed(turned, 2.0)[1][0] * Vec3{back.x(), back.y(), 0.0})) < 1e-9);
  CHECK(judged(text_of(turned)).ok());
  check_guide(turned, true);
  check_guide(double_corner(true), false);
  Structure house = plain_card(120.0, 200.0);
  BoxElement box;
  box.from_mm = 60.0, box.to_mm = 130.0, box.half_mm = 25.0, box.height_mm = 30.0;
  box.lid = BoxLid::Floating, box.lid_mm = 35.0;
  REQUIRE(add(house, spine_of(house), box));
  check_guide(house, false);
}

TEST_CASE("a guide of joints that hold too little says to verify them", "[core][parts][guide]") {
  const auto guide = judge::glue_guide(changed(text_of(two_v_folds()), [](Json& json) {
    json["popcut:joints"].erase(0);
    json["popcut:joints"].erase(0);
  }));
  REQUIRE_FALSE(guide);
  CHECK(guide.error().place == "/popcut:joints");
  CHECK(guide.error().detail.find("popcut verify") != std::string::npos);
}

TEST_CASE("an order of gluing leaves no place hidden where any order does",
          "[core][parts][guide]") {
  std::mt19937 random(42);
  std::size_t open_orders = 0;
  for (int round = 0; round < 200; ++round) {
    constexpr std::size_t kParts = 5;
    std::vector<judge::GlueContact> contacts;
    for (std::size_t p = 1; p < kParts; ++p) {
      judge::GlueContact contact{p, random() % p, 4, std::vector<std::uint32_t>(kParts, 0)};
      for (std::size_t q = 1; q < kParts; ++q)
        if (q != p && q != contact.other && random() % 4 == 0) contact.hides[q] = random() % 16;
      contacts.push_back(std::move(contact));
    }
    // By brute force: parts in an order, each on what is there, with no place hidden by it.
    const auto is_open = [&](const std::vector<std::size_t>& order) {
      std::vector<bool> there(kParts, false);
      there[0] = true;
      for (const std::size_t p : order) {
        const judge::GlueContact& contact = contacts[p - 1];
        if (!there[contact.other]) return false;
        for (std::size_t q = 0; q < kParts; ++q)
          if (there[q] && contact.hides[q] != 0) return false;
        there[p] = true;
      }
      return true;
    };
    std::vector<std::size_t> order{1, 2, 3, 4};
    bool any = false;
    do any = any || is_open(order);
    while (std::next_permutation(order.begin(), order.end()));
    const std::vector<std::size_t> found = judge::glue_order(kParts, contacts);
    REQUIRE(found.size() == kParts - 1);
    open_orders += any ? 1 : 0;
    if (any) CHECK(is_open(found));
  }
  CHECK(open_orders > 50);
  CHECK(open_orders < 200);
}

// Slices of a solid.

namespace {

/// A mesh as an OBJ file.
struct ObjText {
  std::string text;
  std::size_t corners{};

  void corner(double x, double y, double z) {
    text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    ++corners;
  }
  void face(const std::vector<std::size_t>& of) {
    text += "f";
    for (const std::size_t v : of) text += " " + std::to_string(v + 1);
    text += "\n";
  }
};

/// Rings of corners, (radius, height) one a ring, around the z axis; the ends are closed.
std::string turned_obj(const std::vector<std::pair<double, double>>& profile, std::size_t around,
                       std::size_t left_out = 0) {
  ObjText out;
  for (const auto& [r, z] : profile)
    for (std::size_t k = 0; k < around; ++k) {
      const double turn = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(around);
      out.corner(r * std::cos(turn), r * std::sin(turn), z);
    }
  for (std::size_t n = 0; n + 1 < profile.size(); ++n)
    for (std::size_t k = 0; k < around; ++k) {
      const std::size_t l = (k + 1) % around, a = n * around, b = a + around;
      if (k >= left_out) out.face({a + k, a + l, b + l, b + k});
    }
  std::vector<std::size_t> bottom, top;
  for (std::size_t k = 0; k < around; ++k)
    bottom.push_back(around - 1 - k), top.push_back((profile.size() - 1) * around + k);
  out.face(bottom), out.face(top);
  return out.text;
}

std::string torus_obj(double large, double small, bool stands) {
  constexpr std::size_t kAround = 40, kAcross = 20;
  constexpr double kTurn = 6.283185307179586;
  ObjText out;
  for (std::size_t i = 0; i < kAround; ++i)
    for (std::size_t j = 0; j < kAcross; ++j) {
      const double a = kTurn * static_cast<double>(i) / kAround,
                   b = kTurn * static_cast<double>(j) / kAcross;
      const double r = large + small * std::cos(b), x = r * std::cos(a), y = r * std::sin(a),
                   z = small * std::sin(b);
      stands ? out.corner(z, x, y) : out.corner(x, y, z);
    }
  for (std::size_t i = 0; i < kAround; ++i)
    for (std::size_t j = 0; j < kAcross; ++j) {
      const std::size_t a = i * kAcross, b = (i + 1) % kAround * kAcross, n = (j + 1) % kAcross;
      out.face({a + j, b + j, b + n, a + n});
    }
  return out.text;
}

const std::string kTorus = torus_obj(32.0, 12.0, false), kRing = torus_obj(32.0, 9.0, true),
                  kTree = turned_obj(
                      {{9, 0}, {7, 10}, {6, 28}, {26, 30}, {22, 44}, {12, 58}, {4, 70}}, 32);

DesignSpec slices_spec(const std::string& sliceform) {
  auto spec = parse_design_spec(
      R"({"popcut":1,"name":"solid","style":"slices","surface":{"type":"mesh","file":"solid.obj"},)"
      R"("sliceform":)" +
      sliceform + "}");
  if (!spec) FAIL(message(spec.error()));
  return *spec;
}

judge::SoundSlices sound_of(const std::string& obj, const std::string& sliceform) {
  auto sound = judge::sound_slices(slices_spec(sliceform), {{"solid.obj", obj}}, "test");
  if (!sound) FAIL(message(sound.error()));
  return std::move(*sound);
}

/// The distance of a point from a line of two ends.
double off_line(Vec2 p, const FlatLine& line) {
  const Vec2 way = line[1] - line[0], to = p - line[0];
  const double t = std::clamp(dot(to, way) / std::max(dot(way, way), 1e-12), 0.0, 1.0);
  return norm(Vec2(to - t * way));
}

double off_lines(Vec2 p, const std::vector<FlatLine>& lines) {
  double least = 1e9;
  for (const FlatLine& line : lines) least = std::min(least, off_line(p, line));
  return least;
}

/// Where a plane across an axis meets a mesh, side by side of its triangles.
std::vector<FlatLine> sides_of_section(const TriangleSoup& mesh, int axis, double at) {
  std::vector<FlatLine> out;
  const auto flat = [&](const Vec3& p) { return Vec2{p[axis == 0 ? 1 : 0], p.z()}; };
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    std::vector<Vec2> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
      if ((a[axis] < at) == (b[axis] < at)) continue;
      ends.push_back(flat(Vec3(a + (at - a[axis]) / (b[axis] - a[axis]) * (b - a))));
    }
    if (ends.size() == 2) out.push_back({ends[0], ends[1]});
  }
  return out;
}

/// The outlines of slices are the mesh's sections, but for strips below and slots.
void check_outlines(const SlicedCard& made) {
  constexpr double kOff_mm = 0.05, kStep_mm = 0.4;
  std::size_t looked_at = 0;
  for (std::size_t s = 0; s < made.slices.size(); ++s) {
    const Slice& slice = made.slices[s];
    if (slice.is_foot) continue;
    const bool is_x = slice.family == SliceFamily::X;
    const std::vector<FlatLine> section =
        sides_of_section(made.frame_target, is_x ? 0 : 1, slice.at_mm);
    std::vector<FlatLine> cut, whole;  // with slots, and without
    const auto add = [](const FlatRings& rings, std::vector<FlatLine>& to) {
      for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k)
          to.push_back({ring[k], ring[(k + 1) % ring.size()]});
    };
    add(slice.ground, whole), add(slice.islands, whole);
    for (const SlicePiece& piece : made.lattice.pieces)
      if (piece.slice == s) add(piece.paper, cut);
    const auto is_in_slot = [&](Vec2 p) {
      return std::any_of(made.slices.begin(), made.slices.end(), [&](const Slice& other) {
        return other.family != slice.family &&
               std::abs(p.x() - other.at_mm) < 0.5 * made.slot_mm + 2.0 * kOff_mm;
      });
    };
    const auto compare = [&](const std::vector<FlatLine>& of, const std::vector<FlatLine>& with,
                             bool has_slots) {
      double most = 0.0;
      for (const FlatLine& line : of) {
        const double length = norm(Vec2(line[1] - line[0]));
        for (double at = 0.0; at <= length; at += kStep_mm) {
          const Vec2 p = line[0] + at / std::max(length, 1e-9) * (line[1] - line[0]);
          if (p.y() < made.base_mm + 2.0 * kOff_mm || (has_slots && is_in_slot(p))) continue;
          most = std::max(most, off_lines(p, with)), ++looked_at;
        }
      }
      return most;
    };
    INFO((is_x ? "x = " : "y = ") << slice.at_mm);
    CHECK(compare(cut, section, true) < kOff_mm);
    CHECK(compare(section, whole, false) < kOff_mm);
  }
  CHECK(looked_at > 1000);
}

/// Stretches of an upright line with paper of a part's panel, its tabs left out.
std::vector<std::pair<double, double>> stretches(const SheetPart& part, double u) {
  std::vector<std::pair<double, double>> out;
  for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
    if (std::find(part.tabs.begin(), part.tabs.end(), f) != part.tabs.end()) continue;
    std::vector<double> at;
    for (std::size_t k = 0; k < part.faces[f].size(); ++k) {
      const Vec2 a = part.vertices[part.faces[f][k]],
                 b = part.vertices[part.faces[f][(k + 1) % part.faces[f].size()]];
      if ((a.x() < u) != (b.x() < u))
        at.push_back(a.y() + (u - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
    }
    std::sort(at.begin(), at.end());
    for (std::size_t k = 0; k + 1 < at.size(); k += 2) out.emplace_back(at[k], at[k + 1]);
  }
  return out;
}

double overlap(const std::vector<std::pair<double, double>>& a,
               const std::vector<std::pair<double, double>>& b, double raised) {
  double most = 0.0;
  for (const auto& [from, to] : a)
    for (const auto& [low, high] : b)
      most = std::max(most, std::min(to, high + raised) - std::max(from, low + raised));
  return most;
}

/// How often a piece that comes straight down on those before it is stopped, by trying heights.
std::size_t stopped(const SlicedCard& made, const std::vector<std::size_t>& order) {
  constexpr double kHighest_mm = 150.0, kStep_mm = 0.5, kTouch_mm = 2e-3;
  std::size_t out = 0;
  for (std::size_t n = 0; n < order.size(); ++n)
    for (std::size_t m = 0; m < n; ++m) {
      const SlicePiece &later = made.lattice.pieces[order[n]],
                       &there = made.lattice.pieces[order[m]];
      const Slice &a = made.slices[later.slice], &b = made.slices[there.slice];
      const SheetPart &comes = made.card.parts[1 + order[n]],
                      &stands = made.card.parts[1 + order[m]];
      std::vector<std::pair<double, double>> lines;  // on what comes, on what is there
      if (a.family != b.family) {
        lines.emplace_back(b.at_mm, a.at_mm);
      } else if (later.slice == there.slice) {
        for (double u = 0.13; u < 200.0; u += 0.71) lines.emplace_back(u, u);
      }
      bool hits = false;
      for (const auto& [on_comes, on_stands] : lines) {
        const auto moving = stretches(comes, on_comes), fixed = stretches(stands, on_stands);
        for (double up = 0.0; up < kHighest_mm && !hits && !moving.empty() && !fixed.empty();
             up += kStep_mm)
          hits = overlap(fixed, moving, up) > kTouch_mm;
      }
      if (hits) ++out;
    }
  return out;
}

/// Follows a guide of slices: each comes down on those before it, all its slots onto what is there,
/// and nothing is left over. Then both feet are glued.
void check_slides(const judge::SoundSlices& sound) {
  const auto guide = judge::glue_guide(sound.fold);
  if (!guide) FAIL(message(guide.error()));
  const std::vector<SheetPart>& parts = sound.made.card.parts;
  std::vector<std::size_t> order;  // of pieces
  std::vector<bool> is_joined(sound.made.card.joints.size(), false);
  std::string glued;
  for (const judge::GlueStep& step : guide->steps) {
    CAPTURE(step.words);
    if (step.kind == judge::GlueStepKind::Fold) {
      CHECK(order.empty());
      continue;
    }
    if (step.kind == judge::GlueStepKind::Glue) {
      CHECK(order.size() + 1 == parts.size());
      for (const std::size_t t : step.tabs) glued += guide->tabs[t].letter;
      CHECK(step.part == 1);
      CHECK(step.with.size() + 2 == parts.size());
      continue;
    }
    CHECK(glued.empty());
    CHECK(step.standing.size() == order.size());
    double before = -1e9;
    for (const std::size_t k : step.slots) {
      const judge::GlueSlot& slot = guide->slots[k];
      REQUIRE(sound.made.card.joints[slot.joint].kind == PartJointKind::Cross);
      CHECK_FALSE(is_joined[slot.joint]);
      is_joined[slot.joint] = true;
      CHECK(slot.part == step.part);
      CHECK(std::find(order.begin(), order.end(), slot.onto - 1) != order.end());
      CHECK(step.words.find(parts[slot.onto].name) != std::string::npos);
      CHECK(slot.line[0].x() > before);  // named from left to right
      before = slot.line[0].x();
      // A slot has no paper, and ends where paper begins.
      CHECK(slot.line[1].y() > slot.line[0].y() + 1.0);
      const auto paper = stretches(parts[slot.part], slot.line[0].x());
      const auto has_paper = [&](double z) {
        return std::any_of(paper.begin(), paper.end(),
                           [&](const auto& one) { return z > one.first && z < one.second; });
      };
      CHECK_FALSE(has_paper(slot.line[0].y() + 0.1));
      CHECK_FALSE(has_paper(slot.line[1].y() - 0.01));
      CHECK(has_paper(slot.line[1].y() + 0.01));
    }
    order.push_back(step.part - 1);
    for (const std::size_t p : step.with) order.push_back(p - 1);
    if (order.size() > step.with.size() + 1) CHECK(step.with.empty());
  }
  CHECK(glued == "AB");
  for (std::size_t j = 0; j < is_joined.size(); ++j)
    CHECK(is_joined[j] == (sound.made.card.joints[j].kind == PartJointKind::Cross));
  CHECK(stopped(sound.made, order) == 0);
  const Json steps = Json::parse(judge::glue_guide_json(*guide))["steps"];
  CHECK(std::count_if(steps.begin(), steps.end(),
                      [](const Json& step) { return step["kind"] == "slide"; }) > 3);
}

}  // namespace

TEST_CASE("slices of a solid follow its sections, go together from above, open and shut",
          "[core][parts][slices]") {
  struct Solid {
    const char* name;
    const std::string& obj;
    const char* sliceform;
    double least_kept;
    bool has_islands;
  };
  for (const Solid& solid :
       {Solid{"torus", kTorus, R"({"x_slices":6,"y_slices":7})", 0.97, false},
        Solid{"ring", kRing, R"({"x_slices":4,"y_slices":9})", 0.9, true},
        Solid{"tree", kTree, R"({"x_slices":5,"y_slices":5,"frame_deg":40})", 0.85, true}}) {
    INFO(solid.name);
    const judge::SoundSlices sound = sound_of(solid.obj, solid.sliceform);
    const SlicedCard& made = sound.made;
    CHECK(sound.report.degrees_of_freedom == 1U);
    CHECK(sound.report.from_deg == Approx(1.0));
    CHECK(sound.report.to_deg == Approx(179.0));
    CHECK(sound.report.closed_mm <= sound.report.page_mm - 7.9);
    CHECK(made.lattice.crossings.size() > 15);
    const auto& pieces = made.lattice.pieces;
    CHECK(std::any_of(pieces.begin(), pieces.end(),
                      [](const SlicePiece& one) { return one.is_island; }) == solid.has_islands);
    check_outlines(made);
    std::vector<std::size_t> order(pieces.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    CHECK(stopped(made, order) == 0);
    std::reverse(order.begin(), order.end());
    CHECK(stopped(made, order) > 10);
    check_slides(sound);
    std::vector<double> part_x;
    check_shown(made.card, part_x);
    // No slot ends at the tab of a foot, so both fold in one line.
    for (const std::size_t foot : made.lattice.feet)
      for (const SliceCrossing& one : made.lattice.crossings)
        if (one.x_piece == foot || one.y_piece == foot) {
          const std::size_t other = one.x_piece == foot ? one.y_piece : one.x_piece;
          const bool is_foot = other == made.lattice.feet[0] || other == made.lattice.feet[1];
          CHECK((is_foot || pieces[foot].step < pieces[other].step));
        }
    const Json report = Json::parse(sliced_report_json(made, 0.0));
    CHECK(report["pieces"] == pieces.size() + 1);
    CHECK(report["kept"].get<double>() > solid.least_kept);
    std::size_t listed = 0;
    for (const auto& step : report["assembly"]) listed += step.size();
    CHECK(listed == pieces.size());
  }
}

TEST_CASE("paper whose hole touches its outline is opened there, so that its faces fill its border",
          "[core][parts][slices]") {
  // A slot that a touching place closes, as slots of letters do.
  const FlatRings outline{rectangle({0, 0}, {40, 20})};
  const std::vector<Vec2> at_corner{{20, 5}, {15, 10}, {20, 20}, {25, 10}},
      inside{{5, 5}, {5, 8}, {8, 8}, {8, 5}}, beside{{8, 8}, {8, 12}, {12, 12}, {12, 8}};
  for (const FlatRings& holes :
       {FlatRings{at_corner}, FlatRings{inside}, FlatRings{inside, beside}}) {
    FlatRings shape = outline;
    shape.insert(shape.end(), holes.begin(), holes.end());
    const FlatRings apart = without_touching(shape);
    std::vector<Vec2> places;
    double faces_mm2 = 0.0;
    for (const FlatRings& piece : pieces_of(apart)) {
      for (const std::vector<Vec2>& ring : piece)
        for (const Vec2& at : ring) {
          for (const Vec2& other : places) CHECK((at - other).norm() > 1e-3);
          places.push_back(at);
        }
      faces_mm2 += area_of(faces_of_piece(piece));
    }
    const double before_mm2 = area_of(inside_of(shape));
    CHECK(faces_mm2 == Approx(area_of(apart)).margin(1e-3));
    CHECK(area_of(apart) <= before_mm2 + 1e-6);
    CHECK(area_of(apart) >= before_mm2 - 0.02);
  }
}

TEST_CASE("thin walls beside slots are named with their thickness and with what helps",
          "[core][parts][slices]") {
  // The second slot of x is 0.775 mm from its edge; on y both walls are wide.
  const std::vector<Slice> slices{
      {SliceFamily::X, 0.0, true, {rectangle({-3, 0}, {40, 12})}, {}},
      {SliceFamily::X, 20.0, false, {rectangle({-3, 0}, {40, 30})}, {}},
      {SliceFamily::Y, 0.0, true, {rectangle({-3, 0}, {30, 12})}, {}},
      {SliceFamily::Y, 39.0, false, {rectangle({-3, 0}, {30, 30})}, {}}};
  const SliceLattice lattice = cross_slices(slices, {.width_mm = 0.45}, 15.0);
  REQUIRE(lattice.crossings.size() == 4);
  const auto walls = thin_walls(slices, lattice, 0.45, 1.5, 3.0);
  REQUIRE(walls.size() == 2);  // of both slices x
  for (const ThinWall& wall : walls) {
    CHECK(slices[lattice.pieces[wall.piece].slice].family == SliceFamily::X);
    CHECK(slices[lattice.pieces[wall.other].slice].at_mm == 39.0);
    CHECK(wall.thick_mm == Approx(0.775));
    CHECK_FALSE(wall.is_between_slots);
  }
  CHECK(thin_walls(slices, lattice, 0.45, 0.7, 3.0).empty());

  const auto warnings_of = [](const char* sliceform) {
    const auto made = sliced_card(slices_spec(sliceform), {{"solid.obj", kTorus}});
    if (!made) FAIL(message(made.error()));
    std::string out;
    for (const Warning& one : made->warnings) out += one.code + ": " + one.message + "\n";
    return out;
  };
  const std::string crowded = warnings_of(R"({"x_slices":60,"y_slices":6})");
  CAPTURE(crowded);
  CHECK(crowded.find("slots_crowded: paper beside slots is thinner than 1.5 mm") !=
        std::string::npos);
  CHECK(crowded.find("give fewer x_slices, or a larger scale_mm") != std::string::npos);
  CHECK(warnings_of(R"({"x_slices":6,"y_slices":6})").find("slots_crowded") == std::string::npos);
}

TEST_CASE("planted faults of slices are found", "[core][verify][parts][slices]") {
  const judge::SoundSlices sound = sound_of(kTorus, R"({"x_slices":4,"y_slices":4})");
  const auto fails = [](const std::string& text, const char* check) {
    return failures(judged(text), check);
  };
  SECTION("a slot missing") {
    Structure card = sound.made.card;
    const SlicePiece& piece = sound.made.lattice.pieces[2];
    REQUIRE_FALSE(sound.made.slices[piece.slice].is_foot);
    card.parts[3].faces.clear(), card.parts[3].vertices.clear();
    for (const auto& face : faces_of_piece(pieces_of(sound.made.slices[piece.slice].ground)[0]))
      card.parts[3].add_face(face);
    for (const Vec2& at : std::vector<Vec2>(card.parts[3].vertices)) card.parts[3].add_corner(at);
    CHECK(fails(text_of(card), "slots").find("both faces have paper") != std::string::npos);
    // The planes of both always meet in the line of their slots.
    CHECK(fails(text_of(card), "crossing").find("passes through it") != std::string::npos);
  }
  SECTION("slots too narrow for the paper") {
    const std::string thick =
        changed(sound.fold, [](Json& json) { json["popcut:thickness_mm"] = 0.6; });
    CHECK(fails(thick, "slots").find("is narrower than 0.6 mm") != std::string::npos);
  }
  SECTION("a foot that is not glued") {
    for (const std::size_t left_out : {1u, 2u}) {
      Structure card = sound.made.card;
      card.joints.erase(card.joints.end() - static_cast<std::ptrdiff_t>(left_out));
      CHECK(fails(text_of(card), "degrees_of_freedom").find("is required") != std::string::npos);
    }
  }
  SECTION("a crossing where there is no paper") {
    const std::string high = changed(sound.fold, [](Json& json) {
      for (const char* side : {"a", "b"})
        for (const int k : {1, 3}) {
          auto& z = json["popcut:joints"][3][side]["line_mm"][k];
          z = z.get<double>() + 200.0;
        }
    });
    CHECK(fails(high, "slots").find("has no paper on the line") != std::string::npos);
  }
  SECTION("a page too small") {
    const std::string small = changed(sound.fold, [](Json& json) {
      for (auto& at : json["file_frames"][0]["vertices_coords"]) at[0] = 0.8 * at[0].get<double>();
    });
    CHECK(fails(small, "closed").find("sticks out of the pages") != std::string::npos);
  }
  SECTION("a guide says which parts cannot be put together") {
    Structure card = sound.made.card;
    const SlicePiece& piece = sound.made.lattice.pieces[2];
    card.parts[3].faces.clear(), card.parts[3].vertices.clear();
    for (const auto& face : faces_of_piece(pieces_of(sound.made.slices[piece.slice].ground)[0]))
      card.parts[3].add_face(face);
    for (const Vec2& at : std::vector<Vec2>(card.parts[3].vertices)) card.parts[3].add_corner(at);
    const auto guide = judge::glue_guide(text_of(card));
    REQUIRE_FALSE(guide);
    CHECK(guide.error().kind == ErrorKind::Infeasible);
    CHECK(guide.error().detail.find(card.parts[3].name + " cannot come down past each other") !=
          std::string::npos);
  }
}

TEST_CASE("a solid that cannot be sliced says why, and what would do", "[core][parts][slices]") {
  const auto says = [](const std::string& obj, const std::string& sliceform,
                       const std::string& place, const std::string& what) {
    const auto made = sliced_card(slices_spec(sliceform), {{"solid.obj", obj}});
    REQUIRE_FALSE(made);
    CAPTURE(message(made.error()));
    CHECK(made.error().kind == ErrorKind::Infeasible);
    CHECK(made.error().place == place);
    CHECK(made.error().detail.find(what) != std::string::npos);
  };
  says(turned_obj({{30, 0}, {30, 40}}, 24, 9), "{}", "/surface", "has no inside");
  says(turned_obj({{30, 0}, {30, 0.2}}, 24), "{}", "/scale_mm", "0.2 mm high");
  says(kTorus, R"({"page_mm":60})", "/sliceform/page_mm", "need pages of at least");
  says(kTorus, R"({"spine_mm":60})", "/sliceform/spine_mm", "a spine of at least");
  // Cubes in the air over a plate, more than can be looked at.
  ObjText cubes;
  const auto add_cube = [&](double x, double y, double z, double wide, double high) {
    const std::size_t first = cubes.corners;
    for (const double up : {0.0, high})
      for (const auto& [dx, dy] :
           {std::pair(0.0, 0.0), std::pair(wide, 0.0), std::pair(wide, wide), std::pair(0.0, wide)})
        cubes.corner(x + dx, y + dy, z + up);
    cubes.face({first + 3, first + 2, first + 1, first});
    cubes.face({first + 4, first + 5, first + 6, first + 7});
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t l = (k + 1) % 4;
      cubes.face({first + k, first + l, first + 4 + l, first + 4 + k});
    }
  };
  add_cube(0, 0, 0, 400, 10);
  for (int x = 0; x < 50; ++x)
    for (int y = 0; y < 50; ++y) add_cube(8.0 * x, 8.0 * y, 20.0, 5.0, 10.0);
  says(cubes.text, R"({"x_slices":60,"y_slices":60})", "/sliceform",
       "at most 3000 can be looked at");
  const auto refused_spec = [](const std::string& rest, const std::string& place) {
    const auto spec = parse_design_spec(R"({"popcut":1,"style":"slices",)" + rest + "}");
    REQUIRE_FALSE(spec);
    CHECK(spec.error().place == place);
  };
  refused_spec(R"("surface":{"type":"implicit","f":"x-1"})", "/surface/type");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"slices":4)", "/slices");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"sliceform":{"frame_deg":70})",
               "/sliceform/frame_deg");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"layers":{})", "/layers");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"card":false)", "/card");
}

namespace {

/// Boxes, houses and pyramids, with the spine along y.
struct Village : ObjText {
  void box(double x0, double x1, double y0, double y1, double z0, double z1) {
    const std::size_t n = corners;
    for (const double z : {z0, z1})
      for (const auto& [x, y] :
           {std::pair(x0, y0), std::pair(x1, y0), std::pair(x1, y1), std::pair(x0, y1)})
        corner(x, y, z);
    face({n + 3, n + 2, n + 1, n}), face({n + 4, n + 5, n + 6, n + 7});
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t l = (k + 1) % 4;
      face({n + k, n + l, n + 4 + l, n + 4 + k});
    }
  }
  /// Walls, gables, and a roof that goes beyond them.
  void house(double half, double y0, double y1, double walls, double rise, double eaves,
             double verge) {
    const std::size_t n = corners;
    for (const double y : {y0, y1})
      for (const auto& [x, z] :
           {std::pair(-half, 0.0), std::pair(half, 0.0), std::pair(half, walls),
            std::pair(0.0, walls + rise), std::pair(-half, walls)})
        corner(x, y, z);
    face({n, n + 1, n + 2, n + 3, n + 4}), face({n + 9, n + 8, n + 7, n + 6, n + 5});
    face({n + 1, n + 6, n + 7, n + 2}), face({n, n + 4, n + 9, n + 5}),
        face({n, n + 5, n + 6, n + 1});
    const double low = walls - eaves * rise / half;
    for (const double side : {-1.0, 1.0}) {
      const std::size_t r = corners;
      corner(0.0, y0 - verge, walls + rise), corner(0.0, y1 + verge, walls + rise);
      corner(side * (half + eaves), y1 + verge, low),
          corner(side * (half + eaves), y0 - verge, low);
      face({r, r + 1, r + 2, r + 3});
    }
  }
  void pyramid(double half, double y0, double y1, double walls, double top) {
    const std::size_t n = corners;
    corner(-half, y0, walls), corner(half, y0, walls), corner(half, y1, walls);
    corner(-half, y1, walls), corner(0.0, 0.5 * (y0 + y1), top);
    for (std::size_t k = 0; k < 4; ++k) face({n + k, n + (k + 1) % 4, n + 4});
  }
};

std::string church_obj() {
  Village out;
  out.house(20.0, 0.0, 70.0, 25.0, 22.0, 3.0, 0.0);
  out.box(-11.0, 11.0, -22.0, 0.0, 0.0, 60.0);
  out.pyramid(11.0, -22.0, 0.0, 60.0, 100.0);
  return out.text;
}

std::string barn_obj() {
  Village out;
  out.house(32.0, 0.0, 90.0, 30.0, 22.0, 4.0, 4.0);
  out.box(-6.0, 6.0, 40.0, 52.0, 45.0, 60.0);                                            // a cupola
  out.box(-8.0, 8.0, -0.8, 0.0, 0.0, 18.0), out.box(32.0, 32.8, 20.0, 40.0, 0.0, 15.0);  // doors
  return out.text;
}

DesignSpec boxes_spec(const std::string& file, const std::string& rest) {
  auto spec = parse_design_spec(
      R"({"popcut":1,"name":"model","style":"boxes","surface":{"type":"mesh","file":")" + file +
      R"("})" + rest + "}");
  if (!spec) FAIL(message(spec.error()));
  return *spec;
}

judge::SoundBoxes boxes_of(const std::string& obj, const std::string& rest = "") {
  auto sound = judge::sound_boxes(boxes_spec("model.obj", rest), {{"model.obj", obj}}, "test");
  if (!sound) FAIL(message(sound.error()));
  return std::move(*sound);
}

}  // namespace

TEST_CASE("a house, a church and a barn are boxes of few panels, less than 1 % off",
          "[core][parts][boxes]") {
  SECTION("the house of the examples") {
    std::ifstream file(testing::source_file("examples/house.glb"), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const auto sound =
        judge::sound_boxes(boxes_spec("house.glb", R"(,"scale_mm":1000,"rotate_deg":[90,0,90])"),
                           {{"house.glb", bytes}}, "test");
    if (!sound) FAIL(message(sound.error()));
    const BoxedCard& made = sound->made;
    CHECK(made.panels <= 12);
    CHECK(made.error() < 0.01);
    CHECK(sound->report.degrees_of_freedom == 1U);
    CHECK(sound->report.wobble_mm.value_or(9.0) <= 1.0);
    REQUIRE(made.boxes.size() == 1);
    // The model's own numbers: docs/gallery/models/models.mjs.
    const Block& block = made.boxes[0].block;
    CHECK(block.roof == BlockRoof::Gabled);
    CHECK(block.half_mm == Approx(42.0).margin(0.5));
    CHECK(block.to_mm - block.from_mm == Approx(40.0).margin(0.5));
    CHECK(block.height_mm == Approx(44.0).margin(0.5));
    CHECK(block.rise_mm == Approx(35.0).margin(0.5));
    CHECK(block.eaves_mm == Approx(7.8).margin(1.0));
  }
  SECTION("a church: a nave, and a tower with a spire") {
    const judge::SoundBoxes sound = boxes_of(church_obj());
    const BoxedCard& made = sound.made;
    REQUIRE(made.boxes.size() == 2);
    CHECK(made.panels == 22);
    CHECK(sound.report.wobble_mm.value_or(9.0) <= 1.0);
    CHECK(made.error() < 0.01);
    CHECK(sound.report.degrees_of_freedom == 1U);
    CHECK(made.boxes[0].block.roof == BlockRoof::Pyramid);
    CHECK(made.boxes[1].block.roof == BlockRoof::Gabled);
    CHECK(made.boxes[0].block.top_mm() == Approx(100.0).margin(1.0));
    CHECK(made.boxes[1].block.from_mm - made.boxes[0].block.to_mm ==
          Approx(made.card.thickness_mm));
    // Printed, it has the colours of the model.
    const likeness::PrintedFigures clay = judge::boxes_likeness(made, {}, 96);
    CHECK(clay.error() < 0.2);
    CHECK(clay.cover > 0.8);
    std::vector<likeness::Rgb> colours(made.target.size(), {20, 40, 200});
    for (std::size_t t = 0; t < colours.size(); t += 2) colours[t] = {220, 30, 20};
    CHECK(judge::boxes_likeness(made, colours, 96).colour < 0.2);
    BoxedCard low = made;  // without the tower less of the model is there
    std::erase_if(low.boxes, [](const CardBox& box) { return box.first_part == 1; });
    low.card.parts[1].tabs.clear();
    for (std::uint32_t f = 0; f < low.card.parts[1].faces.size(); ++f)
      low.card.parts[1].tabs.push_back(f);
    CHECK(judge::boxes_likeness(low, {}, 96).cover < clay.cover);
    CHECK(Json::parse(boxed_report_json(made, clay, 0.0))["printed"]["error"] ==
          Approx(clay.error()));
    // Nobody reaches into a tower: its inner wall is glued before it is closed.
    const auto guide = judge::glue_guide(sound.fold);
    if (!guide) FAIL(message(guide.error()));
    CHECK(guide->tabs.size() == made.tabs);
    for (const CardBox& box : made.boxes) {
      REQUIRE(box.inner_part);
      const auto step_of = [&](std::size_t part) {
        return std::find_if(guide->steps.begin(), guide->steps.end(),
                            [&](const judge::GlueStep& step) {
                              return step.kind == judge::GlueStepKind::Glue && step.part == part;
                            });
      };
      const auto inner = step_of(*box.inner_part);
      REQUIRE(inner != guide->steps.end());
      CHECK(inner->tabs.size() == 2);
      CHECK(inner->words.find("Fold " + box.name + " around it") != std::string::npos);
      CHECK(inner < step_of(box.first_part));
    }
  }
  SECTION("a barn, without its cupola") {
    const judge::SoundBoxes sound = boxes_of(barn_obj());
    CHECK(sound.made.boxes.size() == 1);
    CHECK(sound.made.panels == 9);
    CHECK(sound.made.error() < 0.01);
    CHECK(sound.report.wobble_mm.value_or(9.0) <= 1.0);
    CHECK(std::any_of(sound.made.warnings.begin(), sound.made.warnings.end(),
                      [](const Warning& one) { return one.code == "left_out"; }));
  }
  SECTION("a hall with a flat roof, and one between lower ones") {
    Village hall;
    hall.box(-25.0, 25.0, 0.0, 60.0, 0.0, 40.0);
    const judge::SoundBoxes flat = boxes_of(hall.text);
    CHECK(flat.made.error() < 0.01);
    CHECK(flat.report.wobble_mm.value_or(9.0) <= 1.0);
    Village wings;
    wings.house(30.0, 0.0, 80.0, 40.0, 30.0, 0.0, 0.0);
    wings.house(18.0, -50.0, 0.0, 28.0, 14.0, 0.0, 0.0);
    wings.house(18.0, 80.0, 130.0, 28.0, 14.0, 0.0, 0.0);
    const judge::SoundBoxes row = boxes_of(wings.text);
    REQUIRE(row.made.boxes.size() == 3);
    CHECK_FALSE(row.made.boxes[1].inner_part);  // both of its ends fold inward
    CHECK(row.made.boxes[0].inner_part);
    CHECK(row.report.wobble_mm.value_or(9.0) <= 1.0);
  }
  SECTION("what would not open or shut becomes the nearest that does") {
    // The paper of a low pyramid leaves too little room for the tab that closes it.
    Village low;
    low.box(-30.0, 30.0, 0.0, 60.0, 0.0, 40.0);
    low.pyramid(30.0, 0.0, 60.0, 40.0, 48.0);
    CHECK(boxes_of(low.text).made.boxes[0].block.roof != BlockRoof::Pyramid);
    // Both ends of the house in the middle would fold inward, and meet.
    Village street;
    street.house(30.0, 0.0, 60.0, 30.0, 20.0, 0.0, 0.0);
    street.house(30.0, 60.0, 90.0, 36.0, 20.0, 0.0, 0.0);
    street.house(30.0, 90.0, 150.0, 42.0, 20.0, 0.0, 0.0);
    const judge::SoundBoxes row = boxes_of(street.text);
    CHECK(row.made.boxes.size() == 2);
    CHECK(row.report.degrees_of_freedom == 1U);
  }
  SECTION("paper over a gate is named, and so is what moves by more than 1 mm") {
    const auto has = [](const judge::SoundBoxes& sound, const char* code) {
      return std::any_of(sound.made.warnings.begin(), sound.made.warnings.end(),
                         [&](const Warning& one) { return one.code == code; });
    };
    Village gate;
    gate.box(-40.0, -15.0, 0.0, 40.0, 0.0, 80.0), gate.box(15.0, 40.0, 0.0, 40.0, 0.0, 80.0);
    gate.box(-15.0, 15.0, 0.0, 40.0, 50.0, 80.0);
    CHECK(has(boxes_of(gate.text), "gaps_filled"));
    CHECK_FALSE(has(boxes_of(barn_obj()), "gaps_filled"));
    Village tower;
    tower.box(-12.0, 12.0, 0.0, 24.0, 0.0, 180.0);
    for (const judge::SoundBoxes& sound : {boxes_of(church_obj()), boxes_of(tower.text)})
      CHECK(has(sound, "moves_in_paper") == (sound.report.wobble_mm.value_or(0.0) > 1.0));
  }
  SECTION("a roof alone is a tent, and a turned church is turned back") {
    Village tent;
    tent.house(25.0, 0.0, 60.0, 0.0, 40.0, 0.0, 0.0);
    const judge::SoundBoxes sound = boxes_of(tent.text);
    REQUIRE(sound.made.boxes.size() == 1);
    CHECK(sound.made.boxes[0].block.is_tent());
    CHECK(sound.made.panels == 2);
    const BoxedCard straight = boxes_of(church_obj()).made;
    const BoxedCard turned = boxes_of(church_obj(), R"(,"rotate_deg":[0,0,27])").made;
    CHECK(turned.turn_rad == Approx(radians(-27.0)).margin(1e-3));
    CHECK(turned.error() == Approx(straight.error()).margin(1e-3));
  }
}

TEST_CASE("layers of tall and slim shapes move by at most 1 mm", "[core][parts][layers]") {
  for (const char* turn : {"0", "90"})
    for (const char* opens : {"180", "90"}) {
      CAPTURE(turn, opens);
      const auto spec = parse_design_spec(
          R"({"popcut":1,"style":"layers","surface":{"type":"mesh","file":"a.obj"},)"
          R"("rotate_deg":[0,0,)" +
          std::string(turn) + R"(],"layers":{"opens_deg":)" + opens + "}}");
      REQUIRE(spec);
      const auto sound = judge::sound_layers(*spec, {{"a.obj", church_obj()}}, "test");
      if (!sound) FAIL(message(sound.error()));
      CHECK(sound->report.wobble_mm.value_or(9.0) <= 1.0);
    }
}

TEST_CASE("a hollow shape has paper for its struts, which hangs on its layers",
          "[core][parts][layers]") {
  ObjText cup;
  for (const auto& [x0, x1, y0, y1] :
       {std::array{0.0, 60.0, 0.0, 5.0}, std::array{0.0, 60.0, 55.0, 60.0},
        std::array{0.0, 5.0, 0.0, 60.0}, std::array{55.0, 60.0, 0.0, 60.0}}) {
    const std::size_t n = cup.corners;
    for (const double z : {0.0, 80.0})
      for (const auto& [x, y] :
           {std::pair(x0, y0), std::pair(x1, y0), std::pair(x1, y1), std::pair(x0, y1)})
        cup.corner(x, y, z);
    cup.face({n + 3, n + 2, n + 1, n}), cup.face({n + 4, n + 5, n + 6, n + 7});
    for (std::size_t k = 0; k < 4; ++k)
      cup.face({n + k, n + (k + 1) % 4, n + 4 + (k + 1) % 4, n + 4 + k});
  }
  const auto spec_of = [](const char* layers) {
    return parse_design_spec(
        R"({"popcut":1,"style":"layers","surface":{"type":"mesh","file":"a.obj"},"layers":)" +
        std::string(layers) + "}");
  };
  const auto spec = spec_of(R"({"opens_deg":90})");
  REQUIRE(spec);
  const auto sound = judge::sound_layers(*spec, {{"a.obj", cup.text}}, "test");
  if (!sound) FAIL(message(sound.error()));
  CHECK(sound->report.degrees_of_freedom == 1U);
  // A mesh has its own ends.
  for (const char* layers : {R"({"from_mm":20})", R"({"length_mm":20})"}) {
    const auto cropped = spec_of(layers);
    REQUIRE_FALSE(cropped);
    CHECK(cropped.error().detail.find("a mesh has its own ends") != std::string::npos);
  }
}

TEST_CASE("solids that overlap are one in each layer", "[core][parts][layers]") {
  // A small box deep in a large one, and the same with all faces inside out.
  for (const bool is_turned : {false, true}) {
    CAPTURE(is_turned);
    TriangleSoup soup;
    const auto box = [&](double half, double front, double back) {
      const auto corner = [&](int k) {
        return Vec3{k & 1 ? -front : -back, k & 2 ? half : -half, k & 4 ? 40.0 : 0.0};
      };
      for (const std::array<int, 4>& side : std::initializer_list<std::array<int, 4>>{
               {1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3}, {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}})
        for (const std::array<int, 3>& t :
             {std::array{side[0], side[1], side[2]}, std::array{side[0], side[2], side[3]}})
          soup.add(corner(t[is_turned ? 2 : 0]), corner(t[1]), corner(t[is_turned ? 0 : 2]));
    };
    box(30.0, 0.0, 60.0);
    box(10.0, 10.0, 50.0);
    const DepthStacks stacks = depth_stacks(soup, {}, 1.0);
    const std::vector<LayerMask> masks = layer_masks(stacks, {5.0, 30.0, 55.0});
    const std::size_t middle = stacks.grid.at(stacks.grid.columns / 2, 20);
    CHECK(stacks.crossings[middle].size() == 4);
    // Without a direction the inner box is a hole in the outer one.
    CHECK(masks[1][middle] == (is_turned ? 0 : 1));
    CHECK(masks[0][middle] == 1);
    CHECK(masks[2][middle] == 1);
    CHECK(height_of(stacks.grid, masks[1]) == Approx(40.0).margin(1.0));
    // Seen from 45 degrees above, the top of what lies up to 17.5 mm behind a layer is over it;
    // what lies before it is lower.
    const DepthStacks seen = depth_stacks(soup, {1.0, 0.0}, 1.0);
    const std::vector<LayerMask> from_above = layer_masks(seen, {5.0, 30.0, 55.0});
    CHECK(height_of(seen.grid, from_above[0]) == Approx(52.5).margin(2.0));
    CHECK(height_of(seen.grid, from_above[2]) == Approx(45.0).margin(2.0));
    // The wings of paper that goes back beside its middle end behind the target.
    const DepthStacks bent = depth_stacks(soup, {0.0, 0.5}, 1.0);
    const std::vector<LayerMask> folded = layer_masks(bent, {5.0, 91.0});
    const auto paper = [&](const LayerMask& mask) {
      return std::count(mask.begin(), mask.end(), 1);
    };
    CHECK(static_cast<double>(paper(folded[1])) ==
          Approx(0.8 * static_cast<double>(paper(folded[0]))).epsilon(0.05));
    CHECK(bent.crossings[bent.grid.at(bent.grid.columns / 2 + 20, 20)].front().depth_mm ==
          Approx(-10.25).margin(0.1));
  }
}

TEST_CASE("what cannot be made of boxes says why, and what would do", "[core][parts][boxes]") {
  const auto says = [](const std::string& obj, const std::string& rest, const std::string& place,
                       const std::string& what) {
    const auto made = boxed_card(boxes_spec("model.obj", rest), {{"model.obj", obj}});
    REQUIRE_FALSE(made);
    CAPTURE(message(made.error()));
    CHECK(made.error().kind == ErrorKind::Infeasible);
    CHECK(made.error().place == place);
    CHECK(made.error().detail.find(what) != std::string::npos);
  };
  std::vector<std::pair<double, double>> ball;
  for (int k = 0; k <= 16; ++k)
    ball.emplace_back(0.1 + 40.0 * std::sin(radians(11.25 * k)),
                      40.0 - 40.0 * std::cos(radians(11.25 * k)));
  says(turned_obj(ball, 32), "", "/surface", "has no boxes");
  says(kTree, "", "/surface", "use the style layers or slices");
  says(church_obj(), R"(,"scale_mm":0.1)", "/scale_mm", "boxes need at least 20 mm");
  says(church_obj(), R"(,"boxes":{"most":1})", "/boxes/most", "is 1; the shape has 2 boxes");
  says(church_obj(), R"(,"boxes":{"page_mm":60})", "/boxes/page_mm", "need pages of at least");
  says(church_obj(), R"(,"boxes":{"spine_mm":60})", "/boxes/spine_mm", "a spine of at least");
  Village street;
  for (int k = 0; k < 11; ++k) street.house(14.0, 40.0 * k, 40.0 * k + 26.0, 16.0, 10.0, 0.0, 0.0);
  says(street.text, "", "/boxes/most", "a card has at most 9");
  const auto refused_spec = [](const std::string& rest, const std::string& place) {
    const auto spec = parse_design_spec(R"({"popcut":1,"style":"boxes",)" + rest + "}");
    REQUIRE_FALSE(spec);
    CHECK(spec.error().place == place);
  };
  refused_spec(R"("surface":{"type":"implicit","f":"x-1"})", "/surface/type");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"sliceform":{})", "/sliceform");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"boxes":{"most":10})", "/boxes/most");
  refused_spec(R"("surface":{"type":"mesh","file":"a.obj"},"translate_mm":[1,0,0])",
               "/translate_mm");
  CHECK_FALSE(parse_design_spec(
      R"({"popcut":1,"style":"layers","surface":{"type":"mesh","file":"a.obj"},"boxes":{}})"));
}

}  // namespace verify_parts_test
