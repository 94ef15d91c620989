// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/plan/plan.hpp"
#include "tests/support/euler_count.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/value.hpp"

namespace clean_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// Walks along the edges of a lattice, some closed, some drawn twice or backwards; ends lie up to
/// `loose` mm beside the lattice.
LineWork lattice_walks(std::mt19937& random, double loose, double pitch) {
  LineWork work;
  const int size = whole(random, 3, 9);
  for (int lines = whole(random, 1, 60); lines > 0; --lines) {
    int x = whole(random, 0, size), y = whole(random, 0, size);
    std::vector<PagePoint> points{{x * pitch, y * pitch}};
    for (int steps = whole(random, 1, 12); steps > 0; --steps) {
      const bool along_x = whole(random, 0, 1) == 0;
      int& place = along_x ? x : y;
      place += place == 0 ? 1 : place == size ? -1 : whole(random, 0, 1) * 2 - 1;
      points.push_back({x * pitch, y * pitch});
    }
    const bool ring = points.front() == points.back();
    if (!ring)
      for (PagePoint* end : {&points.front(), &points.back()}) {
        end->x += uniform(random, -loose, loose);
        end->y += uniform(random, -loose, loose);
      }
    const Operation operation =
        std::array{Operation::Cut, Operation::Score,
                   Operation::Draw}[static_cast<std::size_t>(whole(random, 0, 2))];
    draw(work, operation, points);
    if (whole(random, 0, 3) == 0) {
      std::reverse(points.begin(), points.end());
      draw(work, operation, points);
    }
  }
  return work;
}

/// The same drawing without what a stronger operation covers, edge by edge.
LineWork strongest_only(const LineWork& work, double pitch) {
  const auto key = [&](const PagePoint& p) {
    return std::pair{std::llround(p.x / pitch), std::llround(p.y / pitch)};
  };
  std::map<std::pair<std::pair<long long, long long>, std::pair<long long, long long>>, Operation>
      strongest;
  const auto edge = [&](const PagePoint& a, const PagePoint& b) {
    return std::pair{std::min(key(a), key(b)), std::max(key(a), key(b))};
  };
  for (const DrawnLine& line : work.lines) {
    if (line.operation == Operation::Draw) continue;
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto [at, fresh] =
          strongest.try_emplace(edge(points[i - 1], points[i]), line.operation);
      if (!fresh) at->second = std::max<Operation>(at->second, line.operation);
    }
  }
  LineWork out;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      if (line.operation == Operation::Draw ||
          strongest[edge(points[i - 1], points[i])] == line.operation)
        draw(out, line.operation, {points[i - 1], points[i]});
  }
  return out;
}

}  // namespace

TEST_CASE("random drawings take the Euler minimum of strokes", "[core][plan][euler]") {
  std::mt19937 random(71);
  for (int round = 0; round < 400; ++round) {
    CAPTURE(round);
    const double pitch = uniform(random, 0.5, 12.0);
    const LineWork work = lattice_walks(random, 0.012, pitch);
    const LineWork cleaned = clean(work);
    EulerCount expected(strongest_only(work, pitch), kSnapTolerance);
    CHECK(cleaned.lines.size() == expected.strokes());
    // What is drawn is the union: each edge of the lattice once an operation.
    double all = 0.0;
    for (const DrawnLine& line : cleaned.lines) all += length(cleaned.points_of(line));
    double least = 0.0;
    std::set<std::tuple<Operation, long long, long long, long long, long long>> seen;
    const LineWork strongest = strongest_only(work, pitch);
    for (const DrawnLine& line : strongest.lines) {
      auto a = strongest.points_of(line)[0], b = strongest.points_of(line)[1];
      const auto near = [&](double v) { return std::llround(v / pitch); };
      if (std::pair{near(b.x), near(b.y)} < std::pair{near(a.x), near(a.y)}) std::swap(a, b);
      if (seen.insert({line.operation, near(a.x), near(a.y), near(b.x), near(b.y)}).second)
        least += distance(a, b);
    }
    CHECK(all == Approx(least).margin(0.05 * static_cast<double>(work.lines.size())));
  }
}

TEST_CASE("cleaning a clean drawing changes nothing", "[core][plan][clean]") {
  std::mt19937 random(72);
  for (int round = 0; round < 100; ++round) {
    CAPTURE(round);
    const LineWork once = clean(lattice_walks(random, 0.012, uniform(random, 0.5, 12.0)));
    const LineWork twice = clean(once);
    CHECK(twice.lines.size() == once.lines.size());
    double a = 0.0, b = 0.0;
    for (const DrawnLine& line : once.lines) a += length(once.points_of(line));
    for (const DrawnLine& line : twice.lines) b += length(twice.points_of(line));
    CHECK(b == Approx(a).margin(0.01));
  }
}

TEST_CASE("no line end moves farther than the snap distance", "[core][plan][clean]") {
  std::mt19937 random(73);
  for (const double snap : {0.0, 0.02, 0.05, 0.3}) {
    LineWork work;
    for (int k = 0; k < 3000; ++k) {
      std::vector<PagePoint> line{{uniform(random, 0, 20), uniform(random, 0, 20)}};
      for (int n = whole(random, 1, 4); n > 0; --n)
        line.push_back(
            {line.back().x + uniform(random, -1, 1), line.back().y + uniform(random, -1, 1)});
      draw(work, Operation::Cut, line);
    }
    const LineWork snapped = with_ends_snapped(work, snap);
    REQUIRE(snapped.points.size() == work.points.size());
    std::size_t moved = 0;
    for (std::size_t i = 0; i < work.points.size(); ++i) {
      const double by = distance(work.points[i], snapped.points[i]);
      CHECK(by <= std::max(snap, 0.001) + 1e-12);
      moved += by > 0.001 ? 1 : 0;
    }
    CHECK((moved > 0) == (snap > 0.0));
  }
}

TEST_CASE("line ends snap to the same places in any order of the lines", "[core][plan][clean]") {
  std::mt19937 random(74);
  for (int round = 0; round < 50; ++round) {
    CAPTURE(round);
    // Folds that nearly continue each other: which of three ends meet depends on who is first.
    std::vector<std::array<PagePoint, 2>> folds;
    for (int k = 0; k < 200; ++k) {
      const double y = 3.0 * whole(random, 0, 9) + uniform(random, -0.06, 0.06);
      const double x = 5.0 * whole(random, 0, 19);
      folds.push_back({PagePoint{x, y}, PagePoint{x + 5.0, y}});
    }
    const auto ends = [&] {
      LineWork work;
      for (const auto& fold : folds) draw(work, Operation::FoldValley, {fold[0], fold[1]});
      const LineWork snapped = with_ends_snapped(work, 0.05);
      std::vector<std::array<double, 4>> out;
      for (std::size_t i = 0; i < work.points.size(); ++i)
        out.push_back(
            {work.points[i].x, work.points[i].y, snapped.points[i].x, snapped.points[i].y});
      std::sort(out.begin(), out.end());
      return out;
    };
    const auto before = ends();
    std::shuffle(folds.begin(), folds.end(), random);
    CHECK(ends() == before);
  }
}

TEST_CASE("planned strokes are the cleaned lines in any order and direction",
          "[core][plan][order]") {
  std::mt19937 random(74);
  const Machine machine = *find_machine("cameo3");
  Material paper = *find_material("paper-220");
  paper.score.reset();  // which goes over each line twice
  for (int round = 0; round < 40; ++round) {
    CAPTURE(round);
    const LineWork work = lattice_walks(random, 0.012, uniform(random, 0.5, 12.0));
    PlanOptions options;
    options.place.at = PagePoint{20, 20};
    options.keep_lines = true;
    const auto done = value(plan(work, machine, paper, options));
    const PlannedSheet& sheet = done.sheets[0];
    REQUIRE(sheet.lines);
    REQUIRE(sheet.path.strokes.size() == sheet.lines->lines.size());
    std::vector<bool> seen(sheet.lines->lines.size(), false);
    for (const Stroke& stroke : sheet.path.strokes) {
      REQUIRE(stroke.line < seen.size());
      CHECK_FALSE(seen[stroke.line]);
      seen[stroke.line] = true;
      const DrawnLine& line = sheet.lines->lines[stroke.line];
      CHECK(line.operation == stroke.operation);
      const auto drawn = sheet.lines->points_of(line);
      const auto cut = sheet.path.points_of(stroke);
      REQUIRE(drawn.size() == cut.size());
      std::vector<PagePoint> a(drawn.begin(), drawn.end()), b(cut.begin(), cut.end());
      if (closed(drawn)) {
        CHECK(closed(cut));
        a.pop_back();
        b.pop_back();
      }
      std::sort(a.begin(), a.end());
      std::sort(b.begin(), b.end());
      CHECK(a == b);
      CHECK(length(drawn) == Approx(length(cut)));
      for (const PagePoint& p : cut) CHECK((p.x >= 0.0 && p.x <= 304.8 && p.y >= 0.0));
    }
  }
}

}  // namespace clean_property_test
