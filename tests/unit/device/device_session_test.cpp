// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <functional>

#include <catch2/catch.hpp>

#include "device/session/schedule.hpp"
#include "device/session/session.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_session_test {

using namespace popcut;
using namespace popcut::testing;
using std::chrono::nanoseconds;

namespace {

/// A cable on which each write and each reply is as the test says. Time passes only by waiting.
class ScriptedTransport final : public Transport {
 public:
  std::string received;                  ///< all bytes taken, queries too
  std::vector<std::size_t> write_sizes;  ///< what each write took
  /// Bytes that the next write takes, and its error; everything by default.
  std::function<WriteEnd(std::span<const std::byte>)> on_write;
  /// The reply to ESC ENQ; none is silence.
  std::function<std::optional<std::string>()> on_enquiry = [] { return std::string("0\x03"); };
  std::string identity{"CAMEO 3 V1.60    \x03"};
  std::string pending;

  WriteEnd write(std::span<const std::byte> bytes, Deadline until) override {
    WriteEnd end = on_write ? on_write(bytes) : WriteEnd{bytes.size(), std::nullopt};
    if (end.error && end.error->kind == ErrorKind::Timeout) now_ = std::max(now_, until);
    for (const std::byte byte : bytes.first(end.taken)) received += static_cast<char>(byte);
    write_sizes.push_back(end.taken);
    if (end.taken == 0) return end;
    const std::string_view all = received;
    if (all.substr(std::max<std::size_t>(all.size(), 2) - 2) == "\x1b\x05") {
      if (const auto reply = on_enquiry()) pending += *reply;
    } else if (all.substr(std::max<std::size_t>(all.size(), 3) - 3) == "FG\x03") {
      pending += identity;
    }
    return end;
  }
  Result<std::vector<std::byte>> read(Deadline until) override {
    if (pending.empty()) {
      now_ = std::max(now_, until);
      return fail(ErrorKind::Timeout, "", "nothing");
    }
    std::vector<std::byte> bytes;
    for (const char c : pending) bytes.push_back(static_cast<std::byte>(c));
    pending.clear();
    return bytes;
  }
  nanoseconds now() const override { return now_; }
  void wait(nanoseconds duration) override { now_ += duration; }

  /// What was received without the queries.
  [[nodiscard]] std::string program() const {
    std::string text = received;
    for (const std::string_view query : {kStatusQuery, kIdentityQuery, kWindowQuery})
      for (std::size_t at = text.find(query); at != std::string::npos; at = text.find(query, at))
        text.erase(at, query.size());
    return text;
  }

 private:
  nanoseconds now_{};
};

struct Bench : SimJob {
  explicit Bench(std::size_t strokes = 40, std::uint32_t seed = 7)
      : Bench(strokes, std::mt19937(seed)) {}

 private:
  Bench(std::size_t strokes, std::mt19937 random)
      : SimJob(testing::machine("cameo3"), random, strokes) {
    REQUIRE(program.dots.empty());
  }
};

ErrorKind kind(const SessionEnd& end) {
  REQUIRE(end.error);
  INFO(end.error->detail);
  return end.error->kind;
}

Transport::WriteEnd timed_out(std::size_t taken) {
  return {taken, Error{ErrorKind::Timeout, "", "busy"}};
}

}  // namespace

TEST_CASE("a session ends when the machine has drained and reports ready", "[device][session]") {
  const Bench bench;
  SimTransport cable = bench.cable();
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  REQUIRE_FALSE(end.error);
  CHECK(end.confirmed);
  CHECK(end.identity == "CAMEO 3 V1.60    ");
  CHECK(count(end, StrokeFate::Certain) == 40);
  CHECK(cable.cutter().status() == DeviceStatus::Ready);
  CHECK(cable.cutter().trace().strokes.size() == 40);
  CHECK(cable.cutter().position() == PagePoint{0, 0});
  CHECK(end.seconds > cable.cutter().trace().seconds);
}

