// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/fit/triangle_soup.hpp"
#include "core/fit/triangle_tree.hpp"

namespace popcut {

/// Length of the diagonal of the box around a soup, mm; 0 if it is empty.
[[nodiscard]] double diagonal_of(const TriangleSoup& soup);

/// Distance of each point from a surface, mm. It is quick where neighbours in the list are
/// neighbours in space.
[[nodiscard]] std::vector<double> distances(const std::vector<Vec3>& points,
                                            const TriangleTree& to);

}  // namespace popcut
