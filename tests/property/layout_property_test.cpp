// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/layout/layout.hpp"
#include "core/layout/piece_lines.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/random_pattern.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace layout_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

constexpr double kNear = 1e-5;  // mm

struct Bit {
  PagePoint a, b;
  Operation operation{};
};

std::vector<Bit> bits_of(const LineWork& work) {
  std::vector<Bit> bits;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      bits.push_back({points[i - 1], points[i], line.operation});
  }
  return bits;
}

double from_line(const PagePoint& p, const Bit& bit) {
  const double l = distance(bit.a, bit.b);
  return std::abs((p.x - bit.a.x) * (bit.b.y - bit.a.y) - (p.y - bit.a.y) * (bit.b.x - bit.a.x)) /
         l;
}

double from_bit(const PagePoint& p, const Bit& bit) {
  const double l = distance(bit.a, bit.b);
  const double k = std::clamp(
      ((p.x - bit.a.x) * (bit.b.x - bit.a.x) + (p.y - bit.a.y) * (bit.b.y - bit.a.y)) / (l * l),
      0.0, 1.0);
  return distance(p, {bit.a.x + k * (bit.b.x - bit.a.x), bit.a.y + k * (bit.b.y - bit.a.y)});
}

// The parts of `bit` that `others` of an operation lie on, as how often each part is covered: total
// length once, and total length counted.
std::array<double, 2> covered(const Bit& bit, const std::vector<Bit>& others, bool folds) {
  const double l = distance(bit.a, bit.b);
  std::vector<std::array<double, 2>> parts;
  for (const Bit& other : others) {
    if (is_fold(other.operation) != folds || other.operation == Operation::Draw) continue;
    if (from_line(other.a, bit) > kNear || from_line(other.b, bit) > kNear) continue;
    const auto along = [&](const PagePoint& p) {
      return ((p.x - bit.a.x) * (bit.b.x - bit.a.x) + (p.y - bit.a.y) * (bit.b.y - bit.a.y)) / l;
    };
    const double t0 = std::max(0.0, std::min(along(other.a), along(other.b)));
    const double t1 = std::min(l, std::max(along(other.a), along(other.b)));
    if (t1 > t0) parts.push_back({t0, t1});
  }
  std::sort(parts.begin(), parts.end());
  double once = 0.0, all = 0.0, reached = 0.0;
  for (const auto& [t0, t1] : parts) {
    all += t1 - t0;
    once += std::max(0.0, t1 - std::max(t0, reached));
    reached = std::max(reached, t1);
  }
  return {once, all};
}

// The pieces of all sheets, moved back to where they were in the drawing, without marks.
std::vector<Bit> glued(const Layout& layout) {
  std::vector<Bit> bits;
  for (std::uint32_t s = 0; s < layout.sheets.size(); ++s) {
    std::vector<std::uint32_t> piece_of;
    const LineWork work = sheet_work(layout, s, piece_of);
    for (std::size_t i = 0; i < work.lines.size(); ++i) {
      const Placement& t = layout.pieces[piece_of[i]].transform;
      if (work.lines[i].operation == Operation::Draw) continue;
      const auto back = [&](const PagePoint& p) {  // the inverse of a rotation is its transpose
        const double x = p.x - t.x0, y = p.y - t.y0;
        return PagePoint{t.xx * x + t.yx * y, t.xy * x + t.yy * y};
      };
      const auto points = work.points_of(work.lines[i]);
      for (std::size_t k = 1; k < points.size(); ++k)
        bits.push_back({back(points[k - 1]), back(points[k]), work.lines[i].operation});
    }
  }
  return bits;
}

bool on_run(const PagePoint& p, const SeamRun& run) {
  const double n = (run.vertical ? p.x : p.y) - run.at, t = run.vertical ? p.y : p.x;
  return std::abs(n) < kNear && t > run.from - kNear && t < run.to + kNear;
}

bool on_seam(const PagePoint& p, const Layout& layout) {
  return std::any_of(layout.runs.begin(), layout.runs.end(),
                     [&](const SeamRun& run) { return on_run(p, run); });
}

bool on_tab(const PagePoint& p, const Layout& layout) {
  return std::any_of(layout.tabs.begin(), layout.tabs.end(), [&](const Tab& tab) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Bit edge{tab.corners[k], tab.corners[(k + 1) % 4], Operation::Outline};
      if (edge.a != edge.b && from_bit(p, edge) < kNear) return true;
    }
    return false;
  });
}

