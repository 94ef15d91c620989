// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"

namespace popcut {

/// A sheet's plan to look at, true to scale: the order of cutting as colour from blue to red, the
/// ways between strokes as hairlines, where the first stroke begins and the last one ends, and a
/// legend with lifts, lengths and time. Places are rounded to 0.01 mm; strokes of one of 48 steps
/// of colour share a path, so the file stays small.
[[nodiscard]] std::string plan_svg(const PlannedSheet& sheet, const std::string& title);

}  // namespace popcut
