// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/drawing/clean.hpp"
#include "core/drawing/near_lines.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/cell_choice.hpp"
#include "core/machines/motion.hpp"
#include "core/pattern/pattern.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/plan/plan.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace plan_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

Machine cameo3() { return *find_machine("cameo3"); }
Material paper() { return *find_material("paper-220"); }

/// Seconds for one stroke with the tool down.
double path_seconds(const std::vector<PagePoint>& path, double speed_mm_s, const Motion& motion) {
  Stroke stroke{.operation = Operation::Cut,
                .count = static_cast<std::uint32_t>(path.size()),
                .speed_mm_s = speed_mm_s};
  return strokes_seconds({path, {stroke}}, motion) - motion.drop_s - motion.lift_s;
}

// A pop-up of one box, as a hand would draw it: outline, two slits, three folds.
LineWork card() {
  LineWork work;
  work.name = "card";
  draw(work, Operation::Outline, {{0, 0}, {100, 0}, {100, 120}, {0, 120}, {0, 0}});
  draw(work, Operation::Cut, {{30, 40}, {30, 90}});
  draw(work, Operation::Cut, {{70, 40}, {70, 90}});
  draw(work, Operation::FoldMountain, {{30, 70}, {70, 70}});
  draw(work, Operation::FoldValley, {{30, 40}, {70, 40}});
  draw(work, Operation::FoldValley, {{30, 90}, {70, 90}});
  draw(work, Operation::FoldValley, {{0, 60}, {30, 60}});
  draw(work, Operation::FoldValley, {{70, 60}, {100, 60}});
  return work;
}

}  // namespace

TEST_CASE("a doubled line is cut once", "[core][plan][clean]") {
  LineWork work;
  draw(work, Operation::Cut, {{0, 0}, {10, 0}});
  draw(work, Operation::Cut, {{10, 0}, {0, 0}});
  draw(work, Operation::Cut, {{4, 0.005}, {16, 0.005}});
  const LineWork once = clean(work);
  CHECK(total_mm(once, Operation::Cut) == Approx(16.0).margin(0.02));
  CHECK(once.lines.size() == 1);
}

TEST_CASE("lines that run close beside each other are told and cut once on request",
          "[core][plan][clean]") {
  const auto box = [](double x, double y, double w, double h) {
    return std::vector<PagePoint>{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}, {x, y}};
  };
  const auto circle = [](double r, int corners) {
    std::vector<PagePoint> line;
    for (int k = 0; k <= corners; ++k) {
      const double turn = k == corners ? 0.0 : 2 * kPi * k / corners;
      line.push_back({50 + r * std::cos(turn), 50 + r * std::sin(turn)});
    }
    return line;
  };
  const auto mm = [](const LineWork& work) {
    double all = 0.0;
    for (const DrawnLine& line : work.lines) all += length(work.points_of(line));
    return all;
  };
  CleanOptions once;
  once.one_pass_mm = 0.2;
  LineWork work;
  work.append(Operation::Cut, box(10, 10, 50, 40));
  work.append(Operation::Cut, box(10.05, 10.05, 50, 40));
  CHECK(in_one_pass(clean(work), kHardlyMeantMm).doubled_mm == Approx(180));
  CHECK(in_one_pass(clean(work), kHardlyMeantMm).apart_mm == Approx(0.05).margin(0.02));
  CHECK(mm(clean(work, once)) == Approx(180));
  // Curves with other corners.
  LineWork rings;
  rings.append(Operation::Cut, circle(30, 90));
  rings.append(Operation::Cut, circle(30.15, 97));
  CHECK(mm(clean(rings, once)) == Approx(2 * kPi * 30.15).epsilon(2e-3));
  // A side alone: what goes on comes to the line that stays.
  LineWork side;
  side.append(Operation::Cut, box(10, 10, 30, 20));
  side.append(Operation::Cut, box(40.1, 10, 30, 20));
  CHECK(mm(clean(side, once)) == Approx(180).margin(0.5));
  // One line that goes there and back.
  LineWork thin;
  thin.append(Operation::Cut, box(10, 10, 60, 0.1));
  CHECK(mm(clean(thin, once)) == Approx(60.2).margin(0.01));
  // A fold beside a cut is cut, and a warning says so.
  LineWork fold;
  fold.append(Operation::Cut, box(10, 10, 30, 20));
  fold.append(Operation::FoldValley, std::vector<PagePoint>{{10, 10.1}, {40, 10.1}});
  const LineWork cut = clean(fold, once);
  CHECK(mm(cut) == Approx(100));
  CHECK(cut.warnings.size() == 1);
  // What crosses, meets at a small angle, is small, or is drawn with a pen stays.
  LineWork apart;
  for (int k = 0; k < 20; ++k) apart.append(Operation::Cut, box(10.0 + k, 80, 0.15, 0.15));
  apart.append(Operation::Cut, std::vector<PagePoint>{{10, 100}, {150, 101}});
  apart.append(Operation::Cut, std::vector<PagePoint>{{10, 101}, {150, 100}});
  apart.append(Operation::Draw, box(10, 120, 30, 20));
  apart.append(Operation::Draw, box(10.1, 120.1, 30, 20));
  const LineWork plain = clean(apart);
  const SinglePass single = in_one_pass(plain, 0.02);
  CHECK(single.doubled_mm == 0);
  CHECK(mm(single.once) == Approx(mm(plain)));
}

