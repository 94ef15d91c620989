// SPDX-License-Identifier: MIT
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "device/sim/simulate.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_test {

using namespace popcut;
using namespace popcut::testing;

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
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      const SimJob job(machine(name), random, 1 + seed * 3, 300);
      const Machine& target = job.machine;
      const Toolpath& path = job.path;
      const EncodedProgram& program = job.program;
      SimTransport cable = job.cable();
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
        const std::vector<PagePoint> meant =
            on_grid(path.points_of(path.strokes[k]), target.unit_mm);
        if (meant.size() < 2) continue;
        const auto got = trace.points_of(trace.strokes[drawn++]);
        REQUIRE(got.size() == meant.size());
        double worst = 0;
        for (std::size_t i = 0; i < got.size(); ++i)
          worst =
              std::max({worst, std::abs(got[i].x - meant[i].x), std::abs(got[i].y - meant[i].y)});
        CHECK(worst <= 1e-9);
      }
    }
  }
}

namespace {

/// How many strokes were cut whole, and how many in part or whole. All must be the program's, in
/// its order, none twice.
struct CutStrokes {
  std::size_t whole{};
  std::size_t begun{};
};

CutStrokes compare(const Trace& trace, const std::vector<std::vector<PagePoint>>& meant) {
  CutStrokes cut;
  REQUIRE(trace.strokes.size() <= meant.size());
  for (std::size_t k = 0; k < trace.strokes.size(); ++k) {
    const auto got = trace.points_of(trace.strokes[k]);
    REQUIRE(got.size() <= meant[k].size());
    double worst = 0;
    for (std::size_t i = 0; i < got.size(); ++i)
      worst = std::max(worst, distance(got[i], meant[k][i]));
    REQUIRE(worst <= 1e-9);
    ++cut.begun;
    if (got.size() == meant[k].size()) ++cut.whole;
  }
  return cut;
}

}  // namespace

TEST_CASE("after any simulated fault the ledger is true and nothing is cut twice",
          "[device][session]") {
  std::size_t failed = 0;
  std::size_t finished = 0;
  const auto seeds = static_cast<std::uint32_t>(testing::rounds(400));
  for (const char* name : {"cameo3", "cameo", "hpgl-generic"}) {
    Machine target = machine(name);
    target.buffer_bytes = 600;  // small, so that back-pressure and the buffer rule matter
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      const SimJob job(target, random, 60, 300);
      const Toolpath& path = job.path;
      const EncodedProgram& program = job.program;
      std::vector<std::vector<PagePoint>> meant;
      std::vector<std::size_t> sent_as;  // the program's strokes that are not dots
      for (std::size_t k = 0; k < path.strokes.size(); ++k) {
        auto line = on_grid(path.points_of(path.strokes[k]), target.unit_mm);
        if (line.size() < 2) continue;
        meant.push_back(std::move(line));
        sent_as.push_back(k);
      }
      std::vector<SimFault> faults = random_faults(seed, 1 + seed % 2, program.bytes.size());
      // Nobody can see what a machine that answers nothing has thrown away.
      if (target.language == "hpgl")
        std::erase_if(faults, [](const SimFault& f) { return f.kind == SimFault::Kind::Cancel; });
      std::string what;
      for (const SimFault& fault : faults)
        what += fmt::format("{} at byte {} path {} for {} s; ", name_of(fault.kind), fault.at_byte,
                            fault.at_path.value_or(0), fault.seconds);
      CAPTURE(what);
      SimTransport cable = job.cable(faults);
      SessionOptions options;
      std::atomic<bool> stop{false};
      if (seed % 5 == 0) {  // a host that gives up somewhere on the way
        options.cancel = &stop;
        const std::size_t at = std::uniform_int_distribution<std::size_t>(0, 60)(random);
        options.progress = [&stop, at](const SessionProgress& p) {
          if (p.strokes_done >= at) stop = true;
        };
      }
      std::atomic<bool> hold{false};
      if (seed % 7 == 0) {  // and one that pauses for a while
        options.pause = &hold;
        const std::size_t at = std::uniform_int_distribution<std::size_t>(0, 40)(random);
        options.progress = [&, at](const SessionProgress& p) {
          hold = p.strokes_done >= at && cable.now() < std::chrono::seconds(60);
        };
      }
      const SessionEnd end = run_session(cable, target, program, options);
      INFO((end.error ? message(*end.error) : std::string("done")));
      REQUIRE(end.fates.size() == path.strokes.size());
      ++(end.error ? failed : finished);
      const CutStrokes now = compare(cable.cutter().trace(), meant);
      cable.cutter().load_media();
      cable.cutter().resume();
      cable.cutter().run_dry();
      const CutStrokes later = compare(cable.cutter().trace(), meant);
      for (std::size_t i = 0; i < meant.size(); ++i) {
        const StrokeFate fate = end.fates[sent_as[i]];
        CAPTURE(i);
        if (fate == StrokeFate::Certain && !(i < now.whole)) FAIL("certain, but not cut");
        if (fate == StrokeFate::NotSent && !(i >= later.begun)) FAIL("not sent, but cut");
        if (!end.error && !end.cancelled && end.confirmed && fate != StrokeFate::Certain)
          FAIL("the job is done, but a stroke is not certain");
      }
    }
  }
  CAPTURE(failed, finished);
  CHECK(failed > seeds / 2);
  CHECK(finished > seeds / 2);
}

TEST_CASE("no bytes make the simulated cutter crash or hang or draw anything else",
          "[device][sim]") {
  const std::string letters = "MDOEHJLZFXCETGBSUWPK!\\&[0123456789,.-+ ;\x03\x1b\x04\x05\n";
  for (const char* name : {"cameo3", "cameo", "hpgl-generic"}) {
    Machine target = machine(name);
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      target.buffer_bytes = std::uniform_int_distribution<std::uint32_t>(1, 200)(random);
      std::string program;
      const int length = std::uniform_int_distribution<int>(1, 3000)(random);
      const bool any = seed % 4 == 0;
      for (int k = 0; k < length; ++k)
        program += any ? static_cast<char>(std::uniform_int_distribution<int>(0, 255)(random))
                       : letters[random() % letters.size()];
      const auto trace = simulate(bytes(program), target);
      if (!trace) {
        CHECK(trace.error().kind == ErrorKind::Malformed);
        continue;
      }
      CHECK(std::isfinite(trace->seconds));
      CHECK(trace->clipped_mm <= trace->cut_mm * (1 + 1e-9) + 1e-9);
      std::size_t points = 0;
      for (const TraceStroke& stroke : trace->strokes) points += stroke.count;
      CHECK(points == trace->points.size());
      CHECK_FALSE(trace_svg(*trace).empty());
      CHECK(trace_json(*trace).back() == '\n');
    }
  }
}

}  // namespace device_test
