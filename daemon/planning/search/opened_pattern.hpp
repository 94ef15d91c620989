// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut::planning {

/// The faces of a pattern as it stands when it is opened as it was designed, nine numbers a
/// triangle, (x, v, z) in mm. Faces that are no simple polygons are left out: the verifier reports
/// them.
[[nodiscard]] std::vector<float> opened_pattern(const Pattern& pattern);

}  // namespace popcut::planning
