// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/drawing/linework.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"
#include "daemon/planning/plan_input.hpp"

namespace popcut::planning {

/// The lattice blob of a pattern that popcut did not make: FOLD, SVG or DXF.
///
/// It opens as `popcut deploy` opens it (`pattern_from_fold`, `open_flat_sheet`), as far as it
/// does; a warning says if that is not all the way. Where nothing opens there are only its lines.
/// What `popcut verify` judges of it, and what not, is listed; nothing where there is no fold. What
/// moves in more ways than one, as the net of a box does, gets the warning "many_ways".
///
/// @param how  how it is read; what is unclear then is read as Origami Simulator does
/// @retval Malformed, OutOfRange  it cannot be read
[[nodiscard]] Result<std::string> foreign_blob(std::string text, InputKind kind,
                                               const SvgReadOptions& how);

/// A pattern from elsewhere, to be drawn.
struct ForeignDrawing {
  LineWork lines;
  std::optional<Pattern> pattern;  ///< if it opens by popcut's own law of motion
};
/// @retval Malformed, OutOfRange  it cannot be read
[[nodiscard]] Result<ForeignDrawing> foreign_drawing(std::string text, InputKind kind);

}  // namespace popcut::planning
