// SPDX-License-Identifier: MIT
// What can happen at a cutter, by the real binary and simulated cutters.
#include <algorithm>
#include <csignal>
#include <future>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/at_terminal.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace cutter_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

const std::string kSphere = source_file("examples/sphere.json");

struct Bench : CommandBench {
  /// A cut of the sphere on a simulated Cameo 3 with these faults.
  [[nodiscard]] Ran cut_with(const std::string& faults) const {
    write_file(temp / "faults.json", R"j({"popcut": 1, "faults": [)j" + faults + "]}");
    return popcut({"cut", kSphere, "--direct", "--yes", "--device", "sim:cameo3", "--faults",
                   "faults.json", "--json", "-q"});
  }
};

}  // namespace

TEST_CASE("the simulated cutter fails as its fault file says and the ledger reports the rest",
          "[cli][e2e][faults]") {
  const Bench bench;
  struct Case {
    const char* faults;
    int exit;
    const char* words;
  };
  // The sphere has 378 strokes.
  for (const Case& c : {
           Case{R"({"at_byte": 800, "kind": "nak", "seconds": 3})", 0, ""},
           Case{R"({"at_byte": 700, "kind": "short write"})", 0, ""},
           Case{R"({"at_path": 12, "kind": "pause", "seconds": 20})", 0, ""},
           Case{R"j({"at_path": 12, "kind": "garbage", "text": "7\u0003"})j", 0, ""},
           Case{R"({"at_path": 12, "kind": "unplug"})", 5, "the cutter was unplugged"},
           Case{R"({"at_path": 12, "kind": "stall"})", 5, "the cutter stalled"},
           Case{R"({"at_path": 12, "kind": "silence", "seconds": 9})", 5, "did not answer 3"},
           Case{R"({"at_path": 12, "kind": "cancel", "seconds": 2})", 5,
                "cancelled on the machine"},
           Case{R"({"at_path": 12, "kind": "media out"})", 5, "the sheet came out"},
           Case{R"({"kind": "wrong name", "text": "Portrait V1.00    "})", 5,
                "it is a Portrait, not a CAMEO 3"},
       }) {
    CAPTURE(c.faults);
    const Ran ran = bench.cut_with(c.faults);
    CAPTURE(ran.err);
    CHECK(ran.exit == c.exit);
    CHECK(says(ran.err, c.words));
    const json sheet = json::parse(ran.out)["sheets"][0];
    CHECK(sheet["done"] == (c.exit == 0));
    const json& strokes = sheet["strokes"];
    const int certain = strokes["certain"], in_doubt = strokes["in_doubt"],
              not_sent = strokes["not_sent"];
    CHECK(certain + in_doubt + not_sent == 378);
    if (c.exit == 0)
      CHECK(certain == 378);
    else
      CHECK(not_sent > 300);
  }
}

TEST_CASE("an invalid fault file is refused with the place", "[cli][e2e][faults]") {
  const Bench bench;
  const auto refused = [&](const std::string& faults, const std::string& words) {
    const Ran ran = bench.cut_with(faults);
    CAPTURE(ran.err);
    CHECK(ran.exit == 3);
    CHECK(says(ran.err, words));
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  };
  refused(R"({"kind": "explode"})", "faults.json: /faults/0/kind");
  refused(R"({"kind": "nak"}, {"kind": "nak", "at_path": -1})", "/faults/1/at_path");
  refused(R"({"kind": "nak")", "faults.json: line 1");
  const Ran real = bench.popcut(
      {"cut", "--test", "--direct", "--device", "file:x.gpgl", "--faults", "faults.json"});
  CHECK(real.exit == 2);
  CHECK(says(real.err, "--faults: works only with simulated devices"));
}

TEST_CASE("a program with faults is simulated until the host gives up", "[cli][e2e][faults]") {
  const Bench bench;
  REQUIRE(bench.popcut({"plan", kSphere, "-o", "plan", "-q"}).exit == 0);
  write_file(bench.temp / "faults.json",
             R"({"popcut": 1, "faults": [{"at_byte": 900, "kind": "unplug"}]})");
  const Ran ran = bench.popcut({"simulate", "plan/sheet-01.gpgl", "-o", "sim", "--machine",
                                "cameo3", "--faults", "faults.json"});
  CAPTURE(ran.err);
  CHECK(ran.exit == 0);
  CHECK(says(ran.err, "the host gave up after"));
  const json trace = bench.read_json("sim/trace.json");
  CHECK(trace["strokes"].size() >= 1);
  CHECK(trace["strokes"].size() < 378);
}

