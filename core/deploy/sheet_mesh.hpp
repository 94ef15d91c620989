// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/strips/strips.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The rigid faces as triangles: face `f` has the corners `first_corner[f] .. first_corner[f + 1]`
/// and the triangles `first_triangle[f] .. first_triangle[f + 1]`.
struct FaceTriangles {
  std::vector<std::uint32_t> first_corner, first_triangle;
  std::vector<Vec3> corner;        ///< places of the flat sheet, counter-clockwise around each face
  std::vector<Triangle> triangle;  ///< counter-clockwise, indices of corners

  [[nodiscard]] std::size_t faces() const { return first_corner.size() - 1; }
};

/// Cuts every face into triangles (core/geometry/triangulate.hpp): as many as it has corners that
/// turn, less two, joined without cracks.
///
/// @retval OutOfRange  a face is not a simple polygon with an area; `place` is "faces/N"
[[nodiscard]] Result<FaceTriangles> triangulate_faces(const Pattern& pattern);

/// Triangles that ride on the bodies of a pose table: place `at[i]` of the flat sheet moves with
/// `body[i]`. Front sides look to the side on which the structure pops up.
struct SheetMesh {
  std::vector<Vec3> at;
  std::vector<std::uint32_t> body;
  std::vector<Triangle> triangles;
};

/// How many sides of faces cross the strips between neighbouring borders: about twice the panels of
/// a lattice, but up to faces times borders where faces lie on each other.
[[nodiscard]] std::size_t border_crossings(const Pattern& pattern);

inline constexpr std::size_t kMaxCrossings = 20'000'000;

/// The sheet as one surface: two triangles a panel, strip by strip, each strip from the wall
/// outward. Panels are found from the faces of the pattern, cut where strips meet. Where a pattern
/// is not all rectangles, or has more than `kMaxCrossings`, its faces as triangles instead.
///
/// @retval OutOfRange  a face is not a simple polygon; `place` is "faces/N"
[[nodiscard]] Result<SheetMesh> surface_mesh(const Pattern& pattern);

/// The same of a design whose strips are known: exactly two triangles for each panel of `strips`,
/// where the pattern is all rectangles.
///
/// @retval Internal  a panel lies in no face of the pattern
[[nodiscard]] Result<SheetMesh> surface_mesh(const Pattern& pattern, const Strips& strips);

/// Two triangles for each face of a pattern whose faces are rectangles with the corners (u0, v0),
/// (u1, v0), (u1, v1), (u0, v1), as `pattern_from_segments` makes them; faces may overlap.
[[nodiscard]] SheetMesh rectangle_mesh(const Pattern& pattern);

/// Every rigid face as a closed solid of its own, `thickness_mm` thick, half of it on either side
/// of the sheet: all sides counter-clockwise from outside, each edge of exactly two triangles.
/// Solids overlap at the folds by what half the thickness takes.
///
/// @retval OutOfRange  the thickness is not positive; a face is not a simple polygon
[[nodiscard]] Result<SheetMesh> solid_mesh(const Pattern& pattern, double thickness_mm);

}  // namespace popcut
