// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <map>
#include <random>

#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/pattern/pattern.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/plan/plan.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace plan_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

// An L with one mountain: nothing maps it onto itself, so every mirror shows. `u` is 60, `v` 40.
Pattern letter() {
  Pattern pattern;
  const std::array<std::array<double, 2>, 6> corners{
      {{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 40}, {0, 40}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& p = corners[i];
    const auto& q = corners[(i + 1) % corners.size()];
    pattern.lines.push_back({p[0], p[1], q[0], q[1], EdgeRole::Outline});
  }
  pattern.lines.push_back({40, 0, 40, 20, EdgeRole::Mountain});
  return pattern;
}

// Handedness as a person sees it (y up, counter-clockwise positive) of the corners of the L from
// its inner corner to its two ends; the sheet of (u, v) is seen with u to the right and v up.
double seen_handedness(const PagePoint& inner, const PagePoint& long_end,
                       const PagePoint& short_end) {
  return -((long_end.x - inner.x) * (short_end.y - inner.y) -
           (long_end.y - inner.y) * (short_end.x - inner.x));
}

LineWork random_lines(std::mt19937& random, int n) {
  LineWork work;
  for (int i = 0; i < n; ++i) {
    const auto operation = static_cast<Operation>(whole(random, 0, 5));
    const PagePoint at{uniform(random, 0, 200), uniform(random, 0, 200)};
    if (whole(random, 0, 3) == 0) {
      const double r = uniform(random, 1, 20);
      std::vector<PagePoint> loop;
      for (int k = 0; k < 6; ++k)
        loop.push_back({at.x + r * std::cos(k * 1.05), at.y + r * std::sin(k * 1.05)});
      loop.push_back(loop.front());
      draw(work, operation, loop);
    } else {
      draw(work, operation, {at, {at.x + uniform(random, -9, 9), at.y + uniform(random, -9, 9)}});
    }
  }
  return work;
}

}  // namespace

TEST_CASE("a pattern is never mirrored on the page or the sheet or when turned",
          "[core][plan][mirror]") {
  const LineWork page = linework_from_pattern(letter());
  // On the sheet the long arm ends at (u, v) = (60, 10) and the short one at (10, 40).
  const auto page_point = [](double u, double v) { return PagePoint{v, u}; };
  const double flat = 40.0 * 20.0;  // of (40, 0) x (0, 20) from the inner corner (20, 20) ...
  const PagePoint inner = page_point(20, 20), long_end = page_point(60, 20),
                  short_end = page_point(20, 40);
  CHECK(seen_handedness(inner, long_end, short_end) == Approx(flat));

  const Material paper = *find_material("paper-220");
  const auto check = [&](const Machine& machine, bool turned) {
    const auto done = value(plan(page, machine, paper, {}));
    const PlannedSheet& sheet = done.sheets[0];
    CHECK((sheet.transform.xy != 0.0) == turned);
    CHECK(sheet.transform.xx * sheet.transform.yy - sheet.transform.xy * sheet.transform.yx ==
          Approx(1.0));
    const auto& to = sheet.transform;
    CHECK(seen_handedness(to(inner), to(long_end), to(short_end)) == Approx(flat));
    // The strokes themselves: the mountain's dashes lie on the long arm, and the six corners of the
    // outline are the transformed corners.
    const PagePoint m0 = to(page_point(40, 0)), m1 = to(page_point(40, 20));
    int dashes = 0;
    for (const Stroke& stroke : sheet.path.strokes) {
      if (stroke.operation == Operation::FoldMountain) {
        ++dashes;
        for (const PagePoint& p : sheet.path.points_of(stroke))
          CHECK(distance_to(p, m0, m1) < 1e-9);
      }
      if (stroke.operation == Operation::Outline)
        for (const PagePoint& p : sheet.path.points_of(stroke)) {
          double nearest = 1e9;
          for (const SheetLine& line : letter().lines)
            nearest = std::min(nearest, distance(p, to(page_point(line.u0, line.v0))));
          CHECK(nearest < 1e-9);
        }
    }
    CHECK(dashes == 8);
  };
  check(*find_machine("cameo3"), false);
  check(*ideal_plotter(65, 45), true);
  check(*ideal_plotter(45, 65), false);
}