TEST_CASE(
    "a drawing that fits between registration marks only turned is turned, and a larger one is "
    "split",
    "[cli][e2e][marks]") {
  const Bench bench;
  const auto sheets = [&](double width, double height) {
    write_file(bench.temp / "box.svg",
               fmt::format("<svg xmlns='http://www.w3.org/2000/svg' width='{0}mm' height='{1}mm' "
                           "viewBox='0 0 {0} {1}'><rect width='{0}' height='{1}' fill='none' "
                           "stroke='black'/></svg>",
                           width, height));
    const Ran ran = bench.popcut({"plan", "box.svg", "--marks", "-o", "boxes", "-q"});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    const json plan = bench.read_json("boxes/plan.json");
    CHECK(plan["sheets"][0].contains("registration"));
    return plan["sheets"].size();
  };
  CHECK(sheets(106.5, 262) == 1);  // 256.8 mm lie between the marks one way, 276.8 the other
  CHECK(sheets(262, 106.5) == 1);
  CHECK(sheets(270, 262) > 1);
  // What somebody asks for is not turned away from.
  CHECK(bench.popcut({"plan", "box.svg", "--marks", "--at", "20,30", "-o", "other"}).exit == 4);
}

TEST_CASE("a sheet with registration marks is cut relative to the marks that are found",
          "[cli][e2e][marks]") {
  const Bench bench;
  REQUIRE(bench.popcut({"plan", kSphere, "--marks", "-o", "plan", "-q"}).exit == 0);
  CHECK(says(text_of_file(bench.temp / "plan/sheet-01.marks.svg"), "registration-marks"));
  const json marks = bench.read_json("plan/plan.json")["sheets"][0]["registration"];
  CHECK(marks["left_mm"] == 10);
  CHECK(marks["width_mm"].get<double>() == Approx(284.8));
  CHECK(marks["corners"] == 3);
  CHECK(bench
            .popcut({"simulate", "plan/sheet-01.gpgl", "-o", "sim", "--machine", "cameo3",
                     "--expect", "plan/sheet-01.svg"})
            .exit == 0);
  CHECK(bench.popcut({"cut", kSphere, "--marks", "--direct", "--yes", "-q"}).exit == 0);

  write_file(bench.temp / "blind.json", R"({"popcut": 1, "faults": [{"kind": "no marks"}]})");
  const Ran blind = bench.popcut(
      {"cut", kSphere, "--marks", "--direct", "--yes", "--faults", "blind.json", "--json", "-q"});
  CHECK(blind.exit == 5);
  CHECK(says(blind.err, "the registration marks were not found, and nothing was cut"));
  CHECK(json::parse(blind.out)["sheets"][0]["strokes"]["not_sent"] == 378);
  CHECK(json::parse(blind.out)["sheets"][0]["cut_mm"] == 0);

  const auto refused = [&](std::vector<std::string> more, int exit, const std::string& words) {
    std::vector<std::string> all{"plan", kSphere, "--marks", "-o", "other"};
    all.insert(all.end(), more.begin(), more.end());
    const Ran ran = bench.popcut(all);
    CAPTURE(ran.err);
    CHECK(ran.exit == exit);
    CHECK(says(ran.err, words));
  };
  refused({"--machine", "cameo3", "--mat", "110x110", "--no-split"}, 4,
          "the area holds 98.0 x 78.0 mm");
  refused({"--machine", "cameo3", "--at", "5,5"}, 4, "outside the registration marks");
  refused({"--machine", "hpgl-generic"}, 3, "cannot search for registration marks");
  const Ran small = bench.popcut(
      {"cut", "--test", "--marks", "--machine", "cameo3", "--mat", "70x70", "--direct", "--yes"});
  CHECK(small.exit == 4);
  CHECK(says(small.err, "is too small for registration marks"));
  // What does not fit between the marks of one sheet is split; each sheet has its own.
  REQUIRE(bench
              .popcut({"plan", kSphere, "--marks", "--mat", "170x267", "--machine", "cameo3", "-o",
                       "two", "-q"})
              .exit == 0);
  const json two = bench.read_json("two/plan.json");
  REQUIRE(two["sheets"].size() == 2);
  for (const json& sheet : two["sheets"]) CHECK(sheet["registration"]["width_mm"] == 150.0);
  CHECK(says(two["warnings"].dump(), "each with its own marks"));
  CHECK(says(two["warnings"].dump(), "between the marks of one sheet (142.0 x 219.0 mm)"));
  // It would fit without marks, but not between them: no mat is named that does not help.
  CHECK_FALSE(says(two["warnings"].dump(), "fits whole on --mat 170x267"));
  refused({"--mark-form", "wide"}, 2, "--mark-form: is \"wide\"; one of arm, line");
}

