// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/outline/area.hpp"
#include "core/result.hpp"

namespace popcut {

/// Shapes with their islands joined to what is around them.
struct BridgedAreas {
  std::vector<Area> areas;
  std::size_t islands{};  ///< that were joined
};

/// Joins each island, a piece that stands free in a hole of another one, to the border of its hole:
/// by a bridge to its left and one to its right, where they are shortest. Level bridges leave a
/// window above and one below, as an H does.
///
/// @param width_mm  of a bridge, in the units of the shapes; 0: nothing is joined
/// @retval OutOfRange  too many islands
/// @retval Infeasible  as `areas_within`
[[nodiscard]] Result<BridgedAreas> with_bridges(std::vector<Area> areas, double width_mm);

}  // namespace popcut
