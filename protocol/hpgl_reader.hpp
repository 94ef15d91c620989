// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/arguments.hpp"
#include "protocol/program.hpp"

namespace popcut {

struct HpglCommand;

/// Reads HPGL as it arrives, in pieces of any size.
///
/// A command ends at a semicolon or where the next mnemonic begins; small letters are taken as
/// capitals, blanks and line ends are skipped. PU, PD, PA and PR become Move and Draw with absolute
/// points, according to whether the pen is down; PU and PD without points are a Move and a Draw
/// without points. ESC . device controls are seen at once. Arcs, user scales and rotations are not
/// followed: they are Unknown, as is all that is not HPGL, with its bytes.
class HpglReader {
 public:
  /// Reads the next bytes, as `GpglReader::feed` does.
  void feed(std::span<const std::byte> piece, Program& into);
  /// No more bytes come, as `GpglReader::finish` takes it.
  void finish(Program& into);
  /// A command has begun and not ended.
  [[nodiscard]] bool in_command() const { return state_ != State::Between; }

 private:
  enum class State : std::uint8_t {
    Between,     // no command has begun
    Mnemonic,    // the first letter, or ! and a letter
    Numbers,     // arguments
    Raw,         // to the next terminator, whatever it is
    Escape,      // ESC
    Control,     // ESC .
    ControlArg,  // ESC . and a letter that takes arguments up to a colon
  };

  void take(unsigned char c, Program& into);
  void begin(char c);
  void give_up(Program& into);
  void take_escape(unsigned char c, Program& into);
  void take_mnemonic(char c);
  void take_number(unsigned char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void push_points(std::uint64_t end, Program& into);

  State state_{State::Between};
  State resume_{State::Between};
  std::uint64_t offset_{};
  std::uint64_t begin_{};
  std::uint64_t escape_at_{};
  std::string raw_, mnemonic_, control_;
  char raw_end_{';'};
  const HpglCommand* entry_{};
  Arguments arguments_;
  MachinePoint position_{};
  bool down_{};
  bool relative_{};
};

}  // namespace popcut