TEST_CASE("a fold that lies on a cut is removed there", "[core][plan][clean]") {
  LineWork work;
  draw(work, Operation::FoldMountain, {{0, 5}, {20, 5}});
  draw(work, Operation::Cut, {{5, 5}, {12, 5}});
  const LineWork once = clean(work);
  CHECK(total_mm(once, Operation::Cut) == Approx(7.0));
  CHECK(total_mm(once, Operation::FoldMountain) == Approx(13.0));
  CHECK(count(once, Operation::FoldMountain) == 2);
}

TEST_CASE("lines that cross are left as they are", "[core][plan][clean]") {
  LineWork work;
  draw(work, Operation::Cut, {{0, 0}, {10, 10}});
  draw(work, Operation::Cut, {{0, 10}, {10, 0}});
  draw(work, Operation::FoldValley, {{5, -3}, {5, 20}});
  draw(work, Operation::Cut, {{-1, 0}, {10, 0.5}});
  const LineWork once = clean(work);
  CHECK(once.lines.size() == 4);
  CHECK(total_mm(once, Operation::Cut) == Approx(2 * std::hypot(10, 10) + std::hypot(11, 0.5)));
  CHECK(total_mm(once, Operation::FoldValley) == Approx(23.0));
}

TEST_CASE("cuts that meet end to end become one stroke and one loop is closed",
          "[core][plan][clean]") {
  LineWork work;
  draw(work, Operation::Outline, {{0, 0}, {10, 0}});
  draw(work, Operation::Outline, {{10, 10}, {10, 0}});
  draw(work, Operation::Outline, {{10, 10}, {0, 10}});
  draw(work, Operation::Outline, {{0, 10}, {0, 0.01}});
  draw(work, Operation::Cut, {{2, 2}, {4, 2}});
  draw(work, Operation::Cut, {{6, 2}, {4, 2}});
  const LineWork once = clean(work);
  REQUIRE(once.lines.size() == 2);
  CHECK(count(once, Operation::Outline) == 1);
  for (const DrawnLine& line : once.lines) {
    const auto points = once.points_of(line);
    if (line.operation == Operation::Outline) {
      CHECK(closed(points));
      CHECK(points.size() == 5);
    } else {
      CHECK(points.size() == 2);
      CHECK(length(points) == Approx(4.0));
    }
  }
}

TEST_CASE("without a mat the sheet names none", "[core][plan]") {
  LineWork work = test_shape();
  PlanOptions options;
  const Machine cameo = *find_machine("cameo3");
  const Material paper = *find_material("paper-220");
  CHECK(plan(work, cameo, paper, options)->sheets.at(0).mat.name == "12x12");
  options.mat_free = true;
  const auto planned = value(plan(work, cameo, paper, options));
  CHECK(planned.sheets.at(0).mat.name.empty());
  CHECK(planned.sheets.at(0).mat.code == 0);
}

