// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/arguments.hpp"
#include "protocol/be_delta.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// How a command's arguments are written.
enum class CommandForm : std::uint8_t {
  Numbers,      ///< numbers, kept as sent
  Points,       ///< pairs of coordinates
  Steps,        ///< pairs, each relative to the one before
  Numbered,     ///< the first number belongs to the mnemonic: TB50, FQ0
  Deltas,       ///< bytes of GPGL's BE
  Text,         ///< text up to ETX
  Encoded,      ///< bytes up to the semicolon
  Unsupported,  ///< changes what is drawn in a way that is not followed
};

/// One row of a language's table of commands.
struct CommandEntry {
  std::string_view mnemonic;
  Verb verb;
  CommandForm form{CommandForm::Numbers};
  std::uint8_t least{};  ///< fewest arguments
};

/// What the readers of GPGL and HPGL have in common: a program arrives in pieces of any size, byte
/// by byte, and each completed command is appended to a `Program`.
///
/// ESC codes are read at once, even in the middle of a command, which then continues. A command
/// that exceeds `kLongestCommand` becomes an Unknown.
class CommandReader {
 public:
  /// Reads the next bytes and appends the commands that they complete to `into`. You may empty
  /// `into` between calls. Positions count from the first byte that this reader was given.
  void feed(std::span<const std::byte> piece, Program& into);
  /// No more bytes follow: an unfinished command becomes an Unknown and sets `into.truncated`.
  void finish(Program& into);
  /// A command has begun and not ended.
  [[nodiscard]] bool in_command() const { return state_ != State::Between; }

 protected:
  enum class State : std::uint8_t {
    Between,    // no command has begun
    Mnemonic,   // letters so far
    Numbers,    // arguments of an ordinary command
    FormDigit,  // GPGL: BE, and which one is not known yet
    Deltas,     // GPGL: bytes of BE
    Raw,        // any bytes up to the next terminator
    Escape,     // ESC, and which one is not known yet; this state and those after it are ESC codes
    Jog,        // GPGL: ESC NUL, and which key is not known yet
    Control,    // HPGL: ESC .
    ControlArgs,  // HPGL: ESC . and a letter that takes arguments up to a colon
  };

  CommandReader(Dialect dialect, double unit_mm, std::span<const CommandEntry> commands)
      : dialect_(dialect), unit_mm_(unit_mm), commands_(commands) {}
  CommandReader(const CommandReader&) = default;
  CommandReader& operator=(const CommandReader&) = default;
  virtual ~CommandReader() = default;

  [[nodiscard]] static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
  }

  /// A byte that belongs to no ESC code.
  virtual void take(char c, Program& into) = 0;
  /// A byte after ESC.
  virtual void take_escape(char c, Program& into) = 0;

  /// Null if the language has no such command.
  [[nodiscard]] const CommandEntry* find_command(std::string_view mnemonic) const;
  /// Starts a command with its first byte; the caller sets the state.
  void begin_command(char c);

  /// Appends a command without points and arguments.
  ///
  /// @param text        mnemonic, or all bytes of an Unknown; empty if it has none
  /// @param begin, end  the bytes it was read from
  static void push(Verb verb, std::string text, std::uint64_t begin, std::uint64_t end,
                   Program& into);
  /// Appends the bytes read so far as an Unknown that ends at `end`.
  void push_unknown(std::uint64_t end, Program& into);
  /// Appends a command with arguments.
  void push_numbers(Verb verb, std::string text, std::span<const double> values, std::uint64_t end,
                    Program& into) const;
  /// Appends a Move or a Draw through the points of the arguments, in machine units.
  ///
  /// @param relative  each point counts from the one before; the first from `position_`
  void push_points(Verb verb, bool relative, std::uint64_t end, Program& into);

  State state_{State::Between};
  State resume_{State::Between};  // the state that an ESC code interrupts
  std::uint64_t offset_{};        // of the byte being read
  std::uint64_t begin_{};         // of the command being read
  std::uint64_t escape_at_{};
  std::string raw_;      // bytes of the command being read
  std::string control_;  // bytes of the ESC code being read
  std::string mnemonic_;
  const CommandEntry* entry_{};
  Arguments arguments_;
  MachinePoint position_{};

 private:
  [[nodiscard]] bool in_escape() const { return state_ >= State::Escape; }
  void give_up(Program& into);

  Dialect dialect_;
  double unit_mm_;
  std::span<const CommandEntry> commands_;
};

/// Reads GPGL as tolerantly as the firmware does.
///
/// A command ends at ETX, or where the next command's letter begins; commas between commands are
/// skipped. M, D, O and E take several points, with fractions; O, E and BE are resolved to absolute
/// points. Of the ESC codes, only the reset (ESC EOT) drops the command that it interrupts. A
/// command with missing or unreadable numbers is Unknown, with its bytes, and so is all text from a
/// byte that begins no command up to the next ETX.
class GpglReader final : public CommandReader {
 public:
  GpglReader();

 private:
  void take(char c, Program& into) override;
  void take_escape(char c, Program& into) override;
  void begin(char c);
  void take_mnemonic(char c, Program& into);
  void take_number(char c, Program& into);
  void take_delta(char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void close_deltas(std::uint64_t end, Program& into);

  const DeltaForm* form_{};
  std::int64_t index_{}, weight_{1};
  int digits_{};
  std::vector<MachinePoint> deltas_;  // absolute points of the BE being read
};

/// Reads HPGL.
///
/// A command ends at a semicolon or where the next mnemonic begins; lower case is read as upper
/// case; blanks and line ends are skipped. PU, PD, PA and PR become Move and Draw with absolute
/// points, depending on whether the pen is down; PU and PD without points are a Move and a Draw
/// without points. IW becomes a WindowNear and a WindowFar. ESC . introduces device controls. Arcs,
/// user scales and rotations are not followed: they are Unknown, with their bytes, as is everything
/// that is not HPGL.
class HpglReader final : public CommandReader {
 public:
  HpglReader();

 private:
  void take(char c, Program& into) override;
  void take_escape(char c, Program& into) override;
  void begin(char c);
  void take_mnemonic(char c);
  void take_number(char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void close_points(std::uint64_t end, Program& into);
  void close_window(std::uint64_t end, Program& into);

  char raw_end_{';'};
  bool down_{};
  bool relative_{};
};

}  // namespace popcut
