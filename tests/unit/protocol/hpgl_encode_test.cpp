// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "protocol/gpgl_variants.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/protocol_samples.hpp"

namespace hpgl_encode_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

Machine plotter() {
  Machine machine = one_holder("hpgl", "generic");
  machine.force_gf = {1, 31, 10};
  machine.speed_mm_s = {1, 60, 10};
  machine.axes = Axes::CarriageFeed;  // x and y of the page as they are
  machine.mirrored = true;
  return machine;
}

Toolpath two_lines() {
  Toolpath toolpath;
  add_stroke(toolpath, {{0, 0}, {25.4, 0}, {25.4, 25.4}});
  add_stroke(toolpath, {{10, 10}, {20, 10}});
  return toolpath;
}

std::string text_of(const Toolpath& toolpath, const Machine& machine,
                    const JobOptions& options = {}) {
  const Result<EncodedProgram> program = encode(toolpath, machine, paper(), options);
  if (!program) return message(program.error());
  return program->bytes;
}

}  // namespace

TEST_CASE("an inch is 1016 units of HPGL", "[protocol][hpgl][encode][defects]") {
  // One reference driver takes 1021, which cuts 0.5 percent too large.
  CHECK(text_of(two_lines(), plotter()) ==
        "IN;PA;SP1;VS50;FS7;PU0,0;PD1016,0,1016,1016;PU400,400;PD800,400;PU0,0;SP0;IN;");
}

TEST_CASE("each HPGL habit changes how a program is written", "[protocol][hpgl][encode]") {
  JobOptions options;
  SECTION("moves by PA") {
    options.hpgl = HpglHabits{.move_by_pa = true};
    CHECK(text_of(two_lines(), plotter(), options) ==
          "IN;PA;SP1;VS50;FS7;PU;PA0,0;PD1016,0,1016,1016;PU;PA400,400;PD800,400;PU;PA0,0;SP0;IN;");
    Machine machine = plotter();
    machine.variant = "pa";
    CHECK(text_of(two_lines(), machine) == text_of(two_lines(), plotter(), options));
  }
  SECTION("newlines") {
    options.hpgl = HpglHabits{.newline = true};
    CHECK(text_of(two_lines(), plotter(), options) ==
          "IN;\nPA;\nSP1;\nVS50;\nFS7;\nPU0,0;\nPD1016,0,1016,1016;\nPU400,400;\nPD800,400;\n"
          "PU0,0;\nSP0;\nIN;\n");
  }
  SECTION("no speed and force and no final reset") {
    options.hpgl = HpglHabits{.speed_and_force = false, .final_in = false};
    CHECK(text_of(two_lines(), plotter(), options) ==
          "IN;PA;SP1;PU0,0;PD1016,0,1016,1016;PU400,400;PD800,400;PU0,0;SP0;");
  }
}

TEST_CASE("an HPGL machine without scales gets no VS and FS", "[protocol][hpgl][encode]") {
  Machine machine = plotter();
  machine.force_gf = machine.speed_mm_s = {};
  CHECK(text_of(two_lines(), machine) ==
        "IN;PA;SP1;PU0,0;PD1016,0,1016,1016;PU400,400;PD800,400;PU0,0;SP0;IN;");
}

TEST_CASE("HPGL settings change between strokes with the pen up", "[protocol][hpgl][encode]") {
  Machine machine = plotter();
  machine.tool_holders = 2;
  Toolpath toolpath = two_lines();
  toolpath.strokes[1].tool = 2;
  toolpath.strokes[1].force_gf = 200;
  add_stroke(toolpath, {{0, 1}, {1, 1}}).tool = 2;
  toolpath.strokes[2].force_gf = 200;
  CHECK(text_of(toolpath, machine) ==
        "IN;PA;SP1;VS50;FS7;PU0,0;PD1016,0,1016,1016;PU;SP2;FS20;PU400,400;PD800,400;"
        "PU0,40;PD40,40;PU0,0;SP0;IN;");
}

TEST_CASE("HPGL names the feed first on a roll cutter", "[protocol][hpgl][encode]") {
  Machine machine = plotter();
  machine.axes = Axes::FeedCarriage;
  machine.mirrored = false;
  CHECK_THAT(text_of(two_lines(), machine),
             Catch::Contains("PU0,0;PD0,1016,1016,1016;PU400,400;PD400,800;PU0,0;"));
}

TEST_CASE("with the carriage first, the feed counts from the end of the page",
          "[protocol][hpgl][encode]") {
  Machine machine = plotter();
  machine.mirrored = false;
  JobOptions options{.page_length_mm = 100};
  CHECK_THAT(text_of(two_lines(), machine, options),
             Catch::Contains("PU0,4000;PD1016,4000,1016,2984;PU400,3600;PD800,3600;PU0,0;"));
  CHECK_THAT(text_of(two_lines(), machine), Catch::Contains("give the length of the page"));
}