TEST_CASE("the depth of an autoblade is set where the machine reports it or a person says so",
          "[core][plan]") {
  const auto seconds = [](const char* name, BladeKind blade) {
    PlanOptions options;
    options.blade = blade;
    const auto made = value(plan(card(), *find_machine(name), paper(), options));
    return made.sheets[0].seconds;
  };
  // A reset, and 0.45 s for each step above the lowest: captures of a Cameo 3.
  for (const char* name : {"cameo3", "cameo4"}) {
    const double tapped = seconds(name, BladeKind::Autoblade);
    CHECK(tapped - seconds(name, BladeKind::Ratchet) == Approx(8.7).margin(1));
    CHECK(seconds(name, BladeKind::Auto) ==
          (name == std::string("cameo4") ? tapped : seconds(name, BladeKind::Ratchet)));
  }
  PlanOptions wrong;
  wrong.blade = BladeKind::Autoblade;
  const auto refused = plan(card(), *find_machine("cameo2"), paper(), wrong);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place == "/options/blade");
  CHECK_THAT(refused.error().detail, Catch::Contains("Cameo 2 cannot hold an autoblade"));
}

TEST_CASE("pen lines stay under cuts", "[core][plan][clean]") {
  LineWork work;
  draw(work, Operation::Draw, {{0, 0}, {10, 0}});
  draw(work, Operation::Draw, {{0, 0}, {10, 0}});
  draw(work, Operation::Cut, {{0, 0}, {10, 0}});
  const LineWork once = clean(work);
  CHECK(total_mm(once, Operation::Draw) == Approx(10.0));
  CHECK(total_mm(once, Operation::Cut) == Approx(10.0));
}

TEST_CASE("the dashes of a fold follow the stated formula", "[core][plan][dash]") {
  const DashShape shape = paper().dashes;
  std::vector<Dash> dashes;
  CHECK(append_dashes(0.4, 0.0, shape, dashes) == 0);
  CHECK(append_dashes(1.5, 0.0, shape, dashes) == 1);
  dashes.clear();
  // 39 mm: n = ceil(40 / 2.5) = 16 dashes of exactly 1.5 mm with 15 gaps of exactly 1 mm.
  CHECK(append_dashes(39.0, 0.5, shape, dashes) == 16);
  CHECK(dashes.front().from == Approx(0.5));
  CHECK(dashes.back().to == Approx(39.5));
  CHECK(dashes[1].from - dashes[0].to == Approx(1.0));
  CHECK(dashes[0].to - dashes[0].from == Approx(1.5));
}

TEST_CASE("a cut that meets a fold in its middle keeps its clearance", "[core][plan][dash]") {
  LineWork work;
  draw(work, Operation::FoldValley, {{0, 0}, {30, 0}});
  draw(work, Operation::Cut, {{12, -5}, {12, 5}});   // crosses
  draw(work, Operation::Cut, {{20, 0}, {20, 9}});    // meets
  draw(work, Operation::Cut, {{25, 0.3}, {25, 9}});  // ends near
  const Dashed dashed = micro_cut(work, paper().dashes);
  CHECK(dashed.fold_line_mm == Approx(30.0));
  std::size_t dashes = 0;
  for (const DrawnLine& line : dashed.work.lines) {
    if (line.operation != Operation::FoldValley) continue;
    ++dashes;
    for (const PagePoint& p : dashed.work.points_of(line)) {
      CAPTURE(p.x);
      CHECK(std::abs(p.x - 12.0) >= 0.5 - 1e-9);
      CHECK(std::abs(p.x - 20.0) >= 0.5 - 1e-9);
      CHECK(std::hypot(p.x - 25.0, 0.3) >= 0.5 - 1e-9);
    }
  }
  CHECK(dashes >= 10);
}

TEST_CASE("folds keep clear of each of many cuts", "[core][plan][dash]") {
  LineWork work;
  for (int i = 0; i < 40; ++i)
    draw(work, Operation::FoldValley, {{0, 2.0 * i}, {40, 2.0 * i + 0.5}});
  for (int i = 0; i <= 3000; ++i) {
    const double x = 15.0 + i * 0.001;
    draw(work, Operation::Cut, {{x, -1}, {x, 90}});
  }
  for (int i = 0; i < 40; ++i)
    draw(work, Operation::Cut, {{30, 2.0 * i + 0.2}, {30, 2.0 * i + 1.0}});
  const DashShape shape = paper().dashes;
  const Dashed dashed = micro_cut(work, shape);
  std::vector<double> dashes_mm(work.lines.size(), 0.0);
  for (std::size_t i = 0; i < dashed.work.lines.size(); ++i) {
    const auto points = dashed.work.points_of(dashed.work.lines[i]);
    if (!is_fold(dashed.work.lines[i].operation)) continue;
    dashes_mm[dashed.line[i]] += length(points);
    const double x0 = points.front().x, x1 = points.back().x;
    CAPTURE(x0, x1);
    CHECK((x1 <= 15.0 - 0.49 || x0 >= 18.0 + 0.49));  // the cuts are not quite across the folds
    CHECK((x1 <= 30.0 - 0.49 || x0 >= 30.0 + 0.49));
  }
  // About 14 + 11 + 9 mm are free: six tenths of it are cut.
  for (std::size_t i = 0; i < 40; ++i) CHECK(dashes_mm[i] == Approx(0.62 * 34.0).epsilon(0.05));
}