TEST_CASE("no query is sent inside a command and nothing is sent twice", "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  int asked = 0;
  cable.on_enquiry = [&] { return std::string(++asked % 7 == 0 ? "1\x03" : "0\x03"); };
  // Takes one to five bytes, with and without a time-out.
  std::mt19937 random(3);
  cable.on_write = [&](std::span<const std::byte> bytes) -> Transport::WriteEnd {
    const std::size_t most = std::uniform_int_distribution<std::size_t>(0, 5)(random);
    const std::size_t taken = std::min(most, bytes.size());
    if (taken < bytes.size() && taken % 2 == 0) return timed_out(taken);
    return {taken, std::nullopt};
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  INFO((end.error ? end.error->detail : std::string()));
  REQUIRE_FALSE(end.error);
  CHECK(without_lifts(cable.program(), bench.program) == bench.program.bytes);
  GpglReader reader;
  Program into;
  for (const char c : cable.received) {
    if (c == '\x1b') CHECK_FALSE(reader.in_command());
    reader.feed(bytes(std::string_view(&c, 1)), into);
  }
}

TEST_CASE("settings are sent before any motion and the trailer after all of it",
          "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  const EncodedProgram& program = bench.program;
  // Busy for a while after the settings and after the geometry.
  std::string at_ready;
  int busy = 0;
  std::size_t seen = 0;
  cable.on_enquiry = [&] {
    const std::size_t now = cable.program().size();
    if (now != seen && (now == program.geometry.begin || now == program.geometry.end)) {
      seen = now;
      busy = 5;
    }
    return std::string(busy-- > 0 ? "1\x03" : "0\x03");
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  REQUIRE_FALSE(end.error);
  CHECK(busy < 0);
  CHECK(without_lifts(cable.program(), program) == program.bytes);
  const std::size_t setup = cable.received.find(program.bytes.substr(0, program.geometry.begin));
  CHECK(setup != std::string::npos);  // back to back: no query between the blocks
}

TEST_CASE("without media the session is refused before anything is sent", "[device][session]") {
  const Bench bench;
  SimOptions empty;
  empty.media = false;
  SimTransport cable(cutter(bench.machine, empty));
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Refused);
  CHECK(end.error->detail.find("load a sheet") != std::string::npos);
  CHECK(count(end, StrokeFate::NotSent) == 40);
  CHECK(cable.cutter().trace().settings.empty());
}

TEST_CASE("a single stray reply of no media does not end a cut", "[device][session]") {
  // Recorded: a single 2 between 1s in the middle of a cut (Portrait V1.00).
  const Bench bench;
  ScriptedTransport cable;
  int asked = 0;
  cable.on_enquiry = [&] {
    ++asked;
    return std::string(asked == 6 ? "2\x03" : "0\x03");
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK_FALSE(end.error);
  CHECK(asked > 10);
}

TEST_CASE("when the sheet comes out the session stops sending", "[device][session]") {
  const Bench bench;
  SimTransport cable =
      bench.cable({{bench.program.geometry.begin + 200, SimFault::Kind::MediaOut}});
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Refused);
  CHECK(end.error->detail.find("sheet came out") != std::string::npos);
  CHECK(end.error->reason == ErrorReason::NoMedia);
  CHECK(count(end, StrokeFate::NotSent) > 0);
}

TEST_CASE("a pause on the panel is waited out and reported", "[device][session]") {
  const Bench bench;
  SimTransport cable =
      bench.cable({{bench.program.geometry.begin + 200, SimFault::Kind::Pause, 60}});
  SessionOptions options;
  int paused = 0;
  options.progress = [&](const SessionProgress& p) { paused += p.phase == SessionPhase::Paused; };
  const SessionEnd end = run_session(cable, bench.machine, bench.program, options);
  REQUIRE_FALSE(end.error);
  CHECK(paused > 100);
  CHECK(end.seconds > 60);
  CHECK(cable.cutter().trace().strokes.size() == 40);

  SimTransport forgotten =
      bench.cable({{bench.program.geometry.begin + 200, SimFault::Kind::Pause, 0}});
  SessionOptions impatient;
  impatient.pause_limit_s = 100;
  const SessionEnd given_up = run_session(forgotten, bench.machine, bench.program, impatient);
  CHECK(kind(given_up) == ErrorKind::Refused);
  CHECK(given_up.error->reason == ErrorReason::PanelStop);
  CHECK(given_up.seconds < 200);
}

TEST_CASE("a cancel on the panel stops the sending within a second", "[device][session]") {
  const Bench bench;
  const std::uint64_t at = bench.program.geometry.begin + 300;
  SimTransport cable = bench.cable({{at, SimFault::Kind::Cancel, 2}});
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Refused);
  CHECK(end.error->detail.find("cancelled on the machine's panel") != std::string::npos);
  CHECK(end.error->reason == ErrorReason::PanelStop);
  const std::size_t cut = cable.cutter().trace().strokes.size();
  CHECK(count(end, StrokeFate::Certain) <= cut);
  CHECK(count(end, StrokeFate::NotSent) > 20);
  CHECK(cable.cutter().accepted_bytes() < at + 200);
  cable.cutter().run_dry();
  CHECK(cable.cutter().trace().strokes.size() == cut);
}

