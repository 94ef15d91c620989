// SPDX-License-Identifier: MIT
// A machine that is not as its row says, and what a person with a ruler makes of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/calibrate/measured.hpp"
#include "core/machines/motion.hpp"
#include "device/session/session.hpp"
#include "tests/support/sim_bench.hpp"

namespace calibrate_test {

using namespace popcut;
using namespace popcut::testing;
using namespace popcut::calibrate;

namespace {

constexpr std::array<double, 2> kPage{210, 297};

struct Cut {
  SessionEnd end;
  Trace trace;
};

/// Cuts a path on `real`, as `assumed` writes it.
Cut cut_on(const Machine& real, const Machine& assumed, const Toolpath& path, bool timed = false) {
  JobOptions options{.page_width_mm = kPage[0], .page_length_mm = kPage[1]};
  options.autoblade = false;
  const auto program = value(encode(path, assumed, value(find_material("paper-220")), options));
  SimOptions sheet;
  sheet.page_width_mm = kPage[0];
  sheet.page_length_mm = kPage[1];
  SimTransport cable(cutter(real, sheet));
  SessionOptions how;
  how.poll_s = 0.1;
  how.timed = timed;
  SessionEnd end = run_session(cable, assumed, program, how);
  return {std::move(end), cable.cutter().trace()};
}

double to_tenths(double mm) { return std::round(mm * 10) / 10; }

/// What a person reads from the sheet: the lines of an angle, in the order in which they were cut.
struct Seen {
  Way one_tick, two_ticks;
  Ruled ruled;
};

Way way_of(PagePoint from, PagePoint to) {
  if (std::abs(to.x - from.x) > std::abs(to.y - from.y))
    return to.x > from.x ? Way::Right : Way::Left;
  return to.y > from.y ? Way::Down : Way::Up;
}

Seen look_at(const Trace& trace) {
  REQUIRE(trace.strokes.size() == 5);
  const auto line = [&](std::size_t k) {
    const auto points = trace.points_of(trace.strokes[k]);
    return std::pair{points.front(), points.back()};
  };
  const auto [corner, right] = line(0);
  const auto [corner2, down] = line(2);
  return {way_of(corner, right),
          way_of(corner2, down),
          {to_tenths(distance(corner, right)), to_tenths(distance(corner2, down)),
           to_tenths(corner.x), to_tenths(corner.y)}};
}

/// A machine of the same kind whose every property is another.
Machine hidden_machine(Machine real) {
  real.built_in = false;
  real.name = "hidden";
  if (real.language == "hpgl") real.axes = Axes::CarriageFeed;
  real.margin_left_mm = 3.2;
  real.margin_top_mm = 1.7;
  real.scale_carriage = 1.004;
  real.scale_feed = 0.9965;
  real.speed_mm_s.per_step *= 0.8;
  Motion& m = real.motion;
  m.accel_mm_s2 *= 0.6;
  m.travel_mm_s *= 1.5;
  m.corner_mm *= 1.7;
  m.swivel_mm_s *= 0.7;
  m.drop_s *= 1.8;
  m.lift_s *= 1.8;
  m.setup_s = 2.5;
  m.trailer_s = 6;
  return real;
}

/// A job unlike the runs of the calibration.
Toolpath other_job() {
  Toolpath path;
  const auto add = [&](std::vector<PagePoint> points, double speed) {
    Stroke stroke;
    stroke.operation = Operation::Cut;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = static_cast<std::uint32_t>(points.size());
    stroke.line = static_cast<std::uint32_t>(path.strokes.size());
    stroke.force_gf = 70;
    stroke.speed_mm_s = speed;
    path.points.insert(path.points.end(), points.begin(), points.end());
    path.strokes.push_back(stroke);
  };
  for (int k = 0; k < 24; ++k) {
    const double x = 15 + 7.0 * (k % 20), y = 30 + 9.0 * k;
    add({{x, y}, {x + 30, y}, {x + 30, y + 4}, {x + 12, y + 7}, {x, y}}, 50);
    for (int i = 0; i < 4; ++i) add({{x + 6.0 * i, y + 8}, {x + 6.0 * i + 1.5, y + 8}}, 50);
  }
  add({{10, 10}, {200, 10}, {200, 287}, {10, 287}, {10, 10}}, 50);
  return path;
}

}  // namespace

TEST_CASE("a machine that is not as its row says is measured and then cuts where it should",
          "[calibrate]") {
  const std::string name = GENERATE("cameo3", "cameo5", "portrait", "hpgl-generic", "vevor-cutter");
  CAPTURE(name);
  const Machine listed = machine(name.c_str());
  const Machine real = hidden_machine(listed);
  const Material paper = value(find_material("paper-220"));
  const ToolSettings tool = paper.cut;
  const bool hpgl = listed.language == "hpgl";

  // Which way the lines run: exchanged axes show on the first sheet.
  Machine known = listed;
  const Seen first = look_at(cut_on(real, known, short_angle().path(tool)).trace);
  CHECK(first.one_tick == (hpgl ? Way::Up : Way::Right));
  CHECK(first.two_ticks == (hpgl ? Way::Right : Way::Down));
  known = value(with_ways(known, first.one_tick, first.two_ticks));
  CHECK(known.axes == real.axes);
  CHECK(known.mirrored == real.mirrored);

  // With a ruler that shows tenths.
  const Angle angle = value(long_angle(kPage));
  std::vector<std::string> remarks;
  const Seen ruled = look_at(cut_on(real, known, angle.path(tool)).trace);
  CHECK(ruled.one_tick == Way::Right);
  CHECK(ruled.two_ticks == Way::Down);
  known = value(with_ruled(known, angle, ruled.ruled, kPage[1], remarks));
  CHECK(remarks.empty());
  CHECK(known.scale_carriage == Approx(1.004).margin(0.0005));
  CHECK(known.scale_feed == Approx(0.9965).margin(0.0005));
  CHECK(known.margin_left_mm == Approx(3.2).margin(0.1));
  CHECK(known.margin_top_mm == Approx(1.7).margin(hpgl ? 0.25 : 0.1));

  // The second time the ruler shows what was sent.
  const Seen again = look_at(cut_on(real, known, angle.path(tool)).trace);
  CHECK(again.ruled.right_mm == Approx(angle.right_mm).margin(0.1001));
  CHECK(again.ruled.down_mm == Approx(angle.down_mm).margin(0.1001));
  CHECK(again.ruled.from_left_mm == Approx(20).margin(0.1001));
  CHECK(again.ruled.from_top_mm == Approx(20).margin(0.1001));

  // Times.
  const double offset = listed.firmware_blade_offset ? paper.blade_offset_mm : 0;
  const auto runs = value(timed_runs(known, tool, kPage));
  std::vector<Timing> timings;
  double setup_s = 0, trailer_s = 0;
  for (const TimedRun& run : runs) {
    const SessionEnd end = cut_on(real, known, run.path, true).end;
    REQUIRE(!end.error);
    // A machine that answers is timed by the session; another one with a watch.
    timings.push_back({&run, hpgl ? run_seconds(run, real, offset) : end.geometry_s});
    setup_s = end.setup_s;
    trailer_s = end.trailer_s;
  }
  if (hpgl && known.speed_mm_s.per_step > 0)
    for (Timing& timing : timings) {
      TimedRun slower = *timing.run;
      for (Stroke& stroke : slower.path.strokes) stroke.speed_mm_s *= 0.8;
      timing.seconds = std::round(10 * run_seconds(slower, real, offset)) / 10;
    }
  const auto fitted = value(fit_motion(known, timings, offset));
  INFO("worst " << fitted.worst << ", checked " << fitted.checked);
  CHECK(fitted.checked < 0.05);
  known = fitted.machine;
  if (!hpgl) {
    CHECK(setup_s == Approx(2.5).margin(0.5));
    known.motion.setup_s = setup_s;
    known.motion.trailer_s = parking_seconds(runs.back(), trailer_s, known);
    CHECK(known.motion.trailer_s == Approx(6).margin(0.6));
  }

  // Another job: cut lines within 0.1 mm, time within 5 %.
  known.calibrated = "2026-11-24";
  const std::string table =
      value(table_with("", machine_row(known, listed, {true, true, true, false})));
  const Machine row = value(find_machine(known.name, {table}));
  CHECK(row.calibrated == "2026-11-24");
  const Toolpath job = other_job();
  const Cut done = cut_on(real, row, job);
  REQUIRE(!done.end.error);
  REQUIRE(done.trace.strokes.size() == job.strokes.size());
  CHECK(done.trace.clipped_mm == Approx(0).margin(0.01));
  double worst = 0;
  for (std::size_t k = 0; k < job.strokes.size(); ++k) {
    const auto meant = job.points_of(job.strokes[k]);
    const auto cut = done.trace.points_of(done.trace.strokes[k]);
    worst =
        std::max({worst, distance(meant.front(), cut.front()), distance(meant.back(), cut.back())});
  }
  CHECK(worst < 0.1 * std::sqrt(2.0) + 0.026);
  if (hpgl) return;
  const FirmwareSwivel swivel{offset, 0xFFFF};
  const double promised = row.motion.setup_s + row.motion.trailer_s +
                          strokes_seconds(job, row.motion, swivel) +
                          travel_seconds(distance({}, job.points.front()), row.motion) +
                          travel_seconds(distance({}, job.points.back()), row.motion);
  UNSCOPED_INFO(name << ": promised " << promised << " s, took " << done.end.seconds << " s");
  std::printf("calibrated %s: lines at most %.3f mm off; %.1f s promised, %.1f s taken\n",
              name.c_str(), worst, promised, done.end.seconds);
  CHECK(std::abs(promised / done.end.seconds - 1) < std::min(0.05, row.motion.spread + 1e-9));
}

}  // namespace calibrate_test
