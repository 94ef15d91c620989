// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/layout/layout.hpp"
#include "core/layout/marks.hpp"
#include "core/layout/nest.hpp"
#include "core/layout/packing.hpp"
#include "tests/support/value.hpp"

namespace layout_test {

using namespace popcut;

namespace {

void add(LineWork& work, Operation operation, std::vector<PagePoint> points) {
  work.append(operation, points);
}

LineWork sheet(double width, double height) {
  LineWork work;
  work.name = "sheet";
  add(work, Operation::Outline, {{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}});
  return work;
}

LayoutOptions on(double width, double height) {
  LayoutOptions options;
  options.area_mm = {width, height};
  return options;
}

double glued_from(const Layout& layout, double low, double high) {
  double sum = 0.0;
  for (const SeamRun& run : layout.runs)
    for (const SeamStretch& s : run.uncut)
      sum += std::max(0.0, std::min(s.to, high) - std::max(s.from, low));
  return sum;
}

}  // namespace

TEST_CASE("a drawing that fits stays one piece without seams", "[layout]") {
  const auto layout = testing::value(lay_out(sheet(100, 50), on(120, 60)));
  CHECK(layout.pieces.size() == 1);
  CHECK(layout.seams.empty());
  CHECK(layout.tabs.empty());
  CHECK(layout.least_sheets == 1);
  CHECK(layout.use.paper_mm2 == Approx(100.0 * 50.0));
  CHECK(layout.use.share() == Approx(100.0 * 50.0 / (120.0 * 50.0)));  // of what the piece reaches
  CHECK(layout.use.rows_share() == layout.use.share());
}

TEST_CASE("a drawing that fits when rotated is rotated and not split", "[layout]") {
  const auto layout = testing::value(lay_out(sheet(100, 50), on(60, 120)));
  REQUIRE(layout.pieces.size() == 1);
  const Placement& t = layout.pieces[0].transform;
  CHECK(t.xx * t.yy - t.xy * t.yx == 1.0);  // never mirrored
  CHECK(t.xx == 0.0);
}

TEST_CASE("a seam prefers cuts and glues only the rest", "[layout]") {
  LineWork work = sheet(200, 100);
  add(work, Operation::Cut, {{97, 15}, {97, 85}});
  const auto layout = testing::value(lay_out(work, on(120, 110)));
  REQUIRE(layout.pieces.size() == 2);
  REQUIRE(layout.runs.size() == 1);
  CHECK(layout.runs[0].vertical);
  CHECK(layout.runs[0].at == 97.0);
  CHECK(layout.glue_mm == Approx(30.0));
  REQUIRE(layout.runs[0].uncut.size() == 2);
  CHECK(layout.tabs.size() == 2);
}

TEST_CASE("no seam runs along a fold or nearer to it than the narrowest panel", "[layout]") {
  LineWork work = sheet(200, 100);
  for (int x = 60; x <= 140; x += 1)
    add(work, Operation::FoldValley, {{static_cast<double>(x), 0}, {static_cast<double>(x), 100}});
  // Every place between 60 and 140 is within half a millimetre of a fold: nothing is lawful there.
  LayoutOptions options = on(85, 110);
  options.min_panel_mm = 0.6;
  const auto refused = lay_out(work, options);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  options.area_mm = {160, 110};
  const auto layout = testing::value(lay_out(work, options));
  REQUIRE(layout.runs.size() == 1);
  CHECK((layout.runs[0].at < 60 || layout.runs[0].at > 140));
}

TEST_CASE("a piece of a drawing without outline gets a closed border", "[layout]") {
  LineWork work;
  add(work, Operation::Cut, {{0, 0}, {200, 0}, {200, 60}, {0, 60}, {0, 0}});
  add(work, Operation::Cut, {{10, 30}, {190, 30}});
  const auto layout = testing::value(lay_out(work, on(120, 70)));
  REQUIRE(layout.pieces.size() == 2);
  for (const SheetPiece& piece : layout.pieces)
    for (std::uint32_t l = 0; l < piece.first_mark; ++l)
      CHECK(piece.work.lines[l].operation == Operation::Cut);
}

TEST_CASE("a fold that a seam crosses splits its tabs", "[layout]") {
  LineWork work = sheet(200, 60);
  add(work, Operation::FoldMountain, {{0, 30}, {200, 30}});
  const auto layout = testing::value(lay_out(work, on(120, 70)));
  REQUIRE(layout.runs.size() == 1);
  REQUIRE(layout.runs[0].uncut.size() == 2);
  for (const Tab& tab : layout.tabs) {
    const auto [low, high] = std::minmax(tab.corners[0].y, tab.corners[3].y);
    CHECK((high < 30 || low > 30));
  }
}

TEST_CASE("a stepped seam changes its height only along cuts", "[layout]") {
  // Two strips whose folds leave no straight seam: room is at 35..50 on the left, 55..70 right.
  LineWork work = sheet(60, 105);
  add(work, Operation::Cut, {{30, 10}, {30, 95}});
  for (double y = 5; y < 105; y += 2.5) {
    if (y < 35 || y > 50) add(work, Operation::FoldValley, {{0, y}, {30, y}});
    if (y < 55 || y > 70) add(work, Operation::FoldValley, {{30, y}, {60, y}});
  }
  LayoutOptions options = on(65, 82);
  options.tabs.depth_mm = 4;
  const auto layout = testing::value(lay_out(work, options));
  CHECK(layout.pieces.size() == 2);
  bool stepped = false;
  for (const SeamRun& run : layout.runs) {
    if (!run.vertical) continue;
    stepped = true;
    CHECK(run.at == 30.0);
    CHECK(run.uncut.empty());
  }
  CHECK(stepped);
}

TEST_CASE("a stepped seam goes where strips beside a line are too narrow for a tab", "[layout]") {
  // As above, but at 58..102 a cut leaves a strip of 2 mm at the edge, in which no tab finds room.
  LineWork work = sheet(60, 170);
  add(work, Operation::Cut, {{30, 10}, {30, 160}});
  add(work, Operation::Cut, {{2, 58}, {2, 102}});
  for (double y = 5; y < 170; y += 2.5) {
    if (y < 60 || y > 112) add(work, Operation::FoldValley, {{0, y}, {30, y}});
    if (y < 62 || y > 78) add(work, Operation::FoldValley, {{30, y}, {60, y}});
  }
  LayoutOptions options = on(65, 140);
  options.tabs.depth_mm = 4;
  const auto layout = testing::value(lay_out(work, options));
  REQUIRE(layout.pieces.size() == 2);
  for (const SeamRun& run : layout.runs) {
    if (run.vertical || run.from > 0) continue;
    CHECK(run.at > 102.0);
    CHECK(run.at < 112.5);
  }
}

TEST_CASE("paper ends at its closed outline and is not glued beyond", "[layout]") {
  LineWork work;  // an L: 200 wide below, 60 wide above
  work.name = "L";
  add(work, Operation::Outline,
      {{0, 0}, {60, 0}, {60, 60}, {200, 60}, {200, 120}, {0, 120}, {0, 0}});
  add(work, Operation::Cut, {{90, 80}, {110, 80}, {110, 100}, {90, 100}, {90, 80}});  // a hole
  LayoutOptions options = on(130, 130);
  options.seams_x = {100};
  const auto layout = testing::value(lay_out(work, options));
  CHECK(layout.glue_mm == Approx(40.0));
  CHECK(glued_from(layout, 80, 100) == Approx(0.0));
  CHECK(glued_from(layout, 0, 60) == Approx(0.0));
}

TEST_CASE("a seam has a piece on both of its sides, whatever shape the paper has", "[layout]") {
  // The corner of the bounds that is beyond the paper is first, last, or in the middle.
  for (const std::vector<PagePoint>& outline :
       {std::vector<PagePoint>{{0, 0}, {300, 0}, {300, 100}, {100, 100}, {100, 300}, {0, 300}},
        std::vector<PagePoint>{{200, 0}, {300, 0}, {300, 300}, {0, 300}, {0, 200}, {200, 200}},
        std::vector<PagePoint>{
            {0, 0}, {100, 0}, {100, 200}, {200, 200}, {200, 0}, {300, 0}, {300, 300}, {0, 300}}}) {
    LineWork work;
    std::vector<PagePoint> closed = outline;
    closed.push_back(outline.front());
    add(work, Operation::Outline, closed);
    for (const double area : {110.0, 130.0, 160.0}) {
      const auto layout = lay_out(work, on(area, area));
      CAPTURE(area, outline.size());
      REQUIRE(layout);
      const std::size_t pieces = layout->pieces.size();
      CHECK_FALSE(layout->runs.empty());
      for (const SeamRun& run : layout->runs) {
        CHECK(run.lower < pieces);
        CHECK(run.upper < pieces);
        CHECK(run.seam < layout->seams.size());
      }
      for (const Tab& tab : layout->tabs) {
        CHECK(tab.on < pieces);
        CHECK(tab.under < pieces);
        CHECK(tab.run < layout->runs.size());
      }
      for (const PieceSeam& seam : layout->seams) CHECK(std::max(seam.lower, seam.upper) < pieces);
    }
  }
}

TEST_CASE("a requested seam is used or refused with the nearest valid one", "[layout]") {
  LineWork work = sheet(200, 100);
  add(work, Operation::FoldValley, {{70, 0}, {70, 100}});
  LayoutOptions options = on(150, 110);
  options.seams_x = {80};
  const auto taken = testing::value(lay_out(work, options));
  CHECK(taken.runs[0].at == 80.0);
  options.seams_x = {70};
  const auto refused = lay_out(work, options);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK(refused.error().place == "/options/seam-x");
  CHECK_THAT(refused.error().detail, Catch::Contains("along a fold"));
  CHECK_THAT(refused.error().detail, Catch::Contains("nearest valid place is"));
}

TEST_CASE("impossible tabs and areas are refused before anything is laid", "[layout]") {
  const LineWork work = sheet(200, 100);
  const auto refused = [&](auto&& change) {
    LayoutOptions options = on(120, 110);
    change(options);
    const auto layout = lay_out(work, options);
    REQUIRE_FALSE(layout);
    return layout.error();
  };
  CHECK(refused([](LayoutOptions& o) { o.tabs.depth_mm = -1; }).place == "/tabs/depth_mm");
  CHECK(refused([](LayoutOptions& o) { o.tabs.min_depth_mm = 9; }).place == "/tabs/min_depth_mm");
  CHECK(refused([](LayoutOptions& o) { o.tabs.side_rad = 0; }).place == "/tabs/side_deg");
  CHECK(refused([](LayoutOptions& o) { o.tabs.pitch_mm = std::nan(""); }).place ==
        "/tabs/pitch_mm");
  CHECK(refused([](LayoutOptions& o) { o.area_mm = {0, 100}; }).kind == ErrorKind::OutOfRange);
  CHECK(refused([](LayoutOptions& o) { o.origin = {119.5, 0}; }).place == "/options/at");
  // A mat smaller than a tab: no layout, said with the sizes.
  const Error small = refused([](LayoutOptions& o) { o.area_mm = {10, 10}; });
  CHECK(small.kind == ErrorKind::Infeasible);
  CHECK_THAT(small.detail, Catch::Contains("10.0 x 10.0 mm"));
}

TEST_CASE("a roll takes a long drawing in rows across it", "[layout]") {
  const auto layout = testing::value(lay_out(sheet(1000, 500), on(300, 3000)));
  CHECK(layout.sheets.size() == 1);
  CHECK(layout.pieces.size() == 2);
}

TEST_CASE("both sides of a seam carry its letter and ticks that meet", "[layout]") {
  const auto layout = testing::value(lay_out(sheet(200, 100), on(120, 110)));
  REQUIRE(layout.pieces.size() == 2);
  std::array<std::vector<double>, 2> ticks;
  for (std::size_t i = 0; i < 2; ++i) {
    const SheetPiece& piece = layout.pieces[i];
    REQUIRE(piece.first_mark < piece.work.lines.size());
    for (std::size_t l = piece.first_mark; l < piece.work.lines.size(); ++l) {
      CHECK(piece.work.lines[l].operation == Operation::Draw);
      const auto points = piece.work.points_of(piece.work.lines[l]);
      if (points.size() == 2 && points[0].y == points[1].y) ticks[i].push_back(points[0].y);
    }
    std::sort(ticks[i].begin(), ticks[i].end());
    CHECK(ticks[i].size() >= 2);
  }
  CHECK(std::includes(ticks[0].begin(), ticks[0].end(), ticks[1].begin(), ticks[1].begin() + 1));
  CHECK(layout.seams[0].label == "A");
  // Tabs of a card of parts have the first letters.
  LayoutOptions options = on(120, 110);
  options.letters_taken = 7;
  CHECK(testing::value(lay_out(sheet(200, 100), options)).seams[0].label == "H");
}

TEST_CASE("the marks of both seams of a narrow piece have a place each", "[layout]") {
  LayoutOptions options = on(200, 120);
  options.seams_y = {100, 108};
  const auto layout = testing::value(lay_out(sheet(150, 208), options));
  REQUIRE(layout.pieces.size() == 3);
  CHECK(layout.warnings.empty());  // each seam has its letter
  for (const SheetPiece& piece : layout.pieces) {
    const Box all = bounds(piece.share);
    const auto line = [&](std::size_t l) { return piece.work.points_of(piece.work.lines[l]); };
    for (std::size_t l = piece.first_mark; l < piece.work.lines.size(); ++l) {
      for (const PagePoint& p : line(l)) {
        CHECK(p.y >= all.y0);
        CHECK(p.y <= all.y1);
      }
      // Strokes of one letter meet; those of the letter of the other seam keep away. On the narrow
      // piece no stroke lies beside another one as if it were written twice.
      for (std::size_t k = piece.first_mark; k < l; ++k) {
        const PagePoint a = line(l).front(), b = line(k).front();
        CHECK((a == b || distance(a, b) > 0.4));
      }
    }
  }
}

TEST_CASE("seams are lettered A to Z then AA", "[layout]") {
  CHECK(seam_label(0) == "A");
  CHECK(seam_label(25) == "Z");
  CHECK(seam_label(26) == "AA");
  CHECK(seam_label(27) == "AB");
  CHECK(seam_label(701) == "ZZ");
  CHECK(seam_label(702) == "AAA");
}

TEST_CASE("letters have a bar below them so that they differ upside down", "[layout]") {
  for (const char c : std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.")) {
    CAPTURE(c);
    const auto strokes = single_stroke(std::string(1, c), 6.0);
    REQUIRE(strokes.size() >= 2);
    double top = 0.0, right = 0.0;
    for (const auto& stroke : strokes)
      for (const PagePoint& p : stroke) {
        top = std::min(top, p.y);
        right = std::max(right, p.x);
        CHECK(p.x >= 0.0);
        CHECK(p.y >= -6.0);
      }
    CHECK(right <= single_stroke_size(std::string(1, c), 6.0).x + 1e-12);
    CHECK(strokes.back()[0].y > 0.0);  // the bar
  }
}

TEST_CASE("packed rectangles lie on their sheets and not on each other", "[layout]") {
  std::vector<std::array<double, 2>> sizes;
  for (int i = 0; i < 60; ++i) sizes.push_back({20.0 + (i * 37) % 70, 10.0 + (i * 53) % 90});
  const auto packed = pack(sizes, {100, 110}, 3);
  const auto box = [&](std::size_t i) {
    const double w = sizes[i][packed[i].turned ? 1 : 0], h = sizes[i][packed[i].turned ? 0 : 1];
    return Box{packed[i].x, packed[i].y, packed[i].x + w, packed[i].y + h};
  };
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    CHECK(box(i).x1 <= 100 + 1e-9);
    CHECK(box(i).y1 <= 110 + 1e-9);
    for (std::size_t j = i + 1; j < sizes.size(); ++j) {
      if (packed[i].sheet != packed[j].sheet) continue;
      const Box a = box(i), b = box(j);
      CHECK((a.x1 + 3 <= b.x0 + 1e-9 || b.x1 + 3 <= a.x0 + 1e-9 || a.y1 + 3 <= b.y0 + 1e-9 ||
             b.y1 + 3 <= a.y0 + 1e-9));
    }
  }
}

