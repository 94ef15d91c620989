// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"

namespace popcut {

/// What will be cut on one sheet, true to scale in mm. Every stroke and every dash is its own path,
/// in the order of cutting (`data-order`), in the layer of its operation and with `data-assignment`
/// (M, V, C for cuts, B for the outline; score and draw by name). Paths have no dashed style. The
/// root element has `data-popcut="dashes"`: the folds are dashes already.
[[nodiscard]] std::string sheet_svg(const PlannedSheet& sheet, const std::string& title);

/// A picture of how the sheets come together, not for cutting: `assembly_svg` of the layout, or for
/// an unsplit drawing each sheet's outline and folds with its name and its place on the mat.
[[nodiscard]] std::string assembly_svg(const Plan& plan);

}  // namespace popcut
