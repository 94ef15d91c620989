// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <set>

#include "protocol/command_reader.hpp"
#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/protocol_samples.hpp"

namespace protocol_round_trip_test {

using namespace popcut;
using namespace popcut::samples;

namespace {

using Random = std::mt19937;

int between(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

double real(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// One machine with the options of one case.
struct Case {
  Machine machine;
  JobOptions options;
  bool negative{true};
};

Case gpgl_case(std::string variant, DrawForm form, bool fractions, int holders) {
  Case c{cameo3(), {}};
  c.machine.variant = std::move(variant);
  c.machine.tool_holders = holders;
  c.options.draw = form;
  c.options.fractions = fractions;
  return c;
}

Case hpgl_case(Axes axes, bool mirrored, HpglHabits habits) {
  Case c{one_holder("hpgl", "generic"), {}, false};
  c.machine.tool_holders = 2;
  c.machine.axes = axes;
  c.machine.mirrored = mirrored;
  c.options.page_length_mm = 1000;
  c.options.hpgl = habits;
  return c;
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const char* variant : {"generic", "classic", "cameo3", "cameo4"}) {
    for (const int holders : {1, 2}) {
      cases.push_back(gpgl_case(variant, DrawForm::Usual, false, holders));
      cases.push_back(gpgl_case(variant, DrawForm::Text, false, holders));
      cases.push_back(gpgl_case(variant, DrawForm::Binary, false, holders));
      cases.push_back(gpgl_case(variant, DrawForm::Usual, true, holders));
    }
  }
  cases.push_back(gpgl_case("cameo3", DrawForm::Usual, false, 2));
  cases.back().machine.margin_left_mm = -6;
  cases.back().machine.margin_top_mm = 1;
  for (const bool mirrored : {false, true}) {
    for (const Axes axes : {Axes::FeedCarriage, Axes::CarriageFeed}) {
      cases.push_back(hpgl_case(axes, mirrored, {}));
      cases.push_back(hpgl_case(axes, mirrored, {.move_by_pa = true}));
      cases.push_back(hpgl_case(axes, mirrored, {.newline = true}));
      cases.push_back(hpgl_case(axes, mirrored, {.move_by_pa = true, .newline = true}));
      cases.push_back(hpgl_case(axes, mirrored, {.words = HpglWords::UpDown}));
      for (const bool newline : {false, true}) {
        cases.push_back(hpgl_case(
            axes, mirrored, {.words = HpglWords::MoveDraw, .newline = newline, .negative = true}));
        cases.back().negative = true;
      }
    }
  }
  return cases;
}

/// A step along one axis, often at the limit of a binary form.
int delta(Random& random) {
  const int sign = between(random, 0, 1) == 0 ? -1 : 1;
  switch (between(random, 0, 6)) {
    case 0:
      return 0;
    case 1:
      return sign * (111 + between(random, -1, 1));
    case 2:
      return sign * (1675 + between(random, -1, 1));
    case 3:
      return sign * (375481 + between(random, -1, 1));
    case 4:
      return sign * between(random, 0, 3000);
    default:
      return sign * between(random, 0, 120);
  }
}

/// A drawing, and the moves that a machine must make of it, worked out without the encoder.
struct Drawing {
  Toolpath toolpath;
  PenMoves expected;
  std::size_t dots{};
};

void add_random_stroke(Random& random, const Case& c, Drawing& drawing) {
  const double grid = c.options.fractions ? 0.01 : 1.0;
  const int holders = c.machine.tool_holders;
  const int force = between(random, c.machine.force_gf.min_step, c.machine.force_gf.max_step);
  const int speed = between(random, c.machine.speed_mm_s.min_step, c.machine.speed_mm_s.max_step);
  Stroke stroke{.operation = between(random, 0, 3) == 0 ? Operation::Draw : Operation::Cut,
                .first = static_cast<std::uint32_t>(drawing.toolpath.points.size())};
  stroke.tool = static_cast<std::uint8_t>(between(random, 1, holders));
  stroke.force_gf = (force + real(random, -0.45, 0.45)) * c.machine.force_gf.per_step;
  stroke.speed_mm_s = (speed + real(random, -0.45, 0.45)) * c.machine.speed_mm_s.per_step;
  const PageMap map = page_map(c.machine, c.options.page_length_mm).value();
  PenStroke expected{static_cast<std::uint32_t>(drawing.expected.points.size()), 0, stroke.tool,
                     static_cast<double>(force), static_cast<double>(speed)};
  long a = between(random, 0, 20000), b = between(random, 0, 20000);
  const int count = between(random, 0, 9) == 0 ? between(random, 2, 700) : between(random, 2, 6);
  for (int k = 0; k < count; ++k) {
    if (k > 0) a += delta(random), b += delta(random);
    if (!c.negative) a = std::abs(a), b = std::abs(b);
    const MachinePoint on_grid{static_cast<double>(a), static_cast<double>(b)};
    const MachinePoint exact{(on_grid.a + real(random, -0.45, 0.45)) * grid,
                             (on_grid.b + real(random, -0.45, 0.45)) * grid};
    drawing.toolpath.points.push_back(map.to_page(exact));
    // Hundredths are compared as the numbers that are nearest to their two decimals.
    const MachinePoint point =
        c.options.fractions ? MachinePoint{on_grid.a / 100, on_grid.b / 100} : on_grid;
    const bool repeats = expected.count > 0 && drawing.expected.points.back() == point;
    if (repeats) continue;
    drawing.expected.points.push_back(point);
    ++expected.count;
  }
  stroke.count = static_cast<std::uint32_t>(count);
  drawing.toolpath.strokes.push_back(stroke);
  if (expected.count > 1) {
    drawing.expected.strokes.push_back(expected);
  } else {
    drawing.expected.points.pop_back();
    ++drawing.dots;
  }
}

Drawing random_drawing(Random& random, const Case& c) {
  Drawing drawing;
  const int strokes = between(random, 0, 12);
  for (int k = 0; k < strokes; ++k) add_random_stroke(random, c, drawing);
  return drawing;
}

EncodedProgram encoded(const Drawing& drawing, const Case& c) {
  Result<EncodedProgram> program = encode(drawing.toolpath, c.machine, paper(), c.options);
  if (!program) FAIL(message(program.error()));
  return *std::move(program);
}

void check_same_moves(const PenMoves& read, const PenMoves& expected) {
  REQUIRE(read.strokes.size() == expected.strokes.size());
  CHECK(read.points == expected.points);
  for (std::size_t k = 0; k < read.strokes.size(); ++k) {
    CHECK(read.strokes[k].first == expected.strokes[k].first);
    CHECK(read.strokes[k].count == expected.strokes[k].count);
    CHECK(read.strokes[k].tool == expected.strokes[k].tool);
    CHECK(read.strokes[k].force == expected.strokes[k].force);
    CHECK(read.strokes[k].speed == expected.strokes[k].speed);
  }
}

/// Every range ends where a command ends, and each stroke's Draws lie in its own range.
void check_ranges(const EncodedProgram& program, const Program& read, const PenMoves& drawn) {
  std::set<std::uint64_t> ends{0};
  for (const Command& command : read.commands) ends.insert(command.end);
  if (program.bytes.find('\n') != std::string::npos) {  // a line end belongs to what it ends
    std::set<std::uint64_t> line_ends{0};
    for (const std::uint64_t end : ends) line_ends.insert(end + 1);
    ends = std::move(line_ends);
  }
  for (const ByteRange& block : program.setup) CHECK(ends.count(block.end) == 1);
  CHECK(ends.count(program.geometry.end) == 1);
  CHECK(program.trailer.end == program.bytes.size());
  std::uint64_t at = program.geometry.begin;
  std::size_t k = 0;
  for (const ByteRange& stroke : program.strokes) {
    CHECK(stroke.begin == at);
    CHECK(ends.count(stroke.end) == 1);
    at = stroke.end;
    if (stroke.begin == stroke.end) continue;
    REQUIRE(k < drawn.strokes.size());
    CHECK(drawn.strokes[k].begin > stroke.begin);
    CHECK(drawn.strokes[k].end <= stroke.end);
    ++k;
  }
  CHECK(at == program.geometry.end);
  CHECK(k == drawn.strokes.size());
}

/// The same program, read in pieces; each piece's commands are listed and dropped.
template <typename Reader>
std::string read_in_pieces(Random& random, std::span<const std::byte> bytes, int longest) {
  Reader reader;
  std::string list;
  while (!bytes.empty()) {
    const auto size =
        std::min<std::size_t>(bytes.size(), static_cast<std::size_t>(between(random, 1, longest)));
    Program program;
    reader.feed(bytes.first(size), program);
    list += listing(program, 1000);
    bytes = bytes.subspan(size);
  }
  Program rest;
  reader.finish(rest);
  return list + listing(rest, 1000);
}

}  // namespace

TEST_CASE("decoding a program gives its toolpath back unit by unit", "[protocol][property]") {
  std::size_t strokes = 0, dots = 0;
  const std::vector<Case> cases = all_cases();
  for (std::size_t k = 0; k < cases.size(); ++k) {
    for (unsigned seed = 0; seed < 30; ++seed) {
      CAPTURE(k, seed, cases[k].machine.variant);
      Random random(seed * 1000 + static_cast<unsigned>(k));
      const Drawing drawing = random_drawing(random, cases[k]);
      const EncodedProgram program = encoded(drawing, cases[k]);
      CHECK(program.dots.size() == drawing.dots);
      const Program read = decode(program.dialect, program.view()).value();
      for (const Command& command : read.commands) REQUIRE(command.verb != Verb::Unknown);
      const PenMoves drawn = moves(read);
      check_same_moves(drawn, drawing.expected);
      check_ranges(program, read, drawn);
      CHECK(guess_dialect(program.view()) == program.dialect);
      strokes += drawn.strokes.size();
      dots += drawing.dots;
    }
  }
  CHECK(strokes > 5000);
  CHECK(dots > 10);
}

TEST_CASE("decoding a program gives its toolpath back on the page within half a unit",
          "[protocol][property]") {
  for (const Case& c : all_cases()) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      CAPTURE(seed, c.machine.language, c.machine.variant);
      Random random(seed);
      const Drawing drawing = random_drawing(random, c);
      const EncodedProgram program = encoded(drawing, c);
      const Program read = decode(program.dialect, program.view()).value();
      const Toolpath back = to_toolpath(read, c.machine, c.options.page_length_mm).value();
      REQUIRE(back.strokes.size() + drawing.dots == drawing.toolpath.strokes.size());
      std::size_t k = 0;
      for (const Stroke& stroke : drawing.toolpath.strokes) {
        if (k == back.strokes.size()) break;
        const PagePoint sent = drawing.toolpath.points_of(stroke).back();
        const PagePoint seen = back.points_of(back.strokes[k]).back();
        const double half = c.machine.unit_mm / 2 + 1e-6;
        const bool dot = back.strokes.size() < drawing.toolpath.strokes.size() &&
                         (std::abs(sent.x - seen.x) > half || std::abs(sent.y - seen.y) > half);
        if (dot) continue;
        CHECK(std::abs(sent.x - seen.x) <= half);
        CHECK(std::abs(sent.y - seen.y) <= half);
        CHECK(std::abs(back.strokes[k].force_gf - stroke.force_gf) <=
              c.machine.force_gf.per_step / 2);
        CHECK(back.strokes[k].tool == stroke.tool);
        ++k;
      }
      CHECK(k == back.strokes.size());
    }
  }
}

TEST_CASE("reading a program in pieces gives the same program", "[protocol][property]") {
  const std::vector<Case> cases = all_cases();
  for (std::size_t k = 0; k < cases.size(); ++k) {
    Random random(static_cast<unsigned>(k));
    const EncodedProgram program = encoded(random_drawing(random, cases[k]), cases[k]);
    const std::string whole = listing(decode(program.dialect, program.view()).value(), 1000);
    for (const int longest : {1, 3, 64, 1000}) {
      CAPTURE(k, longest);
      const std::string pieces = program.dialect == Dialect::Gpgl
                                     ? read_in_pieces<GpglReader>(random, program.view(), longest)
                                     : read_in_pieces<HpglReader>(random, program.view(), longest);
      CHECK(pieces == whole);
    }
  }
}

}  // namespace protocol_round_trip_test
