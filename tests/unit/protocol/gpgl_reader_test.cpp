// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "protocol/be_delta.hpp"
#include "protocol/command_reader.hpp"
#include "protocol/decode.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/protocol_samples.hpp"

namespace gpgl_reader_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

Program read(const std::string& text) { return *decode(Dialect::Gpgl, bytes_of(gpgl(text))); }

/// The listing without positions, commands parted by "; ".
std::string brief(const Program& program) {
  std::string out;
  const std::string list = listing(program, 100);
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = list.find('\n', at);
    const std::string line = list.substr(at, end - at);
    const std::string words = line.size() > 10 && line[7] != ' ' ? line.substr(10) : line;
    for (std::size_t k = 0; k < words.size(); ++k)
      if (words[k] != ' ' || out.empty() || out.back() != ' ') out += words[k];
    out += "; ";
    at = end + 1;
  }
  if (!out.empty()) out.resize(out.size() - 2);
  return out;
}

std::string brief(const std::string& text) { return brief(read(text)); }

}  // namespace

TEST_CASE("commands of GPGL end at ETX", "[protocol][gpgl][decode]") {
  CHECK(brief("M0,20|D0,0|FX10,1|TB50,0|") ==
        "move 0,20; draw 0,0; force FX 10,1; orientation TB50 0");
}

TEST_CASE("a missing ETX is tolerated before the next letter", "[protocol][gpgl][decode]") {
  CHECK(brief("HM1,2D3,4M5,6|") == "home H; move 1,2; draw 3,4; move 5,6");
  CHECK(brief("M1,2\\0,0Z10,20J1!5,1FX3|") ==
        "move 1,2; window near \\\\ 0,0; window far Z 10,20; tool J 1; speed ! 5,1; force FX 3");
}

TEST_CASE("commas between commands are skipped", "[protocol][gpgl][decode]") {
  CHECK(brief("&100,100,100,\\0,0,Z100,200,L0,M1,2,D3,4,D5,6,|") ==
        "setting & 100,100,100; window near \\\\ 0,0; window far Z 100,200; line type L 0; "
        "move 1,2; draw 3,4; draw 5,6");
}

TEST_CASE("draws take several points and fractions and steps", "[protocol][gpgl][decode]") {
  CHECK(brief("M1.25,-2.5|D3,4,5,6.75,+7,8|") == "move 1.25,-2.5; draw 3,4 5,6.75 7,8");
  CHECK(brief("M10,10|E1,2,-3,4|O5,5|D0,0|") ==
        "move 10,10; draw 11,12 8,16; move 13,21; draw 0,0");
  CHECK(brief("M 10 , 20 |D30 40|D1-2|") == "move 10,20; draw 30,40; draw 1,-2");
}

TEST_CASE("E is a command and never an exponent", "[protocol][gpgl][decode]") {
  CHECK(brief("M100,1E5,6|") == "move 100,1; draw 105,7");
}

TEST_CASE("binary draws become absolute points", "[protocol][gpgl][decode]") {
  const std::string square =
      "M0,20\x03"
      "BE1\x90\x7c\x03"
      "BE2\xe8\x21\x90\x8c\xf1\xb1\x70\xfd\x8f\xcc\x2d\x6e\x03"
      "BE1\xa4\x90\x03";
  CHECK(brief(*decode(Dialect::Gpgl, bytes_of(square))) ==
        "move 0,20; draw 0,0; draw 508,0 508,508 0,508 0,0; draw 20,0");
}

TEST_CASE("bytes of a binary draw that make no whole point are kept", "[protocol][gpgl][decode]") {
  const Program program = read("M0,0|BE1\xa3\x9b\xa3\x9c\x98|FX1|");
  CHECK(brief(program) == "move 0,0; draw 19,11 38,23; unknown \\x98; force FX 1");
  CHECK(program.commands[1].end == 12);
  CHECK(program.commands[2].begin == 12);
  CHECK(program.commands[2].end == 14);
  CHECK(brief("BE1\x90|") == "unknown BE1\\x90");
  CHECK(brief("BE4\x90|BE|M1,1|") == "unknown BE4\\x90; unknown BE; move 1,1");
}