namespace {

/// Half discs, wedges and hooks of many sizes; each closes in itself, or stroke by stroke.
std::vector<LineWork> odd_shapes(std::size_t count) {
  std::vector<LineWork> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = 18.0 + static_cast<double>((i * 29) % 31);
    std::vector<PagePoint> ring;
    if (i % 3 == 0)
      for (int k = 0; k <= 24; ++k)
        ring.push_back(
            {500.0 + r * std::cos(3.14159265 * k / 24), r * std::sin(3.14159265 * k / 24)});
    else if (i % 3 == 1)
      ring = {{10, 20}, {10 + 2 * r, 20}, {10, 20 + r}};
    else
      ring = {{0, 0}, {2 * r, 0}, {2 * r, 9}, {9, 9}, {9, 1.5 * r}, {0, 1.5 * r}};
    ring.push_back(ring.front());
    LineWork& work = out.emplace_back();
    if (i % 2 == 0) {
      add(work, Operation::Outline, ring);
      continue;
    }
    for (std::size_t k = 0; k + 1 < ring.size(); ++k)  // every other side the other way round
      add(work, Operation::Outline,
          k % 2 == 0 ? std::vector{ring[k], ring[k + 1]} : std::vector{ring[k + 1], ring[k]});
  }
  return out;
}

