// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/curvature/assembly_plot.hpp"
#include "core/plot/plot.hpp"

namespace plot_test {

using namespace popcut;

namespace {

plot::Map map_of(std::size_t side, double (*value)(double, double)) {
  plot::Map map;
  map.columns = map.rows = side;
  for (std::size_t row = 0; row < side; ++row)
    for (std::size_t column = 0; column < side; ++column)
      map.value.push_back(value(static_cast<double>(column), static_cast<double>(row)));
  map.least = -1;
  map.largest = 1;
  return map;
}

}  // namespace

TEST_CASE("a contour of a plane is one straight line and of a bowl one closed ring",
          "[core][curvature][plot]") {
  const auto line = contour_lines(map_of(11, [](double x, double) { return x - 4.25; }), 0.0);
  REQUIRE(line.size() == 1);
  CHECK(line[0].size() == 11);
  for (const plot::PlotPoint& p : line[0]) CHECK(p[0] == Approx(4.25));
  const auto ring = contour_lines(
      map_of(41, [](double x, double y) { return std::hypot(x - 20.0, y - 20.0); }), 12.3);
  REQUIRE(ring.size() == 1);
  CHECK(ring[0].front() == ring[0].back());
  for (const plot::PlotPoint& p : ring[0])
    CHECK(std::hypot(p[0] - 20, p[1] - 20) == Approx(12.3).margin(0.03));
}

TEST_CASE("a contour leaves out what is not finite", "[core][curvature][plot]") {
  plot::Map map = map_of(11, [](double x, double) { return x - 4.25; });
  map.value[5 * 11 + 4] = std::nan("");
  std::size_t points = 0;
  for (const auto& line : contour_lines(map, 0.0)) points += line.size();
  CHECK(points == 10);
}

TEST_CASE("ticks are round and within the axis", "[core][curvature][plot]") {
  CHECK(plot::ticks({"", 0.0, 1.0, false}) ==
        std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0});
  CHECK(plot::ticks({"", 8e-4, 0.5, true}).size() == 3);
  CHECK(plot::tick_text({"", 8e-4, 0.5, true}, 0.001) == "10⁻³");
  CHECK(plot::tick_text({"", -1, 1, false}, -0.5) == "−0.5");
  CHECK(plot::ticks({"", 1.0, 1.0, false}).empty());
}

TEST_CASE("drawings are well-formed and plain", "[core][curvature][plot]") {
  const std::string svg =
      assembly_maps_svg(assembly_maps(0.7, {0.5, 5.0, 20}, {0.2, 3.0, 15}), 0.7);
  pugi::xml_document document;
  REQUIRE(document.load_string(svg.c_str()));
  const pugi::xml_node root = document.child("svg");
  CHECK(root.attribute("width").as_double() == 2 * plot::kPanelWidth);
  for (const pugi::xml_node& node : root.children()) {
    const std::string name = node.name();
    const bool plain = name == "path" || name == "rect" || name == "text" || name == "circle";
    CHECK(plain);
  }
}

TEST_CASE("text in drawings is escaped", "[core][curvature][plot]") {
  plot::Panel panel;
  panel.title = "a < b & \"c\"";
  panel.x = {"x", 0, 1, false};
  panel.y = {"y", 0, 1, false};
  pugi::xml_document document;
  CHECK(document.load_string(plot::figure_svg(std::span(&panel, 1)).c_str()));
}

}  // namespace plot_test
