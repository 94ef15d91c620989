// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/linework_checks.hpp"

namespace fold_writer_test {

using namespace popcut;
using nlohmann::json;

namespace {

json written(const Pattern& pattern, const FoldOptions& options = {}) {
  std::ostringstream out;
  const auto done = write_fold(pattern, options, out);
  REQUIRE(done);
  return json::parse(out.str());
}

}  // namespace

TEST_CASE("a FOLD file reads back as the pattern number for number", "[core][formats][fold]") {
  Pattern pattern = testing::box_card_pattern();
  pattern.vertices[3].x = 1.0 / 3.0;  // no short decimal
  const json fold = written(pattern);
  REQUIRE(fold["vertices_coords"].size() == pattern.vertices.size());
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i) {
    CAPTURE(i);
    CHECK(fold["vertices_coords"][i] ==
          json{pattern.u(pattern.vertices[i]), pattern.vertices[i].v});
  }
  REQUIRE(fold["edges_vertices"].size() == pattern.edges.size());
  for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
    CHECK(fold["edges_vertices"][e] == json{pattern.edges[e].from, pattern.edges[e].to});
  }
  REQUIRE(fold["faces_vertices"].size() == pattern.faces());
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    CHECK(fold["faces_vertices"][f] == json(std::vector<std::uint32_t>(face.begin(), face.end())));
  }
}

TEST_CASE("the key frame is the flat sheet with the fold angles of a right opening angle",
          "[core][formats][fold]") {
  const Pattern pattern = testing::box_card_pattern();
  const json fold = written(pattern);
  CHECK(fold["file_spec"] == 1.2);
  CHECK(fold["frame_unit"] == "mm");
  CHECK(fold["file_title"] == "box card");
  CHECK(fold["frame_classes"] == json{"creasePattern"});
  for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
    CAPTURE(e);
    const EdgeRole role = pattern.edges[e].role;
    const bool mountain = role == EdgeRole::Mountain, valley = role == EdgeRole::Valley;
    CHECK(fold["edges_assignment"][e] == (mountain ? "M" : valley ? "V" : "B"));
    CHECK(fold["edges_foldAngle"][e] == (mountain ? -90.0 : valley ? 90.0 : 0.0));
    CHECK(fold["edges_faces"][e].size() == (mountain || valley ? 2u : 1u));
  }
  const auto& roles = fold["edges_popcut:role"];
  CHECK(std::count(roles.begin(), roles.end(), "mountain") == 1);
  CHECK(std::count(roles.begin(), roles.end(), "valley") == 4);
  CHECK(std::count(roles.begin(), roles.end(), "outline") == 6);
  CHECK(std::count(roles.begin(), roles.end(), "slit") == 8);
}

TEST_CASE("each deployed frame has its angle and its own places and fold angles",
          "[core][formats][fold]") {
  const Pattern pattern = testing::box_card_pattern();
  const json fold = written(pattern, {"test", std::vector{0.4, std::numbers::pi}});
  REQUIRE(fold["file_frames"].size() == 2);
  for (const json& frame : fold["file_frames"]) {
    const double psi = frame["frame_popcut:psi_rad"];
    CHECK(frame["frame_classes"] == json{"foldedForm"});
    CHECK(frame["frame_parent"] == 0);
    CHECK(frame["frame_inherit"] == true);
    for (std::size_t i = 0; i < pattern.vertices.size(); ++i) {
      CHECK(frame["vertices_coords"][i] == json(posed(pattern.vertices[i], psi)));
    }
    for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
      CHECK(frame["edges_foldAngle"][e] == fold_angle_deg(pattern.edges[e].role, psi));
    }
  }
  CHECK(fold["file_frames"][0]["frame_popcut:psi_rad"] == 0.4);
  CHECK(fold["file_frames"][1]["frame_popcut:psi_rad"] == std::numbers::pi);
}

TEST_CASE("every key of a FOLD file is of the standard or popcut's own", "[core][formats][fold]") {
  const std::set<std::string> standard{
      "file_spec",       "file_creator",    "file_title",       "file_classes", "file_frames",
      "frame_title",     "frame_classes",   "frame_attributes", "frame_unit",   "frame_parent",
      "frame_inherit",   "vertices_coords", "edges_vertices",   "edges_faces",  "edges_assignment",
      "edges_foldAngle", "faces_vertices"};
  json fold = written(testing::box_card_pattern());
  fold.update(fold["file_frames"][0]);
  for (const auto& [key, value] : fold.items()) {
    CAPTURE(key);
    CHECK((standard.count(key) == 1 || key.find("_popcut:") != std::string::npos));
  }
}

TEST_CASE("a name with quotes and line breaks stays one JSON string", "[core][formats][fold]") {
  Pattern pattern = testing::box_card_pattern();
  pattern.name = "a \"b\"\n\\ \xc3\xa9 \xff";
  CHECK(written(pattern)["file_title"] == "a \"b\"\n\\ \xc3\xa9 \xef\xbf\xbd");
}

TEST_CASE("FOLD refuses values that JSON or a card cannot represent", "[core][formats][fold]") {
  std::ostringstream out;
  Pattern pattern = testing::box_card_pattern();
  const auto over = write_fold(pattern, {"test", std::vector{1.0, 3.5}}, out);
  REQUIRE_FALSE(over);
  CHECK(over.error().kind == ErrorKind::OutOfRange);
  CHECK(over.error().place == "fold frame 1");
  CHECK_FALSE(write_fold(pattern, {"test", std::vector{std::nan("")}}, out));
  pattern.vertices[2].z = std::numeric_limits<double>::infinity();
  CHECK_FALSE(write_fold(pattern, {}, out));
  CHECK(out.str().empty());
}

TEST_CASE("a FOLD with unsplit cuts gives the same drawing as the split one",
          "[core][formats][fold]") {
  const Pattern pattern = popcut::testing::box_card_pattern();
  FoldOptions options;
  std::ostringstream split, single;
  REQUIRE(write_fold(pattern, options, split));
  options.split_cuts = false;
  REQUIRE(write_fold(pattern, options, single));
  const auto text = nlohmann::json::parse(single.str());
  CHECK(text["frame_attributes"].back() == "cuts");
  CHECK_FALSE(text.contains("file_frames"));
  CHECK(text["faces_vertices"].size() == pattern.faces());
  std::size_t cuts = 0, borders = 0;
  for (std::size_t e = 0; e < text["edges_assignment"].size(); ++e) {
    const std::string letter = text["edges_assignment"][e];
    cuts += letter == "C" ? 1 : 0;
    borders += letter == "B" ? 1 : 0;
    CHECK(text["edges_faces"][e].size() == (letter == "B" ? 1U : 2U));
    const double angle = text["edges_foldAngle"][e];
    CHECK(angle == (letter == "M" ? -90 : letter == "V" ? 90 : 0));
  }
  CHECK(cuts > 0);
  CHECK(borders > 0);
  // Euler: one piece without holes.
  CHECK(text["vertices_coords"].size() + text["faces_vertices"].size() ==
        text["edges_vertices"].size() + 1);
  const auto one = linework_from_fold(single.str()), two = linework_from_fold(split.str());
  REQUIRE(one);
  REQUIRE(two);
  for (const Operation operation :
       {Operation::FoldMountain, Operation::FoldValley, Operation::Cut, Operation::Outline})
    CHECK(popcut::testing::total_mm(*one, operation) ==
          Approx(popcut::testing::total_mm(*two, operation)));
}

}  // namespace fold_writer_test