TEST_CASE("a fold too short for a whole dash gets a shorter one in its middle",
          "[core][plan][dash]") {
  const DashShape shape = paper().dashes;
  CHECK(shortest_good_fold_mm(shape) == Approx(1.5));
  for (const double l : {0.76, 0.9, 1.2, 1.49}) {
    CAPTURE(l);
    LineWork work;
    draw(work, Operation::FoldMountain, {{3, 4}, {3 + l, 4}});
    const Dashed dashed = micro_cut(work, shape);
    REQUIRE(dashed.work.lines.size() == 1);
    CHECK(dashed.shortened == 1);
    CHECK(dashed.left_out.empty());
    const auto dash = dashed.work.points_of(dashed.work.lines[0]);
    CHECK(dash[0].x - 3.0 == Approx(3 + l - dash[1].x));  // in the middle
    CHECK(dash[0].x - 3.0 >= kLeastShare * shape.clearance_mm - 1e-9);
    CHECK(length(dash) >= kLeastShare * shape.min_dash_mm - 1e-9);
  }
}

TEST_CASE("between two cuts that meet a fold a dash is shortened before it is left out",
          "[core][plan][dash]") {
  LineWork work;
  draw(work, Operation::FoldValley, {{0, 0}, {30, 0}});
  draw(work, Operation::Cut, {{12, 0}, {12, 9}});
  draw(work, Operation::Cut, {{13, -9}, {13, 0}});
  const Dashed dashed = micro_cut(work, paper().dashes);
  CHECK(dashed.shortened == 1);
  CHECK(dashed.left_out.empty());
  const bool between =
      std::any_of(dashed.work.lines.begin(), dashed.work.lines.end(), [&](const DrawnLine& line) {
        const auto points = dashed.work.points_of(line);
        return is_fold(line.operation) && points[0].x > 12.2 && points[1].x < 12.8;
      });
  CHECK(between);
}

TEST_CASE("a fold without room for any dash is named, and scored where the machine can",
          "[core][plan][dash]") {
  LineWork work;
  draw(work, Operation::FoldMountain, {{3, 4}, {3.6, 4}});
  draw(work, Operation::FoldMountain, {{3, 9}, {33, 9}});
  const Dashed dashed = micro_cut(work, paper().dashes);
  REQUIRE(dashed.left_out.size() == 1);
  CHECK(dashed.left_out[0].on.to == Approx(0.6));
  const auto said = value(left_out_warning(dashed, paper().dashes, "stay uncut"));
  CHECK(said.message.find("stay uncut") != std::string::npos);
  CHECK(said.message.find("0.60 mm, at 3.30,4.00 mm") != std::string::npos);

  const auto scored_strokes = [&](const PlannedSheet& sheet) {
    return std::count_if(sheet.path.strokes.begin(), sheet.path.strokes.end(), [&](const auto& s) {
      return s.force_gf == paper().light->force_gf &&
             length(sheet.path.points_of(s)) == Approx(0.6);
    });
  };
  const auto cut = value(plan(work, cameo3(), paper(), {}));
  CHECK(scored_strokes(cut.sheets[0]) == 1);
  CHECK(cut.sheets[0].scored.size() == 1);
  REQUIRE(cut.warnings.size() == 1);
  CHECK(cut.warnings[0].message.find("cut half through") != std::string::npos);
  // A machine without settings of force and with one holder can only leave it out.
  Machine plain = cameo3();
  plain.force_gf.per_step = 0.0;
  plain.tool_holders = 1;
  const auto left = value(plan(work, plain, paper(), {}));
  CHECK(left.sheets[0].scored.size() == 0);
  CHECK(left.warnings[0].message.find("stay uncut") != std::string::npos);
}

