// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "protocol/command_reader.hpp"

namespace popcut {

/// Reads HPGL.
///
/// A command ends at a semicolon or where the next mnemonic begins; lower case is read as upper
/// case; blanks and line ends are skipped. PU, PD, PA and PR become Move and Draw with absolute
/// points, depending on whether the pen is down; PU and PD without points are a Move and a Draw
/// without points. ESC . introduces device controls. Arcs, user scales and rotations are not
/// followed: they are Unknown, with their bytes, as is everything that is not HPGL.
class HpglReader final : public CommandReader {
 public:
  HpglReader();

 private:
  void take(unsigned char c, Program& into) override;
  void take_escape(unsigned char c, Program& into) override;
  void begin(char c);
  void take_mnemonic(char c);
  void take_number(unsigned char c, Program& into);
  void close(std::uint64_t end, Program& into);
  void close_points(std::uint64_t end, Program& into);

  char raw_end_{';'};
  bool down_{};
  bool relative_{};
};

}  // namespace popcut