TEST_CASE("an L-shape has the same place on the page from FOLD and pattern and SVG",
          "[core][plan][mirror]") {
  const auto fold = value(linework_from_fold(
      R"x({"frame_unit":"mm","vertices_coords":[[0,0],[40,0],[60,0],[60,20],[40,20],
    [20,20],[20,40],[0,40]],"edges_vertices":[[0,1],[1,2],[2,3],[3,4],[4,5],[5,6],[6,7],[7,0],[1,4]],
    "edges_assignment":["B","B","B","B","B","B","B","B","M"]})x"));
  const LineWork own = clean(linework_from_pattern(letter()));
  const LineWork other = clean(fold);
  REQUIRE(own.lines.size() == 2);
  REQUIRE(other.lines.size() == 2);
  for (const LineWork* work : {&own, &other})
    for (const DrawnLine& line : work->lines) {
      const auto points = work->points_of(line);
      if (line.operation == Operation::FoldMountain) {
        CHECK(points[0].y == 40.0);
        CHECK(points[1].y == 40.0);
      } else {
        CHECK(std::abs(turning(points)) == Approx(2 * (60 * 20 + 20 * 20)));
      }
    }
}

TEST_CASE("dashes cover a fold evenly with valid gaps and paper at both ends",
          "[core][plan][dash]") {
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    DashShape shape;
    shape.gap_mm = uniform(random, 0.5, 2.0);
    shape.dash_mm = uniform(random, 0.6, 4.0);
    shape.clearance_mm = uniform(random, 0.2, shape.gap_mm);
    shape.min_dash_mm = uniform(random, 0.1, 0.5 * shape.dash_mm);
    const double free_mm = uniform(random, 0.0, 60.0);
    CAPTURE(round, shape.gap_mm, shape.dash_mm, shape.clearance_mm, shape.min_dash_mm, free_mm);
    std::vector<Dash> dashes;
    const std::size_t n = append_dashes(free_mm, 10.0, shape, dashes);
    REQUIRE(n == dashes.size());
    if (free_mm < shape.min_dash_mm) {
      CHECK(n == 0);
      continue;
    }
    REQUIRE(n > 0);
    const double lead = dashes.front().from - 10.0, tail = 10.0 + free_mm - dashes.back().to;
    CHECK(lead >= -1e-9);
    CHECK(lead == Approx(tail).margin(1e-9));
    CHECK(lead + shape.clearance_mm <= shape.gap_mm + 1e-9);
    for (std::size_t i = 0; i < n; ++i) {
      const double dash = dashes[i].to - dashes[i].from;
      CHECK(dash >= std::min(shape.min_dash_mm, free_mm) - 1e-9);
      if (lead == 0.0 && n > 1) CHECK(dash <= shape.dash_mm + 1e-9);
      if (i == 0) continue;
      const double gap = dashes[i].from - dashes[i - 1].to;
      CHECK(gap <= shape.gap_mm + 1e-9);
      CHECK(gap >= 0.75 * shape.gap_mm - 1e-9);
    }
  }
}

TEST_CASE("every stretch of a fold has its dashes or is listed as left out", "[core][plan][dash]") {
  std::mt19937 random(31);
  const DashShape shape = find_material("paper-220")->dashes;
  const double most = std::max(shape.gap_mm, 2 * shape.clearance_mm) + 0.05 + 1e-9;
  std::size_t shortened = 0, left_out = 0;
  for (int round = 0; round < 2000; ++round) {
    CAPTURE(round);
    LineWork work;
    const double l = std::pow(10.0, uniform(random, -1.0, 1.3));
    work.append(Operation::FoldValley, std::array<PagePoint, 2>{{{0, 0}, {l, 0}}});
    for (int cuts = whole(random, 0, 5); cuts > 0; --cuts) {
      const double x = uniform(random, 0, l), side = whole(random, 0, 1) == 0 ? 1.0 : -1.0;
      work.append(Operation::Cut, std::array<PagePoint, 2>{{{x, 0}, {x, 5 * side}}});
    }
    const Dashed dashed = micro_cut(work, shape);
    std::vector<Dash> covered;
    for (const DrawnLine& line : dashed.work.lines) {
      if (!is_fold(line.operation)) continue;
      const auto points = dashed.work.points_of(line);
      covered.push_back({points.front().x, points.back().x});
      CHECK(length(points) >= kLeastShare * shape.min_dash_mm - 1e-9);
      CHECK(points.front().x >= kLeastShare * shape.clearance_mm - 1e-9);
      CHECK(points.back().x <= l - kLeastShare * shape.clearance_mm + 1e-9);
      for (const DrawnLine& cut : work.lines)
        if (is_cut(cut.operation)) {
          const double x = work.points_of(cut).front().x;
          CHECK((x <= points.front().x - kLeastShare * shape.clearance_mm + 1e-9 ||
                 x >= points.back().x + kLeastShare * shape.clearance_mm - 1e-9));
        }
    }
    shortened += dashed.shortened;
    left_out += dashed.left_out.size();
    for (const LeftOut& left : dashed.left_out) covered.push_back(left.on);
    REQUIRE_FALSE(covered.empty());
    std::sort(covered.begin(), covered.end(),
              [](const Dash& a, const Dash& b) { return a.from < b.from; });
    double reached = 0.0;
    for (const Dash& dash : covered) {
      CHECK(dash.from - reached <= most);
      CHECK(dash.from >= reached - 1e-9);
      reached = dash.to;
    }
    CHECK(l - reached <= most);
  }
  CHECK(shortened > 100);
  CHECK(left_out > 100);
}

