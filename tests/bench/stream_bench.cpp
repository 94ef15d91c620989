// SPDX-License-Identifier: MIT
// A long program on its way to a cutter: how fast it is written, read and streamed, whether the
// cutter ever waits for bytes with the tool down, and what memory it takes.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "device/sim/sim_transport.hpp"
#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "tests/support/value.hpp"

namespace stream_bench {

using namespace popcut;

namespace {

/// Rows of waves with `segments` lines of `step_mm` in paths of 200 points.
Toolpath waves(std::size_t segments, double step_mm, const Material& material) {
  constexpr std::uint32_t kPoints = 200;
  Toolpath path;
  for (std::size_t done = 0; done < segments; done += kPoints - 1) {
    const auto row = static_cast<double>(path.strokes.size() % 1400);
    Stroke stroke;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = kPoints;
    stroke.force_gf = material.cut.force_gf;
    stroke.speed_mm_s = material.cut.speed_mm_s;
    for (std::uint32_t k = 0; k < kPoints; ++k)
      path.points.push_back({10 + k * step_mm, 10 + row * 0.2 + 2 * std::sin(k * step_mm / 5)});
    path.strokes.push_back(stroke);
  }
  return path;
}

double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Resident memory in MB.
double memory_mb() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  return 0;
}

/// A cutter that moves `factor` times as fast as its row of the table says.
Machine times_as_fast(Machine machine, double factor) {
  machine.motion.accel_mm_s2 *= factor * factor;  // all times shrink alike
  machine.motion.travel_mm_s *= factor;
  machine.motion.swivel_mm_s *= factor;
  machine.motion.drop_s /= factor;
  machine.motion.lift_s /= factor;
  machine.speed_mm_s.per_step *= factor;
  return machine;
}

}  // namespace

TEST_CASE("a million segments are written and streamed", "[bench]") {
  const Machine cameo = *find_machine("cameo3");
  const Material paper = *find_material("paper-220");
  constexpr std::size_t kSegments = 1'000'000;
  for (const double factor : {1.0, 10.0}) {
    // At ten times the speed the model knows of it: the window is in seconds of its own motion.
    const Machine machine = times_as_fast(cameo, factor);
    Toolpath path = waves(kSegments, 1.0, paper);
    for (Stroke& stroke : path.strokes) stroke.speed_mm_s *= factor;
    auto start = std::chrono::steady_clock::now();
    const auto program = testing::value(encode(path, machine, paper));
    const double encode_s = since(start);
    const double mb = static_cast<double>(program.bytes.size()) / 1e6;
    start = std::chrono::steady_clock::now();
    REQUIRE(decode(Dialect::Gpgl, program.view()));
    const double decode_s = since(start);
    std::printf("%.0f times the speed of a Cameo 3: %zu segments, %.1f MB\n", factor, kSegments,
                mb);
    std::printf("  encode %.2f s, %.1f MB/s; decode %.2f s, %.1f MB/s\n", encode_s, mb / encode_s,
                decode_s, mb / decode_s);
    auto sim = testing::value(SimCutter::make(machine));
    SimTransport cable(std::move(sim));
    SessionOptions options;
    double half_mb = 0, most_mb = 0;
    options.progress = [&](const SessionProgress& p) {
      if (p.strokes_done % 100 != 0) return;
      const double now_mb = memory_mb();
      if (p.strokes_done < p.strokes / 2) half_mb = std::max(half_mb, now_mb);
      most_mb = std::max(most_mb, now_mb);
    };
    start = std::chrono::steady_clock::now();
    const SessionEnd end = run_session(cable, machine, program, options);
    const double stream_s = since(start);
    INFO((end.error ? message(*end.error) : std::string()));
    REQUIRE_FALSE(end.error);
    const Trace& trace = cable.cutter().trace();
    std::printf(
        "  stream %.2f s, %.1f MB/s, for %.0f s of its own time; longest wait for bytes with "
        "the tool down %.3f s; memory %.0f MB at half, %.0f MB at most (the trace grows)\n",
        stream_s, mb / stream_s, end.seconds, trace.starved_s, half_mb, most_mb);
    CHECK(trace.strokes.size() == path.strokes.size());
    CHECK(trace.starved_s == 0.0);
  }
}

TEST_CASE("a cutter slower or faster than its model never runs dry", "[bench]") {
  const Machine cameo = *find_machine("cameo3");
  const Material paper = *find_material("paper-220");
  const Toolpath path = waves(40'000, 1.0, paper);
  const auto program = testing::value(encode(path, cameo, paper));
  std::printf("%zu strokes of 200 mm to a Cameo 3 that is not as its row of the table says\n",
              path.strokes.size());
  std::printf("  %5s %10s %12s %14s\n", "pace", "takes, s", "starved, s", "longer than alone");
  for (const double pace : {0.5, 0.7, 1.0, 1.4, 2.0}) {
    const Machine real = times_as_fast(cameo, pace);
    auto sim = testing::value(SimCutter::make(real));
    SimTransport cable(std::move(sim));
    const SessionEnd end = run_session(cable, cameo, program);
    REQUIRE_FALSE(end.error);
    const Trace& trace = cable.cutter().trace();
    SimOptions endless;
    endless.unlimited = true;
    auto whole = testing::value(SimCutter::make(real, endless));
    whole.accept(program.view());
    whole.run_dry();
    std::printf("  %5.1f %10.0f %12.3f %12.2f %%\n", pace, end.seconds, trace.starved_s,
                100 * (end.seconds / whole.trace().seconds - 1));
    CHECK(trace.strokes.size() == path.strokes.size());
    CHECK(trace.starved_s == 0.0);
  }
}

}  // namespace stream_bench
