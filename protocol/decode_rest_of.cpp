// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"

namespace popcut {
namespace {

/// The bytes of a stroke before its way to its first point: settings, and in HPGL the pen's lift.
Result<std::string_view> settings_of(const EncodedProgram& program, ByteRange stroke) {
  const Result<Program> read = decode(program.dialect, program.view(stroke));
  if (!read) return tl::unexpected(read.error());
  std::uint64_t end = 0;
  for (const Command& command : read->commands) {
    const bool goes = (command.verb == Verb::Move || command.verb == Verb::Draw) && command.count;
    if (goes) break;
    end = command.end;
  }
  return std::string_view(program.bytes).substr(stroke.begin, end);
}

/// Blocks of settings in the order in which each was sent last. Later ones win over earlier ones,
/// so that a block that comes again need not be sent the first time.
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
  const std::uint64_t from = program.strokes[first].begin;
  rest.geometry = copy({from, program.geometry.end});
  rest.trailer = copy(program.trailer);
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
