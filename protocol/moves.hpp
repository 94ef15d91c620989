// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "core/drawing/toolpath.hpp"
#include "protocol/page_map.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// One line with the tool down, with the settings that hold for it: points `first .. first +
/// count`, its start included. A count of 1 is a dot.
struct PenStroke {
  std::uint32_t first{};
  std::uint32_t count{};
  int tool{1};     ///< 1 if none was selected, 0 after J0 or SP0
  double force{};  ///< as sent, in the machine's steps; 0 if none was sent
  double speed{};
  std::uint64_t begin{};  ///< bytes of its first to its last Draw
  std::uint64_t end{};
};

/// What a program does to the sheet, without how it says so. Flat.
struct PenMoves {
  std::vector<MachinePoint> points;
  std::vector<PenStroke> strokes;
};

/// The strokes of a program in machine units. Points equal to the one before are left out. A stroke
/// ends at a Move, and where tool, force or speed change; it begins where the machine stands, at
/// first (0, 0). SetOrigin shifts what follows.
[[nodiscard]] PenMoves moves(const Program& program);

/// The strokes of a program on the page in mm, with force and speed in physical units by the
/// machine's scales. A program does not tell folds from cuts: all are `Operation::Cut`.
///
/// @param page_length_mm  for machines with y up, as `page_map` takes it
/// @retval OutOfRange     as `page_map`
[[nodiscard]] Result<Toolpath> to_toolpath(const Program& program, const Machine& machine,
                                           double page_length_mm = 0);

/// The program as text to look at: a line a command, with its position in bytes.
///
/// @param most_points  points and numbers shown of one command; the rest is counted
[[nodiscard]] std::string listing(const Program& program, std::size_t most_points = 8);

}  // namespace popcut