TEST_CASE("folds come before cuts and inner cuts before outer ones and the outline last",
          "[core][plan][order]") {
  LineWork work = card();
  draw(work, Operation::Cut, {{40, 100}, {60, 100}, {60, 115}, {40, 115}, {40, 100}});
  draw(work, Operation::Cut, {{45, 105}, {55, 105}, {55, 110}, {45, 110}, {45, 105}});
  const auto plan_of = value(plan(work, cameo3(), paper(), {}));
  const Toolpath& path = plan_of.sheets[0].path;
  int stage = 0;
  double last_loop = 0.0;
  for (const Stroke& stroke : path.strokes) {
    const int now = is_fold(stroke.operation) ? 0 : stroke.operation == Operation::Cut ? 1 : 2;
    CHECK(now >= stage);
    stage = now;
    const auto points = path.points_of(stroke);
    if (stroke.operation == Operation::Cut && closed(points)) {
      CHECK(length(points) > last_loop);
      last_loop = length(points);
    }
  }
  CHECK(stage == 2);
  CHECK(last_loop == Approx(70.0));
}

TEST_CASE("a pattern too large for the mat is refused with both sizes or split",
          "[core][plan][sheet]") {
  LineWork work;
  draw(work, Operation::Outline, {{0, 0}, {320, 0}, {320, 310}, {0, 310}, {0, 0}});
  PlanOptions whole;
  whole.no_split = true;
  const auto refused = plan(work, cameo3(), paper(), whole);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK(refused.error().detail.find("320.0 x 310.0 mm") != std::string::npos);
  CHECK(refused.error().detail.find("304.8 x 304.8 mm") != std::string::npos);
  work = {};
  draw(work, Operation::Outline, {{0, 0}, {500, 0}, {500, 200}, {0, 200}, {0, 0}});
  const auto longer = plan(work, cameo3(), paper(), whole);
  REQUIRE_FALSE(longer);
  CHECK(longer.error().detail.find("`mat` 12x24") != std::string::npos);
  // Where it may be split it is, and the mat that would hold it whole is named.
  const auto split = value(plan(work, cameo3(), paper(), {}));
  REQUIRE(split.layout);
  CHECK(split.layout->pieces.size() == 2);
  const auto names = [](const Warning& w) {
    return w.message.find("`mat` 12x24") != std::string::npos;
  };
  CHECK(std::any_of(split.warnings.begin(), split.warnings.end(), names));
  CHECK(plan(work, cameo3(), paper(), {.mat = "12x24"}));
}

TEST_CASE("clipping cuts each segment exactly at the border", "[core][plan][sheet]") {
  LineWork work;
  work.has_page = true;
  draw(work, Operation::Cut, {{10, 10}, {350, 10}, {350, 50}, {10, 50}});
  PlanOptions options;
  options.place.clip = true;
  const auto done = value(plan(work, cameo3(), paper(), options));
  const PlannedSheet& sheet = done.sheets[0];
  CHECK(sheet.cut_mm == Approx(2 * 294.8));
  REQUIRE(sheet.path.strokes.size() == 2);
  for (const PagePoint& p : sheet.path.points) {
    CHECK(p.x <= 304.8);
    CHECK((p.x == Approx(10.0) || p.x == Approx(304.8)));
  }
}

TEST_CASE("a clipped closed line continues through its start point", "[core][plan][sheet]") {
  LineWork work;
  draw(work, Operation::Cut, {{50, 20}, {50, 40}, {150, 40}, {150, 20}, {50, 20}});
  const LineWork part = clipped(work, {100.0, 100.0});
  REQUIRE(part.lines.size() == 1);
  CHECK(length(part.points_of(part.lines[0])) == Approx(120.0));
  const LineWork inside = clipped(work, {200.0, 100.0});
  REQUIRE(inside.lines.size() == 1);
  CHECK(closed(inside.points_of(inside.lines[0])));
}

TEST_CASE("a drawing is placed as requested", "[core][plan][sheet]") {
  PlanOptions options;
  options.place.at = PagePoint{20, 30};
  const auto done = value(plan(card(), cameo3(), paper(), options));
  CHECK(done.sheets[0].transform.x0 == 20.0);
  CHECK(done.sheets[0].transform.y0 == 30.0);
  options.place.at = PagePoint{220, 30};
  const auto over = plan(card(), cameo3(), paper(), options);
  REQUIRE_FALSE(over);
  CHECK(over.error().place == "/options/at");
  options.place.at.reset();
  const auto margin = plan(card(), cameo3(), paper(), options);
  CHECK(margin->sheets[0].transform.x0 == 10.0);
}