TEST_CASE("the test shape is cut on every machine of the table", "[cli][e2e]") {
  const Bench bench;
  const json machines = json::parse(bench.popcut({"machines", "--json"}).out);
  std::size_t count = 0;
  for (const json& machine : machines.is_array() ? machines : machines["machines"]) {
    const std::string name = machine["name"];
    if (machine["language"] != "gpgl" && machine["language"] != "hpgl") continue;  // not driven
    CAPTURE(name);
    const Ran ran = bench.popcut(
        {"cut", "--test", "--direct", "--yes", "--device", "sim:" + name, "--json", "-q"});
    CAPTURE(ran.err);
    CHECK(ran.exit == 0);
    CHECK(json::parse(ran.out)["sheets"][0]["strokes"]["not_sent"] == 0);
    ++count;
  }
  CHECK(count >= 25);
  CHECK(bench.popcut({"cut", kSphere, "--test", "--direct", "--yes"}).exit == 2);
}

TEST_CASE("the key p holds the cut with the tool up and continues it", "[cli][e2e]") {
  const TempFolder folder;
  AtTerminal popcut(popcut_program(),
                    {"cut", kSphere, "--direct", "--device", "sim:cameo3", "-o", "cut"}, folder);
  REQUIRE(popcut.shows("Start cutting? [y/N]"));
  popcut.type("y\np");
  const bool held = popcut.shows("paused with the tool up; press p to continue");
  INFO(popcut.shown);
  REQUIRE(held);
  popcut.type("p");
  const int exit = popcut.ended();
  CHECK(exit == 0);
  CHECK(says(popcut.shown, "378 strokes"));
}

TEST_CASE("after the tool went round the sheet a person can move the drawing", "[cli][e2e]") {
  const TempFolder folder;
  AtTerminal popcut(
      popcut_program(),
      {"cut", kSphere, "--direct", "--frame", "--at", "1,2", "--device", "sim:cameo3", "-o", "cut"},
      folder);
  std::string all;
  const auto answers = [&](const std::string& asked, const std::string& words) {
    const bool shown = popcut.shows(asked);
    all += popcut.shown;
    popcut.shown.clear();  // the same question comes again
    INFO(all);
    REQUIRE(shown);
    popcut.type(words + "\n");
  };
  answers("press Enter", "");
  REQUIRE(popcut.shows("mm at 1.0, 2.0"));
  answers("or X,Y", "500,0");  // off the mat
  REQUIRE(popcut.shows("it stays at 1,2"));
  answers("press Enter", "");
  answers("or X,Y", "10,-0.5");
  answers("press Enter", "");
  REQUIRE(popcut.shows("mm at 11.0, 1.5"));
  answers("or X,Y", "y");
  const int exit = popcut.ended();
  INFO(popcut.shown);
  CHECK(exit == 0);
  const json sheet = json::parse(text_of_file(folder / "cut/plan.json"))["sheets"][0];
  CAPTURE(sheet["transform"].dump());
  const json trace = json::parse(text_of_file(folder / "cut/sheet-01.trace.json"));
  double left = 1e9, top = 1e9;
  for (const json& stroke : trace["strokes"])
    for (const json& point : stroke["points"]) {
      left = std::min(left, point[0].get<double>());
      top = std::min(top, point[1].get<double>());
    }
  CHECK(std::abs(left - 11) < 0.06);  // half a unit of 0.05 mm, and a sheet's own rounding
  CHECK(std::abs(top - 1.5) < 0.06);
}

TEST_CASE("cut asks before each sheet and ends if the answer is no", "[cli][e2e][layout]") {
  const TempFolder folder;
  const std::vector<std::string> words{"cut",   kSphere,   "--direct", "--device", "sim:cameo3",
                                       "--mat", "110x160", "-o",       "cut"};
  {
    AtTerminal popcut(popcut_program(), words, folder);
    REQUIRE(popcut.shows("Load sheet 1 of 3"));
    popcut.type("y\n");
    REQUIRE(popcut.shows("Load sheet 2 of 3"));
    popcut.type("y\n");
    REQUIRE(popcut.shows("Load sheet 3 of 3"));
    popcut.type("y\n");
    CHECK(popcut.ended() == 0);
  }
  AtTerminal popcut(popcut_program(), words, folder);
  REQUIRE(popcut.shows("Load sheet 1 of 3"));
  popcut.type("y\n");
  REQUIRE(popcut.shows("Load sheet 2 of 3"));
  popcut.type("n\n");
  CHECK(popcut.ended() == 5);
  CHECK(says(popcut.shown, "sheet 2 was not started"));
}

