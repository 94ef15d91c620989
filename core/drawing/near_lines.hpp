// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

/// Lines this near to each other, mm, are hardly meant: a knife cuts the same place twice.
inline constexpr double kHardlyMeantMm = 0.3;

/// What becomes of a drawing whose lines run close beside each other.
struct SinglePass {
  LineWork once;          ///< without what runs beside another line; its warnings are empty
  double doubled_mm{};    ///< length that was left out
  double cut_folds_mm{};  ///< of it, folds that run beside a cut
  double apart_mm{};      ///< the largest distance of what was left out from the line beside it
};

/// Leaves out what runs within `within_mm` of a stronger line, or of a longer one of the same kind,
/// in nearly the same direction (15 degrees) for at least five times that distance. What goes on
/// is led to the line beside which it came. A line may run beside itself. Pen lines stay. The
/// drawing is cleaned.
///
/// O(n) in the length of lines that run close to others, in steps of a quarter of a millimetre (at
/// most a million of them), plus the cost of `crowded_edges`.
[[nodiscard]] SinglePass in_one_pass(const LineWork& work, double within_mm);

}  // namespace popcut
