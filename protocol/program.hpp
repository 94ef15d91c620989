// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace popcut {

inline constexpr char kEtx = '\x03';
inline constexpr char kEsc = '\x1b';

/// Longest command that is read, in bytes: a path of about 400 000 points. A longer one is Unknown.
inline constexpr std::uint64_t kLongestCommand = std::uint64_t{1} << 22;

/// The language a program is written in.
enum class Dialect : std::uint8_t { Gpgl, Hpgl };

/// What one command of a program asks the cutter to do, in either language.
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
  WindowNear,    ///< \  ; args: feed, carriage; HPGL: any corner of IW; none: all
  WindowFar,     ///< Z  ; args: feed, carriage; HPGL: the other corner
  Autoblade,     ///< TF; args: depth, tool
  TrackEnhance,  ///< FY; args as sent
  LineType,      ///< L; args as sent
  Home,          ///< H
  SetOrigin,     ///< SO
  Absolute,      ///< PA without points
  Empty,         ///< a lone terminator: valid, does nothing
  Other,         ///< a known setting, kept as sent (FW, FM, TJ, ...)
  Unknown,       ///< not understood: kept and reported, never dropped
};

/// A verb in words: "move", "blade offset", ...; "setting" for Other.
[[nodiscard]] std::string_view name_of(Verb verb);

/// `text` in printable ASCII: every other byte is written as \\xNN. Of a text longer than `most`
/// bytes only the beginning is kept.
[[nodiscard]] std::string printable(std::string_view text,
                                    std::size_t most = std::string_view::npos);

/// A point in machine units as sent, before any page mapping. GPGL sends the feed axis first, HPGL
/// sends (x, y). Fractions are valid.
struct MachinePoint {
  double a{};  ///< first coordinate sent: feed in GPGL, x in HPGL
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

/// A program as a flat list of commands in order. Points are absolute: the decoder resolves
/// relative and binary forms.
struct Program {
  Dialect dialect{};
  double unit_mm{0.05};  ///< size of one machine unit
  std::vector<Command> commands;
  std::vector<MachinePoint> points;
  std::vector<double> args;
  std::vector<std::string> texts;
  bool truncated{false};  ///< the input ended within the last command, which is an Unknown
};

}  // namespace popcut
