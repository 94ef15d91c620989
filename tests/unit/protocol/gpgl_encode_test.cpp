// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "protocol/gpgl_variants.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/protocol_samples.hpp"

namespace gpgl_encode_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

const Mat kMat{"12x12", 1, 304.8, 304.8};

EncodedProgram encoded(const Toolpath& toolpath, const Machine& machine = cameo3(),
                       const Material& material = paper(),
                       const JobOptions& options = on_mat(kMat)) {
  Result<EncodedProgram> program = encode(toolpath, machine, material, options);
  if (!program) FAIL(message(program.error()));
  return *std::move(program);
}

std::string setup_of(const EncodedProgram& program) {
  std::string text;
  for (const ByteRange& block : program.setup) text += readable(program.view(block)) + " ";
  return text;
}

Toolpath one_line() {
  Toolpath toolpath;
  add_stroke(toolpath, {{1, 0}, {1, 10}});
  return toolpath;
}

std::string error_of(const Toolpath& toolpath, const Machine& machine,
                     const Material& material = paper(), const JobOptions& options = {}) {
  const Result<EncodedProgram> program = encode(toolpath, machine, material, options);
  REQUIRE_FALSE(program);
  CHECK(program.error().kind == ErrorKind::OutOfRange);
  return message(program.error());
}

}  // namespace

TEST_CASE("a square has the bytes recorded for the Cameo 3", "[protocol][gpgl][encode]") {
  Toolpath square = four_squares();
  square.strokes.resize(1);
  const EncodedProgram program = encoded(square);
  CHECK(readable(program.view(program.geometry)) ==
        "M0,20|BE1\x90\x7c|BE2\xe8\x21\x90\x8c\xf1\xb1\x70\xfd\x8f\xcc\x2d\x6e|BE1\xa4\x90|");
}

TEST_CASE("the settings of a Cameo 3 are sent in the order and blocks of its own software",
          "[protocol][gpgl][encode]") {
  const std::string start = R"(TG1|FN0|TB50,0|\0,0|Z6096,6096|J1| )";
  Toolpath line = one_line();
  CHECK(setup_of(encoded(line)) ==
        start + "!5,1|FX10,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FC18,1,1|TF1,1| ");

  SECTION("with the fastest speed and the highest force") {
    line.strokes[0].speed_mm_s = 1000;
    line.strokes[0].force_gf = 231;
    CHECK(setup_of(encoded(line)) ==
          start + "!10,1|FX33,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FC18,1,1|TF1,1| ");
  }
  SECTION("with the blade deeper") {
    Material deep = paper();
    deep.autoblade_depth = 5;
    CHECK(setup_of(encoded(line, cameo3(), deep)) ==
          start + "!5,1|FX10,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FC18,1,1|TF5,1| ");
  }
  SECTION("with a ratchet blade") {
    JobOptions options = on_mat(kMat);
    options.autoblade = false;
    CHECK(setup_of(encoded(line, cameo3(), paper(), options)) ==
          start + "!5,1|FX10,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FC18,1,1| ");
  }
  SECTION("with the second holder") {
    line.strokes[0].tool = 2;
    CHECK(setup_of(encoded(line)) ==
          "TG1|FN0|TB50,0|\\0,0|Z6096,6096|J2| "
          "!5,2|FX10,2|FE0,2| FF1,0,2|FF1,1,2|FC0,1,2|FC18,1,2| ");
  }
  SECTION("with a pen") {
    line.strokes[0].operation = Operation::Draw;
    line.strokes[0].speed_mm_s = 1000;
    line.strokes[0].force_gf = 126;
    JobOptions options = on_mat(kMat);
    options.autoblade = false;
    const std::string pen = "!10,1|FX18,1|FC0,1,1| FE0,1|FF0,0,1| ";
    CHECK(setup_of(encoded(line, cameo3(), paper(), options)) == start + pen);
    line.strokes[0].operation = Operation::Cut;
    options.holders = {ToolKind::Pen};
    CHECK(setup_of(encoded(line, cameo3(), paper(), options)) == start + pen);
  }
  SECTION("with track enhancing and lifted corners extended by 0.9 mm") {
    JobOptions options = on_mat(kMat);
    options.track_enhancing = options.corner_lift = true;
    options.corner_start_tenths = options.corner_end_tenths = 9;
    CHECK(setup_of(encoded(line, cameo3(), paper(), options)) ==
          start + "!5,1|FX10,1|FE1,1| FF9,0,1|FF9,9,1|FC0,1,1|FY0|FC18,1,1|TF1,1| ");
  }
  SECTION("with track enhancing off, whatever the machine was left at") {
    JobOptions options = on_mat(kMat);
    options.track_enhancing = false;
    CHECK(setup_of(encoded(line, cameo3(), paper(), options)) ==
          start + "!5,1|FX10,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FY1|FC18,1,1|TF1,1| ");
  }
  SECTION("without a mat") {
    Machine machine = cameo3();
    machine.mats = {kMat};
    const JobOptions options{.page_width_mm = 295, .page_length_mm = 279.8};
    CHECK(setup_of(encoded(line, machine, paper(), options)) ==
          "TG0|FN0|TB50,0|\\0,0|Z5596,5900|J1| "
          "!5,1|FX10,1|FE0,1| FF1,0,1|FF1,1,1|FC0,1,1|FC18,1,1|TF1,1| ");
  }
}

