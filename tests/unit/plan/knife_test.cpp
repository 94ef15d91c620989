// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/machines/motion.hpp"
#include "core/plan/knife/blade.hpp"
#include "core/plan/plan.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/value.hpp"

namespace knife_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

Machine machine(const char* name) { return *find_machine(name); }
Material paper() { return *find_material("paper-220"); }

std::vector<PagePoint> ring(PagePoint centre, double r, int sides) {
  std::vector<PagePoint> points;
  for (int k = 0; k < sides; ++k) {
    const double a = 2 * std::numbers::pi * k / sides;
    points.push_back({centre.x + r * std::cos(a), centre.y + r * std::sin(a)});
  }
  points.push_back(points.front());
  return points;
}

double distance_to_line(const PagePoint& p, std::span<const PagePoint> line) {
  double least = 1e300;
  for (std::size_t i = 1; i < line.size(); ++i)
    least = std::min(least, distance_to(p, line[i - 1], line[i]));
  return least;
}

Material from_table(const std::string& fields) {
  const std::string table = R"({"popcut": 1, "materials": [{"name": "mine", "title": "Mine",
    "like": "paper-220")" + fields +
                            "}]}";
  return value(find_material("mine", {table}));
}

Error refusal(const std::string& fields) {
  const std::string table = R"({"popcut": 1, "materials": [{"name": "mine", "title": "Mine",
    "like": "paper-220")" + fields +
                            "}]}";
  const auto made = find_material("mine", {table});
  REQUIRE_FALSE(made);
  return made.error();
}

}  // namespace

TEST_CASE("squares after a small circle keep their full overcut", "[core][plan][knife]") {
  LineWork work;
  draw(work, Operation::Cut, ring({10, 10}, 0.3, 24));
  draw(work, Operation::Cut, {{20, 10}, {30, 10}, {30, 20}, {20, 20}, {20, 10}});
  draw(work, Operation::Cut, {{40, 10}, {50, 10}, {50, 20}, {40, 20}, {40, 10}});
  draw(work, Operation::Cut, {{60, 10}, {70, 15}});
  const auto done = value(plan(work, machine("cameo3"), paper(), {}));
  const PlannedSheet& sheet = done.sheets[0];
  REQUIRE(sheet.sent);
  REQUIRE(sheet.sent->strokes.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto drawn = sheet.path.points_of(sheet.path.strokes[i]);
    const auto sent = sheet.sent->points_of(sheet.sent->strokes[i]);
    const double round = length(drawn);
    const double extra = closed(drawn) ? 2 * std::min(0.5, round / 4) : 0.0;
    CHECK(length(sent) == Approx(round + extra));
    if (!closed(drawn)) continue;
    // It begins before the seam and ends behind it, on the path.
    CHECK(distance_to_line(sent.front(), drawn) < 1e-9);
    CHECK(distance_to_line(sent.back(), drawn) < 1e-9);
    CHECK(sent.front() != sent.back());
  }
  const auto json = nlohmann::json::parse(plan_json(done));
  CHECK(json["sheets"][0]["overcuts"].size() == 6);
  CHECK(json["sheets"][0]["lead_ins"].empty());
  CHECK(sheet.cut_mm == Approx(length(std::vector<PagePoint>{{60, 10}, {70, 15}}) + 82 +
                               1.5 * length(ring({10, 10}, 0.3, 24))));
}

TEST_CASE("the tip of a turned blade stays on the path", "[core][plan][knife]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 60);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    Blade cutting{.offset_mm = round % 2 == 0 ? 0.25 : 0.9};
    Blade trailing = cutting;
    for (int stroke = 0; stroke < 5; ++stroke) {
      std::vector<PagePoint> path;
      for (int k = 0; k < 6; ++k) path.push_back({place(random), place(random)});
      std::vector<PagePoint> axis;
      append_axis_path(path, cutting, axis);
      const auto tip = tip_path(axis, trailing);
      for (const PagePoint& p : tip) CHECK(distance_to_line(p, path) < 0.02);
      for (const PagePoint& p : path) CHECK(distance_to_line(p, tip) < 0.02);
      CHECK(distance(tip.back(), path.back()) < 0.02);
      CHECK(distance(trailing.heading, cutting.heading) < 0.05);
    }
  }
}

TEST_CASE("a corner above the angle is turned on an arc about it", "[core][plan][knife]") {
  Blade blade{.offset_mm = 1.0};
  std::vector<PagePoint> axis;
  const std::vector<PagePoint> path{{0, 0}, {10, 0}, {10, 10}};
  CHECK(append_axis_path(path, blade, axis) == 0);
  CHECK(axis.front() == PagePoint{1, 0});
  std::size_t on_arc = 0;
  for (const PagePoint& p : axis) on_arc += std::abs(distance(p, {10, 0}) - 1.0) < 1e-9 ? 1u : 0u;
  CHECK(on_arc >= 5);
  CHECK(distance(axis.back(), {10, 11}) < 1e-9);
  // Coming back the blade stands wrong: it swings in before it cuts.
  axis.clear();
  CHECK(append_axis_path(std::vector<PagePoint>{{10, 10}, {10, 0}}, blade, axis) > 5);
  CHECK(distance(axis.front(), {10, 11}) < 1e-9);
}

