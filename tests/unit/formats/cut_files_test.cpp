// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/drawing/linework.hpp"
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/formats/write/profile_svg.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/value.hpp"

namespace cut_files_test {

using namespace popcut;

namespace {

/// A DXF as its pairs of code and value.
std::vector<std::pair<int, std::string>> pairs_of(const Pattern& pattern) {
  std::stringstream text;
  write_pattern_dxf(pattern, text);
  std::vector<std::pair<int, std::string>> pairs;
  for (std::string code, value; std::getline(text, code) && std::getline(text, value);)
    pairs.emplace_back(std::stoi(code), value);
  return pairs;
}

struct DxfLine {
  std::string layer;
  double x0{}, y0{}, x1{}, y1{};
};

std::vector<DxfLine> lines_of(const Pattern& pattern) {
  std::vector<DxfLine> lines;
  bool entities = false;
  for (const auto& [code, value] : pairs_of(pattern)) {
    if (code == 2 && value == "ENTITIES") entities = true;
    if (!entities) continue;
    if (code == 0 && value == "LINE") lines.emplace_back();
    if (lines.empty()) continue;
    DxfLine& line = lines.back();
    if (code == 8) line.layer = value;
    if (code == 10) line.x0 = std::stod(value);
    if (code == 20) line.y0 = std::stod(value);
    if (code == 11) line.x1 = std::stod(value);
    if (code == 21) line.y1 = std::stod(value);
  }
  return lines;
}

std::string cricut(const LineWork& work, const CricutMat& mat = {}) {
  std::ostringstream out;
  REQUIRE(write_cricut_svg(work, mat, out));
  return out.str();
}

}  // namespace

TEST_CASE("a DXF says R12 and millimetres", "[core][formats][dxf]") {
  const auto pairs = pairs_of(testing::box_card_pattern());
  std::map<std::string, std::string> header;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i)
    if (pairs[i].first == 9) header[pairs[i].second] = pairs[i + 1].second;
  CHECK(header["$ACADVER"] == "AC1009");
  CHECK(header["$INSUNITS"] == "4");
  CHECK(header["$MEASUREMENT"] == "1");
  CHECK(pairs.back() == std::pair<int, std::string>{0, "EOF"});
}

TEST_CASE("a DXF holds the sheet below the x axis and not mirrored", "[core][formats][dxf]") {
  const Pattern card = testing::box_card_pattern();
  const auto lines = lines_of(card);
  CHECK(lines.size() == card.lines.size());
  for (const DxfLine& line : lines) {
    CHECK(std::max({line.y0, line.y1}) <= 0);
    CHECK(std::min({line.x0, line.x1}) >= 0);
  }
  // Seen from the pop-up side the wall is on top: the box's slits at v = 20 and 45 reach from
  // u = 15.5 above the spine at 40 to 53.3 below it.
  const auto slits = std::count_if(lines.begin(), lines.end(), [](const DxfLine& line) {
    return line.layer == "CUT" && line.y0 == -15.5 && line.y1 == -53.3 &&
           (line.x0 == 20 || line.x0 == 45) && line.x0 == line.x1;
  });
  CHECK(slits == 2);
  const auto mountains = std::count_if(lines.begin(), lines.end(), [](const DxfLine& line) {
    return line.layer == "FOLD_M" && line.y0 == -28.8 && line.y1 == -28.8;
  });
  CHECK(mountains == 1);
  CHECK(std::count_if(lines.begin(), lines.end(),
                      [](const DxfLine& line) { return line.layer == "FOLD_V"; }) == 4);
  CHECK(lines.back().layer == "CUT");  // the outline comes last
}