// Where a line of the drawing touches a run, or stops running along it.
std::vector<double> breaks(const SeamRun& run, const std::vector<Bit>& drawing) {
  std::vector<double> at{run.from, run.to};
  for (const Bit& bit : drawing) {
    const auto n = [&](const PagePoint& p) { return (run.vertical ? p.x : p.y) - run.at; };
    const auto t = [&](const PagePoint& p) { return run.vertical ? p.y : p.x; };
    const double na = n(bit.a), nb = n(bit.b);
    if (std::abs(na) < kNear) at.push_back(t(bit.a));
    if (std::abs(nb) < kNear) at.push_back(t(bit.b));
    if (na * nb < 0) at.push_back(t(bit.a) - na / (nb - na) * (t(bit.b) - t(bit.a)));
  }
  std::erase_if(at, [&](double x) { return x < run.from - kNear || x > run.to + kNear; });
  std::sort(at.begin(), at.end());
  return at;
}

void check_layout(const LineWork& drawing, const LayoutOptions& options, const Layout& layout) {
  const std::vector<Bit> lines = bits_of(drawing), pieces = glued(layout);
  const Box box = bounds(drawing);

  // Glued, they are the drawing: each line once, along seams once on either side.
  for (const Bit& line : lines) {
    const double l = distance(line.a, line.b);
    const auto [once, all] = covered(line, pieces, is_fold(line.operation));
    CHECK(once == Approx(l).margin(1e-4));
    if (is_fold(line.operation)) CHECK(all == Approx(l).margin(1e-4));
    if (all > l + 1e-4) {
      const PagePoint middle{(line.a.x + line.b.x) / 2, (line.a.y + line.b.y) / 2};
      CAPTURE(middle.x, middle.y);
      CHECK(std::any_of(layout.runs.begin(), layout.runs.end(), [&](const SeamRun& run) {
        return from_line(run.vertical ? PagePoint{run.at, run.from} : PagePoint{run.from, run.at},
                         line) < kNear;
      }));
    }
  }
  // And nothing else, but for seams and tabs.
  for (const Bit& bit : pieces) {
    const PagePoint middle{(bit.a.x + bit.b.x) / 2, (bit.a.y + bit.b.y) / 2};
    const double l = distance(bit.a, bit.b);
    if (covered(bit, lines, is_fold(bit.operation))[0] > l - 1e-4) continue;
    CHECK(bit.operation == Operation::Outline);
    CHECK((on_seam(middle, layout) || on_tab(middle, layout)));
  }
  // Each piece lies on its sheet, and none on another.
  for (std::uint32_t s = 0; s < layout.sheets.size(); ++s) {
    std::vector<std::uint32_t> piece_of;
    const LineWork work = sheet_work(layout, s, piece_of);
    const Box all = bounds(work);
    CHECK(all.x0 >= options.origin.x - kNear);
    CHECK(all.y0 >= options.origin.y - kNear);
    CHECK(all.x1 <= options.area_mm[0] + kNear);
    CHECK(all.y1 <= options.area_mm[1] + kNear);
    std::vector<Box> boxes(layout.pieces.size());
    for (std::size_t i = 0; i < work.lines.size(); ++i)
      for (const PagePoint& p : work.points_of(work.lines[i])) boxes[piece_of[i]].add(p);
    for (std::size_t a = 0; a < boxes.size(); ++a)
      for (std::size_t b = a + 1; b < boxes.size(); ++b) {
        if (boxes[a].empty() || boxes[b].empty()) continue;
        const bool apart = boxes[a].x1 <= boxes[b].x0 + kNear ||
                           boxes[b].x1 <= boxes[a].x0 + kNear ||
                           boxes[a].y1 <= boxes[b].y0 + kNear || boxes[b].y1 <= boxes[a].y0 + kNear;
        CHECK(apart);
      }
  }
  // Tabs keep clear of every line and of each other.
  for (std::size_t i = 0; i < layout.tabs.size(); ++i) {
    const Tab& tab = layout.tabs[i];
    for (std::size_t j = i + 1; j < layout.tabs.size(); ++j)
      CHECK_FALSE(tabs_meet(tab, layout.tabs[j], options.tabs.clearance_mm - kNear));
    CHECK(tab.depth_mm >= options.tabs.min_depth_mm - kNear);
    for (const Bit& line : lines) {
      double nearest = 1e300;
      for (int k = 0; k <= 20; ++k)
        for (std::size_t e = 1; e < 4; ++e) {
          const Bit edge{tab.corners[e - 1], tab.corners[e], Operation::Outline};
          const PagePoint p{edge.a.x + k / 20.0 * (edge.b.x - edge.a.x),
                            edge.a.y + k / 20.0 * (edge.b.y - edge.a.y)};
          nearest = std::min(nearest, from_bit(p, line));
        }
      CHECK(nearest >= options.tabs.clearance_mm - 1e-4);
    }
  }
  // Every stretch that no cut follows carries a tab, interval by interval.
  for (std::size_t r = 0; r < layout.runs.size(); ++r) {
    const SeamRun& run = layout.runs[r];
    const std::vector<double> at = breaks(run, lines);
    for (std::size_t i = 1; i < at.size(); ++i) {
      if (at[i] - at[i - 1] < 1e-4) continue;
      const double t = (at[i] + at[i - 1]) / 2;
      const PagePoint middle = run.vertical ? PagePoint{run.at, t} : PagePoint{t, run.at};
      const bool cut = std::any_of(lines.begin(), lines.end(), [&](const Bit& line) {
        return is_cut(line.operation) && from_bit(middle, line) < kNear;
      });
      const bool paper = middle.x > box.x0 && middle.x < box.x1 && middle.y > box.y0 &&
                         middle.y < box.y1;  // all of these sheets are rectangles
      const auto tabs = std::count_if(layout.tabs.begin(), layout.tabs.end(), [&](const Tab& tab) {
        const double a = run.vertical ? tab.corners[0].y : tab.corners[0].x;
        const double b = run.vertical ? tab.corners[3].y : tab.corners[3].x;
        return tab.run == r && std::min(a, b) > at[i - 1] && std::max(a, b) < at[i];
      });
      CAPTURE(run.vertical, run.at, at[i - 1], at[i]);
      if (cut || !paper)
        CHECK(tabs == 0);
      else
        CHECK(tabs >= 1);
    }
  }
}

