// SPDX-License-Identifier: MIT
#include <cmath>

#include <catch2/catch.hpp>

#include "device/sim/simulate.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_sim_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

std::string ask(SimCutter& sim, std::string_view query) {
  sim.accept(bytes(query));
  return replies(sim);
}

/// The status, without letting time pass.
char status(const SimCutter& sim) {
  return static_cast<char>('0' + static_cast<int>(sim.status()));
}

void run_for(SimCutter& sim, double seconds) {
  sim.run_until(sim.now() + std::chrono::nanoseconds(std::llround(seconds * 1e9)));
}

constexpr const char* kLongLine =
    "M0,0\x03"
    "D6000,0\x03";  // 300 mm: seconds at any speed

}  // namespace

TEST_CASE("each query is answered byte by byte as recorded", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  CHECK(ask(sim, "\x1b\x05") == "0\x03");
  CHECK(ask(sim, "FG\x03") == "CAMEO 3 V1.60    \x03");
  CHECK(ask(sim, "TB71\x03") == "    0,    0\x03");
  CHECK(ask(sim, "FA\x03") == "    0,    0\x03");
  CHECK(ask(sim, "TC\x03") == "    0,    0\x03");
  CHECK(ask(sim, "[\x03") == "     0,     0\x03");
  CHECK(ask(sim, "FQ0\x03") == "   10\x03");
  CHECK(ask(sim, "FQ2\x03") == "   18\x03");
  CHECK(ask(sim, "G\x03") == "     0,     0,    10\x03");
  CHECK(ask(sim, "U\x03") == "  6096,  6096\x03");
}

TEST_CASE("limits and speed are returned as they were set", "[device][sim]") {
  SimCutter sim = cutter(machine("portrait"));
  CHECK(ask(sim, "FG\x03") == "Portrait V1.00    \x03");
  CHECK(ask(sim,
            "\\30,30\x03Z5558,4120\x03!3\x03"
            "FC9\x03")
            .empty());
  CHECK(ask(sim, "U\x03") == "  5558,  4120\x03");
  CHECK(ask(sim, "[\x03") == "    30,    30\x03");
  CHECK(ask(sim, "FQ0\x03") == "    3\x03");
  CHECK(ask(sim, "FQ2\x03") == "    9\x03");
  CHECK(ask(sim, "M100,300\x03G\x03") == "   100,   300,    10\x03");
  CHECK(ask(sim, "TC\x03").empty());
}

TEST_CASE("newer machines report the tools in their holders", "[device][sim]") {
  SimCutter two = cutter(machine("cameo4"));
  CHECK(ask(two, "\x1b\x15") == "2,0\x03");
  SimCutter one = cutter(machine("portrait3"));
  CHECK(ask(one, "\x1b\x15") == "2\x03");
  SimCutter none = cutter(machine("cameo3"));
  CHECK(ask(none, "\x1b\x15").empty());
}

TEST_CASE("ordinary commands are not answered", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  CHECK(ask(sim,
            "\x1b\x04TG1\x03"
            "FN0\x03TB50,0\x03J1\x03!5,1\x03"
            "FX10,1\x03M10,10\x03"
            "D20,20\x03L0\x03SO0\x03H\x03\x03")
            .empty());
}

TEST_CASE("a machine that speaks HPGL answers nothing", "[device][sim]") {
  SimCutter sim = cutter(machine("hpgl-generic"));
  CHECK(ask(sim, "IN;OI;OS;PU0,0;\x1b\x05").empty());
}

TEST_CASE("the status query is answered at once with the machine's state", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  CHECK(status(sim) == '0');
  sim.accept(bytes(kLongLine));
  CHECK(status(sim) == '1');
  sim.accept(bytes("\x1b\x05"));
  run_for(sim, 0.001);
  const auto reply = sim.take_replies();
  REQUIRE(reply.size() == 2);
  CHECK(static_cast<char>(reply[0]) == '1');
  sim.run_dry();
  CHECK(status(sim) == '0');
}

TEST_CASE("other queries wait until the commands before them are done", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  sim.accept(bytes(std::string(kLongLine) + "G\x03"));
  run_for(sim, 1);
  CHECK(sim.take_replies().empty());
  CHECK(replies(sim) == "  6000,     0,    10\x03");
}

TEST_CASE("a machine without media reports its name but keeps the order of its replies",
          "[device][sim]") {
  SimOptions empty;
  empty.media = false;
  SimCutter sim = cutter(machine("cameo3"), empty);
  sim.accept(bytes("FG\x03U\x03"));
  CHECK_THAT(replies(sim), Catch::StartsWith("CAMEO 3 V1.60    \x03"));
  sim.accept(
      bytes("M100,100\x03"
            "FA\x03"));
  CHECK(replies(sim).empty());  // what came before it waits for a sheet
  sim.load_media();
  CHECK(replies(sim) == "    0,    0\x03");
}