TEST_CASE("every program parks the tool at its end and only there", "[protocol][gpgl][encode]") {
  const EncodedProgram program = encoded(four_squares());
  CHECK(readable(program.view(program.trailer)) == R"(L0|\0,0|M0,0|J0|FN0|TB50,0|)");
  CHECK(program.bytes.find("J0") > program.trailer.begin);
  CHECK(program.trailer.end == program.bytes.size());
}

TEST_CASE("the Cameo 4 gets its accelerations and the Portrait 3 no holder",
          "[protocol][gpgl][encode]") {
  Machine machine = cameo3();
  machine.variant = "cameo4";
  machine.speed_mm_s.max_step = 30;
  Toolpath line = one_line();
  line.strokes[0].speed_mm_s = 3000;
  const std::string tool =
      "FX10,1|TJ0|!30,1|FC0,1,1|FE0,1| FF1,0,1|FF1,1,1|FX10,1|TJ3|FC18,1,1|TF1,1| ";
  CHECK(setup_of(encoded(line, machine)) == "TG1|FN0|TB50,0|\\0,0|Z6096,6096|J1| " + tool);
  machine.tool_holders = 1;
  const EncodedProgram portrait = encoded(line, machine);
  CHECK(setup_of(portrait) == "TG1|FN0|TB50,0|\\0,0|Z6096,6096| " + tool);
  CHECK(readable(portrait.view(portrait.trailer)) == R"(L0|\0,0|M0,0|FN0|TB50,0|)");
}

TEST_CASE("a classic machine draws with D and gets its defaults back", "[protocol][gpgl][encode]") {
  JobOptions options{.page_width_mm = 206, .page_length_mm = 277.9};
  options.window_left_mm = options.window_top_mm = 1.5;
  const EncodedProgram program =
      encoded(one_line(), one_holder("gpgl", "classic"), paper(), options);
  CHECK(readable(program.view()) ==
        R"(FN0|TB50,0|\30,30|Z5558,4120|FX10|!5|FC18|FE0,0|FF0,0,0|M0,20|D200,20|)"
        R"(FX5|!10|FC18|FE0,0|FF0,0,0|L0|\0,0|M0,0|FN0|TB50,0|)");
}

TEST_CASE("fractions are written with two decimals", "[protocol][gpgl][encode]") {
  Toolpath line;
  add_stroke(line, {{577.08 * 0.05, 175.24 * 0.05}, {884.6 * 0.05, 678.704 * 0.05}, {0.0001, -1}});
  JobOptions options{.fractions = true};
  const EncodedProgram program = encoded(line, one_holder("gpgl", "classic"), paper(), options);
  CHECK(readable(program.view(program.geometry)) == "M175.24,577.08|D678.70,884.60|D-20,0|");
  options.draw = DrawForm::Binary;
  CHECK_THAT(error_of(line, cameo3(), paper(), options), Catch::Contains("use D"));
}

