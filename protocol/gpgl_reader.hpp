// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/arguments.hpp"
#include "protocol/be_delta.hpp"
#include "protocol/program.hpp"

namespace popcut {

struct GpglCommand;

/// Reads GPGL as it arrives, in pieces of any size, as tolerantly as the firmware does.
///
/// A command ends at ETX, or where the next command's letter begins; commas between commands are
/// skipped. M, D, O and E take several points, with fractions; O, E and BE are resolved to absolute
/// points. ESC codes are seen at once, even in the middle of a command, which then goes on; only
/// ESC EOT, the reset, drops it. A command with missing or unreadable numbers is Unknown, with its
/// bytes, and so is all text from a byte that begins no command up to the next ETX.
class GpglReader {
 public:
  /// Reads the next bytes. The commands that they complete are appended to `into`, which may be
  /// emptied between calls. Positions count from the first byte that this reader was given.
  void feed(std::span<const std::byte> piece, Program& into);
  /// No more bytes come: an unfinished command becomes an Unknown, `into.truncated` is set.
  void finish(Program& into);
  /// A command has begun and not ended.
  [[nodiscard]] bool in_command() const { return state_ != State::Between; }

 private:
  enum class State : std::uint8_t {
    Between,    // no command has begun
    Mnemonic,   // letters so far
    Numbers,    // arguments of an ordinary command
    FormDigit,  // BE, and which one is not known yet
    Deltas,     // bytes of BE
    Raw,        // to the next ETX, whatever it is
    Escape,     // ESC, and which one is not known yet
    Jog,        // ESC NUL, and which key is not known yet
  };

  void take(unsigned char c, Program& into);
  void begin(unsigned char c);
  void give_up(Program& into);
  void take_escape(unsigned char c, Program& into);
  void take_mnemonic(unsigned char c, Program& into);
  void take_number(unsigned char c, Program& into);
  void take_delta(unsigned char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void close_deltas(std::uint64_t end, Program& into);
  void push_points(bool relative, std::uint64_t end, Program& into);
  void push_unknown(std::string text, std::uint64_t begin, std::uint64_t end, Program& into);

  State state_{State::Between};
  State resume_{State::Between};  // state that an ESC code interrupts
  std::uint64_t offset_{};        // of the byte being read
  std::uint64_t begin_{};         // of the command being read
  std::uint64_t escape_at_{};
  std::string raw_;  // bytes of the command being read
  std::string mnemonic_;
  const GpglCommand* entry_{};
  Arguments arguments_;
  const DeltaForm* form_{};
  std::int64_t index_{}, weight_{1};
  int digits_{};
  std::vector<MachinePoint> deltas_;  // absolute points of the BE being read
  MachinePoint position_{};
};

}  // namespace popcut