TEST_CASE("a cancel that ended before it was noticed does not count as done", "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  int asked = 0;
  cable.on_enquiry = [&] {
    ++asked;
    // Ready for the connection and the settings, busy while cutting, paused, and ready at once.
    if (cable.program().size() <= bench.program.geometry.begin) return std::string("0\x03");
    return std::string(asked < 12 ? "1\x03" : asked < 14 ? "3\x03" : "0\x03");
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Refused);
  CHECK(count(end, StrokeFate::Certain) == 0);
  CHECK(count(end, StrokeFate::InDoubt) > 0);
}

TEST_CASE("missing and invalid and contradictory replies each have their own error",
          "[device][session]") {
  const Bench bench;
  const auto run = [&](const std::function<std::optional<std::string>(int)>& reply) {
    ScriptedTransport cable;
    int asked = 0;
    cable.on_enquiry = [&] { return reply(++asked); };
    return run_session(cable, bench.machine, bench.program);
  };
  const SessionEnd silent = run([](int) { return std::nullopt; });
  CHECK(kind(silent) == ErrorKind::Timeout);
  CHECK(count(silent, StrokeFate::NotSent) == 40);
  const SessionEnd noise =
      run([](int) { return std::string("hello\x1b panel media stalled\x03"); });
  CHECK(kind(noise) == ErrorKind::Refused);
  CHECK(noise.error->detail.find("hello\\x1b panel media stalled") != std::string::npos);
  CHECK(noise.error->reason == ErrorReason::None);
  const SessionEnd blank = run([](int) { return std::string("  \x03"); });
  CHECK(kind(blank) == ErrorKind::Refused);
  const SessionEnd endless = run([](int) { return std::string(5000, '0'); });
  CHECK(kind(endless) == ErrorKind::Refused);
  const SessionEnd torn = run([](int n) { return std::string(n % 2 == 0 ? "0\x03" : "2\x03"); });
  CHECK(kind(torn) == ErrorKind::Refused);
  // One of each on the way does no harm.
  CHECK_FALSE(run([](int n) -> std::optional<std::string> {
                if (n == 5) return std::nullopt;
                return std::string(n == 8 ? "x\x03" : "0\x03");
              }).error);
}

