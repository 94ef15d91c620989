// SPDX-License-Identifier: MIT
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/formats/write/report_json.hpp"
#include "core/formats/write/segments_csv.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/paths.hpp"

namespace segments_csv_test {

using namespace popcut;

namespace {

using Rows = std::vector<std::vector<double>>;

Rows rows_of(std::istream& text) {
  Rows rows;
  for (std::string line; std::getline(text, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

Rows written(const Strips& strips) {
  std::stringstream text;
  write_segments_csv(strips, text);
  return rows_of(text);
}

}  // namespace

TEST_CASE("segments.csv has one row of twelve columns per panel along its centre line",
          "[core][formats][csv]") {
  const Rows rows = written(testing::box_card_strips());
  REQUIRE(rows.size() == 8);
  for (const auto& row : rows) CHECK(row.size() == 12);
  // The box's top: from the wall outward at v = 32.5, 24.5 above the ground; a strip of 25 mm.
  CHECK(rows[3] == std::vector<double>{0, 32.5, 24.5, 13.3, 32.5, 24.5, 13.3, 7, 0, 1, 0, 50});
  CHECK(rows[4] == std::vector<double>{13.3, 32.5, 24.5, 13.3, 32.5, 0, 24.5, 7, 0, 1, 0, 50});
  CHECK(rows[0] == std::vector<double>{0, 10, 40, 0, 10, 0, 40, 7, -1, 0, 0, 40});
}

TEST_CASE("connectors carry the tags and flags of the published file", "[core][formats][csv]") {
  Strips strips = testing::box_card_strips();
  strips.kind[1] = StripKind::Connector;
  strips.slice[1] = 1;  // the second slice: this connector lies between two branches
  strips.level = {-1, -1, -1, 0, 1, -1, -1, -1};
  const Rows rows = written(strips);
  std::vector<double> tags, flags;
  for (const auto& row : rows) {
    tags.push_back(row[7]);
    flags.push_back(row[10]);
  }
  CHECK(tags == std::vector<double>{7, 7, 6, 6, 8, 6, 7, 7});
  CHECK(flags == std::vector<double>{0, 0, 1, 1, 1, 1, 0, 0});
}

TEST_CASE("the published file has the columns that popcut writes", "[core][formats][csv]") {
  std::ifstream file(popcut::testing::source_file("../shared/data/paper/inverted_sphere.csv"));
  if (!file) {
    WARN("skipped: data/paper/inverted_sphere.csv is not here");
    return;
  }
  const Rows rows = rows_of(file);
  REQUIRE(rows.size() == 116);
  for (const auto& row : rows) {
    REQUIRE(row.size() == 12);
    CHECK((row[7] == 6 || row[7] == 7 || row[7] == 8));
    // A connector inside a branch: 8 on odd levels, 6 on even ones.
    if (row[10] == 0 && row[7] != 7) CHECK(row[7] == (static_cast<int>(row[8]) % 2 == 1 ? 8 : 6));
    if (row[10] == 1) CHECK(row[7] != 7);
  }
}

TEST_CASE("report.json has the documented names and the computed values",
          "[core][formats][report]") {
  DesignReport report;
  report.name = "ball";
  report.units_per_slice = {5};
  report.slices = {{{0.125, 4}, 0, 20, 10}, {{0.25, 5}, 10, 30, 10}};
  report.lattice = report.lattice_asked = "conformal";
  report.faces = 7;
  report.cut_length_mm = 1.0 / 3.0;
  report.degrees_of_freedom = 1;
  report.sheet_u_mm = 210;
  report.sheet_v_mm = 130;
  report.inner_error = {0.1, 0.2};
  report.merged = {{3, 2, "connector", "too steep"}};
  const auto json = nlohmann::json::parse(report_json(report));
  for (const char* name :
       {"units_per_slice", "slices", "lattice", "faces", "panels", "folds", "cuts", "cut_length_mm",
        "fold_length_mm", "degrees_of_freedom", "pieces", "sheet_mm", "inner_error_mm",
        "end_error_mm", "step_over_mean", "gap_mm", "merged", "seconds"}) {
    CAPTURE(name);
    CHECK(json.contains(name));
  }
  CHECK(json["units_per_slice"] == 5);
  CHECK(json["sheet_mm"] == nlohmann::json{210.0, 130.0});
  CHECK(json["cut_length_mm"] == 1.0 / 3.0);
  CHECK(json["inner_error_mm"]["max"] == 0.2);
  CHECK(json["slices"][1]["v_mm"] == 30);
  CHECK(json["slices"][1]["iterations"] == 5);
  CHECK(json["merged"][0]["slice"] == 3);
  CHECK_FALSE(json.contains("lattice_note"));
  report.units_per_slice = {1, 2, 3};
  CHECK(nlohmann::json::parse(report_json(report))["units_per_slice"] == nlohmann::json{1, 2, 3});
}

}  // namespace segments_csv_test
