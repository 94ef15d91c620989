// SPDX-License-Identifier: MIT
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

#include "core/verify/verify.hpp"
#include "tests/support/fold_draft.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace verify_input_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// The error that a text must give, as popcut prints it; it must be one of exit code 3.
std::string refused(const std::string& text) {
  const auto report = verify_fold(text);
  if (report) FAIL("it was read");
  CHECK(exit_code(report.error().kind) == 3);
  return message(report.error());
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) FAIL("no " << what);
  return text.replace(at, what.size(), by);
}

const std::filesystem::path kSamples = popcut::testing::source_file("../shared/data/fold");

std::string sample(const char* name) {
  std::ifstream in(kSamples / name);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("text that is not JSON is refused with line and column", "[core][verify]") {
  const std::string text = box_card().text();
  CHECK(has(refused(""), "line 1"));
  CHECK(has(refused("{\n  \"file_spec\": 1.2,\n  oops"), "line 3, column 3"));
  CHECK(has(refused(text.substr(0, text.size() / 2)), "is not JSON"));
  CHECK(has(refused(replaced(text, "[0,0]", "[NaN,0]")), "is not JSON"));
  CHECK(has(refused(replaced(text, "[0,0]", "[1e999,0]")), "is not JSON"));
  CHECK(has(refused(replaced(text, "[0,0]", "[1e300,0]")), "/vertices_coords/0/0"));
  CHECK(has(refused("[1,2,3]"), "a FOLD file must be an object"));
  CHECK(has(refused("3"), "a FOLD file must be an object"));
}

TEST_CASE("brackets nested without end are refused", "[core][verify]") {
  CHECK(has(refused(std::string(200'000, '[')), "/"));
  const std::string bomb = "{\"popcut:bomb\":" + std::string(200'000, '[');
  CHECK(has(refused(bomb), "nested deeper than"));
  CHECK(has(refused("{\"file_frames\":[" + std::string(200'000, '{')), "JSON"));
  std::string objects = "{";
  for (int k = 0; k < 100'000; ++k) objects += "\"a\":{";
  CHECK(has(refused(objects), "nested deeper than"));
}

TEST_CASE("members of a wrong type are named by JSON pointer", "[core][verify]") {
  const std::string text = box_card().text();
  CHECK(has(refused(replaced(text, "[0,0]", "[0,\"0\"]")),
            "/vertices_coords/0/1: is a string; it must be a number"));
  CHECK(has(refused(replaced(text, "[0,0]", "[0,null]")),
            "/vertices_coords/0/1: is null; it must be a number"));
  CHECK(has(refused(replaced(text, "[0,0]", "[0,[0]]")),
            "/vertices_coords/0/1: is a list; it must be a number"));
  CHECK(has(refused(replaced(text, "[0,0]", "7")),
            "/vertices_coords/0: is a number; it must be a list"));
  CHECK(has(refused(replaced(text, "[0,0]", "[0]")),
            "/vertices_coords/0: a vertex has 1 coordinates"));
  CHECK(has(refused(replaced(text, "\"F\"", "7")), "/edges_assignment/"));
  CHECK(has(refused(replaced(text, "\"F\"", "\"Q\"")),
            "unknown assignment; use B, M, V, F, U, C or J"));
  CHECK(has(refused(replaced(text, "\"frame_unit\":\"mm\"", "\"frame_unit\":\"ell\"")),
            "/frame_unit: unknown unit"));
  CHECK(has(refused(replaced(text, "\"frame_parent\":0", "\"frame_parent\":9")),
            "/file_frames/0/frame_parent"));
  CHECK(has(refused(replaced(text, "\"frame_parent\":0", "\"frame_parent\":1")),
            "inherits from itself"));
  CHECK(has(refused(replaced(text, "\"file_frames\":[", "\"file_frames\":[5,")),
            "/file_frames/0: is a number; it must be"));
  CHECK(has(refused(replaced(text, "\"vertices_coords\"", "\"vertices_coord\"")),
            "/vertices_coords: missing"));
}

TEST_CASE("indices and lengths that do not agree are named", "[core][verify]") {
  FoldDraft draft = box_card();
  SECTION("an edge's vertex") {
    draft.edges[4][1] = 999;
    CHECK(has(refused(draft.text()), "/edges_vertices/4/1: there is no vertex 999"));
  }
  SECTION("a face's vertex") {
    draft.faces[2][3] = 1'000'000'000'000;
    CHECK(has(refused(draft.text()), "/faces_vertices/2/3: there is no vertex 1000000000000"));
  }
  SECTION("a negative or broken index") {
    const std::string text = draft.text();
    const std::string edge =
        "[" + std::to_string(draft.edges[0][0]) + "," + std::to_string(draft.edges[0][1]) + "]";
    const std::size_t from = text.find("edges_vertices");
    for (const char* bad : {"[-1,2]", "[0,1.5]", "[0]", "[0,1,2]", "[3,3]"}) {
      std::string broken = text;
      broken.replace(broken.find(edge, from), edge.size(), bad);
      CHECK(has(refused(broken), "/edges_vertices/0"));
    }
  }
  SECTION("assignments") {
    draft.assignment.pop_back();
    CHECK(has(refused(draft.text()), "/edges_assignment: 26 assignments for 27 edges"));
  }
  SECTION("fold angles of a frame") {
    draft.poses[1].angle_deg.pop_back();
    CHECK(
        has(refused(draft.text()), "/file_frames/1/edges_foldAngle: 26 fold angles for 27 edges"));
  }
  SECTION("vertices of a frame") {
    draft.poses[1].at.pop_back();
    CHECK(has(refused(draft.text()), "/file_frames/1/vertices_coords"));
  }
  SECTION("an angle past half a turn") {
    draft.key_angle_deg[0] = 200.0;
    CHECK(has(refused(draft.text()), "/edges_foldAngle/0"));
  }
}

TEST_CASE("null fold angles and null assignments are ignored", "[core][verify]") {
  std::string text =
      replaced(box_card().text(), "\"edges_foldAngle\":[0", "\"edges_foldAngle\":[null");
  CHECK(verify_fold(text)->ok());
  text = replaced(text, "\"V\"", "null");
  const auto report = value(verify_fold(text, {.degrees_of_freedom = 1}));
  INFO(verify_text(report));
  CHECK(report.ok());
}

TEST_CASE("assignments in lower case are read", "[core][verify]") {
  std::string text = box_card().text();
  for (const char letter : {'B', 'M', 'V'})
    for (const std::string capital{'"', letter, '"'}; text.find(capital) != text.npos;)
      text[text.find(capital) + 1] = static_cast<char>(letter - 'A' + 'a');
  const auto report = value(verify_fold(text, {.degrees_of_freedom = 1}));
  CHECK(report.ok());
}

TEST_CASE("the old name of fold angles and other units are understood", "[core][verify]") {
  std::string text = replaced(box_card().text(), "\"edges_foldAngle\":", "\"edges_foldAngles\":");
  text = replaced(text, "\"frame_unit\":\"mm\"", "\"frame_unit\":\"cm\"");
  const auto report = value(verify_fold(text, {.degrees_of_freedom = 1}));
  CHECK(report.ok());
  CHECK(report.sheet_u_mm == Approx(800.0));
}

TEST_CASE("a folded form in the key frame is taken as a pose of the flat frame", "[core][verify]") {
  // The same file with the first two frames exchanged.
  const FoldDraft draft = box_card();
  const std::string text = draft.text();
  const auto list = [&](std::size_t from) {
    const std::size_t at = text.find("\"vertices_coords\":", from);
    return std::pair(at, text.find("]]", at) + 2 - at);
  };
  const auto [key, key_size] = list(0);
  const auto [pose, pose_size] = list(text.find("1.1000000000000001,"));
  std::string swapped = text;
  swapped.replace(pose, pose_size, text.substr(key, key_size));
  swapped.replace(key, key_size, text.substr(pose, pose_size));
  const std::size_t last = swapped.rfind("foldedForm");
  swapped.replace(last, 10, "creasePattern");
  const std::size_t first = swapped.find("creasePattern");
  swapped.replace(first, 13, "foldedForm");
  const auto report = value(verify_fold(swapped));
  INFO(verify_text(report));
  CHECK(report.degrees_of_freedom == 1U);
  REQUIRE_FALSE(report.notes.empty());
  CHECK(has(report.notes.front(),
            "the key frame is a folded form; the flat sheet is /file_frames/2"));
}

TEST_CASE("sample files of other programs are read or refused as expected", "[core][verify]") {
  if (!std::filesystem::exists(kSamples)) {
    WARN("skipped: no sample files beside the source");
    return;
  }
  CHECK(has(refused(sample("fold_box.fold")), "folded form"));
  CHECK(has(refused(sample("fold_simple.fold")), "folded form"));
  CHECK(has(refused(sample("re_no-faces.fold")), "folded form"));
  CHECK(has(refused(sample("re_invalid-key-names.fold")), "/vertices_coords: missing"));
  CHECK(has(refused(sample("re_invalid-mismatch-length.fold")), "/edges_assignment"));
  const auto diagonal = value(verify_fold(sample("fold_diagonal-cp.fold")));
  CHECK(diagonal.ok());
  CHECK(diagonal.degrees_of_freedom == 1U);
  // A square twist that paper folds only by bending: no rigid motion has these assignments.
  const auto windmill = value(verify_fold(sample("re_windmill.fold")));
  INFO(verify_text(windmill));
  CHECK(windmill.faces == 9);
  CHECK_FALSE(windmill.ok());
  CHECK(has(verify_text(windmill), "wrong branch"));
  const auto panels = value(verify_fold(sample("re_panels-6x2-90deg.fold")));
  INFO(verify_text(panels));
  CHECK(panels.faces == 12);
  CHECK(panels.edges == 32);
  CHECK(panels.vertices == 21);
  CHECK(panels.pieces == 1);
  CHECK(panels.isometry_mm < 1e-12);
  CHECK(panels.fold_angle_deg < 1e-9);
  CHECK(panels.ok());
}

}  // namespace verify_input_test
