// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

namespace popcut {

/// Longest command that is read, in bytes: a path of some 400 000 points. What is longer is
/// Unknown.
inline constexpr std::uint64_t kLongestCommand = std::uint64_t{1} << 22;

/// The language a program is written in.
enum class Dialect : std::uint8_t { Gpgl, Hpgl };

/// What one command of a cutter's program asks for, whatever its spelling.
enum class Verb : std::uint8_t {
  Initialise,    ///< reset (ESC EOT, IN)
  Query,         ///< asks for a reply (ENQ, FG, TB71, FA, TC, U, [, OI ...); `text` is the mnemonic
  Move,          ///< tool up, to one point or along several
  Draw,          ///< tool down, through points
  Speed,         ///< args: value as sent [, tool]
  Force,         ///< args: value as sent [, tool]
  BladeOffset,   ///< FC; args as sent
  CornerLift,    ///< FE; args as sent
  CornerExtend,  ///< FF; args as sent
  SelectTool,    ///< J, SP; args: holder or pen, 0 is none
  Mat,           ///< TG; args: mat code
  Orientation,   ///< FN, TB50; args as sent
  WindowNear,    ///< \  ; args: feed, carriage
  WindowFar,     ///< Z  ; args: feed, carriage
  Autoblade,     ///< TF; args: depth, tool
  TrackEnhance,  ///< FY; args as sent
  LineType,      ///< L; args as sent
  Home,          ///< H
  SetOrigin,     ///< SO
  Absolute,      ///< PA without points
  Empty,         ///< a lone terminator: lawful and harmless
  Other,         ///< understood to be a setting, kept as it stands (FW, FM, TJ, ...)
  Unknown,       ///< not understood: kept and shown, never dropped
};

/// A point in machine units as the wire has it, before any page mapping. GPGL sends the feed axis
/// first; HPGL the same two numbers as (x, y). Fractions are lawful.
struct MachinePoint {
  double a{};  ///< first coordinate on the wire: feed in GPGL, x in HPGL
  double b{};  ///< second coordinate: carriage in GPGL, y in HPGL
  friend constexpr auto operator<=>(const MachinePoint&, const MachinePoint&) = default;
};

/// One command. `first .. first + count` index `Program::points` for Move and Draw, else
/// `Program::args`. `begin .. end` are the bytes it was read from or written to.
struct Command {
  Verb verb{};
  std::uint32_t first{};
  std::uint32_t count{};
  std::uint64_t begin{};
  std::uint64_t end{};
  std::uint32_t text{};  ///< index into `Program::texts`: the mnemonic ("FX", "TB50", "ENQ"), or
                         ///< all bytes of an Unknown; not set for Move, Draw and Empty
};

/// A program as a list of commands in order, flat. Points are absolute (relative and binary forms
/// are resolved by the decoder).
struct Program {
  Dialect dialect{};
  double unit_mm{0.05};  ///< size of one machine unit
  std::vector<Command> commands;
  std::vector<MachinePoint> points;
  std::vector<double> args;
  std::vector<std::string> texts;
  bool truncated{false};  ///< the last command is an Unknown that the end of the input cut off
};

}  // namespace popcut
