// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

/// Lines this near to each other, mm, are hardly meant: a knife cuts the same place twice.
inline constexpr double kHardlyMeantMm = 0.3;

/// What runs close beside other lines of a drawing.
struct DoubledLines {
  double doubled_mm{};    ///< its length
  double cut_folds_mm{};  ///< of it, folds that run beside a cut
  double apart_mm{};      ///< the largest distance of it from the line beside it
};

/// The same, and the drawing without it.
struct SinglePass : DoubledLines {
  LineWork once;  ///< its warnings are empty
};

/// Finds what runs within `within_mm` of a stronger line, or of a longer one of the same kind, in
/// nearly the same direction (15 degrees) for at least five times that distance. A line may run
/// beside itself. Pen lines do not count. The drawing is cleaned.
///
/// O(n) in the length of lines that run close to others, in steps of a quarter of a millimetre (at
/// most a million of them), plus the cost of `crowded_edges`.
[[nodiscard]] DoubledLines doubled_lines(const LineWork& work, double within_mm);

/// Leaves out what `doubled_lines` finds. What goes on is led to the line beside which it came.
[[nodiscard]] SinglePass in_one_pass(const LineWork& work, double within_mm);

}  // namespace popcut