TEST_CASE("only settings that change are sent again between strokes", "[protocol][gpgl][encode]") {
  Toolpath toolpath = one_line();
  for (int k = 0; k < 5; ++k) add_stroke(toolpath, {{5, 0}, {5, 1}});
  toolpath.strokes[1].force_gf = 140;
  toolpath.strokes[2].force_gf = 140;
  toolpath.strokes[3].tool = 2;
  toolpath.strokes[4].tool = 2;
  toolpath.strokes[4].speed_mm_s = 200;
  toolpath.strokes[5].force_gf = 140;
  const EncodedProgram program = encoded(toolpath);
  const auto stroke = [&](std::size_t k) { return readable(program.view(program.strokes[k])); };
  const std::string line = "M0,100|BE1\xa4\x90|";
  CHECK(stroke(1) == "FX20,1|" + line);
  CHECK(stroke(2) == line);
  CHECK(stroke(3) == "J2|!5,2|FX10,2|FE0,2|FF1,0,2|FF1,1,2|FC0,1,2|FC18,1,2|" + line);
  CHECK(stroke(4) == "!2,2|" + line);
  CHECK(stroke(5) == "J1|" + line);
}

TEST_CASE("settings without a holder number are sent again for each holder",
          "[protocol][gpgl][encode]") {
  Machine curio = cameo3();
  curio.variant = "classic";
  curio.autoblade = false;
  Toolpath toolpath = one_line();
  add_stroke(toolpath, {{5, 0}, {5, 1}}).tool = 2;
  toolpath.strokes[1].operation = Operation::Draw;
  toolpath.strokes[1].force_gf = 7;
  add_stroke(toolpath, {{6, 0}, {6, 1}});
  const EncodedProgram program = encoded(toolpath, curio);
  CHECK(readable(program.view(program.strokes[1])) ==
        "J2|FX1|!5|FC0|FE0,0|FF0,0,0|M0,100|D20,100|");
  CHECK(readable(program.view(program.strokes[2])) ==
        "J1|FX10|!5|FC18|FE0,0|FF0,0,0|M0,120|D20,120|");
}

TEST_CASE("coordinates go to the nearest unit with halves away from zero",
          "[protocol][gpgl][encode]") {
  Machine machine = one_holder("gpgl", "classic");
  machine.unit_mm = 1;
  Toolpath toolpath;
  add_stroke(toolpath, {{0.5, 2.49}, {-0.5, -2.5}, {-0.49, -3.4}, {1e6, 7}});
  const EncodedProgram program = encoded(toolpath, machine);
  CHECK(readable(program.view(program.geometry)) == "M2,1|D-3,-1|D-3,0|D7,1000000|");
}

TEST_CASE("a stroke that rounds to a dot is reported and not sent", "[protocol][gpgl][encode]") {
  Toolpath toolpath = one_line();
  add_stroke(toolpath, {{5, 5}, {5.02, 5.01}, {5, 5}});
  add_stroke(toolpath, {{6, 0}, {6, 1}, {6.01, 1.01}});
  const EncodedProgram program = encoded(toolpath);
  CHECK(program.dots == std::vector<std::uint32_t>{1});
  CHECK(program.strokes[1].begin == program.strokes[1].end);
  CHECK(readable(program.view(program.strokes[2])) == "M0,120|BE1\xa4\x90|");
}

TEST_CASE("strokes fill the geometry without gaps", "[protocol][gpgl][encode]") {
  const EncodedProgram program = encoded(four_squares());
  REQUIRE(program.strokes.size() == 4);
  std::uint64_t at = program.geometry.begin;
  for (const ByteRange& stroke : program.strokes) {
    CHECK(stroke.begin == at);
    at = stroke.end;
  }
  CHECK(at == program.geometry.end);
  CHECK(program.setup.back().end == program.geometry.begin);
  CHECK(program.geometry.end == program.trailer.begin);
}