TEST_CASE("unsolicited bytes are never taken for an answer", "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  int asked = 0;
  bool done = false;
  cable.on_enquiry = [&] {
    ++asked;
    done = asked > 40;
    return std::string(cable.program().size() <= bench.program.geometry.begin || done ? "0\x03"
                                                                                      : "1\x03");
  };
  // A stale 0 arrives with every piece of the program.
  cable.on_write = [&](std::span<const std::byte> bytes) -> Transport::WriteEnd {
    if (bytes.size() > 3) cable.pending += "0\x03";
    return {bytes.size(), std::nullopt};
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  INFO((end.error ? end.error->detail : std::string()));
  CHECK_FALSE(end.error);
  CHECK(done);
}

TEST_CASE("another model than the expected one is refused", "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  cable.identity = "Portrait V1.00    \x03";
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Refused);
  CHECK(end.error->detail.find("Portrait") != std::string::npos);
  CHECK(cable.program().empty());
  cable = {};
  cable.identity = "CAMEO 3 V9.99    \x03";  // another firmware is welcome
  CHECK_FALSE(run_session(cable, bench.machine, bench.program).error);
}

TEST_CASE("an unplugged cutter ends the session with what is in doubt", "[device][session]") {
  const Bench bench;
  const std::uint64_t at = bench.program.geometry.begin + 400;
  SimTransport cable = bench.cable({{at, SimFault::Kind::Unplug}});
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::DeviceGone);
  CHECK(count(end, StrokeFate::InDoubt) > 0);
  CHECK(count(end, StrokeFate::NotSent) > 0);
  CHECK_FALSE(end.confirmed);
}

TEST_CASE("a machine that takes no data times out and can be cancelled at once",
          "[device][session]") {
  const Bench bench;
  const std::uint64_t at = bench.program.geometry.begin + 150;
  SimTransport stuck = bench.cable({{at, SimFault::Kind::Nak, 1e6}});
  const SessionEnd end = run_session(stuck, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Timeout);
  CHECK(end.seconds < 300);

  SimTransport again = bench.cable({{at, SimFault::Kind::Nak, 1e6}});
  std::atomic<bool> stop{false};
  nanoseconds asked{};
  SessionOptions options;
  options.cancel = &stop;
  options.progress = [&](const SessionProgress&) {
    if (stop || again.now() < std::chrono::seconds(60)) return;
    stop = true;
    asked = again.now();
  };
  const SessionEnd cancelled = run_session(again, bench.machine, bench.program, options);
  CHECK(kind(cancelled) == ErrorKind::Refused);
  CHECK(cancelled.cancelled);
  CHECK(again.now() - asked < std::chrono::milliseconds(1300));
}

TEST_CASE("a machine that never becomes ready times out", "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  int asked = 0;
  cable.on_enquiry = [&] { return std::string(++asked < 3 ? "0\x03" : "1\x03"); };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK(kind(end) == ErrorKind::Timeout);
  CHECK(end.seconds < 400);
}

TEST_CASE("a cancel from the host ends at the end of a stroke with the tool parked",
          "[device][session]") {
  const Bench bench(200);
  SimTransport cable = bench.cable();
  std::atomic<bool> stop{false};
  nanoseconds asked{};
  SessionOptions options;
  options.cancel = &stop;
  options.progress = [&](const SessionProgress& p) {
    if (stop || p.strokes_done < 20) return;
    stop = true;
    asked = cable.now();
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program, options);
  REQUIRE_FALSE(end.error);
  CHECK(end.cancelled);
  const Trace& trace = cable.cutter().trace();
  const std::size_t cut = trace.strokes.size();
  CHECK(count(end, StrokeFate::Certain) == cut);
  CHECK(count(end, StrokeFate::InDoubt) == 0);
  CHECK(cut >= 20);
  CHECK(cut < 60);
  for (std::size_t k = 0; k < cut; ++k) CHECK(trace.strokes[k].count >= 2);
  CHECK_FALSE(cable.cutter().tool_down());
  CHECK(cable.cutter().position() == PagePoint{0, 0});
  // A window of 2 s, one stroke, the way home.
  CHECK(cable.now() - asked < std::chrono::seconds(25));
}

