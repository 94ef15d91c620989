// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::verify {

/// A fold: where two faces hang together. Going `from` to `to`, `left` is on the left hand.
struct Hinge {
  std::uint32_t edge{};
  std::uint32_t from{};
  std::uint32_t to{};
  std::uint32_t left{};
  std::uint32_t right{};
};

/// How the faces of a pattern hang together, by its sides (one a corner of a face, running to the
/// next corner). Two sides are twins when the faces hang together there. Along a cut no sides are
/// twins, even where the file draws a cut as one edge: that is the surgery that parts the faces.
struct Sheet {
  std::vector<std::uint32_t> side_face;  ///< one a side; sides count as `face_vertices` does
  std::vector<std::int32_t> side_edge;   ///< -1 where no edge joins its two vertices
  std::vector<std::int32_t> side_twin;   ///< -1 at a border or a cut
  std::vector<Hinge> hinges;
  std::vector<std::uint32_t> panel_of_face;  ///< faces that hang together rigidly are one panel
  std::size_t panels{};
  std::vector<std::uint32_t> piece_of_face;
  std::size_t pieces{};

  /// The side after `side` around its face.
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

/// Signed area of face `f` on the flat sheet in mm^2, positive for a counter-clockwise one.
[[nodiscard]] double area(const FoldModel& file, std::size_t f);

/// Gives a file without faces the ones that its edges enclose: the left turns of the planar graph.
/// Holes come out as faces when folds surround them; a drawing whose edges cross unmarked gives
/// faces that the tiling check refuses.
void trace_faces(FoldModel& file);

/// Finds what hangs together. What is inconsistent goes into `check`, named by edge and face: a
/// fold beside one face only, an edge used twice the same way, a side that is no edge.
[[nodiscard]] Sheet make_sheet(const FoldModel& file, VerifyCheck& check);

/// Signed areas in mm^2 of the loops that the sheet's borders and cuts make: each piece has one
/// positive outer loop, holes are negative, a slit has none.
[[nodiscard]] std::vector<double> border_loops(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify
