// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/planning/plan_input.hpp"

namespace popcut::planning {

/// What is known of a drawing from another program, and what a person must say of it, as JSON:
/// `kind` ("svg", "dxf", "fold"), `size_mm` ([width, height] of its lines), `unit` ("said": the
/// file says it; "guessed": 1 unit is read as 1 mm), `asks` ("layers", "colors" or null: the option
/// that must say what lines are for before it can be planned) and `looks`, one for each layer or
/// colour that `asks` is about, else for each colour that has no meaning: `name` (as the option
/// takes it), `option`, `colour`, `length_mm` and `path` (SVG path data in mm, from the upper left
/// corner of the lines). `folds` has the same for layers whose names say a fold and not to which
/// side, or a score. `path` of the document has the other lines.
///
/// @param how  how it is read; `looks` is set here
/// @retval Malformed, OutOfRange  see `drawing_from_text`
[[nodiscard]] Result<std::string> drawing_question(std::string text, InputKind kind,
                                                   SvgReadOptions how);

}  // namespace popcut::planning