TEST_CASE("without media nothing moves until a sheet is loaded", "[device][sim]") {
  SimOptions empty;
  empty.media = false;
  SimCutter sim = cutter(machine("cameo3"), empty);
  CHECK(ask(sim, "\x1b\x05") == "2\x03");
  sim.accept(bytes(kLongLine));
  run_for(sim, 60);
  CHECK(sim.trace().strokes.empty());
  CHECK(status(sim) == '2');
  sim.load_media();
  CHECK(status(sim) == '1');
  sim.run_dry();
  CHECK(sim.trace().strokes.size() == 1);
}

TEST_CASE("a pause holds the tool after the current leg and a resume continues", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  sim.accept(
      bytes("M0,0\x03"
            "D2000,0\x03"
            "D4000,0\x03"
            "D6000,0\x03"));
  run_for(sim, 1.5);
  sim.pause();
  CHECK(status(sim) == '3');
  run_for(sim, 100);
  const double held = sim.trace().cut_mm;
  CHECK(held > 0);
  CHECK(held < 300);
  CHECK(ask(sim, "\x1b\x05") == "3\x03");
  sim.resume();
  CHECK(status(sim) == '1');
  sim.run_dry();
  CHECK(sim.trace().cut_mm == Approx(300));
  CHECK(sim.trace().strokes.size() == 1);
}

TEST_CASE("a cancel works only during a pause and discards the rest", "[device][sim]") {
  SimCutter sim = cutter(machine("cameo3"));
  sim.accept(bytes(std::string("Z4000,4000\x03") + kLongLine));
  run_for(sim, 2);
  sim.cancel();
  CHECK(status(sim) == '1');
  sim.pause();
  sim.cancel();
  CHECK(status(sim) == '4');
  const double held = sim.trace().cut_mm;
  sim.accept(
      bytes("M0,0\x03"
            "D100,100\x03"));  // lost: it is resetting itself
  CHECK(ask(sim, "\x1b\x05") == "4\x03");
  run_for(sim, 10);
  CHECK(status(sim) == '0');
  CHECK(sim.trace().cut_mm == held);
  CHECK(ask(sim, "U\x03") == "     0,     0\x03");  // settings are gone; the limits are nonsense
  sim.accept(
      bytes("M0,0\x03"
            "D100,0\x03"));
  sim.run_dry();
  CHECK(sim.trace().cut_mm == Approx(held + 5));
}

TEST_CASE("the buffer takes no more than its size and drains as the tool moves", "[device][sim]") {
  Machine small = machine("cameo3");
  small.buffer_bytes = 64;
  SimCutter sim = cutter(small);
  std::string program;
  for (int k = 0; k < 50; ++k) program += fmt::format("D{},0\x03", 100 * (k % 2 + 1));
  std::span<const std::byte> rest = bytes(program);
  CHECK(sim.accept(rest) == 64);
  CHECK(sim.accept(rest.subspan(64)) == 0);
  rest = rest.subspan(64);
  int waits = 0;
  while (!rest.empty()) {
    REQUIRE(sim.next_event());
    sim.run_until(*sim.next_event());
    const std::size_t taken = sim.accept(rest);
    CHECK(sim.accepted_bytes() - sim.executed_bytes() <= 64);
    rest = rest.subspan(taken);
    ++waits;
  }
  CHECK(waits > 20);
  sim.run_dry();
  CHECK(sim.executed_bytes() == program.size());
  CHECK(sim.trace().points.size() == 51);
}

TEST_CASE("a command without an end never blocks the buffer", "[device][sim]") {
  Machine small = machine("cameo3");
  small.buffer_bytes = 64;
  SimCutter sim = cutter(small);
  const std::string noise(1000, '#');
  std::size_t taken = 0;
  for (int k = 0; k < 100 && taken < noise.size(); ++k) {
    taken += sim.accept(bytes(noise).subspan(taken));
    run_for(sim, 0.1);
  }
  CHECK(taken == noise.size());
  sim.accept(
      bytes("\x03M0,0\x03"
            "D100,0\x03"));
  sim.run_dry();
  CHECK(sim.trace().cut_mm == Approx(5));
  CHECK(sim.trace().unknown_count == 1);
}