// The drawing as it is after glueing: every seam is cut but where a tab's root bridges it. `skip`
// leaves out that tab.
LineWork as_glued(const LineWork& drawing, const Layout& layout, std::size_t skip) {
  LineWork work = drawing;
  for (const SeamRun& run : layout.runs) {
    const AxisLine line{run.vertical, run.at};
    for (const SeamStretch& stretch : run.uncut) {
      double at = stretch.from;
      for (std::uint32_t i = 0; i < stretch.tabs; ++i) {
        const Tab& tab = layout.tabs[stretch.first_tab + i];
        if (stretch.first_tab + i == skip) continue;
        const double a = run.vertical ? tab.corners[0].y : tab.corners[0].x;
        const double b = run.vertical ? tab.corners[3].y : tab.corners[3].x;
        work.append(Operation::Cut, std::array{line.point(at, 0), line.point(a, 0)});
        at = b;
      }
      work.append(Operation::Cut, std::array{line.point(at, 0), line.point(stretch.to, 0)});
    }
  }
  return work;
}

}  // namespace

TEST_CASE("Pieces that are joined over their tabs have the freedoms of the whole",
          "[layout][verify]") {
  std::mt19937 random(20261122);
  int judged = 0;
  const int all = testing::rounds(14, 2);
  for (int round = 0; round < all; ++round) {
    CAPTURE(round);
    const LineWork drawing = clean(random_linework(random, 2.5));
    const Box box = bounds(drawing);
    LayoutOptions options;
    options.area_mm = {0.7 * box.width(), 0.7 * box.height()};
    const auto layout = lay_out(drawing, options);
    if (!layout || layout->tabs.empty()) continue;
    const auto freedoms = [](const LineWork& work) {
      VerifyOptions verify;
      verify.page = true;
      const auto report = value(verify_fold(fold_from_linework(work), verify));
      return std::pair(report.degrees_of_freedom, report.pieces);
    };
    const auto whole = freedoms(drawing);
    CHECK(freedoms(as_glued(drawing, *layout, layout->tabs.size())) == whole);
    ++judged;
  }
  CHECK(2 * judged > all);
}