TEST_CASE("negative coordinates are refused for HPGL with the remedy", "[protocol][hpgl][encode]") {
  Toolpath toolpath = two_lines();
  toolpath.points[3] = {-3, -0.5};
  CHECK(text_of(toolpath, plotter()) ==
        "/strokes/1: negative coordinates, which HPGL machines do not take; move the drawing by "
        "3 mm along the machine's x and 0.5 mm along its y");
}

TEST_CASE("a long HPGL line is split into PD commands below 1024 bytes",
          "[protocol][hpgl][encode]") {
  Toolpath toolpath;
  add_stroke(toolpath, {});
  for (int k = 0; k < 3000; ++k) toolpath.points.push_back({1000.0 + k, k % 5 * 100.0});
  toolpath.strokes[0].count = 3000;
  for (const bool newline : {false, true}) {
    JobOptions options;
    options.hpgl = HpglHabits{.newline = newline};
    const std::string text = text_of(toolpath, plotter(), options);
    const Program read = *decode(Dialect::Hpgl, bytes_of(text));
    std::uint64_t longest = 0;
    for (const Command& command : read.commands)
      longest = std::max(longest, command.end - command.begin);
    CHECK(longest < 1024);
    CHECK(longest > 900);
    const PenMoves drawn = moves(read);
    REQUIRE(drawn.strokes.size() == 1);
    CHECK(drawn.points.size() == 3000);
  }
}

TEST_CASE("an unknown variant of HPGL is refused with the known ones", "[protocol][hpgl][encode]") {
  Machine machine = plotter();
  machine.variant = "dmpl";
  CHECK_THAT(text_of(two_lines(), machine), Catch::Contains("generic, pa, newline, plain"));
}

TEST_CASE("HPGL variants are words joined by plus signs", "[protocol][hpgl][encode]") {
  const auto written = [](const char* variant) {
    Machine machine = plotter();
    machine.variant = variant;
    return text_of(two_lines(), machine);
  };
  CHECK(written("pa+newline+plain+open") ==
        "IN;\nPA;\nSP1;\nPU;\nPA0,0;\nPD1016,0,1016,1016;\nPU;\nPA400,400;\nPD800,400;\nPU;\n"
        "PA0,0;\nSP0;\n");
  CHECK(written("ud") ==
        "IN;PA;SP1;VS50;FS7;U0,0;D1016,0,1016,1016;U400,400;D800,400;U0,0;SP0;IN;");
  CHECK(written("camm1+plain") == "IN;SP1;M0,0;D1016,0,1016,1016;M400,400;D800,400;M0,0;SP0;IN;");
  CHECK(written("camm2") == written("generic"));
  CHECK_THAT(written("pa+ud"), Catch::Contains("pa needs PU and PD"));
  CHECK_THAT(written("generic+"), Catch::Contains("\"\" is not a variant"));
}

TEST_CASE("the encoder knows every habit that a table may name", "[protocol][hpgl][encode]") {
  for (const std::string_view word : kHpglWords) {
    CAPTURE(word);
    CHECK(hpgl_habits(word));
  }
  for (const std::string_view name : kGpglVariants) CHECK(find_gpgl_variant(name) != nullptr);
}

TEST_CASE("CAMM-GL takes negative coordinates and other HPGL only if enabled",
          "[protocol][hpgl][encode]") {
  Toolpath toolpath = two_lines();
  toolpath.points[3] = {-3, -0.5};
  Machine machine = plotter();
  for (const char* variant : {"camm1", "camm2", "ud+negative"}) {
    machine.variant = variant;
    CHECK_THAT(text_of(toolpath, machine), Catch::Contains("-120,-20;"));
  }
  machine.variant = "ud";
  CHECK_THAT(text_of(toolpath, machine), Catch::Contains("negative coordinates"));
}

TEST_CASE("the tool is lifted with the command that the program uses", "[protocol][encode]") {
  const auto lifted = [](const Machine& machine) {
    return readable(bytes_of(lift_after(*encode(two_lines(), machine, paper()), 0)));
  };
  Machine machine = plotter();
  CHECK(lifted(machine) == readable(bytes_of("PU;")));
  machine.variant = "ud";
  CHECK(lifted(machine) == readable(bytes_of("U;")));
  machine.variant = "camm1";
  CHECK(lifted(machine) == readable(bytes_of("M1016,1016;")));
  CHECK(lifted(cameo3()) == readable(bytes_of("M508,508\x03")));
}

}  // namespace hpgl_encode_test
