// SPDX-License-Identifier: MIT
// Seconds of a comparison by the number of triangles: the target once, a structure each time.
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/compare/comparison.hpp"
#include "core/compare/volume.hpp"
#include "tests/support/meshes.hpp"

namespace compare_bench {

using namespace popcut;
using namespace popcut::likeness;
using namespace popcut::testing;

namespace {

/// A sphere in the corner of about so many triangles, with waves so that it is no plain one.
std::vector<float> ball_of(std::size_t triangles, double waves_mm) {
  const int rings = static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / 4.0)));
  std::vector<float> corners = sphere_mesh(50.0, rings, 2 * rings).corners;
  for (std::size_t k = 0; k < corners.size(); k += 3) {
    const auto x = static_cast<double>(corners[k]), y = static_cast<double>(corners[k + 1]);
    const double out = 1.0 + waves_mm / 50.0 * std::sin(0.2 * x) * std::cos(0.17 * y);
    for (std::size_t i = 0; i < 3; ++i)
      corners[k + i] = static_cast<float>(55.0 + out * static_cast<double>(corners[k + i]));
  }
  return corners;
}

double seconds_of(const auto& work, int times) {
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < times; ++k) work();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / times;
}

void report(std::size_t triangles, int pixels) {
  const auto model = ball_of(triangles, 1.0), structure = ball_of(triangles, 3.0);
  const Scene scene{cone_views(), pixels, Corner{}};
  Buffers buffers;
  const Target target(model, scene);
  const int times = triangles > 500'000 ? 2 : 10;
  const double made = seconds_of([&] { (void)Target(model, scene); }, times);
  const double measured = seconds_of([&] { (void)target.measure(structure, buffers); }, times);
  DepthImage image;
  const double drawn = seconds_of([&] { draw(target.frame(1), structure, image); }, times);
  const double volume = seconds_of([&] { (void)solid_volume(model, {}, pixels); }, 1);
  WARN(
      fmt::format("{:>8} triangles, {:>3} pixels: target {:.4f} s, structure in nine views {:.4f} "
                  "s (drawing one {:.5f} s), volume {:.3f} s",
                  model.size() / 9, pixels, made, measured, drawn, volume));
  CHECK(target.measure(structure, buffers).cover > 0.5);
}

}  // namespace

TEST_CASE("seconds of a comparison by its triangles", "[bench]") {
  for (const int pixels : {64, 256, 512})
    for (const std::size_t triangles :
         {std::size_t{10'000}, std::size_t{100'000}, std::size_t{1'000'000}})
      report(triangles, pixels);
}

}  // namespace compare_bench
