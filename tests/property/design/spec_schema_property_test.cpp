// SPDX-License-Identifier: MIT
// The JSON Schema of a spec and its parser are made from one table: they accept the same specs.
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/rounds.hpp"

namespace spec_schema_property_test {

using namespace popcut;
using nlohmann::json;

namespace {

/// The shipped examples, and specs with every field that these have not.
std::vector<json> sound_specs() {
  std::vector<json> specs;
  for (const auto& file :
       std::filesystem::directory_iterator(popcut::testing::source_file("examples")))
    if (file.path().extension() == ".json") {
      std::ifstream in(file.path());
      specs.push_back(json::parse(in));
    }
  for (const char* text :
       {R"({"popcut": 1, "name": "a", "material": "vinyl", "fit": "nearest", "lattice": "slices",
            "solver": "slsqp", "min_panel_mm": 0.2, "max_step_over_mean": null,
            "surface": {"type": "grid", "file": "h.csv"}, "scale_mm": 2.5,
            "rotate_deg": [0, 90, 0], "translate_mm": [1, 2.5, -3], "units_per_slice": 3,
            "slices": 4, "widths_mm": [5, 6, 7, 8],
            "card": {"wall_mm": 90, "ground_mm": 80, "margin_mm": 10}})",
        R"({"popcut": 1, "surface": {"type": "implicit", "f": "x"}, "units_per_slice": 3,
            "slices": 4, "widths_mm": {"max_error_mm": 0.5, "length_mm": 90}, "card": false,
            "splay": {"alpha": [[0.1, 0.2], [0, 1]], "length_mm": 3, "ligament_mm": 0.7},
            "curvature": {"K_area": [0.1, -0.1], "H": 0.01, "first": [[1, 0, 1], [2, 0, 2]],
                          "second": [1, 0, 1], "weights": {"K": 2, "H": 0, "first": 1,
                          "second": 1}}})",
        R"({"popcut": 1, "style": "facets", "surface": {"type": "mesh", "file": "a.obj"},
            "facets": {"pitch_mm": 1, "strip_mm": 3, "from_mm": -2, "length_mm": 9,
                       "fold_cost_mm2": 0, "jump_cost_mm2": 1, "cut_cost_mm2": 2, "inward": true,
                       "hinge_cost_mm3": 200, "min_fold_mm": 5, "most_folds": 25},
            "card": {"margin_mm": 9}})",
        R"({"popcut": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 5,
            "surface": {"type": "profile", "z": "1 - x"},
            "splay": {"targets": [{"psi_rad": 1, "K": 0.2}, {"psi_rad": 2, "sign": "-",
                                   "margin_rad": 0.1}]}})",
        R"({"popcut": 1, "regions": [{"radius": "9", "units_per_slice": 2, "slices": 3,
            "width_mm": 6}, {"radius": "9", "units_per_slice": 2, "slices": 2,
            "widths_mm": [5, 6]}]})",
        R"({"popcut": 1, "surface": {"type": "composite", "radii": [60, 25, 40]}, "regions": [
            {"units_per_slice": 2, "slices": 3, "width_mm": 6},
            {"units_per_slice": 2, "slices": 3, "widths_mm": 6},
            {"units_per_slice": 2, "slices": 3, "width_mm": 6}]})",
        R"({"popcut": 1, "name": "p", "join": ["auto", "seam"], "join_tolerance_mm": 0.5,
            "lattice": "conformal", "card": {"margin_mm": 9}, "patches": [
            {"surface": {"type": "mesh", "file": "m.stl"}, "units_per_slice": 2, "slices": 3,
             "widths_mm": 6},
            {"name": "q", "regions": [{"radius": "9", "units_per_slice": 2, "slices": 3,
             "width_mm": 6}], "min_panel_mm": 0.3},
            {"surface": {"type": "revolution", "radius": "9"}, "units_per_slice": 2, "slices": 3,
             "widths_mm": 6, "fit": "exact"}]})",
        R"({"popcut": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 5,
            "surface": {"type": "revolution", "radius": {"points": [[0, 9], [5, 7.5], [20, 8]]}}})",
        R"({"popcut": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 5,
            "surface": {"type": "profile", "z": {"points": [[0, 9], [5, 7.5], [8, 0]]}}})",
        R"({"popcut": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 5,
            "surface": {"type": "loft", "stations": [{"y": 0, "curve": [[0, 9], [8, 0]]},
                                                     {"y": 20, "curve": [[0, 7], [9, 0]]}]}})",
        R"({"popcut": 1, "regions": [{"radius": {"points": [[0, 9], [18, 8]]},
            "units_per_slice": 2, "slices": 3, "width_mm": 6}]})",
        R"({"popcut": 1, "join": "sheet", "patches": [
            {"surface": {"type": "revolution", "radius": "9"}, "units_per_slice": 2, "slices": 3,
             "widths_mm": 6}, {"surface": {"type": "revolution", "radius": "9"},
             "units_per_slice": 2, "slices": 3, "widths_mm": 6}]})"})
    specs.push_back(json::parse(text));
  return specs;
}