TEST_CASE("popcut turns the blade only where the firmware does not", "[core][plan][knife]") {
  LineWork work;
  draw(work, Operation::Cut, {{10, 10}, {40, 10}, {40, 30}});
  CHECK_FALSE(plan(work, machine("cameo3"), paper(), {})->sheets[0].sent);
  const auto turned = plan(work, machine("hpgl-generic"), paper(), {});
  REQUIRE(turned->sheets[0].sent);
  CHECK(turned->sheets[0].knife.blade_offset_mm == 0.25);
  CHECK(turned->sheets[0].sent->points.size() > 5);
  Machine own = machine("hpgl-generic");
  own.firmware_blade_offset = true;
  CHECK_FALSE(plan(work, own, paper(), {})->sheets[0].sent);
}

TEST_CASE("the axis of a turned blade stays in the area", "[core][plan][knife]") {
  LineWork work;
  work.has_page = true;
  draw(work, Operation::Cut, {{0, 0}, {300, 0}, {300, 200}, {0, 200}, {0, 0}});
  PlanOptions options;
  for (const bool clip : {false, true}) {
    options.place.clip = clip;
    options.mat = "300.6x200.6";
    const auto done = value(plan(work, machine("hpgl-generic"), paper(), options));
    const PlannedSheet& sheet = done.sheets[0];
    for (const PagePoint& p : sheet.sent_path().points) {
      CHECK(p.x >= -1e-9);
      CHECK(p.y >= -1e-9);
      CHECK(p.x <= sheet.area_mm[0] + 1e-9);
      CHECK(p.y <= sheet.area_mm[1] + 1e-9);
    }
  }
  options.place.clip = false;
  options.mat = "300x200";
  options.no_split = true;
  const auto tight = plan(work, machine("hpgl-generic"), paper(), options);
  REQUIRE_FALSE(tight);
  CHECK(tight.error().detail.find("blade's offset needs 0.25 mm") != std::string::npos);
}

TEST_CASE("a line that leaves the area and comes back is cut as several strokes",
          "[core][plan][sheet]") {
  LineWork work;
  draw(work, Operation::Cut, {{10, 10}, {110, 10}, {110, 20}, {-10, 20}, {-10, 30}, {50, 30}});
  const LineWork inside = clipped(work, {100.0, 100.0});
  REQUIRE(inside.lines.size() == 3);
  CHECK(total_mm(inside, Operation::Cut) == Approx(90 + 100 + 50));
  for (const PagePoint& p : inside.points) CHECK((p.x >= 0.0 && p.x <= 100.0));
}

TEST_CASE("closed cuts start and overcut as configured", "[core][plan][knife]") {
  for (const CutDirection direction : {CutDirection::Clockwise, CutDirection::CounterClockwise}) {
    LineWork work;
    draw(work, Operation::Cut, {{20, 10}, {30, 10}, {30, 20}, {20, 20}, {20, 10}});
    draw(work, Operation::Outline, {{0, 0}, {0, 90}, {90, 90}, {90, 0}, {0, 0}});
    PlanOptions options;
    options.knife.direction = direction;
    const auto done = plan(work, machine("cameo3"), paper(), options);
    const Toolpath& path = done->sheets[0].path;
    for (const Stroke& stroke : path.strokes)  // y points down: clockwise is positive
      CHECK((turning(path.points_of(stroke)) > 0) == (direction == CutDirection::Clockwise));
  }
}

TEST_CASE("each further pass adds the material's extra force", "[core][plan][knife]") {
  const Material card = from_table(R"(, "cut": {"tool": 1, "force_gf": 140, "speed_mm_s": 20,
    "passes": 3, "force_step_gf": 70})");
  LineWork work;
  draw(work, Operation::Cut, {{20, 10}, {30, 10}, {30, 20}, {20, 20}, {20, 10}});
  const auto done = plan(work, machine("cameo3"), card, {});
  const Toolpath& path = done->sheets[0].path;
  REQUIRE(path.strokes.size() == 3);
  CHECK(path.strokes[0].force_gf == 140);
  CHECK(path.strokes[1].force_gf == 210);
  CHECK(path.strokes[2].force_gf == 231);  // no more than the machine can
  CHECK(done->sheets[0].cut_mm == Approx(3 * 41));
}

