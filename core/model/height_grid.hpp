// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/model/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads heights over a grid from CSV: the first row holds the x values, the first column the y
/// values, both increasing; the cell where they meet is empty or holds any word. Commas, semicolons
/// or tabs (the first of these in the first line) separate cells. Each cell of the grid becomes two
/// triangles, which share the side from its smallest to its largest x and y.
///
///     ,    0,  10,  20
///     0,  40,  35,   0
///     10, 42,  36,   0
///
/// @param name  for errors, which give line and column (the cell's number in its row)
/// @retval Malformed   a cell that is empty or not a number, a row that is shorter or longer than
///                     the first, values of x or y that do not increase
/// @retval OutOfRange  more than 4 million cells
[[nodiscard]] Result<TriangleMesh> read_height_grid(const std::string& name,
                                                    std::string_view bytes);

}  // namespace popcut