/// What no schema can say: the parser's rules between fields.
bool is_rule_between_fields(const Error& error) {
  for (const char* words : {"widths for",
                            "in all",
                            "measures no area",
                            "weighs what is not asked for",
                            "are all 0",
                            "must be R1 > R3 > R2",
                            "must be three for a composite surface",
                            "contradicts the composite surface",
                            "which all have a radius",
                            "give a surface such as",
                            "words for",
                            "each patch needs its card",
                            "contradicts the regions' radii",
                            "where the point before it is",
                            "the point before it",
                            "on the wall",
                            "on the ground",
                            "begins above the ground",
                            "ends before the wall",
                            "as the first station",
                            "where the station before it",
                            "must be a radius of 0",
                            "facets hang on wall and ground",
                            "facets are made for 90 degrees",
                            "facets have none, so give another surface",
                            "a formula does not say where it ends"})
    if (error.detail.find(words) != std::string::npos) return true;
  return false;
}

void collect(json& value, std::vector<json*>& nodes) {
  nodes.push_back(&value);
  if (value.is_structured())
    for (json& inner : value) collect(inner, nodes);
}

/// One random change at a random place.
void mutate(json& spec, std::mt19937& random) {
  static const std::vector<json> values{nullptr,
                                        true,
                                        false,
                                        "x",
                                        "",
                                        "exact",
                                        -1,
                                        0,
                                        1,
                                        3,
                                        2.5,
                                        0.001,
                                        1e6,
                                        1e12,
                                        -1e12,
                                        json::array(),
                                        {1},
                                        {1, 2, 3},
                                        {1, "x", 3},
                                        {{1, 0, 1}, {1, 0, 1}},
                                        json::object(),
                                        {{"max_error_mm", 1}},
                                        {{"type", "mesh"}, {"file", "a"}}};
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  std::vector<json*> nodes;
  collect(spec, nodes);
  json& node = *nodes[below(nodes.size())];
  static const std::vector<std::string> names{
      "surface", "slices", "regions", "patches", "join", "widths_mm", "width_mm", "radius", "alpha",
      "K",       "sign",   "card",    "name",    "x",    "material",  "splay",    "H"};
  if (node.is_object() && below(2) == 0) {
    if (below(2) == 0 && !node.empty())
      node.erase(std::next(node.begin(), static_cast<std::ptrdiff_t>(below(node.size()))));
    else
      node[names[below(names.size())]] = values[below(values.size())];
  } else if (node.is_array() && !node.empty() && below(2) == 0) {
    if (below(2) == 0)
      node.erase(below(node.size()));
    else
      node.push_back(json(node[below(node.size())]));
  } else if (&node != &spec) {
    node = values[below(values.size())];
  }
}

}  // namespace

TEST_CASE("the schema of a spec accepts what the parser accepts and nothing else",
          "[core][spec][schema]") {
  const json schema = json::parse(design_spec_schema());
  const JsonSchema checker(schema);
  const std::vector<json> sound = sound_specs();
  for (const json& spec : sound) {
    CAPTURE(spec.dump());
    const auto read = parse_design_spec(spec.dump());
    INFO((read ? "" : message(read.error())));
    CHECK(read);
    CHECK(checker.faults(spec, schema) == std::vector<std::string>{});
  }
  std::mt19937 random(20130);
  const int changes = testing::rounds(20'000);
  int refused = 0;
  for (int k = 0; k < changes; ++k) {
    json spec = sound[static_cast<std::size_t>(k) % sound.size()];
    mutate(spec, random);
    const auto read = parse_design_spec(spec.dump());
    if (!read && is_rule_between_fields(read.error())) continue;
    const auto faults = checker.faults(spec, schema);
    if (read.has_value() == faults.empty()) {
      refused += read ? 0 : 1;
      continue;
    }
    CAPTURE(k, spec.dump(), faults);
    INFO((read ? "the parser accepts it" : message(read.error())));
    REQUIRE(read.has_value() == faults.empty());
  }
  CHECK(refused > changes / 4);
}

TEST_CASE("each field of the schema says what it means", "[core][spec][schema]") {
  const std::function<void(const json&, const std::string&)> check = [&](const json& schema,
                                                                         const std::string& at) {
    for (const char* several : {"oneOf", "anyOf"})
      if (schema.contains(several))
        for (const json& one : schema.at(several)) check(one, at);
    if (schema.contains("items")) check(schema.at("items"), at);
    if (!schema.contains("properties")) return;
    for (const auto& [name, field] : schema.at("properties").items()) {
      if (!field.is_object() || field.contains("$ref") || field.contains("const")) continue;
      CAPTURE(at + "/" + name);
      CHECK(field.contains("description"));
      check(field, at + "/" + name);
    }
  };
  check(json::parse(design_spec_schema()), "");
}

}  // namespace spec_schema_property_test