TEST_CASE("margins of the machine shift the drawing and widen the window",
          "[protocol][gpgl][encode]") {
  Machine machine = one_holder("gpgl", "generic");
  machine.margin_left_mm = 9;
  machine.margin_top_mm = 1;
  const EncodedProgram program = encoded(one_line(), machine);
  CHECK(readable(program.view(program.geometry)) == "M20,200|D220,200|");
  CHECK_THAT(setup_of(program), Catch::Contains("Z6116,6276|"));
  machine.margin_left_mm = -6;
  CHECK_THAT(readable(encoded(one_line(), machine).view()), Catch::Contains("M20,-100|D220,-100|"));
}

TEST_CASE("force and speed outside the machine are errors that say what it takes",
          "[protocol][gpgl][encode]") {
  Toolpath toolpath = one_line();
  add_stroke(toolpath, {{1, 1}, {2, 2}}).force_gf = 300;
  CHECK(error_of(toolpath, cameo3()) ==
        "/strokes/1: a force of 300 gf; cameo3 takes 7 to 231 gf in steps of 7");
  toolpath.strokes[1].force_gf = 3;
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("7 to 231 gf"));
  toolpath.strokes[1].force_gf = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("7 to 231 gf"));
  toolpath.strokes[1].force_gf = 70;
  toolpath.strokes[0].speed_mm_s = 1100;
  CHECK_THAT(error_of(toolpath, cameo3()),
             Catch::Contains("/strokes/0") && Catch::Contains("100 to 1000 mm/s"));
}

TEST_CASE("force and speed go to the nearest step and a force of 40 is not cut down to 33",
          "[protocol][gpgl][encode]") {
  Machine alpha = cameo3();
  alpha.variant = "cameo4";
  alpha.force_gf.max_step = 40;
  Toolpath toolpath = one_line();
  toolpath.strokes[0].force_gf = 278;  // 39.7 steps of 7 gf
  toolpath.strokes[0].speed_mm_s = 449;
  const std::string text = readable(encoded(toolpath, alpha).view());
  CHECK_THAT(text, Catch::Contains("FX40,1|TJ0|!4,1|") && Catch::Contains("FX40,1|TJ3|"));
  CHECK(text.find("FX33") == std::string::npos);
}

TEST_CASE("a machine without force and speed gets neither", "[protocol][gpgl][encode]") {
  Machine machine = one_holder("gpgl", "generic");
  machine.force_gf = machine.speed_mm_s = {};
  const EncodedProgram program = encoded(one_line(), machine);
  CHECK(readable(program.view()) ==
        R"(FN0|TB50,0|\0,0|Z6096,6096|M0,20|D200,20|L0|\0,0|M0,0|FN0|TB50,0|)");
}

TEST_CASE("what a machine cannot do is an error that names the stroke or the field",
          "[protocol][gpgl][encode]") {
  Toolpath toolpath = one_line();
  toolpath.strokes[0].tool = 3;
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("cameo3 has 2"));
  toolpath.strokes[0].tool = 0;
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("counted from 1"));
  toolpath = one_line();
  toolpath.points[1].x = std::numeric_limits<double>::infinity();
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("must lie on the page"));
  toolpath.points[1].x = 1e12;
  CHECK_THAT(error_of(toolpath, cameo3()), Catch::Contains("must lie on the page"));
  Material deep = paper();
  deep.autoblade_depth = 11;
  CHECK_THAT(error_of(one_line(), cameo3(), deep), Catch::Contains("must be 0 to 10"));
  Machine machine = cameo3();
  machine.variant = "cameo33";
  CHECK_THAT(error_of(one_line(), machine), Catch::Contains("generic, classic, cameo3, cameo4"));
  machine.variant = "cameo3";
  machine.unit_mm = 0;
  CHECK_THAT(error_of(one_line(), machine), Catch::Contains("/unit_mm"));
  machine.language = "gcode";
  CHECK_THAT(error_of(one_line(), machine), Catch::Contains("gpgl or hpgl"));
}