namespace {

/// A drawing of two sheets, cut at a terminal that gets a signal while the first sheet parks.
struct StoppedWhileParking {
  bool asked{}, parked{};
  int exit{};
  std::string shown;
};

StoppedWhileParking stop_while_parking(int signal) {
  const TempFolder desk, cutter_room;
  AtTerminal cutter(popcut_program(), {"simulate", "--pty", "--machine", "cameo3"}, cutter_room);
  write_file(desk / "two.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg" width="150mm"
      height="90mm" viewBox="0 0 150 90"><path stroke="#000"
      d="M0 0h2M148 0h2M0 88v2M150 88v2"/></svg>)x");
  AtTerminal popcut(popcut_program(),
                    {"cut", "two.svg", "--direct", "--device", "serial:" + cutter.first_line(),
                     "--machine", "cameo3", "--mat", "100x100", "--labels", "none"},
                    desk);
  StoppedWhileParking end;
  end.asked = popcut.shows("Load sheet 1 of 2");
  popcut.type("y\n");
  end.parked = popcut.shows("parking");
  popcut.signal(signal);
  end.exit = popcut.ended();
  end.shown = popcut.shown;
  return end;
}

}  // namespace

TEST_CASE("a stop while a sheet parks asks for no further sheet", "[cli][e2e][pty]") {
  // The cutters run by the clock; side by side they take no longer than one.
  std::map<int, std::future<StoppedWhileParking>> all;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    all[signal] = std::async(std::launch::async, stop_while_parking, signal);
  for (auto& [signal, coming] : all) {
    const StoppedWhileParking end = coming.get();
    CAPTURE(signal, end.shown);
    CHECK(end.asked);
    CHECK(end.parked);
    CHECK(end.exit == 5);
    CHECK_FALSE(says(end.shown, "Load sheet 2 of 2"));
    CHECK(says(end.shown, "sheet 1: is cut; stopped as you asked before sheet 2"));
  }
}

TEST_CASE("a cutter at a pseudo terminal is used through a serial port", "[cli][e2e][pty]") {
  const TempFolder desk, cutter_room;
  AtTerminal cutter(popcut_program(),
                    {"simulate", "--pty", "--machine", "cameo3", "--speedup", "50", "-o", "did"},
                    cutter_room);
  const std::string port = cutter.first_line();
  REQUIRE(port.rfind("/dev/", 0) == 0);
  REQUIRE(cutter.shows("Ctrl-C ends"));
  cutter.type("m\n");  // the sheet out
  REQUIRE(cutter.shows("no media"));
  const std::vector<std::string> words{
      "cut",       "--test", "--direct", "--device", "serial:" + port,
      "--machine", "cameo3", "-o",       "cut"};
  {
    AtTerminal popcut(popcut_program(), words, desk);
    REQUIRE(popcut.shows("Start cutting? [y/N]"));
    popcut.type("y\n");
    CHECK(popcut.ended() == 5);
    CHECK(says(popcut.shown, "no media in the machine; load a sheet"));
  }
  cutter.type("m\n");
  REQUIRE(cutter.shows("ready"));
  AtTerminal popcut(popcut_program(), words, desk);
  REQUIRE(popcut.shows("Start cutting? [y/N]"));
  popcut.type("y\n");
  const int exit = popcut.ended();
  INFO(popcut.shown);
  CHECK(exit == 0);
  cutter.type("\x03");
  CHECK(cutter.ended() == 0);
  const json sheet = json::parse(text_of_file(desk / "cut/plan.json"))["sheets"][0];
  const json trace = json::parse(text_of_file(cutter_room / "did/trace.json"));
  CHECK(trace["lifts"] == sheet["lifts"]);
  CHECK(trace["unknown"].empty());
  CHECK(trace["cut_mm"].get<double>() ==
        Approx(sheet["cut_mm"].get<double>() + sheet["fold_mm"].get<double>()).epsilon(0.01));
}

}  // namespace cutter_command_test
