// SPDX-License-Identifier: MIT
#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "device/session.hpp"
#include "tests/support/sim_bench.hpp"

using namespace popcut;
using namespace popcut::test;

namespace {

/// Points of a stroke on the machine's grid, without repeats: what a machine can be asked to draw.
std::vector<PagePoint> on_grid(std::span<const PagePoint> points, double unit_mm) {
  std::vector<PagePoint> line;
  for (const PagePoint& p : points) {
    const PagePoint q{std::round(p.x / unit_mm) * unit_mm, std::round(p.y / unit_mm) * unit_mm};
    if (line.empty() || distance(line.back(), q) > unit_mm / 2) line.push_back(q);
  }
  return line;
}

std::size_t strokes_of(const Toolpath& path, const EncodedProgram& program) {
  return path.strokes.size() - program.dots.size();
}

}  // namespace

TEST_CASE("what the simulated cutter draws is the toolpath within half a machine unit",
          "[device][session]") {
  for (const char* name : {"cameo3", "cameo", "cameo4", "cameo5", "portrait3", "hpgl-generic"}) {
    const Machine target = machine(name);
    const Material paper = value(find_material("paper-220"));
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      const Toolpath path = random_toolpath(random, 1 + seed * 3, 190, paper);
      JobOptions job;
      job.page_length_mm = 300;
      const EncodedProgram program = value(encode(path, target, paper, job));
      SimOptions sheet;
      sheet.page_length_mm = 300;
      SimTransport cable(cutter(target, sheet));
      const SessionEnd end = run_session(cable, target, program);
      INFO((end.error ? message(*end.error) : std::string()));
      REQUIRE_FALSE(end.error);
      CHECK(end.confirmed == (target.language == "gpgl"));
      const Trace& trace = cable.cutter().trace();
      CHECK(trace.unknown.empty());
      CHECK(trace.remarks.empty());
      CHECK(trace.clipped_mm == 0.0);
      CHECK(trace.starved_s < 0.05);
      REQUIRE(trace.strokes.size() == strokes_of(path, program));
      std::size_t drawn = 0;
      for (std::size_t k = 0; k < path.strokes.size(); ++k) {
        const std::vector<PagePoint> meant = on_grid(path.points_of(path.strokes[k]), target.unit_mm);
        if (meant.size() < 2) continue;
        const auto got = trace.points_of(trace.strokes[drawn++]);
        REQUIRE(got.size() == meant.size());
        double worst = 0;
        for (std::size_t i = 0; i < got.size(); ++i)
          worst = std::max({worst, std::abs(got[i].x - meant[i].x), std::abs(got[i].y - meant[i].y)});
        CHECK(worst <= 1e-9);
      }
    }
  }
}