TEST_CASE("each binary form holds deltas to its limit and no further", "[protocol][gpgl][decode]") {
  for (const DeltaForm& form : kDeltaForms) {
    const std::int64_t most = form.half - 1;
    CHECK(shortest_form(most, -most)->number == form.number);
    CHECK(shortest_form(-most, most)->number == form.number);
    const DeltaForm* const next = shortest_form(0, most + 1);
    CHECK((next == nullptr ? 4 : next->number) == form.number + 1);
    for (const Delta delta : {Delta{most, -most}, Delta{-most, most}, Delta{0, 0}, Delta{1, -1}}) {
      std::string text = "BE" + std::to_string(form.number);
      put_delta(form, delta.feed, delta.carriage, [&](char c) { text += c; });
      const Program program = *decode(Dialect::Gpgl, bytes_of(text + '\x03'));
      REQUIRE(program.points.size() == 1);
      CHECK(program.points[0].a == static_cast<double>(delta.feed));
      CHECK(program.points[0].b == static_cast<double>(delta.carriage));
    }
  }
}

TEST_CASE("binary forms have the bytes of their rule", "[protocol][gpgl][decode]") {
  // Worked out apart from this code, with whole numbers of any size.
  struct Row {
    Delta delta;
    std::string payload;
  };
  const std::vector<Row> rows{
      {{111, -111}, "\xff\x21"},
      {{-111, 111}, "\x21\xff"},
      {{508, 0}, "\xe8\x21\x90"},
      {{1675, -1675}, "\xef\x3d\x20"},
      {{-1675, 1675}, "\x69\xe1\xff"},
      {{375481, -375481}, "\x27\xf1\x3d\x20\x20"},
      {{-375481, 375481}, "\x9d\x23\xc1\xff\xff"},
      {{6096, 0}, "\x92\xa5\xef\xff\x8f"},
      {{0, -5000}, "\x22\x8d\xde\x91\x8e"},
  };
  for (const Row& row : rows) {
    const DeltaForm& form = *shortest_form(row.delta.feed, row.delta.carriage);
    CAPTURE(form.number, row.delta.feed, row.delta.carriage);
    std::string payload;
    put_delta(form, row.delta.feed, row.delta.carriage, [&](char c) { payload += c; });
    CHECK(payload == row.payload);
    const std::string text = "BE" + std::to_string(form.number) + row.payload + '\x03';
    const Program program = *decode(Dialect::Gpgl, bytes_of(text));
    REQUIRE(program.points.size() == 1);
    CHECK(program.points[0].a == static_cast<double>(row.delta.feed));
    CHECK(program.points[0].b == static_cast<double>(row.delta.carriage));
  }
}

TEST_CASE("a listing has one line per command and counts what it leaves out",
          "[protocol][listing]") {
  CHECK(listing(read("J1|M1,2|D3,4,5,6,7.5,8||q\\\x80|D1"), 2) ==
        "       0  tool          J 1\n"
        "       3  move          1,2\n"
        "       8  draw          3,4 5,6 ... 1 more\n"
        "      23  empty\n"
        "      24  unknown       q\\\\\\x80\n"
        "      28  unknown       D1\n"
        "the last command is cut off by the end of the program\n");
}

TEST_CASE("ESC codes need no ETX and are seen at once", "[protocol][gpgl][decode]") {
  Program program;
  GpglReader reader;
  reader.feed(bytes_of("\x1b"), program);
  CHECK(program.commands.empty());
  reader.feed(bytes_of("\x05"), program);
  CHECK(brief(program) == "query ENQ");
  reader.feed(bytes_of("M10,"), program);
  reader.feed(bytes_of("\x1b\x05"), program);
  CHECK(brief(program) == "query ENQ; query ENQ");
  reader.feed(bytes_of("20\x03"), program);
  CHECK(brief(program) == "query ENQ; query ENQ; move 10,20");
  CHECK_FALSE(reader.in_command());
}

