// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// A mesh with fewer triangles: corners in the same cell of a grid become one, and triangles
/// without three corners go (Rossignac and Borrel, Multi-Resolution 3D Approximations for Rendering
/// Complex Scenes, 1993). The corner that comes first in a cell stands for all, so that flat parts
/// stay flat where cells are small. Meshes of `most` triangles or less stay as they are.
/// O(triangles).
///
/// @param cells  along the longest side of the box
[[nodiscard]] TriangleMesh coarse_mesh(const TriangleMesh& mesh, int cells, std::size_t most);

/// The mesh as a binary STL file: `read_mesh` gives the same triangles, bit by bit, in a fraction
/// of the time that it takes to read a text.
[[nodiscard]] std::string stl_bytes(const TriangleMesh& mesh);

}  // namespace popcut