TEST_CASE("sizes of mats are read with their units", "[core][plan][sheet]") {
  CHECK((*parse_size_mm("300x200"))[1] == 200.0);
  CHECK((*parse_size_mm("12x12in"))[0] == Approx(304.8));
  CHECK((*parse_size_mm("30.5x20cm"))[0] == Approx(305.0));
  for (const char* wrong :
       {"", "x", "300", "300x", "300x200x", "-3x4", "1e9x1", "300x200km", "nanxnan"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_size_mm(wrong));
  }
  CHECK(choose_mat(cameo3(), "12x24")->code == 2);
  CHECK(choose_mat(cameo3(), "a9").error().kind == ErrorKind::Usage);
  CHECK(choose_mat(cameo3(), "400x400").error().kind == ErrorKind::OutOfRange);
}

TEST_CASE("a mat can be named as a paper", "[core][plan][sheet]") {
  // ISO 216 and ANSI, mm
  const struct {
    const char* word;
    double width_mm, length_mm;
  } papers[] = {{"A4", 210, 297},
                {"a3", 297, 420},
                {"A3-Landscape", 420, 297},
                {"Letter", 215.9, 279.4},
                {"letter-landscape", 279.4, 215.9}};
  for (const auto& paper : papers) {
    CAPTURE(paper.word);
    const auto size = value(parse_size_mm(paper.word));
    CHECK(size[0] == Approx(paper.width_mm));
    CHECK(size[1] == Approx(paper.length_mm));
  }
  CHECK((*parse_size_mm("12x12"))[0] == 12.0);  // a size, as it always was
  CHECK_FALSE(parse_size_mm("-landscape"));
  CHECK_FALSE(parse_size_mm("A4-portrait"));
  CHECK(choose_mat(cameo3(), "A4")->length_mm == 297.0);
  CHECK(choose_mat(cameo3(), "A2").error().kind == ErrorKind::OutOfRange);
}

TEST_CASE("times of moves follow acceleration and corners", "[core][plan][motion]") {
  Motion motion;
  motion.accel_mm_s2 = 100;
  motion.travel_mm_s = 50;
  motion.corner_mm = 0.0;
  const std::vector<PagePoint> line{{0, 0}, {100, 0}};
  // 50 mm/s after 0.5 s and 12.5 mm: 2 x 0.5 s + 75 mm / 50 mm/s.
  CHECK(path_seconds(line, 50, motion) == Approx(2.5));
  CHECK(travel_seconds(100, motion) == Approx(2.5));
  CHECK(travel_seconds(4, motion) == Approx(0.4));
  const std::vector<PagePoint> there_and_back{{0, 0}, {4, 0}, {0, 0}};
  CHECK(path_seconds(there_and_back, 50, motion) == Approx(0.8));
  const std::vector<PagePoint> in_pieces{{0, 0}, {30, 0}, {30, 0}, {70, 0}, {100, 0}};
  CHECK(path_seconds(in_pieces, 50, motion) == Approx(2.5));
  const std::vector<PagePoint> square{{0, 0}, {4, 0}, {4, 4}};
  CHECK(path_seconds(square, 50, motion) == Approx(0.8));
  motion.corner_mm = 10.0;
  CHECK(path_seconds(square, 50, motion) < 0.8);
}

TEST_CASE("the estimate for the recorded job is about its recorded time", "[core][plan][motion]") {
  // Four one inch squares in the corners of a page with 1 mm of overcut at both ends: 20.4 s at
  // speed 5, 16.8 s at speed 10, 15.4 s at speed 10 with a pen, which is not turned at corners.
  const auto seconds = [](double speed_mm_s) {
    Toolpath path;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {279.4, 0.0}, {0.0, 279.4}, {279.4, 279.4}}) {
      const std::vector<PagePoint> points{
          {x + 1, y},    {x, y}, {x, y + 25.4}, {x + 25.4, y + 25.4},
          {x + 25.4, y}, {x, y}, {x, y + 1}};
      path.strokes.push_back({.operation = Operation::Cut,
                              .first = static_cast<std::uint32_t>(path.points.size()),
                              .count = 7,
                              .force_gf = 70,
                              .speed_mm_s = speed_mm_s});
      path.points.insert(path.points.end(), points.begin(), points.end());
    }
    return strokes_seconds(path, cameo3().motion);
  };
  CHECK(seconds(50) == Approx(20.4).epsilon(0.1));
  CHECK(seconds(100) == Approx(15.4).epsilon(0.05));
}

