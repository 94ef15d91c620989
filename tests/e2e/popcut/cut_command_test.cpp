// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace cut_command_test {

using namespace popcut::testing;

namespace {

const std::string kSphere = source_file("examples/sphere.json");

struct Bench : CommandBench {
  void plan(const std::string& machine = "cameo3", const std::string& spec = kSphere) const {
    const Ran ran = popcut({"plan", spec, "-o", "plan", "--machine", machine});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
  }
};

}  // namespace

TEST_CASE("a planned program draws its sheet on the simulated cutter", "[cli][e2e]") {
  for (const char* machine : {"cameo3", "cameo", "cameo4", "cameo5", "portrait3", "hpgl-generic"}) {
    CAPTURE(machine);
    const Bench bench;
    bench.plan(machine);
    const bool hpgl = std::string(machine) == "hpgl-generic";
    const std::string program = hpgl ? "plan/sheet-01.hpgl" : "plan/sheet-01.gpgl";
    const Ran ran = bench.popcut(
        {"simulate", program, "-o", "sim", "--machine", machine, "--expect", "plan/sheet-01.svg"});
    INFO(ran.err);
    CHECK(ran.exit == 0);
    CHECK(ran.err.find("matches plan/sheet-01.svg") != std::string::npos);
    const auto trace = bench.read_json("sim/trace.json");
    const auto sheet = bench.read_json("plan/plan.json")["sheets"][0];
    CHECK(trace["lifts"] == sheet["lifts"]);
    // Each end of a stroke is rounded to a step.
    const double planned = sheet["cut_mm"].get<double>() + sheet["fold_mm"].get<double>();
    CHECK(trace["cut_mm"].get<double>() == Approx(planned).epsilon(0.002));
    CHECK(trace["travel_mm"].get<double>() ==
          Approx(sheet["travel_mm"].get<double>()).epsilon(0.01));
    CHECK(trace["unknown"].empty());
    CHECK(trace["strokes"].size() == trace["lifts"]);
    pugi::xml_document svg;
    CHECK(svg.load_string(text_of_file(bench.temp / "sim/cut.svg").c_str()));
  }
}

TEST_CASE("simulate compares a program with a pattern and its plan", "[cli][e2e]") {
  for (const std::string example : {"unit", "fig2a", "cylinder", "sphere", "saddle", "no card"}) {
    CAPTURE(example);
    const Bench bench;
    std::string spec = source_file("examples/") + example + ".json";
    if (example == "no card") {
      spec = bench.temp / "card.json";
      write_file(spec, R"j({"popcut":1,"surface":{"type":"profile","z":"40 - x + 4*sin(y/10)"},
          "units_per_slice":6,"slices":5,"widths_mm":8,"fit":"nearest","card":false})j");
    }
    bench.plan("cameo3", spec);
    REQUIRE(bench.popcut({"design", spec, "-o", "design", "-q"}).exit == 0);
    for (const std::string& pattern :
         {std::string("design/pattern.fold"), std::string("design/pattern.svg"), spec}) {
      CAPTURE(pattern);
      const Ran ran = bench.popcut({"simulate", "plan/sheet-01.gpgl", "-o", "sim", "--expect",
                                    pattern, "--plan", "plan/plan.json"});
      INFO(ran.err);
      CHECK(ran.exit == 0);
    }
  }
}

TEST_CASE("what a cutter did not say is told after the cut", "[cli][e2e]") {
  const Bench bench;
  const std::string spec = source_file("examples/unit.json");
  write_file(bench.temp / "mute.json",
             R"({"popcut": 1, "faults": [{"at_byte": 0, "kind": "silence", "seconds": 9}]})");
  const std::vector<std::string> words{"cut",   spec,       "--direct",
                                       "--yes", "--device", "sim:gcc-bobcat"};
  const Ran told = bench.popcut(words);
  INFO(told.err);
  CHECK(told.exit == 0);
  CHECK_FALSE(says(told.err, "note"));
  std::vector<std::string> mute = words;
  mute.insert(mute.end(), {"--faults", "mute.json"});
  const Ran ran = bench.popcut(mute);
  INFO(ran.err);
  CHECK(says(ran.err, "note     the machine did not say how far it reaches (OH)"));
}

