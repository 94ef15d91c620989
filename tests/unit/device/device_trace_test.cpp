// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "device/sim/simulate.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_trace_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

Trace two_strokes() {
  return value(simulate(bytes("FX10,1\x03!5,1\x03M200,100\x03"
                              "D200,300\x03"
                              "D400,300\x03"
                              "FX20,1\x03"
                              "M600,300\x03"
                              "D600,6500\x03J0\x03NONSENSE\x03"),
                        machine("cameo3")));
}

}  // namespace

TEST_CASE("lengths of a trace are those of the program", "[device][trace]") {
  const Trace trace = two_strokes();
  CHECK(trace.lifts == 2);
  CHECK(trace.cut_mm == Approx(10 + 10 + 310));
  CHECK(trace.travel_mm == Approx(10));
  CHECK(trace.home_mm == Approx(std::hypot(10, 5) + std::hypot(30, 325)));
  CHECK(trace.clipped_mm == Approx(325 - 304.8));
  REQUIRE(trace.strokes.size() == 2);
  const auto points = trace.points_of(trace.strokes[0]);
  REQUIRE(points.size() == 3);
  CHECK(points[0].x == Approx(5));
  CHECK(points[0].y == Approx(10));
  CHECK(points[2].x == Approx(15));
  CHECK(points[2].y == Approx(20));
}

TEST_CASE("trace.json has all of the trace", "[device][trace]") {
  const Trace trace = two_strokes();
  const auto json = nlohmann::json::parse(trace_json(trace));
  CHECK(json["cut_mm"] == 330.0);
  CHECK(json["travel_mm"] == 10.0);
  CHECK(json["lifts"] == 2);
  CHECK(json["seconds"].get<double>() > 1);
  CHECK(json["clipped_mm"].get<double>() == Approx(20.2));
  CHECK(json["machine"] == "cameo3");
  CHECK(json["unknown"] == nlohmann::json::array({"NONSENSE"}));
  REQUIRE(json["strokes"].size() == 2);
  CHECK(json["strokes"][1]["force"] == 20);
  CHECK(json["strokes"][1]["force_gf"] == 140);
  CHECK(json["strokes"][0]["tool"] == 1);
  CHECK(json["strokes"][0]["points"] == nlohmann::json({{5, 10}, {15, 10}, {15, 20}}));
  CHECK(json["settings"][0] == nlohmann::json({{"name", "force"}, {"values", {10, 1}}}));
  const auto summary = trace_summary(trace);
  CHECK_FALSE(summary.contains("strokes"));
  CHECK(summary["cut_mm"] == 330.0);
}

TEST_CASE("an empty trace is still a valid document", "[device][trace]") {
  const Trace empty;
  CHECK(nlohmann::json::parse(trace_json(empty))["strokes"].empty());
  pugi::xml_document svg;
  CHECK(svg.load_string(trace_svg(empty).c_str()));
}

TEST_CASE("cut.svg has a colour for each force and grey for what was clipped", "[device][trace]") {
  Trace trace = two_strokes();
  trace.machine = "<b>&\"mine\"";
  pugi::xml_document svg;
  REQUIRE(svg.load_string(trace_svg(trace).c_str()));
  const pugi::xml_node root = svg.child("svg");
  CHECK(std::string(root.attribute("width").value()).find("mm") != std::string::npos);
  std::vector<std::string> colours;
  int clipped = 0;
  int travel = 0;
  for (const pugi::xml_node path : root.children("path")) {
    const std::string kind = path.attribute("class").value();
    if (kind == "cut") colours.emplace_back(path.attribute("stroke").value());
    clipped += kind == "clipped";
    travel += kind == "travel";
  }
  REQUIRE(colours.size() == 2);
  CHECK(colours[0] != colours[1]);
  CHECK(clipped == 1);
  CHECK(travel == 1);
  CHECK(std::string(root.child("title").text().get()).find("<b>&\"mine\"") != std::string::npos);
}

}  // namespace device_trace_test