using Side = std::array<PagePoint, 2>;

double off_side(const PagePoint& p, const Side& side) {
  const double x = side[1].x - side[0].x, y = side[1].y - side[0].y;
  const double t =
      std::clamp(((p.x - side[0].x) * x + (p.y - side[0].y) * y) / (x * x + y * y), 0.0, 1.0);
  return std::hypot(p.x - side[0].x - t * x, p.y - side[0].y - t * y);
}

bool sides_cross(const Side& a, const Side& b) {
  const auto turn = [](const PagePoint& p, const PagePoint& q, const PagePoint& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
  };
  return turn(a[0], a[1], b[0]) != turn(a[0], a[1], b[1]) &&
         turn(b[0], b[1], a[0]) != turn(b[0], b[1], a[1]);
}

double apart(const std::vector<Side>& a, const std::vector<Side>& b) {
  double least = 1e9;
  for (const Side& s : a)
    for (const Side& t : b) {
      if (sides_cross(s, t)) return -1.0;
      for (const std::size_t end : {0u, 1u})
        least = std::min({least, off_side(s[end], t), off_side(t[end], s)});
    }
  std::size_t over = 0;  // whether one holds the other
  for (const Side& t : b)
    if ((t[0].y > a[0][0].y) != (t[1].y > a[0][0].y) &&
        a[0][0].x < t[0].x + (a[0][0].y - t[0].y) / (t[1].y - t[0].y) * (t[1].x - t[0].x))
      ++over;
  return over % 2 == 1 ? -1.0 : least;
}

