// SPDX-License-Identifier: MIT
// Times of each stage of planning, from a file's text to a program's bytes.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/plan/plan.hpp"
#include "protocol/encode.hpp"
#include "tests/support/corpus.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"
#include "tests/support/value.hpp"

namespace plan_bench {

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

// Closed strokes of `corners` corners in rows, none on another.
void write_rings(const std::string& file, int n, int corners) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> size(0.15, 0.4);
  std::ofstream svg(file);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300mm\" height=\"300mm\" "
         "viewBox=\"0 0 300 300\"><g fill=\"none\" stroke=\"black\">\n";
  const int side = static_cast<int>(std::ceil(std::sqrt(n)));
  for (int k = 0; k < n; ++k) {
    const double x = 5 + 290 * (k % side + 0.5) / side, y = 5 + 290 * (k / side + 0.5) / side;
    const double r = size(random);
    svg << "<path d=\"M";
    for (int c = 0; c < corners; ++c)
      svg << fmt::format("{:.3f},{:.3f} ", x + r * std::cos(6.283185307 * c / corners),
                         y + r * std::sin(6.283185307 * c / corners));
    svg << "z\"/>\n";
  }
  svg << "</g></svg>\n";
}

void plan_text(const char* name, const std::string& text) {
  std::printf("%s\n", name);
  Stages stages;
  const auto work = testing::value(linework_from_svg(text, SvgProfile::Plain));
  stages.done("read");
  const LineWork cleaned = clean(work);
  stages.done("clean");
  const Machine machine = *ideal_plotter(305, 305);
  const Material paper = *find_material("paper-220");
  const auto planned = testing::value(plan(work, machine, paper, {}));
  stages.done("plan (all)");
  const PlannedSheet& sheet = planned.sheets[0];
  const auto program = testing::value(encode(sheet.sent_path(), machine, paper));
  stages.done("encode");
  CHECK_FALSE(sheet_svg(sheet, name).empty());
  stages.done("sheet.svg");
  CHECK_FALSE(plan_svg(sheet, name).empty());
  stages.done("plan.svg");
  CHECK_FALSE(plan_json(planned).empty());
  stages.done("plan.json");
  std::printf("  %zu lines, %zu strokes, travel %.0f mm\n", work.lines.size(),
              sheet.path.strokes.size(), sheet.travel_mm);
}

}  // namespace

// The first case: what a program takes counts from what this process has had.
TEST_CASE("from a drawing's file to a program", "[.][bench][plan]") {
  using popcut::testing::run_program;
  struct File {
    std::string name;
    double strokes, vpype_s;    // of vpype 1.16a: read, linemerge, linesort, write; 0: not known
    double most_s, most_bytes;  // a stroke; 0: only told
  };
  const File files[] = {{"rand_10k", 10'000, 2.0, 0.3, 0},    {"kiri_10k", 9'800, 1.9, 0.3, 0},
                        {"rand_100k", 100'000, 21.0, 2, 400}, {"kiri_100k", 99'458, 19.7, 2, 400},
                        {"rectangles", 100'000, 0, 0, 0},     {"dodecagons", 100'000, 0, 0, 0}};
  const popcut::testing::TempFolder folder;
  write_rings(folder / "rectangles.svg", 100'000, 4);
  write_rings(folder / "dodecagons.svg", 100'000, 12);
  const bool corpus = !testing::corpus().empty();
  if (!corpus) WARN("skipped: the files of the generator of drawings, which is not here");
  const long bare =
      run_program({popcut::testing::popcut_program(), "--version"}, folder.path()).peak_kb;
  std::string table = fmt::format(
      "popcut plan FILE --machine cameo3, load {}; memory beyond that of --version, {} KB\n{:<12}"
      "{:>8}{:>9}{:>9}{:>11}{:>11}{:>9}\n",
      testing::load(), bare, "file", "strokes", "wall s", "cpu s", "peak KB", "B/stroke",
      "vpype s");
  for (const File& file : files) {
    CAPTURE(file.name);
    const bool own = file.vpype_s == 0;
    if (!own && !corpus) continue;
    const auto drawing = (own ? folder.path() : testing::corpus_folder()) / (file.name + ".svg");
    const auto ran = run_program({popcut::testing::popcut_program(), "plan", drawing.string(), "-o",
                                  folder / "out", "--machine", "cameo3", "-q"},
                                 folder.path());
    CHECK(ran.exit == 0);
    const double each = 1024.0 * static_cast<double>(ran.peak_kb - bare) / file.strokes;
    table += fmt::format("{:<12}{:>8}{:>9.2f}{:>9.2f}{:>11}{:>11.0f}{:>9}\n", file.name,
                         file.strokes, ran.wall_s, ran.cpu_s, ran.peak_kb, each,
                         own ? std::string() : fmt::format("{:.1f}", file.vpype_s));
    if (file.most_s > 0) CHECK(ran.cpu_s < file.most_s);
    if (file.most_bytes > 0) CHECK(each < file.most_bytes);
  }
  WARN(table);
}

TEST_CASE("planning by stages", "[.][bench][plan]") {
  plan_text("10 000 random strokes", random_strokes(10'000));
  plan_text("100 000 random strokes", random_strokes(100'000));
  for (const auto& file : testing::corpus())
    if (file.stem() == "kiri_100k" || file.stem() == "nested_2k" || file.stem() == "hilbert_65k")
      plan_text(file.filename().c_str(), testing::text_of(file));
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

}  // namespace plan_bench