TEST_CASE("overlapping collinear lines are cut as their union and nothing twice",
          "[core][plan][clean]") {
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    const double angle = uniform(random, 0, 6.3), c = std::cos(angle), s = std::sin(angle);
    const int n = whole(random, 1, 60);
    LineWork work;
    std::vector<std::pair<double, double>> spans;
    for (int i = 0; i < n; ++i) {
      // Places on a lattice of 0.5 mm, so that ends meet and lines double.
      const double a = 0.5 * whole(random, 0, 400), b = a + 0.5 * whole(random, 1, 40);
      const double aside = uniform(random, -0.002, 0.002);
      spans.emplace_back(a, b);
      PagePoint p{100 + a * c - aside * s, 100 + a * s + aside * c};
      PagePoint q{100 + b * c - aside * s, 100 + b * s + aside * c};
      if (whole(random, 0, 1) == 1) std::swap(p, q);
      draw(work, Operation::Cut, {p, q});
    }
    std::sort(spans.begin(), spans.end());
    double covered = 0.0, reached = -1.0;
    std::size_t runs = 0;
    for (const auto& [a, b] : spans) {
      if (a > reached) ++runs;
      covered += std::max(0.0, b - std::max(a, reached));
      reached = std::max(reached, b);
    }
    const LineWork once = clean(work);
    CHECK(total_mm(once, Operation::Cut) == Approx(covered).margin(0.02 * n));
    CHECK(once.lines.size() == runs);
    CHECK(total_mm(clean(once), Operation::Cut) ==
          Approx(total_mm(once, Operation::Cut)).margin(1e-6));
  }
}

TEST_CASE("cleaning keeps every place of a drawing and adds none", "[core][plan][clean]") {
  std::mt19937 random(13);
  for (int round = 0; round < 20; ++round) {
    CAPTURE(round);
    LineWork work = random_lines(random, 60);
    const std::size_t before = work.lines.size();
    for (std::size_t i = 0; i < before; i += 2) {  // every second line doubled
      const auto points = work.points_of(work.lines[i]);
      draw(work, work.lines[i].operation, std::vector<PagePoint>(points.begin(), points.end()));
    }
    const LineWork once = clean(work);
    const auto covers = [](const LineWork& by, const PagePoint& p) {
      for (const DrawnLine& line : by.lines) {
        const auto points = by.points_of(line);
        for (std::size_t i = 1; i < points.size(); ++i)
          if (distance_to(p, points[i - 1], points[i]) < 0.03) return true;
      }
      return false;
    };
    double doubled = 0.0, single = 0.0;
    for (const DrawnLine& line : work.lines) {
      const auto points = work.points_of(line);
      doubled += length(points);
      for (std::size_t i = 1; i < points.size(); ++i)
        CHECK(covers(once,
                     {(points[i - 1].x + points[i].x) / 2, (points[i - 1].y + points[i].y) / 2}));
    }
    for (const DrawnLine& line : once.lines) {
      single += length(once.points_of(line));
      for (const PagePoint& p : once.points_of(line)) CHECK(covers(work, p));
    }
    CHECK(single < 0.8 * doubled);
  }
}

