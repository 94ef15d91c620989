// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"

namespace popcut {

/// A picture of a sheet's plan, true to scale: strokes coloured from blue (first) to red (last),
/// moves between strokes as hairlines, marks where the first stroke begins and the last one ends,
/// and a legend with lifts, lengths and time. Coordinates are rounded to 0.01 mm. Strokes of the
/// same of 48 colours share a path, so the file stays small.
[[nodiscard]] std::string plan_svg(const PlannedSheet& sheet, const std::string& title);

}  // namespace popcut