TEST_CASE("before a cut the tool goes round the sheet if a person wants to see where",
          "[cli][e2e]") {
  const Bench bench;
  const std::string spec = source_file("examples/unit.json");
  const Ran ran = bench.popcut({"cut", spec, "--direct", "--yes", "--frame"});
  INFO(ran.err);
  CHECK(ran.exit == 0);
  CHECK(says(ran.err, "the lifted tool went around 60.0 x 150."));
  CHECK(says(ran.err, "mm cut on sim:cameo3"));
  check_refused(bench.popcut({"cut", spec, "--frame"}), 2, "works only with --direct");
  check_refused(bench.popcut({"cut", spec, "--direct", "--frame", "--device", "file:a.gpgl"}), 2,
                "--device is a file");
}

TEST_CASE("a program file is sent as it is, after a rehearsal", "[cli][e2e]") {
  const Bench bench;
  bench.plan("cameo4");
  const Ran ran =
      bench.popcut({"send", "plan/sheet-01.gpgl", "--device", "sim:cameo4", "--yes", "--json"});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const auto json = nlohmann::json::parse(ran.out);
  CHECK(json["done"] == true);
  CHECK(json["strokes"]["certain"].get<int>() > 20);
  CHECK(json["strokes"]["not_sent"] == 0);
  REQUIRE(bench.popcut({"send", "plan/sheet-01.gpgl", "--device", "file:copy.gpgl", "-q"}).exit ==
          0);
  CHECK(text_of_file(bench.temp / "copy.gpgl") == text_of_file(bench.temp / "plan/sheet-01.gpgl"));
  check_refused(bench.popcut({"send", "plan/sheet-01.gpgl", "-q"}), 5, "not a terminal");
  check_refused(bench.popcut({"send", "plan/sheet-01.gpgl", "--yes", "--device", "usb:1-1"}), 2,
                "works only with simulated devices");
  write_file(bench.temp / "far.plt", "IN;PU100,100;PD900000,100;");
  check_refused(bench.popcut({"send", "far.plt", "--device", "sim:hpgl-generic", "--yes"}), 4,
                "beyond the 600 x 5000 mm");
  check_refused(bench.popcut({"send", "far.plt", "--yes"}), 5, "is written in HPGL");
  write_file(bench.temp / "empty.plt", "");
  check_refused(bench.popcut({"send", "empty.plt", "--yes"}), 3, "is empty");
}

TEST_CASE("copies, sizes, turns and settings of one job together are cut as the design says",
          "[cli][e2e]") {
  const Bench bench;
  const std::string spec = source_file("examples/unit.json");
  REQUIRE(bench.popcut({"design", spec, "-o", "design", "-q"}).exit == 0);
  const std::vector<std::vector<std::string>> jobs{
      {"--per-sheet", "4"},
      {"--per-sheet", "9", "--scale", "0.5", "--mirror"},
      {"--per-sheet", "3", "--rotate", "90", "--pen", "cut: passes=2 force=70; fold: passes=3"},
      {"--per-sheet", "2", "--width", "110", "--rotate", "30", "--mirror", "--mat-free"},
      {"--per-sheet", "5", "--scale", "0.6", "--at", "20,30", "--pen", "cut: passes=2"},
      {"--per-sheet", "2", "--weed-box", "4.5", "--rotate", "90"},
      {"--per-sheet", "3", "--pen", "mountain: passes=2; valley: speed=9; outline: passes=3"}};
  for (const std::vector<std::string>& job : jobs) {
    CAPTURE(job);
    std::vector<std::string> words{"plan", spec, "--machine", "cameo3", "-o", "many", "-q"};
    words.insert(words.end(), job.begin(), job.end());
    const Ran planned = bench.popcut(words);
    INFO(planned.err);
    REQUIRE(planned.exit == 0);
    const auto plan = nlohmann::json::parse(text_of_file(bench.temp / "many/plan.json"));
    CHECK(plan["copies"].size() == std::stoul(job[1]));
    for (const std::string& pattern : {std::string("design/pattern.fold"), spec}) {
      const Ran ran = bench.popcut({"simulate", "many/sheet-01.gpgl", "-o", "sim", "--expect",
                                    pattern, "--plan", "many/plan.json"});
      INFO(ran.err);
      CHECK(ran.exit == 0);
    }
    // One copy fewer is not what was asked for.
    nlohmann::json wrong = plan;
    wrong["copies"].erase(wrong["copies"].size() - 1);
    write_file(bench.temp / "wrong.json", wrong.dump());
    CHECK(bench
              .popcut({"simulate", "many/sheet-01.gpgl", "-o", "sim", "--expect", spec, "--plan",
                       "wrong.json"})
              .exit == 6);
  }
  check_refused(bench.popcut({"plan", spec, "--per-sheet", "50", "-o", "none"}), 4,
                "8 fit on 304.8 x 304.8 mm; use at most 8");
}