TEST_CASE("values beyond a machine are adjusted with a warning", "[core][plan]") {
  Material strong = paper();
  strong.cut.force_gf = 500;
  strong.cut.tool = 2;
  const auto done = value(plan(card(), *find_machine("portrait3"), strong, {}));
  CHECK(done.warnings.size() == 2);
  for (const Stroke& stroke : done.sheets[0].path.strokes) {
    CHECK(stroke.force_gf <= 231.0);
    CHECK(stroke.tool == 1);
  }
}

TEST_CASE("a second pass returns along an open cut and goes round a closed one", "[core][plan]") {
  LineWork work;
  draw(work, Operation::Cut, {{10, 10}, {20, 10}});
  draw(work, Operation::Outline, {{0, 0}, {50, 0}, {50, 50}, {0, 50}, {0, 0}});
  Material twice = paper();
  twice.cut.passes = 2;
  const auto done = value(plan(work, cameo3(), twice, {}));
  const PlannedSheet& sheet = done.sheets[0];
  CHECK(sheet.cut_mm == Approx(2 * (10 + 200) + 1.0));  // the outline's overcut at both ends
  CHECK(sheet.path.strokes.size() == 3);
  const auto go = sheet.path.points_of(sheet.path.strokes[0]);
  const auto back = sheet.path.points_of(sheet.path.strokes[1]);
  CHECK(go.front() == back.back());
  CHECK(go.back() == back.front());
}

TEST_CASE("an empty drawing and one without end are refused", "[core][plan]") {
  CHECK(plan({}, cameo3(), paper(), {}).error().kind == ErrorKind::OutOfRange);
  LineWork far;
  draw(far, Operation::Cut, {{0, 0}, {1e9, 0}});
  CHECK(plan(far, cameo3(), paper(), {}).error().kind == ErrorKind::OutOfRange);
  LineWork nan;
  draw(nan, Operation::Cut, {{0, 0}, {std::nan(""), 0}});
  CHECK(plan(nan, cameo3(), paper(), {}).error().kind == ErrorKind::OutOfRange);
}

TEST_CASE("plan.json has the fields of the manual and adds up", "[core][plan]") {
  const auto done = value(plan(card(), cameo3(), paper(), {}));
  const auto json = nlohmann::json::parse(plan_json(done));
  REQUIRE(json["sheets"].size() == 1);
  const auto& sheet = json["sheets"][0];
  for (const char* field :
       {"cut_mm", "fold_mm", "fold_line_mm", "travel_mm", "travel_input_mm", "home_mm", "lifts",
        "paths", "seconds", "seconds_range", "transform", "tabs", "seams", "marks", "overcuts"}) {
    CAPTURE(field);
    CHECK(sheet.contains(field));
  }
  CHECK(json["seed"] == 1);
  CHECK(json["warnings"].empty());
  CHECK(sheet["cut_mm"].get<double>() == Approx(440 + 100 + 1));  // overcut
  CHECK(sheet["fold_line_mm"].get<double>() == Approx(3 * 40 + 2 * 30));
  CHECK(sheet["fold_mm"].get<double>() < sheet["fold_line_mm"].get<double>());
  CHECK(sheet["travel_mm"].get<double>() <= sheet["travel_input_mm"].get<double>());
  CHECK(sheet["seconds_range"][0].get<double>() < sheet["seconds"].get<double>());
  std::size_t strokes = 0;
  for (const auto& operation : sheet["operations"])
    strokes += operation["strokes"].get<std::size_t>();
  CHECK(strokes == sheet["lifts"].get<std::size_t>());
}

