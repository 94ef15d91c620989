// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "protocol/command_reader.hpp"
#include "protocol/decode.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/protocol_samples.hpp"

namespace hpgl_reader_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

Program read(const std::string& text) { return *decode(Dialect::Hpgl, bytes_of(text)); }

/// Verbs and numbers, commands parted by "; ".
std::string brief(const Program& program) {
  std::string out;
  for (const Command& command : program.commands) {
    Program one = program;
    one.commands = {command};
    one.truncated = false;
    std::string line = listing(one, 100).substr(10);
    line.pop_back();
    for (const char c : line)
      if (c != ' ' || out.empty() || out.back() != ' ') out += c;
    out += "; ";
  }
  if (!out.empty()) out.resize(out.size() - 2);
  return out;
}

}  // namespace

TEST_CASE("HPGL moves and draws follow the pen", "[protocol][hpgl][decode]") {
  CHECK(brief(read("IN;PA;SP1;PU1,2;PD3,4,5,6;PU;PA7,8;PD;PA9,9;")) ==
        "initialise IN; absolute PA; tool SP 1; move 1,2; draw 3,4 5,6; move; move 7,8; draw; "
        "draw 9,9");
}

TEST_CASE("HPGL relative points are resolved", "[protocol][hpgl][decode]") {
  CHECK(brief(read("PU10,10;PR;PD1,1,2,2;PA0,0;PR5,5;")) ==
        "move 10,10; setting PR; draw 11,11 13,13; draw 0,0; draw 5,5");
  CHECK(brief(read("PU10,10;PR;DF;PD1,1;")) == "move 10,10; setting PR; setting DF; draw 1,1");
}

TEST_CASE("HPGL may be in lower case on several lines and without semicolons",
          "[protocol][hpgl][decode]") {
  CHECK(brief(read("in;\r\npu 1 2 pd3,4\nPU5,6PD7,8SP;")) ==
        "initialise IN; move 1,2; draw 3,4; move 5,6; draw 7,8; tool SP 0");
}

TEST_CASE("HPGL settings and queries are distinguished", "[protocol][hpgl][decode]") {
  CHECK(brief(read("VS40;FS12,1;VS;OI;!PG;;DF;\x1b.B\x1b.@;0:LT;")) ==
        "speed VS 40; force FS 12,1; setting VS; query OI; setting !PG; empty; setting DF; "
        "query \\x1b.B; setting \\x1b.@;0:; setting LT");
}

TEST_CASE("the window of HPGL is read", "[protocol][hpgl][decode]") {
  CHECK(brief(read("IW1,2,30,40;PD5,5;IW;")) ==
        "window near IW 1,2; window far IW 30,40; draw 5,5; window near IW; window far IW");
  CHECK(brief(read("IW1,2,30;")) == "unknown IW1,2,30");
  std::uint64_t end = 0;
  for (const Command& command : read("IW;IW1,2,30,40;IWPU5,5;").commands) {
    CHECK(command.begin == std::exchange(end, command.end));
    CHECK(command.begin < command.end);
  }
}

TEST_CASE("HPGL that changes geometry in other ways is unknown", "[protocol][hpgl][decode]") {
  const Program program = read("SC0,1,0,1;AA1,2,90;LBhi; there\x03PU1,1;PD1;ZZ1;Q5;\x80\x81;PU;");
  CHECK(brief(program) ==
        "unknown SC0,1,0,1; unknown AA1,2,90; unknown LBhi; there; move 1,1; unknown PD1; "
        "unknown ZZ1; unknown Q5; unknown \\x80\\x81; move");
  CHECK(program.commands[2].begin == 19);
  CHECK(program.commands[2].end == 31);
}

TEST_CASE("an HPGL program that ends within a command is marked as truncated",
          "[protocol][hpgl][decode]") {
  for (const std::string rest : {"PD3,4", "P", "\x1b", "\x1b.", "\x1b.@1", "!P", "LBx"}) {
    const Program program = read("PU1,2;" + rest);
    CAPTURE(rest);
    CHECK(program.truncated);
    REQUIRE(program.commands.size() == 2);
    CHECK(program.commands[1].verb == Verb::Unknown);
    CHECK(program.texts[program.commands[1].text] == rest);
    CHECK(program.commands[1].begin == 6);
  }
}

TEST_CASE("pen down without a point is a dot", "[protocol][hpgl][decode]") {
  const PenMoves pen = moves(read("PU5,6;PD;PU;PU7,7;PD;PD8,8;"));
  REQUIRE(pen.strokes.size() == 2);
  CHECK(pen.strokes[0].count == 1);
  CHECK(pen.points[0] == MachinePoint{5, 6});
  CHECK(pen.strokes[1].count == 2);
}

TEST_CASE("CAMM-GL mode 1 and U and D are read within HPGL", "[protocol][hpgl][decode]") {
  CHECK(brief(read("H;M1,2;D3,4,5,6;I1,1;R-2,-3;I0,5;PU9,9;")) ==
        "home H; move 1,2; draw 3,4 5,6; draw 6,7; move 4,4; draw 4,9; move 9,9");
  CHECK(brief(read("U1,2;D3,4;U;D;d7,8u9,9;")) ==
        "move 1,2; draw 3,4; move; draw; draw 7,8; move 9,9");
  CHECK(brief(read("L0;F30;C1,2,3,0,360;A1,1;")) ==
        "line type L 0; speed F 30; unknown C1,2,3,0,360; unknown A1,1");
}

TEST_CASE("an HPGL command without an end is given up at a limit", "[protocol][hpgl][decode]") {
  HpglReader reader;
  Program program;
  const std::string piece(1 << 20, '~');
  for (int k = 0; k < 10; ++k) reader.feed(bytes_of(piece), program);
  CHECK(program.commands.size() == 2);  // of 4 MiB each, all Unknown
  reader.finish(program);
  REQUIRE(program.commands.size() == 3);
  CHECK(program.commands[2].end == 10U << 20);
  for (const std::string& text : program.texts) CHECK(text.size() <= kLongestCommand);
  // And what follows it is read again.
  reader = {};
  Program after;
  reader.feed(bytes_of("PD" + std::string(5 << 20, '1') + ";PU1,2;"), after);
  CHECK(after.commands.back().verb == Verb::Move);
}

}  // namespace hpgl_reader_test