TEST_CASE("a drawing on a roll is as long as itself and comes out at the end", "[cli][e2e]") {
  const Bench bench;
  write_file(bench.temp / "long.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg" width="200mm"
      height="900mm" viewBox="0 0 200 900"><path d="M10 10H190V890H10Z" stroke="#000"
      fill="none"/></svg>)x");
  for (const char* machine : {"cameo3", "portrait2", "hpgl-generic", "gcc-bobcat"}) {
    CAPTURE(machine);
    const Ran planned = bench.popcut({"plan", "long.svg", "--machine", machine, "--mat", "roll",
                                      "--finish", "below", "-o", "roll", "-q"});
    INFO(planned.err);
    REQUIRE(planned.exit == 0);
    const auto plan = bench.read_json("roll/plan.json");
    REQUIRE(plan["sheets"].size() == 1);
    CHECK(plan["sheets"][0]["mat"] == "");
    CHECK(plan["sheets"][0]["area_mm"][1] == 900);
    CHECK(plan["sheets"][0]["feed_out_mm"].get<double>() == Approx(10).margin(0.3));
    const bool gpgl = std::filesystem::exists(bench.temp / "roll/sheet-01.gpgl");
    const std::string program = gpgl ? "sheet-01.gpgl" : "sheet-01.hpgl";
    CHECK(bench
              .popcut({"simulate", "roll/" + program, "-o", "sim", "--expect", "long.svg", "--plan",
                       "roll/plan.json"})
              .exit == 0);
  }
  CHECK(bench
            .popcut({"cut", "long.svg", "--direct", "--device", "sim:cameo3", "--mat", "roll",
                     "--finish", "below", "--yes", "-q"})
            .exit == 0);
  check_refused(bench.popcut({"plan", "long.svg", "--machine", "none", "--mat", "roll", "-o", "x"}),
                2, "roll");
}

TEST_CASE("scores and pen lines are expected as often as they are drawn", "[cli][e2e]") {
  const Bench bench;
  write_file(bench.temp / "ops.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg" width="100mm"
      height="80mm" viewBox="0 0 100 80"><g id="score" stroke="#f0f"><path d="M10,50 H80"/></g>
      <g id="draw" stroke="#0a0"><path d="M10,20 H80"/></g></svg>)x");
  for (const std::string pen : {"", "draw: passes=3", "score: passes=1; draw: passes=2"}) {
    CAPTURE(pen);
    std::vector<std::string> words{"plan", "ops.svg", "-o", "ops", "-q"};
    if (!pen.empty()) words.insert(words.end(), {"--pen", pen});
    REQUIRE(bench.popcut(words).exit == 0);
    const Ran held = bench.popcut({"simulate", "ops/sheet-01.gpgl", "-o", "sim", "--expect",
                                   "ops.svg", "--plan", "ops/plan.json"});
    INFO(held.err);
    CHECK(held.exit == 0);
  }
  auto wrong = bench.read_json("ops/plan.json");
  CHECK(wrong["passes"]["score"] == 1);
  CHECK(wrong["passes"]["draw"] == 2);
  wrong["passes"]["draw"] = 1;
  write_file(bench.temp / "wrong.json", wrong.dump());
  CHECK(bench
            .popcut({"simulate", "ops/sheet-01.gpgl", "-o", "sim", "--expect", "ops.svg", "--plan",
                     "wrong.json"})
            .exit == 6);
}

