// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/be_delta.hpp"
#include "protocol/command_reader.hpp"

namespace popcut {

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
  void take(unsigned char c, Program& into) override;
  void take_escape(unsigned char c, Program& into) override;
  void begin(unsigned char c);
  void take_mnemonic(unsigned char c, Program& into);
  void take_number(unsigned char c, Program& into);
  void take_delta(unsigned char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void close_deltas(std::uint64_t end, Program& into);

  const DeltaForm* form_{};
  std::int64_t index_{}, weight_{1};
  int digits_{};
  std::vector<MachinePoint> deltas_;  // absolute points of the BE being read
};

}  // namespace popcut
