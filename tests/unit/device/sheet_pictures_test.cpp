// SPDX-License-Identifier: MIT
// Pictures of sheets can be read when they are 600 pixels wide.
#include <algorithm>
#include <array>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

#include "core/drawing/linework.hpp"
#include "core/drawing/sheet_frame.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/plan.hpp"
#include "core/text/text_width.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/encode.hpp"
#include "tests/support/sim_bench.hpp"

namespace sheet_pictures_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

constexpr double kPixels = 600;

LineWork card(double width, double height) {
  LineWork work;
  work.name = "A card with a long name, which must not leave the picture, whatever it says";
  work.append(Operation::Outline,
              std::array<PagePoint, 5>{{{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}}});
  work.append(Operation::FoldValley,
              std::array<PagePoint, 2>{{{0, height / 2}, {width, height / 2}}});
  work.append(Operation::Cut,
              std::array<PagePoint, 2>{{{width / 3, height / 4}, {width / 3, height / 1.5}}});
  return work;
}

Plan planned(LineWork work, const std::string& mat = {}, const std::string& name = "cameo3") {
  PlanOptions options;
  options.mat = mat;
  return value(
      plan(std::move(work), machine(name.c_str()), value(find_material("paper-220")), options));
}

struct Picture {
  pugi::xml_document document;
  double x{}, y{}, width{}, height{};
  [[nodiscard]] double pixels(double mm) const { return mm * kPixels / width; }
};

Picture read(const std::string& svg) {
  Picture picture;
  REQUIRE(picture.document.load_string(svg.c_str()));
  std::istringstream box(picture.document.child("svg").attribute("viewBox").value());
  box >> picture.x >> picture.y >> picture.width >> picture.height;
  REQUIRE(picture.width > 0);
  return picture;
}

double inherited(pugi::xml_node node, const char* name) {
  for (; node; node = node.parent())
    if (const auto given = node.attribute(name)) return given.as_double();
  return 0.0;
}

// Letters of 10 pixels at least that do not leave the picture, and lines of at least 0.9.
void check_readable(const std::string& svg) {
  const Picture picture = read(svg);
  for (const auto& found : picture.document.select_nodes("//text")) {
    const pugi::xml_node text = found.node();
    CAPTURE(text.text().get());
    const double size = inherited(text, "font-size");
    CHECK(picture.pixels(size) >= 10);
    CHECK(text.attribute("x").as_double() >= picture.x);
    CHECK(text.attribute("x").as_double() + text_width(text.text().get(), size) <=
          picture.x + picture.width + 0.01);
    CHECK(text.attribute("y").as_double() <= picture.y + picture.height);
  }
  int lines = 0;
  for (const auto& found : picture.document.select_nodes("//path[@d]")) {
    const pugi::xml_node path = found.node();
    const std::string id = path.attribute("id").value(), look = path.attribute("class").value();
    const std::string stroke = path.attribute("stroke").value();
    const bool thin = id == "travel" || look == "travel" || stroke == "#3a9";  // on purpose
    if (thin || stroke.empty() || stroke == "none") continue;
    CHECK(picture.pixels(inherited(path, "stroke-width")) >= 0.9);
    ++lines;
  }
  CHECK(lines > 0);
}

// The drawing or the sheet fills at least half of the width that the words leave.
void check_filled(const std::string& svg, const Box& drawn, double sheet_width,
                  double share = 0.5) {
  const Picture picture = read(svg);
  const bool sheet = sheet_width > share * picture.width && picture.x <= 0 &&
                     picture.x + picture.width >= sheet_width;
  CHECK(
      (drawn.width() > share * picture.width || drawn.height() > share * picture.height || sheet));
}

}  // namespace

TEST_CASE("pictures of a plan have lines to see and words to read at every size",
          "[core][plan][picture]") {
  for (const auto& [width, height] : std::vector<std::pair<double, double>>{
           {20, 20}, {120, 150}, {300, 300}, {20, 290}, {290, 20}}) {
    CAPTURE(width, height);
    const Plan made = planned(card(width, height));
    REQUIRE(made.sheets.size() == 1);
    const PlannedSheet& sheet = made.sheets[0];
    const Box drawn = bounds(sheet.path.points);
    const std::string order = plan_svg(sheet, made.name + ": sheet 1");
    check_readable(order);
    check_filled(order, drawn, sheet.area_mm[0], width > 20 || height > 20 ? 0.4 : 0.2);
    const std::string assembly = assembly_svg(made);
    check_readable(assembly);
    check_filled(assembly, drawn, sheet.area_mm[0]);
  }
}

TEST_CASE("the picture of a simulated cut has lines to see and words to read",
          "[device][trace][picture]") {
  for (const char* name : {"cameo3", "hpgl-generic", "portrait"}) {
    CAPTURE(name);
    for (const auto& [width, height] :
         std::vector<std::pair<double, double>>{{20, 20}, {120, 150}, {190, 200}}) {
      CAPTURE(width, height);
      const Plan made = planned(card(width, height), {}, name);
      const PlannedSheet& sheet = made.sheets[0];
      JobOptions job;
      job.page_width_mm = sheet.area_mm[0];
      job.page_length_mm = sheet.area_mm[1];
      const auto program = value(encode(sheet.sent_path(), made.machine, made.material, job));
      SimOptions options;
      options.page_width_mm = sheet.area_mm[0];
      options.page_length_mm = sheet.area_mm[1];
      const Trace trace =
          value(simulate(std::as_bytes(std::span(program.bytes)), made.machine, options));
      const std::string svg = trace_svg(trace);
      check_readable(svg);
      // Small drawings leave room for words in letters of 2 mm.
      check_filled(svg, bounds(trace.points), sheet.area_mm[0], width > 20 ? 0.5 : 0.2);
    }
  }
}

TEST_CASE("a sheet to cut is the mat at true scale with lines to see and nothing else",
          "[core][plan][picture]") {
  const Plan made = planned(card(120, 150));
  const std::string svg = sheet_svg(made.sheets[0], "card");
  const Picture picture = read(svg);
  CHECK(picture.width == Approx(304.8));
  CHECK(picture.height == Approx(304.8));
  CHECK(std::string(picture.document.child("svg").attribute("width").value()) == "304.8mm");
  for (const auto& group : picture.document.child("svg").children("g"))
    CHECK(picture.pixels(group.attribute("stroke-width").as_double()) >= 0.7);
  CHECK(picture.document.select_nodes("//text").empty());
  CHECK(picture.document.select_nodes("//rect").empty());
  const auto back = value(linework_from_svg(svg, SvgProfile::Plain));
  CHECK(back.lines.size() == made.sheets[0].path.strokes.size());
}

TEST_CASE("the picture of how to glue pieces has lines to see", "[core][layout][picture]") {
  const Plan made = planned(card(400, 300), "200x200");
  REQUIRE(made.layout);
  const std::string svg = assembly_svg(made);
  const Picture picture = read(svg);
  for (const auto& found : picture.document.select_nodes("//path[@fill='none']"))
    CHECK(picture.pixels(found.node().attribute("stroke-width").as_double()) >= 0.5);
}

}  // namespace sheet_pictures_test