TEST_CASE("the sheet's picture can be read back stroke by stroke", "[core][plan]") {
  const auto done = value(plan(card(), cameo3(), paper(), {}));
  const PlannedSheet& sheet = done.sheets[0];
  const auto back = value(linework_from_svg(sheet_svg(sheet, "a < b & c"), SvgProfile::Popcut));
  CHECK(back.name == "a < b & c");
  CHECK(back.warnings.empty());
  CHECK(back.dashed);
  CHECK(back.lines.size() == sheet.path.strokes.size());
  CHECK(total_mm(back, Operation::FoldMountain) + total_mm(back, Operation::FoldValley) ==
        Approx(sheet.fold_mm));
  CHECK(total_mm(back, Operation::Cut) + total_mm(back, Operation::Outline) ==
        Approx(sheet.cut_mm - 1.0));
  const auto again = value(plan(back, cameo3(), paper(), {}));
  CHECK(again.sheets[0].fold_mm == Approx(sheet.fold_mm));
  CHECK(linework_from_svg(assembly_svg(done), SvgProfile::Plain));
}

TEST_CASE("the used length of a roll is that of the drawing", "[core][plan][sheet]") {
  const auto done = value(plan(card(), *find_machine("hpgl-generic"), paper(), {}));
  CHECK(done.sheets[0].area_mm[0] == 600.0);
  CHECK(done.sheets[0].area_mm[1] == 140.0);
}

TEST_CASE("each plan option takes its default and its limits and nothing beyond",
          "[core][plan][options]") {
  using Kind = PlanOption::Kind;
  for (const PlanOption& option : plan_option_table()) {
    CAPTURE(option.name);
    const auto of_name = [&](const PlanOption& other) { return other.name == option.name; };
    CHECK(std::count_if(plan_option_table().begin(), plan_option_table().end(), of_name) == 1);
    if (option.of_request) continue;
    const std::string name(option.name);
    const auto place_of = [&](const std::string& text) {
      const auto read = read_plan_options({{name, text}});
      return read ? std::string("valid") : read.error().place;
    };
    for (const std::string& word : option.words) CHECK(place_of(word) == "valid");
    if (option.kind == Kind::Flag) CHECK(place_of("true") == "valid");
    if (option.kind == Kind::Flag || option.kind == Kind::Word || option.kind == Kind::Place)
      CHECK(place_of("nonsense") == pointer_to(option));
    if (option.kind != Kind::Number && option.kind != Kind::Whole && option.kind != Kind::Lengths)
      continue;
    CHECK(place_of(fmt::format("{}", option.least)) == "valid");
    CHECK(place_of(fmt::format("{:.0f}", 2 * option.most + 1)) == pointer_to(option));
    CHECK(place_of("nan") == pointer_to(option));
    const std::vector<double> usual = option.numbers(PlanOptions{});
    if (usual.empty()) continue;
    const auto read = value(read_plan_options({{name, option.usual}}));
    CHECK(option.numbers(read) == usual);
  }
  CHECK(read_plan_options({{"machine", "cameo3"}}).error().place == "/options/machine");
  CHECK(read_plan_options({{"split", "false"}})->no_split);
}

TEST_CASE("cells get smaller only where many lines lie side by side", "[core][plan][clean]") {
  const auto lines = [](std::size_t count, double apart_mm) {
    std::vector<Segment> made;
    for (std::size_t k = 0; k < count; ++k) {
      const double y = apart_mm * static_cast<double>(k);
      made.push_back({{0.1, y}, {0.9, y}});
    }
    return made;
  };
  const auto cell = [](const std::vector<Segment>& of) {
    return cell_for_density(
        of.size(), [&](std::size_t k) { return of[k]; }, 4.0, 0.1);
  };
  CHECK(cell(lines(2000, 1)) == 4.0);
  CHECK(cell(lines(2000, 0.02)) < 1.1);
  CHECK(cell(lines(2000, 0.02)) >= 0.1);
  CHECK(cell(lines(2000, 0)) >= 0.1);  // all on one place: no cell helps
  CHECK(cell({}) == 4.0);
}

TEST_CASE("travel is told in millimetres and in the machine's seconds", "[core][plan]") {
  const auto made = value(plan(card(), cameo3(), paper(), {}));
  const PlannedSheet& sheet = made.sheets[0];
  const Motion motion = cameo3().motion;
  CHECK(sheet.travel_s > sheet.travel_mm / motion.travel_mm_s);  // it speeds up and brakes
  CHECK(sheet.travel_s < sheet.seconds);
  const auto json = nlohmann::json::parse(plan_json(made));
  CHECK(json["sheets"][0]["travel_s"].get<double>() == Approx(sheet.travel_s).margin(1e-3));
}

}  // namespace plan_test