double area_of_box(const LineWork& work) { return bounds(work).width() * bounds(work).height(); }

}  // namespace

TEST_CASE("shapes are nested apart from each other, on fewer sheets than their boxes", "[layout]") {
  const double width = GENERATE(150.0, 203.3), spacing = GENERATE(0.5, 3.0, 5.0);
  const std::array<double, 2> area{width, 250.0};
  const std::vector<LineWork> works = odd_shapes(45);
  std::vector<const LineWork*> pieces;
  std::vector<std::array<double, 2>> sizes;
  double paper = 0.0, boxes = 0.0;
  for (const LineWork& work : works) {
    pieces.push_back(&work);
    sizes.push_back({bounds(work).width(), bounds(work).height()});
    paper += paper_mm2(work), boxes += area_of_box(work);
  }
  CHECK(paper < 0.75 * boxes);
  const Nest made = nest(pieces, area, spacing), again = nest(pieces, area, spacing);
  std::vector<std::vector<Side>> sides(works.size());
  for (std::size_t i = 0; i < works.size(); ++i) {
    const NestedPiece& at = made.places[i];
    CHECK(at.sheet < made.sheets);
    CHECK((at.sheet == again.places[i].sheet && at.quarters == again.places[i].quarters &&
           at.x == again.places[i].x && at.y == again.places[i].y));
    const Box box = bounds(works[i]);
    for (const DrawnLine& line : works[i].lines) {
      const auto points = works[i].points_of(line);
      for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        Side side{points[k], points[k + 1]};
        for (PagePoint& p : side) {
          p = {p.x - box.x0, p.y - box.y0};
          double high = box.height(), wide = box.width();
          for (std::uint32_t q = 0; q < at.quarters; ++q, std::swap(high, wide))
            p = {high - p.y, p.x};
          p = {p.x + at.x, p.y + at.y};
          CHECK((p.x > -1e-6 && p.y > -1e-6 && p.x < area[0] + 1e-5 && p.y < area[1] + 1e-5));
        }
        sides[i].push_back(side);
      }
    }
  }
  for (std::size_t i = 0; i < works.size(); ++i)
    for (std::size_t j = i + 1; j < works.size(); ++j)
      if (made.places[i].sheet == made.places[j].sheet)
        CHECK(apart(sides[i], sides[j]) > spacing - 1e-5);
  std::uint32_t rows = 0;
  for (const PackedBox& box : pack(sizes, area, spacing)) rows = std::max(rows, box.sheet + 1);
  const double bound = std::ceil(paper / (area[0] * area[1]));
  CAPTURE(width, spacing, made.sheets, rows, bound);
  CHECK(made.sheets >= bound);
  CHECK(made.sheets <= rows);
  CHECK(made.sheets < rows);
}

TEST_CASE("the assembly names every piece and every seam", "[layout]") {
  const LineWork work = sheet(500, 300);
  const auto layout = testing::value(lay_out(work, on(200, 200)));
  const std::string svg = assembly_svg(layout, work);
  for (std::size_t i = 0; i < layout.pieces.size(); ++i)
    CHECK_THAT(svg, Catch::Contains(">" + std::to_string(i + 1) + "</text>"));
  std::size_t in_steps = 0;
  for (const auto& step : layout.steps) in_steps += step.size();
  CHECK(in_steps == layout.seams.size());
  for (const PieceSeam& seam : layout.seams)
    CHECK_THAT(svg, Catch::Contains(">" + seam.label + "</text>"));
  CHECK_THAT(svg, Catch::Contains("Glue in this order"));
  const auto whole = testing::value(lay_out(work, on(600, 400)));
  CHECK_THAT(assembly_svg(whole, work), !Catch::Contains("Glue in this order"));
}

}  // namespace layout_test
