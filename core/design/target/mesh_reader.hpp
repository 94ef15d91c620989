// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/design/target/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads the triangles of an STL (text or binary) or OBJ file; polygons are cut into triangles, all
/// parts of the file together. Nothing beside `bytes` is opened: an OBJ's materials are left out.
/// Counts are checked against the bytes that are there before memory is taken.
///
/// @param name  file name, for its extension (without one the bytes tell) and for errors
/// @retval Malformed   neither STL nor OBJ, broken, cut off, without faces
/// @retval OutOfRange  more than `kMaxTriangles`, or a coordinate that is not a finite number
[[nodiscard]] Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes);

}  // namespace popcut