TEST_CASE("folds are dashed or pressed or half cut as requested", "[core][plan][knife]") {
  LineWork work;
  draw(work, Operation::FoldMountain, {{10, 10}, {60, 10}});
  draw(work, Operation::Cut, {{10, 30}, {60, 30}});
  PlanOptions options;
  CHECK(plan(work, machine("cameo3"), paper(), options)->sheets[0].path.strokes.size() > 10);
  for (const FoldMode mode : {FoldMode::Score, FoldMode::Light}) {
    options.knife.folds = mode;
    const auto done = value(plan(work, machine("cameo3"), paper(), options));
    const PlannedSheet& sheet = done.sheets[0];
    const Material material = paper();
    const ToolSettings tool = mode == FoldMode::Score ? *material.score : *material.light;
    REQUIRE(sheet.path.strokes.size() == static_cast<std::size_t>(tool.passes) + 1);
    CHECK(sheet.path.strokes[0].operation == Operation::FoldMountain);
    CHECK(sheet.path.strokes[0].tool == tool.tool);
    CHECK(sheet.path.strokes[0].force_gf == tool.force_gf);
    CHECK(sheet.fold_mm == Approx(50.0 * tool.passes));
    CHECK(sheet.knife.blade(2) == false);
  }
  Material plain = paper();
  plain.score.reset();
  options.knife.folds = FoldMode::Score;
  const auto refused = plan(work, machine("cameo3"), plain, options);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place == "/options/folds");
}

TEST_CASE("wrong knife values in a table are refused with their place", "[core][plan][tables]") {
  CHECK(refusal(R"(, "overcut_mm": -1)").place.find("/materials/0/overcut_mm") !=
        std::string::npos);
  CHECK(refusal(R"(, "swivel_above_deg": "much")").place.find("/materials/0/swivel_above_deg") !=
        std::string::npos);
  CHECK(refusal(R"(, "folds": "crease")").place.find("/materials/0/folds") != std::string::npos);
  CHECK(refusal(R"(, "folds": "score", "score": null)").detail.find("\"score\"") !=
        std::string::npos);
  CHECK(refusal(R"(, "light": {"tool": 1, "force_gf": 5, "speed_mm_s": 3, "passes": 99})")
            .place.find("/materials/0/light/passes") != std::string::npos);
  CHECK(refusal(
            R"(, "cut": {"tool": 1, "force_gf": 5, "speed_mm_s": 3, "passes": 1, "tip": "laser"})")
            .place.find("/materials/0/cut/tip") != std::string::npos);
  PlanOptions options;
  LineWork work;
  draw(work, Operation::Cut, {{10, 30}, {60, 30}});
  options.clean.snap_mm = std::nan("");
  CHECK(plan(work, machine("cameo3"), paper(), options).error().place == "/options/snap");
  options.clean.snap_mm = 0.05;
  options.knife.overcut_mm = 1e9;
  CHECK(plan(work, machine("cameo3"), paper(), options).error().place == "/options/overcut");
}

TEST_CASE("estimated times match the recorded jobs with blade and with pen",
          "[core][plan][motion]") {
  // Captures of a Cameo 3, four squares of one inch with 1 mm before and behind the seam: seconds
  // from the last geometry write to the first 0, polled twice a second.
  Toolpath path;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {279.4, 0.0}, {0.0, 279.4}, {279.4, 279.4}}) {
    const std::vector<PagePoint> points{{x + 1, y},    {x, y}, {x, y + 25.4}, {x + 25.4, y + 25.4},
                                        {x + 25.4, y}, {x, y}, {x + 1, y}};
    path.strokes.push_back(
        {Operation::Cut, static_cast<std::uint32_t>(path.points.size()), 7, 0, 1, 70, 0});
    path.points.insert(path.points.end(), points.begin(), points.end());
  }
  struct Recorded {
    double speed_mm_s, offset_mm, seconds;
  };
  for (const Recorded& job : {Recorded{50, 0.9, 20.2}, {100, 0.9, 16.8}, {100, 0.0, 15.4}}) {
    for (Stroke& stroke : path.strokes) stroke.speed_mm_s = job.speed_mm_s;
    CAPTURE(job.speed_mm_s, job.offset_mm);
    CHECK(strokes_seconds(path, machine("cameo3").motion, {job.offset_mm, 2}) ==
          Approx(job.seconds).margin(0.75));
  }
}

TEST_CASE("the picture of a plan shows its lifts", "[core][plan]") {
  LineWork work;
  for (int k = 0; k < 100; ++k) draw(work, Operation::Cut, {{10, 10.0 + k}, {60, 10.5 + k}});
  const auto done = plan(work, machine("cameo3"), paper(), {});
  const std::string svg = plan_svg(done->sheets[0], "many & more");
  CHECK(svg.find("100 lifts") != std::string::npos);
  CHECK(svg.find("many &amp; more") != std::string::npos);
  CHECK(svg.find("stroke 100, cut last") != std::string::npos);
}

}  // namespace knife_test
