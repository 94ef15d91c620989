// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// Capital letters, digits, '-' and '.' as single strokes `height_mm` high with a bar below, so
/// that N and Z, 6 and 9, M and W can be told apart upside down. The baseline's left end is the
/// origin, y down; other characters are left blank.
[[nodiscard]] std::vector<std::vector<PagePoint>> single_stroke(std::string_view text,
                                                                double height_mm);

/// Width and height of what `single_stroke` draws, its bar included.
[[nodiscard]] PagePoint single_stroke_size(std::string_view text, double height_mm);

}  // namespace popcut