TEST_CASE("an autoblade depth is ignored on a machine without an autoblade",
          "[protocol][gpgl][encode]") {
  Material deep = paper();
  deep.autoblade_depth = 11;
  const EncodedProgram program = encoded(one_line(), one_holder("gpgl", "cameo3"), deep);
  CHECK(program.bytes.find("TF") == std::string::npos);
}

TEST_CASE("nothing is dropped where a line leaves the machine", "[protocol][gpgl][defects]") {
  // Reference drivers turn every segment with one end outside into a move, and so draw nothing.
  Toolpath toolpath;
  add_stroke(toolpath, {{10, 10}, {350, 10}, {350, 50}, {10, 50}});
  const EncodedProgram program = encoded(toolpath);
  const PenMoves drawn = moves(*decode(Dialect::Gpgl, program.view()));
  REQUIRE(drawn.strokes.size() == 1);
  CHECK(drawn.points ==
        std::vector<MachinePoint>{{200, 200}, {200, 7000}, {1000, 7000}, {1000, 200}});
}

TEST_CASE("no command reaches 1024 bytes however long the line", "[protocol][gpgl][defects]") {
  // A reference driver loops for ever over a command that is longer than its window.
  Toolpath toolpath;
  add_stroke(toolpath, {});
  Stroke& stroke = toolpath.strokes[0];
  for (int k = 0; k < 5000; ++k)
    toolpath.points.push_back({k % 2 == 0 ? 1.0 : 2.0 + k % 7 * 20, 1 + k * 0.05});
  stroke.count = 5000;
  for (const DrawForm form : {DrawForm::Text, DrawForm::Binary}) {
    JobOptions options;
    options.draw = form;
    const EncodedProgram program = encoded(toolpath, cameo3(), paper(), options);
    const Program read = *decode(Dialect::Gpgl, program.view());
    std::uint64_t longest = 0;
    for (const Command& command : read.commands)
      longest = std::max(longest, command.end - command.begin);
    CHECK(longest < 1024);
    const PenMoves drawn = moves(read);
    REQUIRE(drawn.strokes.size() == 1);  // continued without lifting
    CHECK(drawn.points.size() == 5000);
  }
}

TEST_CASE("a run of short lines fills its command to the limit", "[protocol][gpgl][encode]") {
  Toolpath toolpath;
  add_stroke(toolpath, {});
  for (int k = 0; k < 1200; ++k) toolpath.points.push_back({0, k * 0.05});
  toolpath.strokes[0].count = 1200;
  const EncodedProgram program = encoded(toolpath);
  std::vector<std::uint64_t> sizes;
  const Program read = decode(Dialect::Gpgl, program.view(program.geometry)).value();
  for (const Command& command : read.commands)
    if (command.verb == Verb::Draw) sizes.push_back(command.end - command.begin);
  CHECK(sizes == std::vector<std::uint64_t>{1022, 1022, 4 + 2 * (1199 - 2 * 509)});
}

TEST_CASE("a line too long for any binary form is drawn with D", "[protocol][gpgl][encode]") {
  Toolpath toolpath;
  add_stroke(toolpath, {{0, 0}, {0, 375481 * 0.05}, {0, 0}, {0, 375482 * 0.05}});
  const std::string text = readable(encoded(toolpath).view(encoded(toolpath).geometry));
  CHECK_THAT(text, Catch::StartsWith("M0,0|BE3") && Catch::EndsWith("|D375482,0|"));
}

TEST_CASE("an empty toolpath gives a program that only parks", "[protocol][gpgl][encode]") {
  const EncodedProgram program = encoded({});
  CHECK(program.geometry.begin == program.geometry.end);
  CHECK(moves(*decode(Dialect::Gpgl, program.view())).strokes.empty());
}

}  // namespace gpgl_encode_test
