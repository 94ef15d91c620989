// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <cstdio>

#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "tests/support/sim_bench.hpp"

namespace session_hold_test {

using namespace popcut;
using namespace popcut::testing;
using std::chrono::nanoseconds;

namespace {

/// A job of short strokes to and fro, so that a window of motion holds several.
SimJob short_strokes(const char* name = "cameo3") {
  const Material paper = value(find_material("paper-220"));
  Toolpath path;
  for (int k = 0; k < 200; ++k) {
    Stroke stroke;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = 2;
    stroke.tool = 1;
    stroke.force_gf = paper.cut.force_gf;
    stroke.speed_mm_s = paper.cut.speed_mm_s;
    const int row = k / 20, column = row % 2 == 0 ? k % 20 : 19 - k % 20;
    const double x = 5 + column * 9.0, y = 5 + row * 9.0;
    path.points.push_back({x, y});
    path.points.push_back({x + 4, y + 1});
    path.strokes.push_back(stroke);
  }
  return {machine(name), std::move(path), 300};
}

/// A cable that notes when it last took more than a query.
class Watched final : public Transport {
 public:
  explicit Watched(SimTransport& cable) : cable_(cable) {}
  WriteEnd write(std::span<const std::byte> bytes, Deadline until) override {
    const WriteEnd end = cable_.write(bytes, until);
    if (end.taken > 3) last = cable_.now();
    return end;
  }
  Result<std::vector<std::byte>> read(Deadline until) override { return cable_.read(until); }
  nanoseconds now() const override { return cable_.now(); }
  void wait(nanoseconds duration) override { cable_.wait(duration); }

  nanoseconds last{};