TEST_CASE("lines of several operations on each other are expected as they are planned",
          "[cli][e2e]") {
  const Bench bench;
  const auto line = [](const char* layer, const char* d) {
    return fmt::format("<g id='{}' stroke='#000' fill='none'><path d='{}'/></g>", layer, d);
  };
  const std::vector<std::string> drawings{
      line("cut", "M10 10h60") + line("fold-mountain", "M10 10h80") + line("valley", "M30 10h80") +
          line("score", "M0 10h110"),
      line("draw", "M10 50h80") + line("cut", "M10 50h80"),
      line("cut", "M10 10h30v20h-30z") + line("draw", "M10 10h30v20h-30z") +
          line("score", "M10 10h30v20h-30z")};
  for (const std::string& drawing : drawings) {
    CAPTURE(drawing);
    write_file(bench.temp / "on.svg",
               "<svg xmlns='http://www.w3.org/2000/svg' width='120mm' height='80mm' "
               "viewBox='0 0 120 80'>" +
                   drawing + "</svg>");
    REQUIRE(bench.popcut({"plan", "on.svg", "-o", "on", "-q"}).exit == 0);
    const auto held = [&](const char* plan) {
      const Ran ran = bench.popcut(
          {"simulate", "on/sheet-01.gpgl", "-o", "sim", "--expect", "on.svg", "--plan", plan});
      UNSCOPED_INFO(ran.err);
      return ran.exit;
    };
    CHECK(held("on/plan.json") == 0);
    auto wrong = bench.read_json("on/plan.json");
    wrong["passes"]["cut"] = 2;
    write_file(bench.temp / "wrong.json", wrong.dump());
    CHECK(held("wrong.json") == 6);
  }
}

TEST_CASE("a split drawing with letters that the knife makes is as planned", "[cli][e2e]") {
  const Bench bench;  // a dash of the 4 ends 0.03 mm from another one and is joined to it
  write_file(bench.temp / "long.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg" width="60mm"
      height="900mm" viewBox="0 0 60 900"><g fill="none" stroke="#000"><rect x="5" y="5" width="50"
      height="890"/><path d="M10,100 l30,300 l-20,400"/></g></svg>)x");
  REQUIRE(bench.popcut({"plan", "long.svg", "--machine", "portrait", "-o", "long", "-q"}).exit ==
          0);
  const auto plan = bench.read_json("long/plan.json");
  REQUIRE(plan["sheets"].size() == 1);
  const Ran held = bench.popcut({"simulate", "long/sheet-01.gpgl", "--machine", "portrait", "-o",
                                 "sim", "--expect", "long.svg", "--plan", "long/plan.json"});
  INFO(held.err);
  CHECK(held.exit == 0);
}

