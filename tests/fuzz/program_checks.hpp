// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <span>

#include "protocol/decode.hpp"
#include "tests/support/moves.hpp"

namespace popcut::fuzzing {

inline void demand(bool holds) {
  if (!holds) std::abort();
}

/// What must hold of a program read from any bytes: its indices are in range and its memory is
/// bounded by the input.
inline void check_sound(const Program& program, std::size_t bytes) {
  std::size_t text = 0;
  for (const Command& command : program.commands) {
    demand(command.begin < command.end && command.end <= bytes);
    const bool way = command.verb == Verb::Move || command.verb == Verb::Draw;
    const std::uint64_t last = std::uint64_t{command.first} + command.count;
    demand(last <= (way ? program.points.size() : program.args.size()));
    if (!way && command.verb != Verb::Empty) demand(command.text < program.texts.size());
  }
  for (const std::string& one : program.texts) text += one.size();
  demand(program.commands.size() <= bytes && program.points.size() <= bytes);
  demand(program.args.size() <= bytes && text <= 2 * bytes);
}

/// Reads `bytes` whole and in two pieces: both must be sound and say the same.
template <typename Reader>
void read_both_ways(std::span<const std::byte> bytes) {
  Program whole, parted;
  Reader one, two;
  one.feed(bytes, whole);
  one.finish(whole);
  const std::size_t cut =
      bytes.empty() ? 0 : std::to_integer<std::size_t>(bytes[0]) % (bytes.size() + 1);
  two.feed(bytes.first(cut), parted);
  two.feed(bytes.subspan(cut), parted);
  two.finish(parted);
  check_sound(whole, bytes.size());
  demand(whole.truncated == parted.truncated && listing(whole) == listing(parted));
  const PenMoves pen = moves(whole);
  std::size_t points = 0;
  for (const PenStroke& stroke : pen.strokes) points += stroke.count;
  demand(points == pen.points.size());
}

}  // namespace popcut::fuzzing