TEST_CASE("unknown commands are kept and counted and never executed", "[device][sim]") {
  const Trace trace = value(simulate(bytes("M0,0\x03QQ5,5\x03W100,100,50\x03"
                                           "D200,0\x03"
                                           "D1,"),
                                     machine("cameo3")));
  CHECK(trace.unknown_count == 3);
  REQUIRE(trace.unknown.size() == 3);
  CHECK(trace.unknown[0] == "QQ5,5");
  CHECK(trace.unknown[1] == "W100,100,50");
  CHECK(trace.cut_mm == Approx(10));
  const auto nothing =
      simulate(bytes("\x89PNG\r\n\x1a\n nothing of this is a program"), machine("cameo3"));
  REQUIRE_FALSE(nothing);
  CHECK(nothing.error().kind == ErrorKind::Malformed);
  CHECK(simulate({}, machine("cameo3")).error().kind == ErrorKind::Malformed);
}

TEST_CASE("force speed and tool are those sent for the holder in use", "[device][sim]") {
  const Trace trace = value(simulate(bytes("J1\x03!3,1\x03"
                                           "FX10,1\x03!7,2\x03"
                                           "FX20,2\x03M0,0\x03"
                                           "D100,0\x03J2\x03M0,100\x03"
                                           "D100,100\x03"
                                           "FX99,2\x03M0,200\x03"
                                           "D100,200\x03J5\x03"),
                                     machine("cameo3")));
  REQUIRE(trace.strokes.size() == 3);
  CHECK(trace.strokes[0].tool == 1);
  CHECK(trace.strokes[0].force_gf == Approx(70));
  CHECK(trace.strokes[0].speed_mm_s == Approx(30));
  CHECK(trace.strokes[1].tool == 2);
  CHECK(trace.strokes[1].force_steps == Approx(20));
  CHECK(trace.strokes[1].speed_mm_s == Approx(70));
  CHECK(trace.strokes[2].force_steps == Approx(33));
  REQUIRE(trace.remarks.size() == 2);
  CHECK(trace.remarks[0] == "force 99: outside 1 to 33, 33 was used");
  CHECK(trace.remarks[1] == "tool 5: the machine has 2; tool 2 stays selected");
}

TEST_CASE("a line is clipped at the window and not dropped", "[device][sim]") {
  // (10,10) to (350,10) to (350,50) to (10,50) mm on a machine of 304.8 mm: known drivers send no
  // line of it at all.
  const Trace trace = value(simulate(bytes("M200,200\x03"
                                           "D200,7000\x03"
                                           "D1000,7000\x03"
                                           "D1000,200\x03"),
                                     machine("cameo3")));
  CHECK(trace.cut_mm == Approx(340 + 40 + 340));
  CHECK(trace.clipped_mm == Approx(2 * 45.2 + 40));
  REQUIRE(trace.strokes.size() == 1);
  CHECK(trace.strokes[0].clipped_mm == Approx(trace.clipped_mm));
  CHECK(trace.clipped.size() == 6);
}

TEST_CASE("one warning says that line types are not solid", "[device][sim]") {
  const auto remarks = [](const std::string& program, const std::string& model) {
    return value(simulate(bytes(program), machine(model.c_str()))).remarks;
  };
  const auto dashed = remarks("IN;SP1;LT2,4;PU0,0;PD800,0;LT3;PU;SP0;", "hpgl-generic");
  REQUIRE(dashed.size() == 1);
  CHECK(dashed[0] == "line type 2: dashes are not followed, lines are shown whole");
  CHECK(remarks("IN;SP1;LT;PU0,0;PD800,0;PU;SP0;", "hpgl-generic").empty());
  CHECK(remarks("L1\x03M0,0\x03"
                "D100,0\x03",
                "cameo3")
            .size() == 1);
  CHECK(remarks("L0\x03M0,0\x03"
                "D100,0\x03",
                "cameo3")
            .empty());
}

TEST_CASE("the window of an HPGL program clips what it cuts", "[device][sim]") {
  for (const std::string& window : {"IW0,0,400,400;", "IW400,400,0,0;", "IW0,400,400,0;"}) {
    CAPTURE(window);
    const Trace trace =
        value(simulate(bytes("IN;" + window + "SP1;PU0,200;PD800,200;PU;IW;PU0,300;PD800,300;SP0;"),
                       machine("hpgl-generic")));
    CHECK(trace.clipped_mm == Approx(10));
    CHECK(trace.cut_mm == Approx(40));
    CHECK(trace.remarks.empty());
  }
}

TEST_CASE("the window that the host sets clips as the machine does", "[device][sim]") {
  // The recorded matless job draws from carriage -100 on.
  const Trace trace = value(simulate(bytes("\\0,0\x03Z5596,5900\x03M0,-100\x03"
                                           "D0,408\x03M5588,0\x03"
                                           "D6096,0\x03"),
                                     machine("cameo3")));
  CHECK(trace.clipped_mm == Approx(5 + 25));
  CHECK(trace.cut_mm == Approx(25.4 + 25.4));
}

