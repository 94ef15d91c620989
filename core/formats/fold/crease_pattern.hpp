// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// Whether a text is a crease pattern as ORIPA, Oriedita and others write it: .cp, lines of a type
/// and two points, or .opx, XML. One with a first line that cannot be read is one, too.
[[nodiscard]] bool is_crease_pattern(std::string_view text);

/// The same pattern as a FOLD text, which has no unit. Type 1 is a border, 2 a mountain fold, 3 a
/// valley fold; others are auxiliary lines, which are flat folds. On the page, x runs to the right
/// and y down, as those programs show it.
///
/// @retval Malformed   a line is not a type and four numbers (place: line and column), not XML, or
///                     an .opx with fewer lines than it announces
/// @retval OutOfRange  an .opx of more than 16 MB
[[nodiscard]] Result<std::string> fold_of_crease_pattern(std::string_view text);

}  // namespace popcut
