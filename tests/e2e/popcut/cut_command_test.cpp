// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace cut_command_test {

using namespace popcut::testing;

namespace {

const std::string kSphere = source_file("examples/sphere.json");

struct Bench {
  TempFolder folder;

  [[nodiscard]] Ran run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), popcut_program());
    return run_program(arguments, folder.path());
  }
  [[nodiscard]] nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(text_of_file(folder / name));
  }
  void plan(const std::string& machine = "cameo3", const std::string& spec = kSphere) const {
    const Ran ran = run({"plan", spec, "-o", "plan", "--machine", machine});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
  }
};

void check_one_line(const Ran& ran, int exit, const std::string& telling) {
  CAPTURE(ran.err);
  CHECK(ran.exit == exit);
  CHECK(ran.err.rfind("popcut: ", 0) == 0);
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  CHECK(ran.err.find(telling) != std::string::npos);
}

}  // namespace

TEST_CASE("a planned program does on the simulated cutter what its sheet says", "[cli][e2e]") {
  for (const char* machine : {"cameo3", "cameo", "cameo4", "cameo5", "portrait3", "hpgl-generic"}) {
    CAPTURE(machine);
    const Bench bench;
    bench.plan(machine);
    const bool hpgl = std::string(machine) == "hpgl-generic";
    const std::string program = hpgl ? "plan/sheet-01.hpgl" : "plan/sheet-01.gpgl";
    const Ran ran = bench.run(
        {"simulate", program, "-o", "sim", "--machine", machine, "--expect", "plan/sheet-01.svg"});
    INFO(ran.err);
    CHECK(ran.exit == 0);
    CHECK(ran.err.find("as expected by plan/sheet-01.svg") != std::string::npos);
    const auto trace = bench.json("sim/trace.json");
    const auto sheet = bench.json("plan/plan.json")["sheets"][0];
    CHECK(trace["lifts"] == sheet["lifts"]);
    // Each end of a stroke is rounded to a step.
    const double planned = sheet["cut_mm"].get<double>() + sheet["fold_mm"].get<double>();
    CHECK(trace["cut_mm"].get<double>() == Approx(planned).epsilon(0.002));
    CHECK(trace["travel_mm"].get<double>() ==
          Approx(sheet["travel_mm"].get<double>()).epsilon(0.01));
    CHECK(trace["unknown"].empty());
    CHECK(trace["strokes"].size() == trace["lifts"]);
    pugi::xml_document svg;
    CHECK(svg.load_string(text_of_file(bench.folder / "sim/cut.svg").c_str()));
  }
}

TEST_CASE("a pattern with its plan is what the program must do", "[cli][e2e]") {
  for (const char* example : {"unit", "fig2a", "cylinder", "sphere", "saddle"}) {
    CAPTURE(example);
    const Bench bench;
    const std::string spec = source_file("examples/") + example + ".json";
    bench.plan("cameo3", spec);
    REQUIRE(bench.run({"design", spec, "-o", "design", "-q"}).exit == 0);
    for (const std::string& pattern :
         {std::string("design/pattern.fold"), std::string("design/pattern.svg"), spec}) {
      CAPTURE(pattern);
      const Ran ran = bench.run({"simulate", "plan/sheet-01.gpgl", "-o", "sim", "--expect", pattern,
                                 "--plan", "plan/plan.json"});
      INFO(ran.err);
      CHECK(ran.exit == 0);
    }
  }
}

TEST_CASE("another sheet than the expected one is exit code 6 and still drawn", "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  const std::string program = text_of_file(bench.folder / "plan/sheet-01.gpgl");
  // Without its last stroke, the outline.
  const std::size_t last = program.rfind("M", program.rfind("L0"));
  write_file(bench.folder / "short.gpgl",
             program.substr(0, last) + program.substr(program.rfind("L0")));
  const Ran ran =
      bench.run({"simulate", "short.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q"});
  check_one_line(ran, 6, "plan/sheet-01.svg: line");
  CHECK(ran.err.find("is not cut from 0.000 to") != std::string::npos);
  CHECK(bench.json("sim/trace.json")["lifts"].get<int>() > 100);
  const Ran json = bench.run(
      {"simulate", "short.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q", "--json"});
  CHECK(json.exit == 6);
  CHECK(nlohmann::json::parse(json.out)["as_expected"] == false);
}

TEST_CASE("simulate tells what it cannot work with", "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  write_file(bench.folder / "empty.gpgl", "");
  write_file(bench.folder / "noise.gpgl", "this is no program\n");
  write_file(bench.folder / "plan.json", R"({"sheets": [{"transform": 5}]})");
  const std::string good = "plan/sheet-01.gpgl";
  check_one_line(bench.run({"simulate", good}), 2, "-o DIR is missing");
  check_one_line(bench.run({"simulate", "absent.gpgl", "-o", "sim"}), 3, "absent.gpgl");
  check_one_line(bench.run({"simulate", "empty.gpgl", "-o", "sim"}), 3, "empty");
  check_one_line(bench.run({"simulate", "noise.gpgl", "-o", "sim"}), 3, "nothing is drawn");
  check_one_line(bench.run({"simulate", good, "-o", "sim", "--machine", "cameo33"}), 2, "cameo3");
  check_one_line(bench.run({"simulate", good, "-o", "sim", "--expect", kSphere}), 2, "--plan");
  check_one_line(bench.run({"simulate", good, "-o", "sim", "--plan", "plan.json"}), 3,
                 "plan.json: /machine");
  check_one_line(
      bench.run({"simulate", good, "-o", "sim", "--plan", "plan/plan.json", "--sheet", "2"}), 3,
      "no sheet 2");
  check_one_line(bench.run({"simulate", good, "-o", "/dev/null/x"}), 7, "/dev/null");
  CHECK_FALSE(std::filesystem::exists(bench.folder / "sim"));
}