 private:
  SimTransport& cable_;
};

}  // namespace

TEST_CASE("a pause from the host stops between strokes with the tool up and continues",
          "[device][session]") {
  for (const char* name : {"cameo3", "portrait", "hpgl-generic"}) {
    CAPTURE(name);
    const SimJob job = short_strokes(name);
    double worst_s = 0;
    for (int ask = 0; ask < 12; ++ask) {
      CAPTURE(ask);
      SimTransport cable = job.cable();
      std::atomic<bool> pause{false};
      std::optional<nanoseconds> asked, held;
      std::size_t strokes_held = 0;
      bool tool_up = true;
      SessionOptions options;
      options.poll_s = 0.05;  // a fine clock for the figure
      options.pause = &pause;
      options.progress = [&](const SessionProgress& p) {
        if (!asked && p.strokes_done >= 20 && to_seconds(cable.now()) > 12 + 0.37 * ask) {
          pause = true;
          asked = cable.now();
        }
        if (p.phase != SessionPhase::Held || cable.cutter().status() == DeviceStatus::Moving)
          return;
        if (!held) {
          held = cable.now();
          strokes_held = cable.cutter().trace().strokes.size();
        }
        tool_up = tool_up && !cable.cutter().tool_down();
        CHECK(cable.cutter().trace().strokes.size() == strokes_held);
        if (cable.now() > *held + std::chrono::seconds(30)) pause = false;
      };
      const SessionEnd end = run_session(cable, job.machine, job.program, options);
      REQUIRE_FALSE(end.error);
      REQUIRE(held);
      CHECK(tool_up);
      worst_s = std::max(worst_s, to_seconds(*held - *asked));
      // Then all of it is cut, once.
      const Trace& trace = cable.cutter().trace();
      CHECK(trace.strokes.size() == 200);
      CHECK(trace.cut_mm == Approx(200 * 4.123).epsilon(0.01));
      CHECK(trace.unknown.empty());
      if (name != std::string("hpgl-generic")) CHECK(count(end, StrokeFate::Certain) == 200);
    }
    CHECK(worst_s <= SessionOptions().window_s);
    std::printf("host pause on %s: at rest, tool up, at most %.2f s after it was asked\n", name,
                worst_s);
  }
}

TEST_CASE("a machine that needs a newline after each command gets its whole job",
          "[device][session]") {
  for (const char* name : {"hpgl-clone", "hpgl-ud", "camm-1", "camm-2"}) {
    CAPTURE(name);
    const SimJob job = short_strokes(name);
    SimTransport cable = job.cable();
    const SessionEnd end = run_session(cable, job.machine, job.program);
    REQUIRE_FALSE(end.error);
    cable.cutter().run_dry();
    CHECK(cable.cutter().trace().strokes.size() == 200);
    CHECK(cable.cutter().trace().unknown.empty());
    CHECK(cable.cutter().accepted_bytes() == job.program.bytes.size());
  }
}

TEST_CASE("the sheet comes out after a whole job and stays where a stopped one can go on",
          "[device][session]") {
  for (const char* name : {"cameo3", "portrait", "hpgl-generic", "camm-1", "stika-sv15"}) {
    CAPTURE(name);
    SimJob job = short_strokes(name);
    JobOptions out;
    out.page_length_mm = 300;
    out.feed_out_mm = 7;
    job.program = value(encode(job.path, job.machine, value(find_material("paper-220")), out));
    const EncodedProgram& program = job.program;
    REQUIRE(program.feed_out == ByteRange{program.trailer.end, program.bytes.size()});
    double first = 300, last = 0;  // along the feed of the page
    for (const PagePoint& p : job.path.points) {
      first = std::min(first, p.y);
      last = std::max(last, p.y);
    }
    for (const bool stop : {false, true}) {
      SimTransport cable = job.cable();
      std::atomic<bool> cancel{false};
      SessionOptions options;
      options.cancel = &cancel;
      options.progress = [&](const SessionProgress& p) {
        cancel = cancel || (stop && p.strokes_done >= 40);
      };
      const SessionEnd end = run_session(cable, job.machine, program, options);
      CHECK(end.cancelled == stop);
      cable.cutter().run_dry();
      const Trace& trace = cable.cutter().trace();
      CHECK((trace.strokes.size() == 200) != stop);
      CHECK(trace.unknown.empty());
      CHECK_FALSE(cable.cutter().tool_down());
      const PagePoint at = cable.cutter().position();
      // Where the axis counts up from the end of the page, that end is the first to come out.
      const double beyond = job.machine.feed_up() ? first - 7 : last + 7;
      if (stop)
        CHECK(std::abs(at.y - beyond) > 20);
      else
        CHECK(at.y == Approx(beyond).margin(0.06));
    }
  }
}

TEST_CASE("strokes before a pause of the host are certain during it and after a cancel",
          "[device][session]") {
  const SimJob job = short_strokes();
  SimTransport cable = job.cable();
  std::atomic<bool> pause{false}, cancel{false};
  SessionOptions options;
  options.pause = &pause;
  options.cancel = &cancel;
  options.progress = [&](const SessionProgress& p) {
    if (p.strokes_done >= 20) pause = true;
    if (p.phase == SessionPhase::Held && cable.cutter().status() == DeviceStatus::Ready)
      cancel = true;
  };
  const SessionEnd end = run_session(cable, job.machine, job.program, options);
  REQUIRE_FALSE(end.error);
  CHECK(end.cancelled);
  const std::size_t cut = cable.cutter().trace().strokes.size();
  CHECK(cut < 60);
  CHECK(count(end, StrokeFate::Certain) == cut);
  CHECK(count(end, StrokeFate::InDoubt) == 0);
  CHECK(cable.cutter().position() == PagePoint{0, 0});
}

TEST_CASE("each way to stop is obeyed within one window and the rest is never sent",
          "[device][session]") {
  const SimJob job = short_strokes();
  constexpr double kWindowS = 2;
  constexpr double kPollS = 0.5;
  using Kind = SimFault::Kind;
  // On the panel: no byte of the geometry is taken later than a poll after the button.
  for (const Kind kind : {Kind::Pause, Kind::Cancel, Kind::MediaOut}) {
    SimFault fault{.kind = kind, .seconds = kind == Kind::Cancel ? 1.0 : 0.0};
    fault.at_path = 30;
    SimTransport cable = job.cable({fault});
    Watched watched(cable);
    SessionOptions options;
    options.pause_limit_s = 20;
    options.poll_s = kPollS;
    const SessionEnd end = run_session(watched, job.machine, job.program, options);
    CAPTURE(static_cast<int>(kind));
    REQUIRE(end.error);
    CHECK(end.error->kind == ErrorKind::Refused);
    REQUIRE(cable.struck());
    const double late = std::max(0.0, to_seconds(watched.last - *cable.struck()));
    std::printf("%s: the last byte was sent at most %.2f s later, %zu of 200 strokes not sent\n",
                std::string(name_of(kind)).c_str(), late, count(end, StrokeFate::NotSent));
    CHECK(late <= kWindowS);
    CHECK(count(end, StrokeFate::NotSent) > 130);
    cable.cutter().load_media();
    cable.cutter().resume();
    cable.cutter().run_dry();
    CHECK(cable.cutter().trace().strokes.size() <= 200 - count(end, StrokeFate::NotSent));
  }
  double worst_s = 0;
  for (int ask = 0; ask < 12; ++ask) {
    CAPTURE(ask);
    SimTransport cable = job.cable();
    std::atomic<bool> cancel{false};
    nanoseconds asked{}, tool_stopped{};
    std::size_t strokes = 0;
    SessionOptions options;
    options.poll_s = 0.05;  // a fine clock for the figure
    options.cancel = &cancel;
    options.progress = [&](const SessionProgress& p) {
      if (!cancel && p.strokes_done >= 20 && to_seconds(cable.now()) > 12 + 0.37 * ask)
        cancel = true, asked = cable.now();
      const std::size_t cut = cable.cutter().trace().strokes.size();
      if (cut != strokes) tool_stopped = cable.now();
      strokes = cut;
    };
    const SessionEnd end = run_session(cable, job.machine, job.program, options);
    REQUIRE_FALSE(end.error);
    CHECK(end.cancelled);
    worst_s = std::max(worst_s, to_seconds(tool_stopped - asked));
    CHECK(count(end, StrokeFate::InDoubt) == 0);
    CHECK(count(end, StrokeFate::NotSent) > 100);
  }
  std::printf("host cancel: the last stroke ended at most %.2f s later\n", worst_s);
  CHECK(worst_s <= kWindowS);
}

}  // namespace session_hold_test