TEST_CASE("colours and layers have settings of their own, in a drawing and a design",
          "[cli][e2e]") {
  const Bench bench;
  write_file(bench.temp / "two.svg", R"x(<svg xmlns="http://www.w3.org/2000/svg"
      xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="100mm" height="80mm"
      viewBox="0 0 100 80"><g fill="none"><path d="M10 10h40v30h-40z" stroke="red"/>
      <circle cx="30" cy="25" r="8" stroke="blue"/><g inkscape:groupmode="layer"
      inkscape:label="Window Frame"><path d="M60 10h20v20h-20z" stroke="black"/></g></g></svg>)x");
  const Ran planned = bench.popcut(
      {"plan", "two.svg", "--svg-profile", "popcut", "-o", "two", "--pen",
       "red: force=119 passes=3; blue: passes=2 speed=50; window frame: tool=1 force=14", "-q"});
  INFO(planned.err);
  REQUIRE(planned.exit == 0);
  const auto plan = bench.read_json("two/plan.json");
  const auto& cuts = plan["sheets"][0]["operations"];
  REQUIRE(cuts.size() == 3);
  CHECK(cuts[0]["pen"] == "blue");
  CHECK(cuts[1]["pen"] == "red");
  CHECK(cuts[1]["force_gf"] == 119);
  CHECK(cuts[2]["force_gf"] == 14);
  CHECK(bench
            .popcut({"simulate", "two/sheet-01.gpgl", "-o", "sim", "--expect", "two.svg", "--plan",
                     "two/plan.json"})
            .exit == 0);
  // The bytes say so too: the forces in steps of 7 gf, before their strokes.
  const std::string program = text_of_file(bench.temp / "two/sheet-01.gpgl");
  CHECK(program.find("FX17,1") != std::string::npos);
  CHECK(program.find("FX2,1") != std::string::npos);
  CHECK(program.find("!5,1") != std::string::npos);
  auto wrong = plan;
  wrong["pens"][0]["passes"] = 2;
  write_file(bench.temp / "wrong.json", wrong.dump());
  CHECK(bench
            .popcut({"simulate", "two/sheet-01.gpgl", "-o", "sim", "--expect", "two.svg", "--plan",
                     "wrong.json"})
            .exit == 6);
  check_refused(bench.popcut({"plan", "two.svg", "--svg-profile", "popcut", "-o", "none", "--pen",
                              "gold: force=9"}),
                2, "the drawing has #ff0000, #0000ff, layer Window Frame, #000000");

  auto spec = nlohmann::json::parse(text_of_file(source_file("examples/unit.json")));
  spec["pen"] = "outline: passes=2; cut: speed=20";
  write_file(bench.temp / "pens.json", spec.dump());
  REQUIRE(
      bench.popcut({"plan", "pens.json", "-o", "own", "--pen", "outline: force=70", "-q"}).exit ==
      0);
  const auto own = bench.read_json("own/plan.json");
  CHECK(own["pens"] == nlohmann::json::parse(R"([{"name": "outline", "passes": 2}])"));
  CHECK(own["sheets"][0]["operations"].back()["force_gf"] == 70);
  CHECK(own["sheets"][0]["operations"].back()["speed_mm_s"] == 20);
  spec["pen"] = "gold: passes=2";
  write_file(bench.temp / "gold.json", spec.dump());
  check_refused(bench.popcut({"plan", "gold.json", "-o", "none"}), 3, "gold.json: /pen");
}

TEST_CASE("a sheet that differs from the expected one gives exit code 6 and is still drawn",
          "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  const std::string program = text_of_file(bench.temp / "plan/sheet-01.gpgl");
  // Without its last stroke, the outline.
  const std::size_t last = program.rfind("M", program.rfind("L0"));
  write_file(bench.temp / "short.gpgl",
             program.substr(0, last) + program.substr(program.rfind("L0")));
  const Ran ran =
      bench.popcut({"simulate", "short.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q"});
  check_refused(ran, 6, "plan/sheet-01.svg: line");
  CHECK(ran.err.find("is not cut from 0.000 to") != std::string::npos);
  CHECK(bench.read_json("sim/trace.json")["lifts"].get<int>() > 100);
  const Ran json = bench.popcut(
      {"simulate", "short.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q", "--json"});
  CHECK(json.exit == 6);
  CHECK(nlohmann::json::parse(json.out)["as_expected"] == false);
}

TEST_CASE("simulate reports input that it cannot use", "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  write_file(bench.temp / "empty.gpgl", "");
  write_file(bench.temp / "noise.gpgl", "this is no program\n");
  write_file(bench.temp / "plan.json", R"({"sheets": [{"transform": 5}]})");
  const std::string good = "plan/sheet-01.gpgl";
  check_refused(bench.popcut({"simulate", good}), 2, "-o DIR is missing");
  check_refused(bench.popcut({"simulate", "absent.gpgl", "-o", "sim"}), 3, "absent.gpgl");
  check_refused(bench.popcut({"simulate", "empty.gpgl", "-o", "sim"}), 3, "empty");
  check_refused(bench.popcut({"simulate", "noise.gpgl", "-o", "sim"}), 3, "draws nothing");
  check_refused(bench.popcut({"simulate", good, "-o", "sim", "--machine", "cameo33"}), 2, "cameo3");
  check_refused(bench.popcut({"simulate", good, "-o", "sim", "--expect", kSphere}), 2, "--plan");
  check_refused(bench.popcut({"simulate", good, "-o", "sim", "--plan", "plan.json"}), 3,
                "plan.json: /machine");
  check_refused(
      bench.popcut({"simulate", good, "-o", "sim", "--plan", "plan/plan.json", "--sheet", "2"}), 3,
      "no sheet 2");
  check_refused(bench.popcut({"simulate", good, "-o", "/dev/null/x"}), 7, "/dev/null");
  CHECK_FALSE(std::filesystem::exists(bench.temp / "sim"));
}

