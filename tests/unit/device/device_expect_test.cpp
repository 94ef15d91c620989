// SPDX-License-Identifier: MIT
#include <cmath>

#include <catch2/catch.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/plan.hpp"
#include "device/compare/expect.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_expect_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// A card of 83 x 61 mm that is like no mirror image of itself: an outline, three slits, four
/// folds, of which one is drawn in two parts and one is short.
LineWork card() {
  LineWork work;
  const auto line = [&](Operation operation, std::initializer_list<PagePoint> points) {
    work.append(operation, std::vector<PagePoint>(points));
  };
  line(Operation::Outline, {{10, 10}, {93, 10}, {93, 71}, {10, 71}, {10, 10}});
  line(Operation::Cut, {{20.013, 20.4}, {60.777, 20.4}});
  line(Operation::Cut, {{20.013, 50.031}, {60.777, 50.031}});
  line(Operation::Cut, {{70, 15}, {85.3, 33.3}, {88, 40}});
  line(Operation::FoldValley, {{20.013, 20.4}, {20.013, 50.031}});
  line(Operation::FoldMountain, {{40.4, 20.4}, {40.4, 30}});
  line(Operation::FoldMountain, {{40.4, 50.031}, {40.4, 30}});
  line(Operation::FoldValley, {{60.777, 20.4}, {60.777, 50.031}});
  line(Operation::FoldValley, {{75, 50}, {76.2, 51}});
  return work;
}

struct Bench {
  Machine machine = testing::machine("cameo3");
  Material material = value(find_material("paper-220"));
  PlannedSheet sheet;

  Bench() {
    PlanOptions options;
    options.place.at = PagePoint{10, 10};
    sheet = value(plan(card(), machine, material, options)).sheets.at(0);
  }

  [[nodiscard]] Trace cut(const Toolpath& path) const {
    JobOptions job;
    job.page_width_mm = sheet.area_mm[0];
    job.page_length_mm = sheet.area_mm[1];
    const EncodedProgram program = value(encode(path, machine, material, job));
    SimOptions options;
    options.unlimited = true;
    SimCutter sim = cutter(machine, options);
    sim.accept(program.view());
    sim.run_dry();
    return sim.trace();
  }
  [[nodiscard]] Expected by_sheet() const {
    Expected expected;
    expected.drawing = value(linework_from_svg(sheet_svg(sheet, "card"), SvgProfile::Popcut));
    return expected;
  }
  [[nodiscard]] Expected by_pattern() const {
    Expected expected;
    expected.drawing = placed(card(), sheet.transform);
    expected.dashes = material.dashes;
    return expected;
  }
};

std::string words(const Comparison& result) {
  std::string text;
  for (const std::string& failure : result.failures) text += failure + "\n";
  return text;
}

/// Fails against sheet and pattern alike, in words that have `telling` in them.
void fails(const Bench& bench, const Toolpath& path, const char* telling) {
  const Trace trace = bench.cut(path);
  for (const Expected& expected : {bench.by_sheet(), bench.by_pattern()}) {
    const Comparison result = compare(trace, expected);
    INFO(words(result));
    CHECK(result.failed > 0);
    CHECK(words(result).find(telling) != std::string::npos);
  }
}

std::size_t first_of(const Toolpath& path, Operation operation) {
  for (std::size_t k = 0; k < path.strokes.size(); ++k)
    if (path.strokes[k].operation == operation) return k;
  FAIL("no such stroke");
  return 0;
}

std::span<PagePoint> points_of(Toolpath& path, std::size_t stroke) {
  return std::span(path.points).subspan(path.strokes[stroke].first, path.strokes[stroke].count);
}

}  // namespace

TEST_CASE("a sheet cut as planned matches the expected one", "[device][expect]") {
  const Bench bench;
  const Trace trace = bench.cut(bench.sheet.path);
  for (const Expected& expected : {bench.by_sheet(), bench.by_pattern()}) {
    const Comparison result = compare(trace, expected);
    INFO(words(result));
    CHECK(result.failed == 0);
    CHECK(result.drawn_mm > 300);
    CHECK(expect(trace, expected));
  }
}

TEST_CASE("two passes are expected if the material needs them", "[device][expect]") {
  Bench bench;
  bench.material.cut.passes = 2;
  PlanOptions options;
  options.place.at = PagePoint{10, 10};
  bench.sheet = value(plan(card(), bench.machine, bench.material, options)).sheets.at(0);
  const Trace trace = bench.cut(bench.sheet.path);
  Expected pattern = bench.by_pattern();
  CHECK(compare(trace, pattern).failed > 0);
  pattern.cut_passes = 2;
  CHECK(words(compare(trace, pattern)).empty());
  CHECK(words(compare(trace, bench.by_sheet())).empty());
}

TEST_CASE("a missing cut is found and named with its place", "[device][expect]") {
  const Bench bench;
  Toolpath path = bench.sheet.path;
  path.strokes.erase(path.strokes.begin() +
                     static_cast<std::ptrdiff_t>(first_of(path, Operation::Cut)));
  fails(bench, path, "not cut from 0.000 to");
}

TEST_CASE("a missing dash is found", "[device][expect]") {
  const Bench bench;
  const std::size_t first = first_of(bench.sheet.path, Operation::FoldValley);
  for (std::size_t k = first; k < first + 8; ++k) {
    CAPTURE(k);
    Toolpath path = bench.sheet.path;
    path.strokes.erase(path.strokes.begin() + static_cast<std::ptrdiff_t>(k));
    fails(bench, path, "line");
  }
}

