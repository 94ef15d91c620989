// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// Polylines of capital letters, digits, '-' and '.', `height_mm` high, as single strokes with a
/// bar below. The bar tells N from Z, 6 from 9 and M from W when the paper lies upside down. The
/// origin is the left end of the baseline, y down, mm. Other characters become spaces.
[[nodiscard]] std::vector<std::vector<PagePoint>> single_stroke(std::string_view text,
                                                                double height_mm);

/// Width and height in mm of what `single_stroke` draws, including the bar.
[[nodiscard]] PagePoint single_stroke_size(std::string_view text, double height_mm);

}  // namespace popcut