TEST_CASE("a query between the bytes of a point does not change it", "[protocol][gpgl][decode]") {
  const std::string be = "BE2\xe8\x21";
  CHECK(brief("M0,0|" + be + "\x1b\x05\x90|") == "move 0,0; query ENQ; draw 508,0");
}

TEST_CASE("a reset drops the command that it interrupts and keeps its bytes",
          "[protocol][gpgl][decode]") {
  CHECK(brief("M5,5|M10,\x1b\x04"
              "E1,1|") == "move 5,5; unknown M10,; initialise EOT; draw 1,1");
}

TEST_CASE("jog keys take one more byte and other ESC codes are unknown",
          "[protocol][gpgl][decode]") {
  const std::string jog("\x1b\x00\x04\x1b\x00\x1b", 6);
  const Program program = *decode(Dialect::Gpgl, bytes_of(jog + "\x1b\x15\x1bQ"));
  CHECK(brief(program) == "setting JOG 4; setting JOG 27; query NAK; unknown \\x1bQ");
}

TEST_CASE("a lone ETX is an empty command", "[protocol][gpgl][decode]") {
  CHECK(brief("FC18,1,1||M0,0|") == "blade offset FC 18,1,1; empty; move 0,0");
}

TEST_CASE("unknown commands are kept with bytes and position", "[protocol][gpgl][decode]") {
  const Program program = read("M1,2|qqq\x80 7|XY12,3|D1|D|D1,,2|FX|M1,2x3|D5,6|");
  CHECK(brief(program) ==
        "move 1,2; unknown qqq\\x80 7; unknown XY12,3; unknown D1; unknown D; unknown D1,,2; "
        "unknown FX; unknown M1,2x3; draw 5,6");
  CHECK(program.commands[1].begin == 5);
  CHECK(program.commands[1].end == 12);
}

TEST_CASE("numbers have bounds", "[protocol][gpgl][decode]") {
  CHECK(brief("M2147483648,-2147483648|") == "move 2147483648,-2147483648");
  CHECK(brief("M2147483649,0|") == "unknown M2147483649,0");
  CHECK(brief("M1.2.3,0|M-,0|M.,0|M--1,0|") ==
        "unknown M1.2.3,0; unknown M-,0; unknown M.,0; unknown M--1,0");
  const std::string digits(33, '0');
  CHECK(brief("M" + digits + ",0|") == "unknown M" + digits + ",0");
}

TEST_CASE("curves that cannot be followed are kept as unknown", "[protocol][gpgl][decode]") {
  CHECK(brief("BZ0,1,2,3,4,5,6,7,8|W1,2,3|Pa text, M1,2|&2,2,1|") ==
        "unknown BZ0,1,2,3,4,5,6,7,8; unknown W1,2,3; unknown Pa text, M1,2; unknown &2,2,1");
}

TEST_CASE("queries are distinguished from settings by their number", "[protocol][gpgl][decode]") {
  CHECK(brief("FG|TB71|FQ0|FA|TC|[|U|TB99|TB51,400|") ==
        "query FG; query TB71; query FQ0; query FA; query TC; query [; query U; setting TB99; "
        "setting TB51 400");
}

TEST_CASE("a program that ends within a command is marked as truncated",
          "[protocol][gpgl][decode]") {
  for (const std::string rest : {"M3,", "BE1\x90\x91\x92", "\x1b", "F", "qq", "BE"}) {
    const Program program = read("M1,2|" + rest);
    CHECK(program.truncated);
    REQUIRE(program.commands.size() == 2);
    CHECK(program.commands[1].verb == Verb::Unknown);
    CHECK(program.commands[1].begin == 5);
    CHECK(program.commands[1].end == 5 + rest.size());
    CHECK(program.texts[program.commands[1].text] == rest);
  }
  CHECK_FALSE(read("M1,2|").truncated);
}

