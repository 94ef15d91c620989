// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/drawing/linework.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/picture/deployed_svg.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/value.hpp"

namespace drawings_test {

using namespace popcut;

namespace {

pugi::xml_document parsed(const std::string& text) {
  pugi::xml_document document;
  REQUIRE(document.load_string(text.c_str()));
  return document;
}

template <typename Write>
std::string text_of(Write write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

std::string pattern_svg(const Pattern& pattern) {
  return text_of([&](std::ostream& out) { write_pattern_svg(pattern, out); });
}

/// "M x,yL x,y" of every path of the layer `label`.
std::vector<std::string> paths(const pugi::xml_node& svg, const std::string& label) {
  std::vector<std::string> found;
  for (const auto& layer : svg.children("g")) {
    if (layer.attribute("inkscape:label").value() != label) continue;
    CHECK(std::string(layer.attribute("inkscape:groupmode").value()) == "layer");
    for (const auto& path : layer.children("path")) found.push_back(path.attribute("d").value());
  }
  return found;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("pattern.svg is the sheet in mm with the wall on top and not mirrored",
          "[core][formats][svg]") {
  const auto document = parsed(pattern_svg(testing::box_card_pattern()));
  const auto svg = document.child("svg");
  CHECK(std::string(svg.attribute("width").value()) == "70mm");
  CHECK(std::string(svg.attribute("height").value()) == "70mm");
  CHECK(std::string(svg.attribute("viewBox").value()) == "0 0 70 70");
  // x = v and y = u: the box stands at v 20..45, its slits run over u 15.5..53.3.
  CHECK(paths(svg, "cut") == std::vector<std::string>{"M20,15.5L20,53.3", "M45,15.5L45,53.3"});
  CHECK(paths(svg, "fold-mountain") == std::vector<std::string>{"M20,28.8L45,28.8"});
  CHECK(paths(svg, "fold-valley") == std::vector<std::string>{"M20,15.5L45,15.5",
                                                              "M20,53.3L45,53.3", "M0,40L20,40",
                                                              "M45,40L70,40"});
  CHECK(paths(svg, "outline").size() == 4);
}

TEST_CASE("each line of pattern.svg says what it is", "[core][formats][svg]") {
  const auto document = parsed(pattern_svg(testing::box_card_pattern()));
  const std::map<std::string, std::array<std::string, 3>> expected{
      {"fold-mountain", {"M", "-90", "#ff0000"}},
      {"fold-valley", {"V", "90", "#0000ff"}},
      {"cut", {"C", "0", "#000000"}},
      {"outline", {"B", "0", "#000000"}}};
  std::size_t seen = 0;
  for (const auto& layer : document.child("svg").children("g")) {
    const auto& [assignment, angle, colour] =
        expected.at(layer.attribute("inkscape:label").value());
    const std::string label = layer.attribute("inkscape:label").value();
    CHECK(layer.attribute("stroke-dasharray").empty() == (label.rfind("fold", 0) != 0));
    for (const auto& path : layer.children("path")) {
      CHECK(path.attribute("data-assignment").value() == assignment);
      CHECK(path.attribute("data-foldAngle").value() == angle);
      CHECK(path.attribute("stroke").value() == colour);
      ++seen;
    }
  }
  CHECK(seen == testing::box_card_pattern().lines.size());
}

TEST_CASE("a sheet without a card is drawn from the origin as far as its lines reach",
          "[core][formats][svg]") {
  Pattern pattern = testing::box_card_pattern();
  pattern.card = false;
  std::erase_if(pattern.lines, [](const SheetLine& line) { return line.role != EdgeRole::Slit; });
  const auto document = parsed(pattern_svg(pattern));
  const auto svg = document.child("svg");
  CHECK(std::string(svg.attribute("width").value()) == "45mm");
  CHECK(std::string(svg.attribute("height").value()) == "53.3mm");
  CHECK(std::string(svg.attribute("viewBox").value()) == "0 0 45 53.3");
}

TEST_CASE("a title cannot inject markup into a drawing", "[core][formats][svg]") {
  Pattern pattern = testing::box_card_pattern();
  pattern.name = "</title><script>'&\"\x01";
  const auto document = parsed(pattern_svg(pattern));
  CHECK(std::string(document.child("svg").child("title").text().get()) == "</title><script>'&\" ");
  CHECK(document.child("svg").child("script").empty());
}

TEST_CASE("cut.svg has every micro-cut as a solid path and cuts the outline last",
          "[core][formats][svg]") {
  const Pattern pattern = testing::box_card_pattern();
  const std::vector<SheetLine> dashes{{40, 1, 40, 2.5, EdgeRole::Valley},
                                      {40, 3.5, 40, 5, EdgeRole::Valley},
                                      {28.8, 21, 28.8, 22.5, EdgeRole::Mountain}};
  const std::string text = text_of([&](std::ostream& out) { write_cut_svg(pattern, dashes, out); });
  const auto document = parsed(text);
  const auto svg = document.child("svg");
  CHECK(text.find("stroke-dasharray") == std::string::npos);
  CHECK(paths(svg, "fold-valley") == std::vector<std::string>{"M1,40L2.5,40", "M3.5,40L5,40"});
  CHECK(paths(svg, "fold-mountain") == std::vector<std::string>{"M21,28.8L22.5,28.8"});
  CHECK(paths(svg, "cut").size() == 2);
  CHECK(std::string(svg.last_child().attribute("inkscape:label").value()) == "outline");
  CHECK(std::string(svg.child("g").attribute("inkscape:label").value()) == "fold-mountain");
}

TEST_CASE("a drawing reads back as the lines of the pattern", "[core][formats][svg]") {
  const Pattern pattern = testing::box_card_pattern();
  const LineWork expected = linework_from_pattern(pattern);
  const auto same_lines = [&](const LineWork& read) {
    REQUIRE(read.lines.size() == expected.lines.size());
    for (const DrawnLine& line : expected.lines) {
      const auto points = expected.points_of(line);
      CHECK(std::any_of(read.lines.begin(), read.lines.end(), [&](const DrawnLine& other) {
        const auto there = read.points_of(other);
        return other.operation == line.operation && there.size() == 2 &&
               distance(there[0], points[0]) < 1e-5 && distance(there[1], points[1]) < 1e-5;
      }));
    }
  };
  const auto looked_at =
      testing::value(linework_from_svg(pattern_svg(pattern), SvgProfile::Popcut));
  CHECK_FALSE(looked_at.dashed);
  same_lines(looked_at);
  std::vector<SheetLine> folds = pattern.lines;  // whole folds stand in for their dashes
  const auto cut = testing::value(linework_from_svg(
      text_of([&](std::ostream& out) { write_cut_svg(pattern, folds, out); }), SvgProfile::Popcut));
  CHECK(cut.dashed);
  same_lines(cut);
}

TEST_CASE("the deployed picture paints every face and stays in its frame",
          "[core][formats][picture]") {
  const Pattern card = testing::box_card_pattern();
  for (const double psi : {3.14159265358979, 1.5707963, 1.1, 0.05}) {
    CAPTURE(psi);
    const std::string text =
        text_of([&](std::ostream& out) { write_deployed_svg(card_scene(card), psi, View{}, out); });
    const auto document = parsed(text);
    // Three slabs: two of wall and ground, and between them two holes and the box's four panels.
    CHECK(count(text, "Z") == 2 + 2 + 4 + 2);
    const auto svg = document.child("svg");
    CHECK(svg.attribute("width").as_double() == 900);
    const double height = svg.attribute("height").as_double();
    for (const auto& path : svg.child("g").children("path")) {
      std::string d = path.attribute("d").value();
      for (char& c : d) c = (c == 'M' || c == 'L' || c == 'Z') ? ' ' : c;
      std::istringstream numbers(d);
      for (double x = 0, y = 0; numbers >> x >> y;) {
        CHECK((x >= 0 && x <= 900 && y >= 0 && y <= height));
      }
    }
  }
}

}  // namespace drawings_test