TEST_CASE("unknown commands are told and are no success of an expectation", "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  write_file(bench.folder / "odd.gpgl",
             "QQ7\x03" + text_of_file(bench.folder / "plan/sheet-01.gpgl"));
  const Ran plain = bench.run({"simulate", "odd.gpgl", "-o", "sim"});
  CHECK(plain.exit == 0);
  CHECK(plain.err.find("not understood: QQ7") != std::string::npos);
  CHECK(bench.json("sim/trace.json")["unknown"][0] == "QQ7");
  const Ran checked =
      bench.run({"simulate", "odd.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q"});
  check_one_line(checked, 6, "QQ7");
}

TEST_CASE("cut goes from a spec through session and protocol to the simulated cutter",
          "[cli][e2e]") {
  const Bench bench;
  const Ran ran = bench.run(
      {"cut", kSphere, "--direct", "--yes", "--device", "sim:cameo3", "-o", "cut", "--json"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const auto json = nlohmann::json::parse(ran.out);
  CHECK(json["device"] == "sim:cameo3");
  REQUIRE(json["sheets"].size() == 1);
  CHECK(json["sheets"][0]["done"] == true);
  CHECK(json["sheets"][0]["confirmed"] == true);
  CHECK(json["sheets"][0]["strokes"]["in_doubt"] == 0);
  CHECK(json["sheets"][0]["identity"] == "CAMEO 3 V1.60    ");
  CHECK(files_below(bench.folder / "cut") ==
        std::vector<std::string>{"manifest.json", "plan.json", "sheet-01.cut.svg", "sheet-01.gpgl",
                                 "sheet-01.svg", "sheet-01.trace.json"});
  // What was streamed is the program that plan writes.
  bench.plan();
  CHECK(text_of_file(bench.folder / "cut/sheet-01.gpgl") ==
        text_of_file(bench.folder / "plan/sheet-01.gpgl"));
  CHECK(ran.err.find('\r') == std::string::npos);  // no progress bar off a terminal
}

TEST_CASE("a machine that answers nothing is cut on and its doubt is told", "[cli][e2e]") {
  const Bench bench;
  const Ran ran = bench.run({"cut", kSphere, "--direct", "--yes", "--device", "sim:hpgl-generic"});
  INFO(ran.err);
  CHECK(ran.exit == 0);
  CHECK(ran.err.find("answers nothing") != std::string::npos);
}

TEST_CASE("nothing is cut without somebody who said yes", "[cli][e2e]") {
  const Bench bench;
  check_one_line(bench.run({"cut", kSphere, "--direct", "-q", "-o", "cut"}), 5, "nobody to ask");
  CHECK_FALSE(std::filesystem::exists(bench.folder / "cut/sheet-01.gpgl"));
  check_one_line(bench.run({"cut", kSphere, "--direct", "--yes", "--device", "usb:1"}), 2,
                 "simulated devices only");
  check_one_line(bench.run({"cut", kSphere, "--direct", "--device", "usb:1"}), 5, "usb:1");
  ::setenv("POPCUT_URL", "/nonexistent/popcut.sock", 1);
  check_one_line(bench.run({"cut", kSphere}), 5, "popcutd does not answer there");
  check_one_line(bench.run({"cut", "absent.json"}), 3, "absent.json");
  check_one_line(bench.run({"cut", kSphere, "--yes"}), 2, "--direct");
  check_one_line(bench.run({"cut", kSphere, "--direct", "--wait"}), 2, "queue");
  check_one_line(bench.run({"cut", kSphere, "--direct", "--yes", "--device", "sim:nothing"}), 2,
                 "nothing");
  check_one_line(bench.run({"cut", kSphere, "--direct", "--yes", "--device", "sim:cameo3",
                            "--machine", "cameo4"}),
                 2, "cameo4");
  check_one_line(bench.run({"cut", kSphere, "--direct", "--yes", "--machine", "cameo3", "--mat",
                            "100x100", "--no-split"}),
                 4, "mm");
}

TEST_CASE("devices lists a simulated one for each machine", "[cli][e2e]") {
  const Bench bench;
  const Ran ran = bench.run({"devices"});
  CHECK(ran.exit == 0);
  CHECK(ran.out.find("sim:cameo3 ") != std::string::npos);
  CHECK(ran.out.find("sim:hpgl-generic ") != std::string::npos);
  const auto json = nlohmann::json::parse(bench.run({"devices", "--json"}).out);
  const auto machines = nlohmann::json::parse(bench.run({"machines", "--json"}).out);
  CHECK(json["devices"].size() == machines["machines"].size());
}

}  // namespace cut_command_test