TEST_CASE("a Cricut drawing is as large as the mat with each operation a group",
          "[core][formats][cricut]") {
  const LineWork dashed =
      micro_cut(linework_from_pattern(testing::box_card_pattern()), DashShape{}).work;
  std::string text = cricut(dashed);
  pugi::xml_document document;
  REQUIRE(document.load_string(text.c_str()));
  const auto svg = document.child("svg");
  CHECK(std::string(svg.attribute("width").value()) == "11.5in");
  CHECK(std::string(svg.attribute("viewBox").value()) == "0 0 828 828");
  CHECK(text.find("dasharray") == std::string::npos);
  std::size_t paths = 0;
  std::vector<std::string> colours;
  for (const auto& group : svg.children("g")) {
    colours.emplace_back(group.attribute("stroke").value());
    for (const auto& path : group.children("path")) {
      paths += 1;
      CHECK_FALSE(path.attribute("stroke"));  // one layer a colour
    }
  }
  CHECK(paths == dashed.lines.size());  // each dash is a solid path to cut
  CHECK(colours == std::vector<std::string>{"#000000"});
  const auto back = testing::value(linework_from_svg(text, SvgProfile::Cricut));
  CHECK(bounds(back).width() == Approx(70));
  CHECK(bounds(back).height() == Approx(70));
  // Whole folds are one path to score.
  text = cricut(linework_from_pattern(testing::box_card_pattern()));
  REQUIRE(document.load_string(text.c_str()));
  const auto score = document.child("svg").child("g");
  CHECK(std::string(score.attribute("id").value()) == "score");
  CHECK(std::distance(score.children("path").begin(), score.children("path").end()) == 1);
  CHECK(std::string(score.next_sibling("g").attribute("id").value()) == "cut");
}

TEST_CASE("a drawing that is too wide for the Cricut mat is rotated and not mirrored",
          "[core][formats][cricut]") {
  LineWork work;
  work.append(Operation::Cut, std::vector<PagePoint>{{10, 10}, {210, 10}, {210, 40}});
  const auto back = testing::value(linework_from_svg(cricut(work, {4, 9}), SvgProfile::Plain));
  REQUIRE(back.lines.size() == 1);
  const auto points = back.points_of(back.lines[0]);
  // The corner turns to the right (y down) before and after.
  const double turn = (points[1].x - points[0].x) * (points[2].y - points[1].y) -
                      (points[1].y - points[0].y) * (points[2].x - points[1].x);
  CHECK(turn == Approx(200 * 30));
  CHECK(bounds(back).height() == Approx(200));
  std::ostringstream out;
  const auto large = write_cricut_svg(work, {4, 4}, out);
  REQUIRE_FALSE(large);
  CHECK(large.error().kind == ErrorKind::Infeasible);
  CHECK(out.str().empty());
}

TEST_CASE("the DXF of a sheet has its lines in cutting order, at true size, y up",
          "[core][formats][dxf]") {
  LineWork work;
  const std::vector<PagePoint> dash{{10, 20}, {11.5, 20}}, pen{{1, 2}, {3, 2}};
  const std::vector<PagePoint> bend{{0, 0}, {10, 0}, {10, 5}};
  const std::vector<PagePoint> ring{{0, 0}, {40, 0}, {40, 30}, {0, 30}, {0, 0}};
  work.append(Operation::Draw, pen);
  work.append(Operation::FoldMountain, dash);
  work.append(Operation::FoldValley, dash);
  work.append(Operation::Cut, bend);
  work.append(Operation::Outline, ring);
  std::ostringstream out;
  write_sheet_dxf(work, {100, 50}, out);
  const auto read = testing::value(linework_from_dxf(out.str()));
  CHECK(read.warnings.size() == 1);  // folds of no side
  REQUIRE(read.lines.size() == 5);
  const Operation operations[] = {Operation::Draw, Operation::FoldValley, Operation::FoldValley,
                                  Operation::Cut, Operation::Cut};
  for (std::size_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    CHECK(read.lines[i].operation == operations[i]);
    const auto mine = work.points_of(work.lines[i]), theirs = read.points_of(read.lines[i]);
    REQUIRE(theirs.size() == mine.size());
    // The reader's page begins at the DXF's origin, which is the lower left corner of the sheet.
    for (std::size_t k = 0; k < mine.size(); ++k) {
      CHECK(theirs[k].x == Approx(mine[k].x));
      CHECK(theirs[k].y + 50 == Approx(mine[k].y));
    }
  }
  CHECK_THAT(out.str(), Catch::Contains("$INSUNITS\n70\n4\n"));
}

}  // namespace cut_files_test
