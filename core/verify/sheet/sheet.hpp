// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::verify {

/// A fold between two connected faces. Going from `from` to `to`, `left` is on the left.
struct Hinge {
  std::uint32_t edge{};
  std::uint32_t from{};
  std::uint32_t to{};
  std::uint32_t left{};
  std::uint32_t right{};
};

/// How the faces of a pattern are connected, by their sides. A side belongs to a corner of a face
/// and runs to the next corner. Two sides are twins if the faces are connected there. Sides along a
/// cut have no twins, even if the file draws the cut as one edge: this is what separates the faces.
struct Sheet {
  std::vector<std::uint32_t> side_face;  ///< one per side; sides are numbered like `face_vertices`
  std::vector<std::int32_t> side_edge;   ///< -1: no edge joins its two vertices
  std::vector<std::int32_t> side_twin;   ///< -1: a border or a cut
  std::vector<Hinge> hinges;
  std::vector<std::uint32_t> panel_of_face;  ///< rigidly connected faces are one panel
  std::size_t panels{};
  std::vector<std::uint32_t> piece_of_face;
  std::size_t pieces{};

  /// The next side around the face of `side`.
  [[nodiscard]] std::uint32_t next(const FoldModel& file, std::uint32_t side) const {
    const std::uint32_t face = side_face[side];
    return side + 1 == file.face_first[face + 1] ? file.face_first[face] : side + 1;
  }
};

/// Vertices of face `f`.
[[nodiscard]] inline std::span<const std::uint32_t> face_of(const FoldModel& file, std::size_t f) {
  return std::span(file.face_vertices)
      .subspan(file.face_first[f], file.face_first[f + 1] - file.face_first[f]);
}

/// Signed area of face `f` on the flat sheet in mm^2, positive if counter-clockwise.
[[nodiscard]] double area(const FoldModel& file, std::size_t f);

/// Gives a file without faces the faces that its edges enclose, by turning left along the planar
/// graph. Holes surrounded by folds become faces. If edges of the drawing cross without a vertex,
/// the faces will fail the tiling check.
void trace_faces(FoldModel& file);

/// Finds which faces are connected. Inconsistencies go into `check`, named by edge and face: a fold
/// beside only one face, an edge used twice in the same direction, a side that is not an edge.
[[nodiscard]] Sheet make_sheet(const FoldModel& file, VerifyCheck& check);

/// Separates a sheet along its cuts. Each group of connected faces around a vertex gets its own
/// vertex, and a cut drawn as one edge becomes two borders. Faces and the first group at each
/// vertex keep their numbers; copies come after them. A slit that is connected at both ends stays
/// one edge. The file's poses get the copies too.
/// @return number of added vertices
std::size_t part_at_cuts(FoldModel& file, const Sheet& sheet);

/// A loop of borders and cuts: the side that it begins with, and its signed area in mm^2. Each
/// piece has one positive outer loop, holes are negative, a slit has area 0.
struct BorderLoop {
  std::uint32_t start{};
  double area_mm2{};
  double length_mm{};
};
[[nodiscard]] std::vector<BorderLoop> border_loops(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