TEST_CASE("planned strokes lie inside the area and the totals add up", "[core][plan]") {
  std::mt19937 random(19);
  const Machine machine = *find_machine("cameo3");
  const Material paper = *find_material("paper-220");
  for (int round = 0; round < 25; ++round) {
    CAPTURE(round);
    LineWork work = random_lines(random, 80);
    PlanOptions options;
    options.place.at = PagePoint{uniform(random, -50, 150), uniform(random, -50, 150)};
    options.place.clip = true;
    const auto done = value(plan(work, machine, paper, options));
    const PlannedSheet& sheet = done.sheets[0];
    for (const PagePoint& p : sheet.path.points) {
      CHECK(p.x >= -1e-9);
      CHECK(p.y >= -1e-9);
      CHECK(p.x <= 304.8 + 1e-9);
      CHECK(p.y <= 304.8 + 1e-9);
    }
    double cut = 0.0, fold = 0.0;
    for (const Stroke& stroke : sheet.sent_path().strokes) {
      REQUIRE(stroke.count >= 2);
      const double mm = length(sheet.sent_path().points_of(stroke));
      if (is_cut(stroke.operation)) cut += mm;
      if (is_fold(stroke.operation)) fold += mm;
    }
    CHECK(cut == Approx(sheet.cut_mm));
    CHECK(fold == Approx(sheet.fold_mm));
    CHECK(sheet.fold_mm <= sheet.fold_line_mm);
  }
}

TEST_CASE("no drawing crashes or hangs its reader", "[core][formats][fuzz]") {
  const std::string fold =
      R"x({"file_spec":1.2,"frame_unit":"mm","vertices_coords":[[0,0],[3,0],[3,1],null,[1,0.5e1]],
    "edges_vertices":[[0,1],[1,2],[0,2]],"edges_assignment":["B","M",null],"edges_foldAngle":[0,-90,null],
    "faces_vertices":[[0,1,2]],"file_frames":[{"frame_parent":0,"frame_inherit":true,"vertices_coords":[[0,0,0],[3,0,1],[3,1,2]]}]})x";
  const std::string svg =
      R"x(<?xml version="1.0"?><!DOCTYPE svg><svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="5in"
    viewBox="0 0 10 20"><g transform="rotate(30 1 2) scale(2)" stroke="red"><path d="M0,0C1 2 3 4 5 6s1 1 2 2q1 1 2 0t3 3a3 4 30 0 1 2 2zm1 1h-1v2H3V4"
    stroke-dasharray="1 2 3" data-assignment="M"/><rect x="1" y="2" width="3" height="4" rx="1"/><circle r="3"/><polygon points="1,2 3,4 5 6"/></g></svg>)x";
  std::mt19937 random(23);
  const std::string alphabet = "0123456789.-+eE,[]{}\":<>/=MLCQAZz \x01\xff#\\";
  const int changes = testing::rounds(4000);
  int good = 0;
  for (int round = 0; round < changes; ++round) {
    CAPTURE(round);
    std::string text = round % 2 == 0 ? fold : svg;
    for (int edits = whole(random, 0, 6); edits > 0; --edits) {
      const auto at = static_cast<std::size_t>(whole(random, 0, static_cast<int>(text.size()) - 1));
      const auto n = static_cast<std::size_t>(whole(random, 1, 12));
      switch (whole(random, 0, 3)) {
        case 0:
          text[at] = alphabet[static_cast<std::size_t>(
              whole(random, 0, static_cast<int>(alphabet.size()) - 1))];
          break;
        case 1:
          text.erase(at, n);
          break;
        case 2:
          text.insert(at, text.substr(at / 2, n));
          break;
        default:
          text.insert(at, "9e99");
          break;
      }
      if (text.empty()) text = "{";
    }
    const auto work =
        round % 2 == 0 ? linework_from_fold(text) : linework_from_svg(text, SvgProfile::OrigamiSim);
    if (!work) {
      CHECK_FALSE(work.error().detail.empty());
      continue;
    }
    ++good;
    PlanOptions options;
    options.place.clip = true;
    const auto done = plan(*work, *find_machine("cameo3"), *find_material("paper-220"), options);
    if (!done) CHECK_FALSE(done.error().detail.empty());
  }
  CHECK(good > changes / 40);
}

}  // namespace plan_property_test