TEST_CASE("at most one window of motion is sent ahead and the machine never starves",
          "[device][session]") {
  const Bench bench(150);
  SimTransport cable = bench.cable();
  SessionOptions options;
  std::uint64_t most = 0;
  options.progress = [&](const SessionProgress& p) {
    if (p.phase == SessionPhase::Cutting)
      most = std::max(most, cable.cutter().accepted_bytes() - cable.cutter().executed_bytes());
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program, options);
  REQUIRE_FALSE(end.error);
  CHECK(most > 0);
  CHECK(most < 300);  // of several thousand bytes
  CHECK(bench.program.bytes.size() > 3000);
  CHECK(cable.cutter().trace().starved_s < 0.05);
}

TEST_CASE("a session works with a machine slower or faster than its model", "[device][session]") {
  const Bench bench;
  for (const double factor : {0.3, 3.0}) {
    Machine real = bench.machine;
    real.motion.travel_mm_s *= factor;
    real.speed_mm_s.per_step *= factor;
    SimTransport cable(cutter(real));
    const SessionEnd end = run_session(cable, bench.machine, bench.program);
    CAPTURE(factor);
    CHECK_FALSE(end.error);
    CHECK(count(end, StrokeFate::Certain) == 40);
    CHECK(cable.cutter().trace().strokes.size() == 40);
  }
}

TEST_CASE("a machine that answers nothing is paced by its model and never reported as certain",
          "[device][session]") {
  std::mt19937 random(5);
  const SimJob job(machine("hpgl-generic"), random, 40, 300);
  SimTransport cable = job.cable();
  const SessionEnd end = run_session(cable, job.machine, job.program);
  REQUIRE_FALSE(end.error);
  CHECK_FALSE(end.confirmed);
  CHECK(count(end, StrokeFate::Certain) == 0);  // the whole job fits its buffer
  CHECK(count(end, StrokeFate::NotSent) == 0);
  CHECK(cable.cutter().trace().strokes.size() == 40);
}

TEST_CASE("the ledger follows its rule", "[device][session]") {
  const ByteRange stroke{100, 200};
  constexpr std::uint64_t kBuffer = 1000;
  CHECK(fate_of(stroke, 0, 0, 100, kBuffer) == StrokeFate::NotSent);
  CHECK(fate_of(stroke, 0, 0, 101, kBuffer) == StrokeFate::InDoubt);
  CHECK(fate_of(stroke, 0, 200, 200, kBuffer) == StrokeFate::InDoubt);
  CHECK(fate_of(stroke, 199, 199, 200, kBuffer) == StrokeFate::InDoubt);
  CHECK(fate_of(stroke, 200, 200, 200, kBuffer) == StrokeFate::Certain);
  CHECK(fate_of(stroke, 0, 1199, 5000, kBuffer) == StrokeFate::InDoubt);
  CHECK(fate_of(stroke, 0, 1200, 1200, kBuffer) == StrokeFate::Certain);
  CHECK(fate_of({100, 100}, 5000, 5000, 5000, kBuffer) == StrokeFate::NotSent);  // a dot
}

TEST_CASE("a schedule covers every command of the geometry in order", "[device][session]") {
  const Bench bench;
  const Schedule plan = value(schedule(bench.program, bench.machine, first_lines(bench.program)));
  CHECK(plan.setup_s > 9);  // the autoblade
  REQUIRE_FALSE(plan.geometry.empty());
  CHECK(plan.geometry.back().end_byte == bench.program.geometry.end);
  CHECK(plan.geometry.back().seconds == Approx(plan.geometry_s));
  CHECK(std::is_sorted(plan.geometry.begin(), plan.geometry.end(),
                       [](const TimedCommand& a, const TimedCommand& b) {
                         return a.end_byte < b.end_byte && a.seconds <= b.seconds;
                       }));
  for (const ByteRange& stroke : bench.program.strokes)
    CHECK(std::any_of(plan.geometry.begin(), plan.geometry.end(),
                      [&](const TimedCommand& c) { return c.end_byte == stroke.end; }));
}

