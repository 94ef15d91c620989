// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// Bytes `begin .. end` of a program.
struct ByteRange {
  std::uint64_t begin{};
  std::uint64_t end{};
  friend constexpr auto operator<=>(const ByteRange&, const ByteRange&) = default;
};

/// A program as it is sent: `setup` blocks, `search`, `geometry`, `trailer`, `feed_out`, with
/// nothing between them. A session waits until the device is ready after the setup, the geometry,
/// the trailer and the way out.
///
/// Every range ends at the end of a command. The strokes' ranges follow each other without gaps
/// and fill the geometry: a stroke's bytes are the settings that changed before it, the move with
/// the tool up to its start, and its lines. A program contains no queries.
struct EncodedProgram {
  Dialect dialect{};
  std::string bytes;
  std::vector<ByteRange> setup;
  ByteRange geometry;
  ByteRange trailer;
  /// Moves past what was cut, tool up, so that the sheet comes out. Sent only after a whole job:
  /// what was stopped must stay where it can be continued.
  ByteRange feed_out{};
  std::vector<ByteRange> strokes;   ///< one per stroke of the toolpath, in its order
  std::vector<std::uint32_t> dots;  ///< strokes whose points all round to one unit: not sent,
                                    ///< their range is empty; the caller reports them
  /// The search for registration marks, if there are any. The machine answers it once; send nothing
  /// more until it has answered that it found them.
  ByteRange search{};
  /// Where it did not find them, how much lower it may begin next, in units: `search_lower`.
  std::vector<std::int64_t> search_again{};
  /// The commands that set an autoblade's depth are sent only to a machine that reports an
  /// autoblade in its first holder. Else they are always sent: a person said what the blade is.
  bool ask_blade{false};

  [[nodiscard]] std::span<const std::byte> view(ByteRange range) const {
    return std::as_bytes(std::span(bytes)).subspan(range.begin, range.end - range.begin);
  }
  [[nodiscard]] std::span<const std::byte> view() const { return std::as_bytes(std::span(bytes)); }
};

/// For each stroke, the byte where its first line begins: before it are only settings and the move
/// to its start, with the tool up. Its begin if the program cannot be read.
[[nodiscard]] std::vector<std::uint64_t> first_lines(const EncodedProgram& program);

/// The commands that set an autoblade's depth, in order; none if the program cannot be read.
[[nodiscard]] std::vector<ByteRange> autoblade_commands(const EncodedProgram& program);

/// The bytes that lift the tool at the end of stroke `index`, for a pause between strokes: a move
/// to the position it is at. Empty for a dot.
[[nodiscard]] std::string lift_after(const EncodedProgram& program, std::size_t index);

/// A program that somebody else wrote, divided as a session needs it: settings before the first
/// move, strokes, and what follows the last line. Where nothing lifts the tool after it, that is
/// added.
///
/// @retval Malformed   a command cannot be read, or asks the machine something, searches for marks,
///                     calibrates the machine, turns the sheet or jogs; place is "byte N"
/// @retval OutOfRange  it draws no line, or has strokes that cannot be read by themselves (relative
///                     coordinates from stroke to stroke)
[[nodiscard]] Result<EncodedProgram> read_foreign(Dialect dialect, std::string bytes);

/// The commands of a program's search for marks, with a start that is so many units lower. Empty if
/// it has none that can be read.
[[nodiscard]] std::string search_lower(const EncodedProgram& program, std::int64_t units);

/// The rest of a program from stroke `first` on, as a program of its own: the whole setup, the
/// settings that earlier strokes changed, the search for marks if there is one, the strokes from
/// `first` on (each begins with a move, tool up), and the trailer. Its stroke 0 is `first`.
///
/// @retval OutOfRange  there is no such stroke
/// @retval Malformed   a stroke before it cannot be read
[[nodiscard]] Result<EncodedProgram> rest_of(const EncodedProgram& program, std::size_t first);

}  // namespace popcut