TEST_CASE("a doubled stroke is found", "[device][expect]") {
  const Bench bench;
  for (const Operation operation : {Operation::Cut, Operation::FoldValley, Operation::Outline}) {
    Toolpath path = bench.sheet.path;
    path.strokes.push_back(path.strokes[first_of(path, operation)]);
    fails(bench, path, "more often");
  }
}

TEST_CASE("a stray stroke is found", "[device][expect]") {
  const Bench bench;
  Toolpath path = bench.sheet.path;
  Stroke stray = path.strokes.front();
  stray.first = static_cast<std::uint32_t>(path.points.size());
  stray.count = 2;
  path.points.push_back({30, 60});
  path.points.push_back({33, 60});
  path.strokes.push_back(stray);
  fails(bench, path, "where nothing should be drawn");
}

TEST_CASE("a cut that is one machine unit off is found", "[device][expect]") {
  const Bench bench;
  for (const PagePoint by :
       {PagePoint{0.05, 0}, PagePoint{-0.05, 0}, PagePoint{0, 0.05}, PagePoint{0, -0.05}}) {
    for (std::size_t k = 0; k < bench.sheet.path.strokes.size(); ++k) {
      const bool fold = is_fold(bench.sheet.path.strokes[k].operation);
      Toolpath path = bench.sheet.path;
      for (PagePoint& p : points_of(path, k)) p = {p.x + by.x, p.y + by.y};
      CAPTURE(k, by.x, by.y);
      const Trace trace = bench.cut(path);
      CHECK(compare(trace, bench.by_sheet()).failed > 0);
      // A dash may lie anywhere on its fold: only beside it is it wrong.
      const bool beside = !fold || (by.x != 0 && k != 0);
      const auto points = bench.sheet.path.points_of(bench.sheet.path.strokes[k]);
      const bool upright = points.front().x == points.back().x;
      if (!fold || (beside && upright)) CHECK(compare(trace, bench.by_pattern()).failed > 0);
    }
  }
}

TEST_CASE("a mirrored sheet is found", "[device][expect]") {
  const Bench bench;
  for (const bool left_right : {true, false}) {
    Toolpath path = bench.sheet.path;
    for (PagePoint& p : path.points) (left_right ? p.x : p.y) = 103 - (left_right ? p.x : p.y);
    fails(bench, path, "where nothing should be drawn");
  }
}

TEST_CASE("a fold that is cut through is found", "[device][expect]") {
  const Bench bench;
  for (const LineWork pattern = card(); const std::size_t line : {4u, 7u}) {
    Toolpath path = bench.sheet.path;
    std::erase_if(path.strokes, [&](const Stroke& s) {
      return is_fold(s.operation) &&
             std::abs(path.points[s.first].x - (line == 4u ? 20.013 : 60.777)) < 1e-6;
    });
    Stroke solid = path.strokes.front();
    solid.first = static_cast<std::uint32_t>(path.points.size());
    solid.count = 2;
    for (const PagePoint& p : pattern.points_of(pattern.lines[line]))
      path.points.push_back(bench.sheet.transform(p));
    path.strokes.push_back(solid);
    const Comparison result = compare(bench.cut(path), bench.by_pattern());
    INFO(words(result));
    CHECK(result.failed > 0);
    CHECK(compare(bench.cut(path), bench.by_sheet()).failed > 0);
  }
}

TEST_CASE("a fold in short parts is found when each part is cut through", "[device][expect]") {
  Expected expected;
  Trace trace;
  trace.unit_mm = 0.05;
  for (int k = 0; k < 20; ++k) {
    const std::vector<PagePoint> part{{10, 10 + 2.0 * k}, {10, 12 + 2.0 * k}};
    expected.drawing.append(Operation::FoldValley, part);
    trace.strokes.push_back({static_cast<std::uint32_t>(trace.points.size()), 2});
    trace.points.insert(trace.points.end(), part.begin(), part.end());
  }
  const Comparison result = compare(trace, expected);
  INFO(words(result));
  CHECK(result.failed == 1);
}

TEST_CASE("allowed lines may be drawn or left out", "[device][expect]") {
  const Bench bench;
  Toolpath path = bench.sheet.path;
  Stroke mark = path.strokes.front();
  mark.first = static_cast<std::uint32_t>(path.points.size());
  mark.count = 2;
  path.points.push_back({30, 60});
  path.points.push_back({33, 60});
  path.strokes.insert(path.strokes.begin(), mark);
  Expected expected = bench.by_sheet();
  expected.also_allowed.append(Operation::Draw, std::vector<PagePoint>{{30, 60}, {35, 60}});
  CHECK(words(compare(bench.cut(path), expected)).empty());
  CHECK(words(compare(bench.cut(bench.sheet.path), expected)).empty());
}

TEST_CASE("lines outside the window are reported", "[device][expect]") {
  Expected expected;
  expected.drawing.append(Operation::Cut, std::vector<PagePoint>{{300, 10}, {320, 10}});
  expected.drawing.dashed = true;
  SimCutter sim = cutter(machine("cameo3"));
  sim.accept(
      bytes("M200,6000\x03"
            "D200,6400\x03"));
  sim.run_dry();
  const Comparison result = compare(sim.trace(), expected);
  INFO(words(result));
  CHECK(result.failed == 1);
  CHECK(words(result).find("15.200 mm fell outside") != std::string::npos);
}

}  // namespace device_expect_test
