// SPDX-License-Identifier: MIT
// Machines that are slower or faster than popcut's model of them.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <random>

#include <catch2/catch.hpp>

#include "device/session/pace.hpp"
#include "device/session/session.hpp"
#include "device/sim/simulate.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/sim_bench.hpp"

namespace session_pace_test {

using namespace popcut;
using namespace popcut::testing;
using std::chrono::nanoseconds;

namespace {

constexpr double kPaces[] = {0.5, 0.7, 1.0, 1.4, 2.0};
constexpr double kWindowS = 2;

/// Some minutes of strokes between 3 mm and 80 mm.
SimJob long_job(std::size_t strokes = 300) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(5, 185), length(3, 80), turn(0, 6.28);
  const Material paper = value(find_material("paper-220"));
  Toolpath path;
  for (std::size_t k = 0; k < strokes; ++k) {
    Stroke stroke;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = 3;
    stroke.line = static_cast<std::uint32_t>(k);
    stroke.tool = 1;
    stroke.force_gf = paper.cut.force_gf;
    stroke.speed_mm_s = paper.cut.speed_mm_s;
    PagePoint at{place(random), place(random)};
    for (int i = 0; i < 3; ++i) {
      path.points.push_back(at);
      const double way = length(random) / 2, angle = turn(random);
      at = {std::clamp(at.x + way * std::cos(angle), 1.0, 189.0),
            std::clamp(at.y + way * std::sin(angle), 1.0, 189.0)};
    }
    path.strokes.push_back(stroke);
  }
  return {machine("cameo3"), std::move(path)};
}

SimTransport cable_of(const SimJob& job, double pace, std::vector<SimFault> faults = {}) {
  return SimTransport(cutter(at_pace(job.machine, pace)), std::move(faults));
}

}  // namespace

TEST_CASE("a machine of any pace gets its whole job without a dry moment", "[device][session]") {
  const SimJob job = long_job();
  for (const double pace : kPaces) {
    CAPTURE(pace);
    SimTransport cable = cable_of(job, pace);
    const SessionEnd end = run_session(cable, job.machine, job.program);
    REQUIRE_FALSE(end.error);
    const Trace& trace = cable.cutter().trace();
    CHECK(trace.strokes.size() == 300);
    CHECK(trace.starved_s == 0.0);
    CHECK(count(end, StrokeFate::Certain) == 300);
    // What waiting for the machine costs: tenths of a second each 10 to 15 s.
    const double alone =
        value(simulate(std::as_bytes(std::span(job.program.bytes)), at_pace(job.machine, pace)))
            .seconds;
    CHECK(end.seconds < 1.05 * alone + 4);
    std::printf("pace %.1f: %.0f s, %.1f %% longer than without a host\n", pace, end.seconds,
                100 * (end.seconds / alone - 1));
  }
}

TEST_CASE("a stop takes effect within the window at any pace", "[device][session]") {
  const SimJob job = long_job();
  double worst_s = 0;
  for (const double pace : kPaces) {
    for (int moment = 0; moment < 12; ++moment) {
      CAPTURE(pace, moment);
      const bool cancel_it = moment % 2 == 0;  // else a pause
      SimTransport cable = cable_of(job, pace);
      std::atomic<bool> cancel{false}, pause{false};
      std::optional<double> asked, stroke_end, at_rest;
      std::size_t under_way = 0;
      SessionOptions options;
      options.cancel = &cancel;
      options.pause = &pause;
      options.poll_s = 0.05;  // a fine clock for the figures
      const double when = 1.1 + moment * moment * 1.3 / pace;
      std::optional<double> begun;
      options.progress = [&](const SessionProgress& p) {
        const double now = to_seconds(cable.now());
        const Trace& trace = cable.cutter().trace();
        if (p.phase == SessionPhase::Cutting && !begun) begun = now;
        if (begun && !asked && now > *begun + when) {
          (cancel_it ? cancel : pause) = true;
          asked = now;
          // On its way to a stroke, that stroke is under way: the machine has it already.
          under_way = trace.strokes.size() + (cable.cutter().tool_down() ? 0 : 1);
        }
        const std::size_t begun_now = trace.strokes.size();
        if (asked && !stroke_end &&
            (begun_now > under_way || (begun_now == under_way && !cable.cutter().tool_down())))
          stroke_end = now;
        const bool resting =
            !cable.cutter().tool_down() &&
            (cable.cutter().status() != DeviceStatus::Moving || p.phase == SessionPhase::Parking);
        if (asked && !stroke_end && resting && p.phase != SessionPhase::Cutting)
          stroke_end = asked;  // nothing was under way
        if (asked && stroke_end && !at_rest && resting && p.phase != SessionPhase::Cutting)
          at_rest = now;
        if (at_rest && pause) cancel = true;
      };
      const SessionEnd end = run_session(cable, job.machine, job.program, options);
      REQUIRE(end.cancelled);
      REQUIRE(at_rest);
      const double late = *at_rest - *stroke_end;
      worst_s = std::max(worst_s, late);
      CHECK(late <= kWindowS + 1);  // it may already have the next stroke, if that was due at once
      CHECK(cable.cutter().position() == PagePoint{0, 0});
      // All that was cut is in the ledger, and nothing else.
      const std::size_t cut = cable.cutter().trace().strokes.size();
      CHECK(count(end, StrokeFate::Certain) + count(end, StrokeFate::InDoubt) >= cut);
      CHECK(count(end, StrokeFate::Certain) <= cut);
    }
  }
  std::printf("stop at paces 0.5 to 2: tool up and at rest at most %.2f s after the stroke\n",
              worst_s);
}

