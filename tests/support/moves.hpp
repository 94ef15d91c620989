// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "protocol/page_map.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// One line with the tool down and the settings it is drawn with: points `first .. first + count`,
/// including its start. A count of 1 is a dot.
struct PenStroke {
  std::uint32_t first{};
  std::uint32_t count{};
  int tool{1};     ///< 1 if none was selected, 0 after J0 or SP0
  double force{};  ///< as sent, in the machine's steps; 0 if none was sent
  double speed{};
  std::uint64_t begin{};  ///< bytes of its first to its last Draw
  std::uint64_t end{};
};

/// What a program does to the sheet, independent of its language.
struct PenMoves {
  std::vector<MachinePoint> points;
  std::vector<PenStroke> strokes;
};

/// The strokes of a program in machine units, without repeated points. A stroke ends at a Move and
/// where tool, force or speed change. It begins at the machine's current position, initially (0,
/// 0). SetOrigin shifts all points after it.
[[nodiscard]] PenMoves moves(const Program& program);

/// The strokes of a program on the page in mm, with force and speed in physical units by the
/// machine's scales. A program does not distinguish folds from cuts: all are `Operation::Cut`.
///
/// @param page_length_mm  for machines with y up, as `page_map` takes it
/// @retval OutOfRange     as `page_map`
[[nodiscard]] Result<Toolpath> to_toolpath(const Program& program, const Machine& machine,
                                           double page_length_mm = 0);

/// The program as readable text: one line per command, with its position in bytes.
///
/// @param most_points  points or numbers shown per command; the rest is counted
[[nodiscard]] std::string listing(const Program& program, std::size_t most_points = 8);

}  // namespace popcut
