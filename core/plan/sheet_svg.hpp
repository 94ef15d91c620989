// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"

namespace popcut {

/// What will be cut on one sheet, true to scale in mm: every stroke, each dash too, is a path of
/// its own in the order of cutting (`data-order`), in a layer of its operation with
/// `data-assignment` (M, V, C for cuts, B for the outline; score and draw by name). No line is
/// dashed by its style. The root says `data-popcut="dashes"`: folds are dashes already.
[[nodiscard]] std::string sheet_svg(const PlannedSheet& sheet, const std::string& title);

/// How the sheets come together: what `assembly_svg` of a layout draws, or for one whole sheet its
/// outline and its folds as lines, with its name and its place on the mat. To look at, not to cut.
[[nodiscard]] std::string assembly_svg(const Plan& plan);

}  // namespace popcut