TEST_CASE("a machine that says moving for ever after it parked has done the job",
          "[device][session]") {
  const Bench bench;
  ScriptedTransport cable;
  bool parks = false;
  const std::string trailer(bench.program.bytes.substr(bench.program.trailer.begin));
  cable.on_enquiry = [&]() -> std::optional<std::string> {
    parks = parks || cable.program().find(trailer) != std::string::npos;
    return parks ? "1\x03" : "0\x03";
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  CHECK_FALSE(end.error);
  CHECK(parks);
  CHECK(count(end, StrokeFate::Certain) == 40);
  REQUIRE(end.remarks.size() == 1);
  CHECK_THAT(end.remarks[0], Catch::Contains("still says that it moves"));
}

TEST_CASE("a machine that says moving for ever after its strokes is given up in minutes and parked",
          "[device][session]") {
  const Bench bench(400);
  SimTransport sure(cutter(at_pace(bench.machine, 1)));
  const double whole_s = run_session(sure, bench.machine, bench.program).seconds;
  ScriptedTransport cable;
  const ByteRange last = bench.program.strokes.back();
  const std::string last_stroke = bench.program.bytes.substr(last.begin, last.end - last.begin);
  cable.on_enquiry = [&]() -> std::optional<std::string> {
    const std::string sent = cable.program();
    return sent.size() > last_stroke.size() &&
                   sent.compare(sent.size() - last_stroke.size(), sent.npos, last_stroke) == 0
               ? "1\x03"
               : "0\x03";
  };
  const SessionEnd end = run_session(cable, bench.machine, bench.program);
  REQUIRE(end.error);
  CHECK(kind(end) == ErrorKind::Timeout);
  CHECK_THAT(end.error->detail, Catch::Contains("All was sent") && Catch::Contains("expected"));
  CHECK_FALSE(end.confirmed);
  CHECK(end.seconds < whole_s + 240);
  const std::string sent = cable.program();
  const std::string trailer(bench.program.bytes.substr(bench.program.trailer.begin));
  REQUIRE(sent.size() > trailer.size());
  CHECK(sent.substr(sent.size() - trailer.size()) == trailer);
  CHECK(count(end, StrokeFate::NotSent) == 0);
  CHECK(count(end, StrokeFate::InDoubt) > 0);
  CHECK(count(end, StrokeFate::InDoubt) < 60);
}

TEST_CASE("a program read from its bytes alone is divided as it was written",
          "[device][protocol][session]") {
  std::mt19937 random(11);
  for (const char* name : {"cameo3", "cameo4", "portrait", "hpgl-generic", "mh-721", "camm-1",
                           "stika-sv15", "vevor-cutter"})
    for (int round = 0; round < 10; ++round) {
      CAPTURE(name, round);
      const SimJob job(machine(name), random, 25, 200);
      const EncodedProgram& written = job.program;
      const EncodedProgram read = value(read_foreign(written.dialect, written.bytes));
      // A line's end after a command goes with either.
      const auto same = [&](std::uint64_t at, std::uint64_t end) {
        return at == end || (at + 1 == end && written.bytes[at] == '\n');
      };
      CHECK(same(read.geometry.end, written.geometry.end));
      CHECK(read.trailer.end == written.trailer.end);
      std::vector<std::uint64_t> ends;
      for (std::size_t k = 0; k < written.strokes.size(); ++k)
        if (written.strokes[k].begin != written.strokes[k].end)
          ends.push_back(written.strokes[k].end);
      REQUIRE(read.strokes.size() == ends.size());
      for (std::size_t k = 0; k < ends.size(); ++k) CHECK(same(read.strokes[k].end, ends[k]));
      SimTransport cable = job.cable();
      const SessionEnd end = run_session(cable, job.machine, read);
      CHECK_FALSE(end.error);
      CHECK(cable.cutter().trace().strokes.size() == ends.size());
    }
}

TEST_CASE("a foreign program that cannot be read or stopped is refused with its byte",
          "[device][protocol]") {
  const auto error = [](Dialect dialect, const std::string& bytes) {
    const auto read = read_foreign(dialect, bytes);
    return read ? std::string("accepted") : message(read.error());
  };
  CHECK(error(Dialect::Hpgl, "IN;SP1;PU100,100;PD200,100;PU0,0;") == "accepted");
  CHECK_THAT(error(Dialect::Hpgl, "IN;PU1,1;PD2,1;ZZ9;"), Catch::Contains("byte 16"));
  CHECK_THAT(error(Dialect::Hpgl, "IN;PU1,1;PD2,1;OI;"), Catch::Contains("asks the cutter"));
  CHECK_THAT(error(Dialect::Hpgl, "IN;PD2,1;"), Catch::Contains("before it has moved"));
  CHECK_THAT(error(Dialect::Hpgl, "IN;PU5,5;PR;PD2,1;PU3,3;PD4,4;"), Catch::Contains("relative"));
  CHECK_THAT(error(Dialect::Hpgl, "IN;PU5,5;"), Catch::Contains("draws no line"));
  CHECK_THAT(error(Dialect::Gpgl,
                   "M1,1\x03"
                   "D2,2\x03"
                   "FG\x03"),
             Catch::Contains("byte 11"));
  CHECK_THAT(error(Dialect::Gpgl,
                   "M1,1\x03"
                   "D2,2"),
             Catch::Contains("byte 6"));  // cut off
  CHECK_THAT(error(Dialect::Gpgl,
                   "TB50,0\x03"
                   "TB123,10,10,0,0\x03"
                   "M1,1\x03"
                   "D2,2\x03"),
             Catch::Contains("byte 8") && Catch::Contains("--marks"));
  CHECK_THAT(error(Dialect::Gpgl, ""), Catch::Contains("draws no line"));
  const auto with = [&](const std::string& command) {
    return error(Dialect::Gpgl, command +
                                    "M1,1\x03"
                                    "D2,2\x03"
                                    "M0,0\x03");
  };
  for (const char* plain : {"", "TB50,0\x03", "FN0\x03", "TB55,1\x03"})
    CHECK(with(plain) == "accepted");
  for (const char* lasting : {"FB\x03", "FB70\x03", "TB70\x03", "TB70,1\x03", "TB72\x03"})
    CHECK_THAT(with(lasting), Catch::Contains("byte 1") && Catch::Contains("calibration"));
  for (const char* turned : {"TB50,1\x03", "FN1\x03"})
    CHECK_THAT(with(turned), Catch::Contains("turns the sheet"));
  CHECK_THAT(with(std::string("\x1b\0\x01", 3)), Catch::Contains("moves the tool as a key does"));
}

TEST_CASE("a foreign program that ends with the tool down gets a lift", "[device][protocol]") {
  const auto read = [](Dialect dialect, const std::string& bytes) {
    const EncodedProgram program = value(read_foreign(dialect, bytes));
    CHECK(program.trailer.end == program.bytes.size());
    return program.bytes;
  };
  const std::string line =
      "M1,1\x03"
      "D2,2\x03";
  CHECK(read(Dialect::Gpgl, line) == line + "M2,2\x03");
  CHECK(read(Dialect::Gpgl, line + "SO0\x03") == line + "M2,2\x03SO0\x03");
  CHECK(read(Dialect::Gpgl, line + "H\x03") == line + "H\x03");
  CHECK(read(Dialect::Hpgl, "IN;PU1,1;PD2,1;") == "IN;PU1,1;PD2,1;PU;");
  CHECK(read(Dialect::Hpgl, "IN;U1,1;D2,1;SP0;") == "IN;U1,1;D2,1;U;SP0;");
  CHECK(read(Dialect::Hpgl, "IN;PU1,1;PD2,1;PU;") == "IN;PU1,1;PD2,1;PU;");
}

}  // namespace device_session_test
