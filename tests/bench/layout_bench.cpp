// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <array>
#include <chrono>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/layout/layout.hpp"
#include "tests/support/random_pattern.hpp"
#include "tests/support/value.hpp"

namespace layout_bench {

using namespace popcut;

namespace {

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// Of the processor, then of the wall: these machines are shared.
std::array<double, 2> seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  const double before = processor_s();
  work();
  return {processor_s() - before,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

void lay(const char* what, const LineWork& drawing, std::size_t faces, LayoutOptions options) {
  const Box box = bounds(drawing);
  std::size_t segments = 0;
  for (const DrawnLine& line : drawing.lines) segments += line.count - 1;
  Layout layout;
  const auto [seconds, wall] =
      seconds_of([&] { layout = testing::value(lay_out(drawing, options)); });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "{:<28} {:>7} {:>8} {:>6.0f} x {:<6.0f} {:>4.0f} x {:<4.0f} {:>6} {:>6} {:>6} {:>7.0f} "
      "{:>6} {:>8.3f} {:>8.3f} {:>7.2f} {:>6}\n",
      what, faces, segments, box.width(), box.height(), options.area_mm[0], options.area_mm[1],
      layout.pieces.size(), layout.sheets.size(), layout.least_sheets, layout.glue_mm,
      layout.tabs.size(), seconds, wall, seconds * 1e6 / static_cast<double>(segments),
      usage.ru_maxrss / 1024);
}

}  // namespace

TEST_CASE("splitting and packing", "[bench]") {
  fmt::print(
      "{:<28} {:>7} {:>8} {:>15} {:>11} {:>6} {:>6} {:>6} {:>7} {:>6} {:>8} {:>8} {:>7} {:>6}\n",
      "drawing", "faces", "segments", "mm", "area", "pieces", "sheets", "least", "glue", "tabs",
      "cpu s", "wall s", "us/seg", "MB");
  const auto with = [](double width, double height) {
    LayoutOptions options;
    options.area_mm = {width, height};
    return options;
  };
  std::size_t faces = 0;
  const LineWork composite = clean(testing::example_linework("composite", faces));
  lay("Fig. 3A, 12 x 12 inch mat", composite, faces, with(304.8, 304.8));
  lay("Fig. 3A, A4", composite, faces, with(210, 297));
  const LineWork wide = clean(testing::lattice_linework(6, 200, 10, 100, faces));
  lay("2 m lattice, 12 x 12 inch", wide, faces, with(304.8, 304.8));
  lay("2 m lattice, A4", wide, faces, with(210, 297));
  for (const int slices : {125, 250, 500, 1000, 2000}) {
    const LineWork large = clean(testing::lattice_linework(50, slices, 30, 1000, faces));
    lay("lattice of 50 units", large, faces, with(610, 914));
  }
}

}  // namespace layout_bench
