// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/target/triangle_mesh.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/result.hpp"

namespace popcut {

/// Reads the triangles of an STL (text or binary), OBJ or glTF 2.0 file (.glb, or .gltf with its
/// mesh inside); polygons are cut into triangles, all parts of the file together. Nothing beside
/// `bytes` is opened: materials are left out.
/// Counts are checked against the bytes that are there before memory is taken.
///
/// @param name  file name, for its extension (without one the bytes tell) and for errors
/// @retval Malformed   none of these (the text says what else it is, if that can be told),
///                     broken, cut off, without faces
/// @retval OutOfRange  more than `kMaxTriangles`, or a coordinate that is not a finite number
[[nodiscard]] Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes);
/// The same of a glTF file, whatever its name.
[[nodiscard]] Result<TriangleMesh> read_gltf_mesh(const std::string& name, std::string_view bytes);

/// A polygon as triangles of its corners, counted from its first: a fan where it is convex, else by
/// its ears, as it is seen from where it looks largest. What is no simple polygon is a fan too.
///
/// @param face  its corners as indices of `vertices`, at least three
[[nodiscard]] std::vector<Triangle> polygon_triangles(
    std::span<const std::array<float, 3>> vertices, const std::vector<std::uint32_t>& face);

/// Reads heights over a grid from CSV: the first row holds the x values, the first column the y
/// values, both growing; the cell where they meet is left empty or holds any word. Cells are parted
/// by commas, semicolons or tabs (whichever the first line has). Each cell of the grid becomes two
/// triangles.
///
///     ,    0,  10,  20
///     0,  40,  35,   0
///     10, 42,  36,   0
///
/// @param name  for errors, which give line and column (the cell's number in its row)
/// @retval Malformed   a cell that is empty or no number, a row that is shorter or longer than the
///                     first, values of x or y that do not grow
/// @retval OutOfRange  more than 4 million cells
[[nodiscard]] Result<TriangleMesh> read_height_grid(const std::string& name,
                                                    std::string_view bytes);

}  // namespace popcut
