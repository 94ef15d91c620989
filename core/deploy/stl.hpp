// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <string_view>

#include "core/deploy/pose_table.hpp"
#include "core/deploy/sheet_mesh.hpp"

namespace popcut {

/// In which axes a mesh is written.
enum class MeshAxes : std::uint8_t {
  Upright,  ///< (x, v, z): x away from the wall, v along the spine, z up
  Paper,    ///< (x, 1 - z, v), as the paper's code has them: y falls as z grows
};

/// Writes `mesh` in one pose as binary STL, mm, with normals computed from the corners; the normal
/// of a triangle without area is zero. `title` goes into the header as far as it fits.
void write_stl(const SheetMesh& mesh, const PoseTable& table, std::size_t pose, MeshAxes axes,
               std::string_view title, std::ostream& out);

}  // namespace popcut
