// SPDX-License-Identifier: MIT
// Cards of several parts, and the faults that verify must find in them.
#include <algorithm>
#include <functional>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/geometry/angle.hpp"
#include "core/parts/elements.hpp"
#include "core/parts/structure_fold.hpp"
#include "core/verify/parts/parts.hpp"

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
}

}  // namespace verify_parts_test