TEST_CASE("unknown commands are reported and fail the comparison with a sheet", "[cli][e2e]") {
  const Bench bench;
  bench.plan();
  write_file(bench.temp / "odd.gpgl", "QQ7\x03" + text_of_file(bench.temp / "plan/sheet-01.gpgl"));
  const Ran plain = bench.popcut({"simulate", "odd.gpgl", "-o", "sim"});
  CHECK(plain.exit == 0);
  CHECK(plain.err.find("unknown command: QQ7") != std::string::npos);
  CHECK(bench.read_json("sim/trace.json")["unknown"][0] == "QQ7");
  const Ran checked =
      bench.popcut({"simulate", "odd.gpgl", "-o", "sim", "--expect", "plan/sheet-01.svg", "-q"});
  check_refused(checked, 6, "QQ7");
}

TEST_CASE("cut sends a spec through protocol and session to the simulated cutter", "[cli][e2e]") {
  const Bench bench;
  const Ran ran = bench.popcut(
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
  CHECK(files_below(bench.temp / "cut") ==
        std::vector<std::string>{"manifest.json", "plan.json", "sheet-01.cut.svg", "sheet-01.gpgl",
                                 "sheet-01.svg", "sheet-01.trace.json"});
  // What was streamed is the program that plan writes.
  bench.plan();
  CHECK(text_of_file(bench.temp / "cut/sheet-01.gpgl") ==
        text_of_file(bench.temp / "plan/sheet-01.gpgl"));
  CHECK(ran.err.find('\r') == std::string::npos);  // no progress bar off a terminal
}

TEST_CASE("a cut on a machine that answers nothing is reported as in doubt", "[cli][e2e]") {
  const Bench bench;
  const Ran ran =
      bench.popcut({"cut", kSphere, "--direct", "--yes", "--device", "sim:hpgl-generic"});
  INFO(ran.err);
  CHECK(ran.exit == 0);
  CHECK(ran.err.find("reports nothing back") != std::string::npos);
}

TEST_CASE("nothing is cut without a person's confirmation", "[cli][e2e]") {
  const Bench bench;
  check_refused(bench.popcut({"cut", kSphere, "--direct", "-q", "-o", "cut"}), 5,
                "cannot ask whether to start");
  CHECK_FALSE(std::filesystem::exists(bench.temp / "cut/sheet-01.gpgl"));
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--yes", "--device", "usb:1"}), 2,
                "only with simulated devices");
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--device", "usb:1"}), 5, "usb:1");
  ::setenv("POPCUT_URL", "/nonexistent/popcut.sock", 1);
  check_refused(bench.popcut({"cut", kSphere}), 5, "popcutd does not answer there");
  check_refused(bench.popcut({"cut", "absent.json"}), 3, "absent.json");
  check_refused(bench.popcut({"cut", kSphere, "--yes"}), 2, "--direct");
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--wait"}), 2, "queue");
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--yes", "--device", "sim:nothing"}), 2,
                "nothing");
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--yes", "--device", "sim:cameo3",
                              "--machine", "cameo4"}),
                2, "cameo4");
  check_refused(bench.popcut({"cut", kSphere, "--direct", "--yes", "--machine", "cameo3", "--mat",
                              "100x100", "--no-split"}),
                4, "mm");
}

TEST_CASE("devices lists a simulated one for each machine that popcut drives", "[cli][e2e]") {
  const Bench bench;
  const Ran ran = bench.popcut({"devices"});
  CHECK(ran.exit == 0);
  CHECK(ran.out.find("sim:cameo3 ") != std::string::npos);
  CHECK(ran.out.find("sim:hpgl-generic ") != std::string::npos);
  const auto json = nlohmann::json::parse(bench.popcut({"devices", "--json"}).out);
  const auto machines = nlohmann::json::parse(bench.popcut({"machines", "--json"}).out);
  std::size_t driven = 0;
  for (const auto& machine : machines["machines"])
    driven += machine["language"] == "gpgl" || machine["language"] == "hpgl" ? 1u : 0u;
  CHECK(driven >= 25);
  CHECK(json["devices"].size() == driven);
}

}  // namespace cut_command_test
