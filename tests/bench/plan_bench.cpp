// SPDX-License-Identifier: MIT
// Times of each stage of planning, from a file's text to a program's bytes.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include <catch2/catch.hpp>

#include "core/formats/svg_reader.hpp"
#include "core/plan/clean.hpp"
#include "core/plan/micro_cut.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/plan_json.hpp"
#include "core/plan/plan_svg.hpp"
#include "core/plan/sheet_svg.hpp"
#include "protocol/encode.hpp"
#include "tests/support/corpus.hpp"

using namespace popcut;

namespace {

/// Seconds since the last call, printed with what took them.
class Stages {
 public:
  void done(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    std::printf("  %-12s %8.1f ms\n", stage,
                std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = std::chrono::steady_clock::now();
  }

 private:
  std::chrono::steady_clock::time_point last_{std::chrono::steady_clock::now()};
};

std::string random_strokes(int n) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(5, 295), size(-5, 5);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300mm\" height=\"300mm\" "
      "viewBox=\"0 0 300 300\"><g fill=\"none\" stroke=\"black\">\n";
  char line[120];
  for (int k = 0; k < n; ++k) {
    std::snprintf(line, sizeof line, "<path d=\"M%.4f,%.4fl%.4f,%.4f\"/>\n", place(random),
                  place(random), size(random), size(random));
    svg += line;
  }
  return svg + "</g></svg>\n";
}

void plan_text(const char* name, const std::string& text) {
  std::printf("%s\n", name);
  Stages stages;
  const auto work = linework_from_svg(text, SvgProfile::Plain);
  REQUIRE(work);
  stages.done("read");
  const LineWork cleaned = clean(*work);
  stages.done("clean");
  const Machine machine = *ideal_plotter(305, 305);
  const Material paper = *find_material("paper-220");
  const auto planned = plan(*work, machine, paper, {});
  REQUIRE(planned);
  stages.done("plan (all)");
  const PlannedSheet& sheet = planned->sheets[0];
  const auto program = encode(sheet.sent_path(), machine, paper);
  REQUIRE(program);
  stages.done("encode");
  CHECK_FALSE(sheet_svg(sheet, name).empty());
  stages.done("sheet.svg");
  CHECK_FALSE(plan_svg(sheet, name).empty());
  stages.done("plan.svg");
  CHECK_FALSE(plan_json(*planned).empty());
  stages.done("plan.json");
  std::printf("  %zu lines, %zu strokes, travel %.0f mm\n", work->lines.size(),
              sheet.path.strokes.size(), sheet.travel_mm);
}

}  // namespace

TEST_CASE("planning by stages", "[.][bench][plan]") {
  plan_text("10 000 random strokes", random_strokes(10'000));
  plan_text("100 000 random strokes", random_strokes(100'000));
  for (const auto& file : test::corpus())
    if (file.stem() == "kiri_100k" || file.stem() == "nested_2k" || file.stem() == "hilbert_65k")
      plan_text(file.filename().c_str(), test::text_of(file));
}

TEST_CASE("cleaning one random path of a million points", "[.][bench][plan]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(0, 300);
  std::vector<PagePoint> points(1'000'000);
  for (PagePoint& p : points) p = {place(random), place(random)};
  LineWork work;
  work.append(Operation::Cut, points);
  Stages stages;
  CHECK(clean(work).lines.size() >= 1);
  stages.done("clean");
}

TEST_CASE("dashing 2 000 folds among 2 000 cuts that all cross them", "[.][bench][plan]") {
  LineWork work;
  for (int k = 0; k < 2000; ++k) {
    const double at = 0.15 * k;
    work.append(Operation::Cut, std::vector<PagePoint>{{at, 0}, {at, 300}});
    work.append(Operation::FoldValley, std::vector<PagePoint>{{0, at + 0.07}, {300, at + 0.07}});
  }
  Stages stages;
  CHECK(micro_cut(work, {}).work.lines.size() >= 2000);
  stages.done("micro-cut");
}
