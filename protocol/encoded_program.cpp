// SPDX-License-Identifier: MIT
#include "protocol/encoded_program.hpp"

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "protocol/decode.hpp"

namespace popcut {
namespace {

/// The bytes of a stroke before the move to its first point: settings, and in HPGL the pen's lift.
Result<std::string_view> settings_of(const EncodedProgram& program, ByteRange stroke) {
  const Result<Program> read = decode(program.dialect, program.view(stroke));
  if (!read) return tl::unexpected(read.error());
  std::uint64_t end = 0;
  for (const Command& command : read->commands) {
    const bool goes =
        (command.verb == Verb::Move || command.verb == Verb::Draw) && command.count != 0;
    if (goes) break;
    end = command.end;
  }
  return std::string_view(program.bytes).substr(stroke.begin, end);
}

/// Blocks of settings in the order in which each was last sent. A later block overrides earlier
/// ones, so a repeated block is needed only once.
Result<std::vector<std::string_view>> settings_before(const EncodedProgram& program,
                                                      std::size_t first) {
  std::vector<std::string_view> blocks;
  for (std::size_t k = 0; k < first; ++k) {
    const ByteRange range = program.strokes[k];
    if (range.begin == range.end) continue;
    const Result<std::string_view> block = settings_of(program, range);
    if (!block) return tl::unexpected(block.error());
    if (block->empty()) continue;
    std::erase(blocks, *block);
    blocks.push_back(*block);
  }
  return blocks;
}

}  // namespace

std::vector<std::uint64_t> first_lines(const EncodedProgram& program) {
  std::vector<std::uint64_t> lines;
  lines.reserve(program.strokes.size());
  for (const ByteRange& stroke : program.strokes) lines.push_back(stroke.begin);
  const Result<Program> read = decode(program.dialect, program.view(program.geometry));
  if (!read) return lines;
  std::size_t k = 0;
  bool found = false;
  for (const Command& command : read->commands) {
    const std::uint64_t begin = command.begin + program.geometry.begin;
    for (; k < lines.size() && begin >= program.strokes[k].end; ++k) found = false;
    if (k == lines.size()) break;
    if (found || command.verb != Verb::Draw) continue;
    lines[k] = begin;
    found = true;
  }
  return lines;
}

std::vector<ByteRange> autoblade_commands(const EncodedProgram& program) {
  std::vector<ByteRange> found;
  const Result<Program> read = decode(program.dialect, program.view());
  if (!read) return found;
  for (const Command& command : read->commands)
    if (command.verb == Verb::Autoblade) found.push_back({command.begin, command.end});
  return found;
}

std::string lift_after(const EncodedProgram& program, std::size_t index) {
  const ByteRange range = program.strokes.at(index);
  if (range.begin == range.end) return {};
  const Result<Program> read = decode(program.dialect, program.view(range));
  if (!read || read->points.empty()) return {};
  // A stroke begins with a move to a point, so its last point is absolute.
  const MachinePoint end = read->points.back();
  if (program.dialect == Dialect::Gpgl) return fmt::format("M{},{}{}", end.a, end.b, kEtx);
  // In the words of the program itself.
  for (const Command& command : read->commands) {
    if (command.verb != Verb::Move) continue;
    const char first = program.bytes[range.begin + command.begin];
    if (first == 'U') return "U;";
    if (first == 'M') return fmt::format("M{},{};", end.a, end.b);
    break;
  }
  return "PU;";
}

namespace {

// What a command of somebody else's program does that popcut neither follows nor wants; empty:
// nothing.
std::string_view harm_of(const Program& program, const Command& command) {
  if (command.verb == Verb::Orientation && command.count > 0 && program.args[command.first] != 0)
    return "turns the sheet, so that popcut cannot know where it cuts";
  if (command.verb != Verb::Other) return {};
  const std::string_view text = program.texts[command.text];
  for (const std::string_view calibrates : {"FB", "TB70", "TB72"})
    if (text == calibrates) return "changes the calibration of the cutter for good";
  if (text == "JOG")
    return "moves the tool as a key does, so that popcut cannot know where it cuts";
  return {};
}

}  // namespace

Result<EncodedProgram> read_foreign(Dialect dialect, std::string bytes) {
  EncodedProgram program;
  program.dialect = dialect;
  program.bytes = std::move(bytes);
  const Result<Program> whole = decode(dialect, program.view());
  if (!whole) return tl::unexpected(whole.error());
  std::uint64_t end = 0;
  bool lifted = true;
  std::optional<std::uint64_t> first_move;
  std::vector<MachinePoint> ends;  // of the strokes
  for (const Command& command : whole->commands) {
    const auto wrong = [&](std::string why) {
      return fail(ErrorKind::Malformed, fmt::format("byte {}", command.begin + 1), std::move(why));
    };
    if (command.verb == Verb::Unknown)
      return wrong(fmt::format("\"{}\" is no command of {}; popcut sends only what it can read",
                               printable(whole->texts[command.text], 20),
                               dialect == Dialect::Gpgl ? "GPGL" : "HPGL"));
    if (command.verb == Verb::Query)
      return wrong(fmt::format("\"{}\" asks the cutter something; remove it, popcut asks itself",
                               printable(whole->texts[command.text], 20)));
    if (const auto harm = harm_of(*whole, command); !harm.empty())
      return wrong(fmt::format(
          "\"{}\" {}; remove it",
          printable(
              std::string_view(program.bytes).substr(command.begin, command.end - command.begin),
              20),
          harm));
    // The machine would answer in the middle of the program, and only its answer says whether the
    // marks are where the lines count from.
    if (command.verb != Verb::Move && command.verb != Verb::Draw && command.verb != Verb::Empty)
      for (const std::string_view search : {"TB123", "TB124"})
        if (std::string_view(program.bytes).substr(command.begin).starts_with(search))
          return wrong(
              "searches for registration marks; cut the drawing with 'popcut cut --marks'");
    if (command.verb == Verb::Move || command.verb == Verb::Home) lifted = true;
    const bool moves = command.verb == Verb::Move && command.count > 0;
    if (moves && !first_move) first_move = command.begin;
    if (command.verb != Verb::Draw || command.count == 0) continue;
    if (!first_move)
      return wrong("draws before it has moved to a place; begin with a move, tool up");
    const bool goes_on = !program.strokes.empty() && program.strokes.back().end == command.begin;
    if (goes_on)
      program.strokes.back().end = command.end;
    else
      program.strokes.push_back({end == 0 ? *first_move : end, command.end});
    end = command.end;
    lifted = false;
    const MachinePoint last = whole->points[command.first + command.count - 1];
    if (goes_on)
      ends.back() = last;
    else
      ends.push_back(last);
  }
  if (program.strokes.empty())
    return fail(ErrorKind::OutOfRange, "", "draws no line; there is nothing to cut");
  for (std::size_t k = 0; k < program.strokes.size(); ++k) {
    const Result<Program> alone = decode(dialect, program.view(program.strokes[k]));
    if (!alone || alone->points.empty() || alone->points.back() != ends[k])
      return fail(ErrorKind::OutOfRange, fmt::format("byte {}", program.strokes[k].begin + 1),
                  "is relative to what came before, so popcut could not stop there; write absolute "
                  "coordinates at the start of each line");
  }
  // Machines look one command ahead: without a move after it the last line is never finished, and
  // the knife stays in the sheet.
  if (!lifted) program.bytes.insert(end, lift_after(program, program.strokes.size() - 1));
  if (*first_move > 0) program.setup.push_back({0, *first_move});
  program.search = {*first_move, *first_move};
  program.geometry = {*first_move, end};
  program.trailer = {end, program.bytes.size()};
  return program;
}

std::string search_lower(const EncodedProgram& program, std::int64_t units) {
  std::string text =
      program.bytes.substr(program.search.begin, program.search.end - program.search.begin);
  const std::size_t left = text.rfind(',');  // the last arguments: the start's top and left
  const std::size_t top = left == std::string::npos || left == 0 ? left : text.rfind(',', left - 1);
  if (top == std::string::npos) return {};
  std::int64_t start = 0;
  const char *const first = text.data() + top + 1, *const last = text.data() + left;
  const auto [end, fault] = std::from_chars(first, last, start);
  if (fault != std::errc() || end != last) return {};
  return text.replace(top + 1, left - top - 1, std::to_string(start + units));
}

Result<EncodedProgram> rest_of(const EncodedProgram& program, std::size_t first) {
  const std::size_t strokes = program.strokes.size();
  if (first >= strokes)
    return fail(
        ErrorKind::OutOfRange, fmt::format("/strokes/{}", first),
        fmt::format("there is no such stroke; the program has {}, counted from 0", strokes));
  const auto settings = settings_before(program, first);
  if (!settings) return tl::unexpected(settings.error());
  EncodedProgram rest;
  rest.dialect = program.dialect;
  rest.ask_blade = program.ask_blade;
  const auto append = [&](std::string_view bytes) {
    const std::uint64_t begin = rest.bytes.size();
    rest.bytes += bytes;
    return ByteRange{begin, rest.bytes.size()};
  };
  const auto copy = [&](ByteRange range) {
    return append(std::string_view(program.bytes).substr(range.begin, range.end - range.begin));
  };
  for (const ByteRange& block : program.setup) rest.setup.push_back(copy(block));
  for (const std::string_view block : *settings) rest.setup.push_back(append(block));
  rest.search = copy(program.search);
  rest.search_again = program.search_again;
  const std::uint64_t from = program.strokes[first].begin;
  rest.geometry = copy({from, program.geometry.end});
  rest.trailer = copy(program.trailer);
  rest.feed_out = copy(program.feed_out);
  for (std::size_t k = first; k < strokes; ++k) {
    const ByteRange range = program.strokes[k];
    rest.strokes.push_back(
        {range.begin - from + rest.geometry.begin, range.end - from + rest.geometry.begin});
  }
  for (const std::uint32_t dot : program.dots)
    if (dot >= first) rest.dots.push_back(static_cast<std::uint32_t>(dot - first));
  return rest;
}

}  // namespace popcut