TEST_CASE("commands fed in pieces to an emptied program come out whole",
          "[protocol][gpgl][decode]") {
  GpglReader reader;
  std::string out;
  for (const char c : gpgl("TG1|M0,20|BE1\xa4\x90|FX3,1|")) {
    Program program;
    reader.feed(bytes_of({&c, 1}), program);
    if (!program.commands.empty()) out += brief(program) + "; ";
  }
  CHECK(out == "mat TG 1; move 0,20; draw 20,20; force FX 3,1; ");
}

TEST_CASE("settings apply to their holder and a change splits a line", "[protocol][gpgl][decode]") {
  const PenMoves pen =
      moves(read("J1|FX10,1|FX20,2|!5,1|M0,0|D1,1|FX10,1|D2,2|FX11,1|D3,3|J2|M0,0|D9,9|J0|"));
  REQUIRE(pen.strokes.size() == 3);
  CHECK(pen.strokes[0].count == 3);
  CHECK(pen.strokes[0].force == 10);
  CHECK(pen.strokes[0].speed == 5);
  CHECK(pen.strokes[1].count == 2);
  CHECK(pen.points[pen.strokes[1].first] == MachinePoint{2, 2});
  CHECK(pen.strokes[1].force == 11);
  CHECK(pen.strokes[2].tool == 2);
  CHECK(pen.strokes[2].force == 20);
}

TEST_CASE("an origin set within a program shifts what follows", "[protocol][gpgl][decode]") {
  const PenMoves pen = moves(read("M10,20|SO0|D1,1|E1,1|"));
  CHECK(pen.points == std::vector<MachinePoint>{{10, 20}, {11, 21}, {12, 22}});
}

TEST_CASE("the language of a program is guessed from its first bytes", "[protocol][decode]") {
  CHECK(guess_dialect(bytes_of(gpgl("FN0|TB50,0|M1,2|D3,4|"))) == Dialect::Gpgl);
  CHECK(guess_dialect(bytes_of("HM1,2D3,4M5,6D7,8")) == Dialect::Gpgl);
  CHECK(guess_dialect(bytes_of("\x1b\x04M10,10\x03")) == Dialect::Gpgl);
  CHECK(guess_dialect(bytes_of("IN;PA;SP1;PU0,0;PD1,1;")) == Dialect::Hpgl);
  CHECK(guess_dialect(bytes_of("in;pu0,0pd1,1")) == Dialect::Hpgl);
  CHECK(guess_dialect(bytes_of("IN;\nPU1,2;\nPD3,4;\nLBtext\x03;PU;")) == Dialect::Hpgl);
  CHECK(guess_dialect({}) == Dialect::Gpgl);
}

TEST_CASE("what no cutter of popcut takes is named", "[protocol][decode]") {
  const auto says = [](std::string_view text) { return foreign_program(bytes_of(text)); };
  CHECK(says("\x1b.(;\x1b.I81;;17:IN;SC;PU;PA1,1;").find("begins with ESC.(,") !=
        std::string::npos);
  CHECK(says("\x1b%-12345X@PJL\r\n\x1b%1BIN;").find("is a print job") != std::string::npos);
  CHECK(says("; made by x\nG21\nG90\nG0 X0 Y0\n").find("is G-code") != std::string::npos);
  CHECK(says("%\nN10 G21\nN20 G1X5Y5F100\n").find("is G-code") != std::string::npos);
  CHECK(says(gpgl("FN0|TB50,0|M1,2|D3,4|")).empty());
  CHECK(says("\x1b\x04M10,10\x03").empty());
  CHECK(says("IN;PA;SP1;PU0,0;PD1,1;").empty());
}

TEST_CASE("a GPGL command without an end is given up at a limit", "[protocol][gpgl][decode]") {
  GpglReader reader;
  Program program;
  reader.feed(bytes_of("BE1" + std::string(5 << 20, '\x90') + "\x03M1,2\x03"), program);
  REQUIRE(program.commands.size() == 3);
  CHECK(program.commands[0].verb == Verb::Unknown);
  CHECK(program.commands[1].verb == Verb::Unknown);
  CHECK(program.commands[2].verb == Verb::Move);
  CHECK(program.points.size() == 1);
}

}  // namespace gpgl_reader_test