TEST_CASE("an unplug leaves few strokes in doubt at any pace and names the likeliest",
          "[device][session]") {
  const SimJob job = long_job();
  double worst_s = 0;
  std::size_t far_off = 0, named = 0;
  for (const double pace : kPaces) {
    for (std::uint64_t moment = 0; moment < 12; ++moment) {
      CAPTURE(pace, moment);
      const std::uint64_t stroke = 12 + moment * 24;
      SimTransport cable = cable_of(job, pace, {{0, SimFault::Kind::Unplug, 0, "", stroke}});
      const SessionEnd end = run_session(cable, job.machine, job.program);
      REQUIRE(end.error);
      const std::size_t certain = count(end, StrokeFate::Certain);
      const std::size_t doubt = count(end, StrokeFate::InDoubt);
      CHECK(certain < stroke);
      CHECK(certain + doubt + 1 >= stroke);
      // How long the machine takes for those in doubt.
      Toolpath some;
      some.points = job.path.points;
      some.strokes.assign(job.path.strokes.begin() + static_cast<std::ptrdiff_t>(certain),
                          job.path.strokes.begin() + static_cast<std::ptrdiff_t>(certain + doubt));
      const SimJob in_doubt(job.machine, some);
      const auto bytes = std::as_bytes(std::span(in_doubt.program.bytes));
      const Machine real = at_pace(job.machine, pace);
      const double seconds = value(simulate(bytes, real)).seconds - real.motion.setup_s - 2;
      worst_s = std::max(worst_s, seconds);
      CHECK(seconds <= 20);
      if (!end.likely_stroke) continue;
      ++named;
      const auto likely = static_cast<std::int64_t>(*end.likely_stroke) + 1;
      far_off += std::abs(likely - static_cast<std::int64_t>(stroke)) > 2 ? 1u : 0u;
    }
  }
  CHECK(named >= 55);
  CHECK(far_off <= 6);
  std::printf(
      "unplug at paces 0.5 to 2: strokes of at most %.1f s in doubt; likeliest named in "
      "%zu of 60, more than two strokes off in %zu\n",
      worst_s, named, far_off);
}

TEST_CASE("no pause on the panel ends a job, and no cancel there goes unseen",
          "[device][session]") {
  const SimJob job = long_job(40);
  std::mt19937 random(23);
  std::uniform_real_distribution<double> length(0.001, 1.2);
  std::uniform_int_distribution<std::uint64_t> stroke(1, 40);
  int ended = 0, unseen = 0, asked = 0;
  const int all = rounds(250);
  for (int round = 0; round < all; ++round) {
    const double pace = kPaces[round % 5];
    for (const bool cancelled : {false, true}) {
      std::vector<SimFault> faults;
      for (int k = 0; k < (cancelled ? 1 : 4); ++k)
        faults.push_back({0, cancelled ? SimFault::Kind::Cancel : SimFault::Kind::Pause,
                          length(random), "", stroke(random)});
      SimTransport cable = cable_of(job, pace, faults);
      std::atomic<bool> pause{false}, cancel{false};
      SessionOptions options;
      options.pause = &pause;
      options.cancel = &cancel;
      options.ask = [&] {
        ++asked;
        if (cancelled) cancel = true;  // the person says what was done on the panel
      };
      const SessionEnd end = run_session(cable, job.machine, job.program, options);
      const std::size_t cut = cable.cutter().trace().strokes.size();
      if (cancelled)
        unseen += !end.error ? 1 : 0;
      else
        ended += end.error || cut != 40 ? 1 : 0;
    }
  }
  CHECK(ended == 0);
  CHECK(unseen == 0);
  std::printf(
      "%d pauses on the panel: %d ended a job; %d cancels: %d unseen; a person was asked "
      "%d times\n",
      4 * all, ended, all, unseen, asked);
}

TEST_CASE("the pace of a machine is found from two rests", "[device][session]") {
  Pace pace(true);
  const auto at = [](double s) { return to_time(s); };
  pace.start(at(0), 0);
  CHECK(pace.slow() <= 0.5);
  pace.advance(at(1), 10);
  CHECK(pace.least_s() <= 0.5);
  CHECK(pace.most_s() >= 2);
  CHECK(pace.sync_due());
  pace.rest(at(10), at(10), 7, false);  // 7 s of the model took 10 s
  CHECK(pace.rate() == Approx(0.7));
  CHECK(pace.slow() > 0.6);
  CHECK(pace.fast() < 0.8);
  CHECK_FALSE(pace.sync_due());
  pace.advance(at(12), 8);
  CHECK(pace.at_s() == 8.0);  // it stops where its data end
  pace.stand_still(at(100));
  pace.advance(at(101), 20);
  pace.rest(at(110), at(110), 20, false);
  CHECK(pace.rate() == Approx(0.7));  // a pause says nothing about its pace
  Pace exact(false);
  exact.start(at(0), 0);
  exact.advance(at(50), 100);
  CHECK(exact.least_s() == 50.0);
  CHECK(exact.most_s() == 50.0);
  CHECK_FALSE(exact.sync_due());
}

}  // namespace session_pace_test
