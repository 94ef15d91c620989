// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <random>
#include <string>
#include <vector>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/other_replies.hpp"
#include "tests/support/protocol_samples.hpp"

namespace protocol_fuzz_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

/// Text that is nearly a program: pieces of commands, numbers, terminators and noise.
std::string nearly_a_program(Random& random) {
  static const std::vector<std::string> kPieces{
      "M",           "D",   "E",  "O",    "BE1",   "BE2",      "BE3",      "FX",   "!",   "J",
      "TB50",        "\\",  "Z",  "\x03", ",",     "\x1b\x05", "\x1b\x04", "\x1b", "FQ0", "&1,1,1",
      "P",           "SO0", "H",  "L0",   "PU",    "PD",       "PA",       "PR",   ";",   "IN",
      "SP1",         "LB",  "\n", " ",    "\x1b.", "0",        "10",       "-3",   "1.5", "1,2",
      "99999999999", ".",   "-",  "\x80", "\xff",  "\x90\x7c", "a",        "?"};
  std::string text;
  const std::size_t count = below(random, 60);
  for (std::size_t k = 0; k < count; ++k) {
    if (below(random, 20) == 0)
      text += static_cast<char>(below(random, 256));
    else
      text += kPieces[below(random, kPieces.size())];
  }
  return text;
}

void mutate(Random& random, std::string& text) {
  for (std::size_t k = below(random, 6) + 1; k > 0 && !text.empty(); --k) {
    const std::size_t at = below(random, text.size());
    switch (below(random, 4)) {
      case 0:
        text[at] = static_cast<char>(below(random, 256));
        break;
      case 1:
        text.erase(at, below(random, 8) + 1);
        break;
      case 2:
        text.insert(at, 1, static_cast<char>(below(random, 256)));
        break;
      default:
        text.resize(at);
        break;
    }
  }
}

/// What must hold of a program read from any bytes: indices are in range, commands lie in the
/// input, no byte but `skipped` is outside them, and memory is bounded by the input.
void check_sound(const Program& program, std::string_view bytes, std::string_view skipped) {
  std::vector<bool> covered(bytes.size());
  std::size_t texts = 0;
  for (const Command& command : program.commands) {
    REQUIRE(command.begin < command.end);
    REQUIRE(command.end <= bytes.size());
    for (std::uint64_t k = command.begin; k < command.end; ++k) covered[k] = true;
    const bool drawn = command.verb == Verb::Move || command.verb == Verb::Draw;
    REQUIRE(std::uint64_t{command.first} + command.count <=
            (drawn ? program.points.size() : program.args.size()));
    if (!drawn && command.verb != Verb::Empty) REQUIRE(command.text < program.texts.size());
  }
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (!covered[k]) REQUIRE(skipped.find(bytes[k]) != std::string_view::npos);
  for (const std::string& text : program.texts) texts += text.size();
  REQUIRE(program.commands.size() <= bytes.size());
  REQUIRE(program.points.size() * 2 <= bytes.size());
  REQUIRE(program.args.size() <= bytes.size());
  REQUIRE(texts <= 2 * bytes.size());
}

void check_any(const std::string& text) {
  const auto bytes = bytes_of(text);
  const Program gpgl = decode(Dialect::Gpgl, bytes).value();
  check_sound(gpgl, text, ", \t\r\n");
  const Program hpgl = decode(Dialect::Hpgl, bytes).value();
  check_sound(hpgl, text, " \t\r\n");
  for (const Program* const program : {&gpgl, &hpgl}) {
    const PenMoves pen = moves(*program);
    std::size_t points = 0;
    for (const PenStroke& stroke : pen.strokes) points += stroke.count;
    REQUIRE(points == pen.points.size());
    REQUIRE((listing(*program).empty() == program->commands.empty()));
  }
  REQUIRE((guess_dialect(bytes) == Dialect::Gpgl || guess_dialect(bytes) == Dialect::Hpgl));
  REQUIRE(name_of(parse_status(text)) != "");
  if (const auto pair = parse_pair(text)) REQUIRE(text.size() <= 64);
}

}  // namespace

TEST_CASE("any bytes can be read and none is lost", "[protocol][property]") {
  Random random(1);
  for (int k = 0; k < 3000; ++k) {
    std::string noise(below(random, 300), '\0');
    for (char& c : noise) c = static_cast<char>(below(random, 256));
    check_any(noise);
    check_any(nearly_a_program(random));
  }
}

TEST_CASE("damaged programs can be read and no byte of them is lost", "[protocol][property]") {
  Random random(2);
  const Toolpath squares = four_squares();
  const std::vector<std::string> programs{
      encode(squares, cameo3(), paper()).value().bytes,
      encode(squares, one_holder("gpgl", "classic"), paper()).value().bytes,
      encode(squares, one_holder("hpgl", "generic"), paper(),
             {.hpgl = HpglHabits{.speed_and_force = false}})
          .value()
          .bytes};
  for (int k = 0; k < 3000; ++k) {
    std::string text = programs[below(random, programs.size())];
    mutate(random, text);
    check_any(text);
  }
}

TEST_CASE("a program cut off anywhere keeps all that came before", "[protocol][property]") {
  const std::string text = encode(four_squares(), cameo3(), paper()).value().bytes;
  const Program whole = decode(Dialect::Gpgl, bytes_of(text)).value();
  for (std::size_t size = 0; size < text.size(); ++size) {
    CAPTURE(size);
    const Program part =
        decode(Dialect::Gpgl, bytes_of(std::string_view(text).substr(0, size))).value();
    const std::size_t complete = part.commands.size() - (part.truncated ? 1 : 0);
    REQUIRE(complete <= whole.commands.size());
    for (std::size_t k = 0; k < complete; ++k)
      REQUIRE(part.commands[k].end == whole.commands[k].end);
    const std::uint64_t at = complete == 0 ? 0 : whole.commands[complete - 1].end;
    REQUIRE(part.truncated == (at < size));
    if (part.truncated) REQUIRE(part.commands.back().begin == at);
  }
}

}  // namespace protocol_fuzz_test