TEST_CASE("A piece's lines can be restored from its plan", "[layout]") {
  std::mt19937 random(77);
  int split = 0;
  const int all_rounds = testing::rounds(25, 3);
  for (int round = 0; round < all_rounds; ++round) {
    CAPTURE(round);
    const LineWork drawing = clean(random_linework(random, 2.5));
    const Box box = bounds(drawing);
    LayoutOptions options;
    options.area_mm = {std::max(60.0, 0.6 * box.width()), std::max(60.0, 0.7 * box.height())};
    const auto layout = lay_out(drawing, options);
    if (!layout || layout->pieces.size() < 2) continue;
    ++split;
    const LineIndex lines(drawing, 10.0);
    for (std::uint32_t i = 0; i < layout->pieces.size(); ++i) {
      CAPTURE(i);
      const SheetPiece& piece = layout->pieces[i];
      PlannedPiece planned{piece.transform, piece.share, {}, {}};
      const auto to_sheet = [&](const SeamRun& run, double from, double to) {
        const AxisLine line{run.vertical, run.at};
        return std::array{piece.transform(line.point(from, 0)), piece.transform(line.point(to, 0))};
      };
      for (const SeamRun& run : layout->runs) {
        if (run.lower != i && run.upper != i) continue;
        PlannedPiece::Seam seam{to_sheet(run, run.from, run.to), {}};
        for (const SeamStretch& s : run.uncut) seam.glued.push_back(to_sheet(run, s.from, s.to));
        planned.seams.push_back(std::move(seam));
      }
      for (const Tab& tab : layout->tabs)
        if (tab.on == i)
          planned.tabs.push_back({piece.transform(tab.corners[0]), piece.transform(tab.corners[1]),
                                  piece.transform(tab.corners[2]),
                                  piece.transform(tab.corners[3])});
      LineWork really;
      std::vector<PagePoint> points;
      for (std::uint32_t l = 0; l < piece.first_mark; ++l) {
        points.clear();
        for (const PagePoint& p : piece.work.points_of(piece.work.lines[l]))
          points.push_back(piece.transform(p));
        really.append(piece.work.lines[l].operation, points);
      }
      const std::vector<Bit> said = bits_of(lines_of_piece(drawing, lines, planned));
      const std::vector<Bit> made = bits_of(really);
      for (const auto& [ones, others] : {std::pair{&said, &made}, std::pair{&made, &said}})
        for (const Bit& bit : *ones) {
          const double l = distance(bit.a, bit.b);
          if (l < 1e-4) continue;
          const auto [once, all] = covered(bit, *others, is_fold(bit.operation));
          CAPTURE(bit.a.x, bit.a.y, bit.b.x, bit.b.y);
          CHECK(once == Approx(l).margin(1e-4));
          CHECK(all == Approx(l).margin(1e-4));
        }
    }
  }
  CHECK(5 * split >= 2 * all_rounds);
}

TEST_CASE("Pieces with tabs glue together to the drawing they were split from", "[layout]") {
  std::mt19937 random(20261121);
  int split = 0, refused = 0;
  const int all = testing::rounds(60, 3);
  for (int round = 0; round < all; ++round) {
    CAPTURE(round);
    const LineWork drawing = clean(random_linework(random, 2.5));
    const Box box = bounds(drawing);
    const auto side = [&](double of) {
      return std::max(60.0, of * std::uniform_real_distribution<double>(0.35, 1.1)(random));
    };
    LayoutOptions options;
    options.area_mm = {side(box.width()), side(box.height())};
    if (round % 5 == 0) options.origin = {5, 8};
    CAPTURE(box.width(), box.height(), options.area_mm[0], options.area_mm[1]);
    const auto layout = lay_out(drawing, options);
    if (!layout) {
      CHECK(layout.error().kind == ErrorKind::Infeasible);
      ++refused;
      continue;
    }
    if (layout->pieces.size() > 1) ++split;
    CHECK(layout->sheets.size() >= layout->least_sheets);
    check_layout(drawing, options, *layout);
  }
  CAPTURE(split, refused);
  CHECK(2 * split >= all);
  CHECK(4 * refused <= all);
}

}  // namespace layout_property_test
