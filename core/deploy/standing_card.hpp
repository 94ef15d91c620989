// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// The faces of a pattern as it stands when it is opened as it was designed, nine numbers a
/// triangle, (x, v, z) in mm. Faces that are no simple polygons are left out: the verifier reports
/// them.
[[nodiscard]] std::vector<float> standing_triangles(const Pattern& pattern);

}  // namespace popcut