TEST_CASE("the autoblade is tapped and the set up takes its second", "[device][sim]") {
  const auto busy = [](const char* program, const char* name) {
    SimCutter sim = cutter(machine(name));
    sim.accept(bytes(program));
    sim.run_dry();
    return std::chrono::duration<double>(sim.now()).count();
  };
  CHECK(busy("Z6096,6096\x03J1\x03", "cameo3") == Approx(1.0));
  const double deep = busy("Z6096,6096\x03J1\x03TF5,1\x03", "cameo3");
  const double shallow = busy("Z6096,6096\x03J1\x03TF1,1\x03", "cameo3");
  CHECK(shallow - deep == Approx(4 * 0.45));
  CHECK(deep == Approx(10.1).margin(0.7));
  CHECK(busy("Z6096,6096\x03J1\x03TF5,1\x03", "cameo") == Approx(1.0));
}

TEST_CASE("lifting at corners takes longer than rounding them", "[device][sim]") {
  const auto drawn = [](const std::string& settings, const char* line) {
    return value(simulate(bytes(settings + line), machine("cameo3"))).seconds;
  };
  const char* corner =
      "M0,0\x03"
      "D400,0\x03"
      "D400,400\x03";
  const char* straight =
      "M0,0\x03"
      "D400,0\x03"
      "D800,0\x03";
  const double plain = drawn("", corner);
  CHECK(drawn("FE1,1\x03", corner) == Approx(plain + 0.2));
  CHECK(drawn("FC0,1,1\x03", corner) < plain);
  CHECK(drawn("", straight) < drawn("FC0,1,1\x03", corner));
  // Many short legs in one direction are ridden like one long leg.
  std::string pieces = "M0,0\x03";
  for (int k = 1; k <= 80; ++k) pieces += fmt::format("D{},0\x03", 10 * k);
  CHECK(drawn("", pieces.c_str()) == Approx(drawn("", straight)).epsilon(0.02));
}

TEST_CASE("set origin and home shift what follows as the machine does", "[device][sim]") {
  const Trace trace = value(simulate(bytes("M1000,200\x03SO0\x03M0,0\x03"
                                           "D100,0\x03H\x03M0,0\x03"
                                           "D100,0\x03"),
                                     machine("cameo3")));
  REQUIRE(trace.strokes.size() == 2);
  CHECK(trace.points[trace.strokes[0].first].y == Approx(50));
  CHECK(trace.points[trace.strokes[0].first].x == Approx(10));
  CHECK(trace.points[trace.strokes[1].first].y == Approx(0));
}

TEST_CASE("extreme numbers and lone commands neither crash nor hang", "[device][sim]") {
  for (const char* program : {"M1e300,1e300\x03"
                              "D-1e300,5\x03"
                              "D0,0\x03",
                              "Z-5,-5\x03\\9e9,9e9\x03M1,1\x03"
                              "D2,2\x03",
                              "!-1\x03"
                              "FX1e99\x03"
                              "FC1e300,1e300,1\x03J-3\x03"
                              "D5,5\x03",
                              "TF-1,1\x03TF1e9,1\x03"
                              "D1,1\x03",
                              "FE1,99999999999\x03"
                              "FF,,,\x03"
                              "D9,9\x03",
                              "SO0\x03SO0\x03H\x03H\x03J0\x03J0\x03",
                              "D0,0\x03"
                              "D0,0\x03"
                              "D0,0\x03",
                              "D1,1", "\x1b", "\x1b\x04\x1b\x04\x1b\x05"}) {
    CAPTURE(program);
    const auto trace = simulate(bytes(program), machine("cameo3"));
    if (!trace) continue;
    CHECK(std::isfinite(trace->seconds));
    CHECK_FALSE(trace_json(*trace).empty());
    CHECK_FALSE(trace_svg(*trace).empty());
  }
}

TEST_CASE("an impossible machine is refused", "[device][sim]") {
  Machine stuck = machine("cameo3");
  stuck.motion.accel_mm_s2 = 0;
  CHECK(SimCutter::make(stuck).error().kind == ErrorKind::OutOfRange);
  Machine mute = machine("cameo3");
  mute.buffer_bytes = 0;
  CHECK(SimCutter::make(mute).error().place == "/buffer_bytes");
  Machine foreign = machine("cameo3");
  foreign.language = "klingon";
  CHECK(SimCutter::make(foreign).error().kind == ErrorKind::OutOfRange);
}

}  // namespace device_sim_test
