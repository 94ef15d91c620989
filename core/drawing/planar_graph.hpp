// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/geometry/overlap.hpp"
#include "core/result.hpp"

namespace popcut {

/// A straight line of a crease pattern, with its FOLD assignment: B M V F U C.
struct CreaseLine {
  Segment segment;
  char assignment{'U'};
};

/// A crease pattern as a planar graph: lines meet only in vertices, and each edge occurs once.
struct PlanarGraph {
  std::vector<PagePoint> vertices;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<char> assignments;
  std::vector<std::uint32_t> lines;  ///< per edge: the line that gave it its assignment
  /// Bounded faces, counter-clockwise with x to the right and y up. A vertex or edge may occur
  /// twice (a slit that ends inside a face). Lines inside a face that do not touch its border are
  /// not part of its loop.
  std::vector<std::vector<std::uint32_t>> faces;
  /// Per edge: the faces to its left and right, seen from its first to its second vertex; -1: none.
  std::vector<std::array<std::int32_t, 2>> edge_faces;

  /// Number of groups of faces that are connected over edges of these assignments: "F" gives the
  /// rigid panels, "FMVU" the pieces of paper.
  [[nodiscard]] std::size_t joined(std::string_view over) const;
};

/// Makes the graph. Ends within `tolerance` mm become one vertex; lines are split where they cross
/// or where an end lies on them; of overlapping lines the strongest stays (C, B, M and V, U, F).
/// O(n log n) if few lines cross.
///
/// @retval OutOfRange  coordinates beyond 100 m, or more than 20 million crossings
[[nodiscard]] Result<PlanarGraph> planar_graph(std::span<const CreaseLine> lines, double tolerance);

/// The graph with its cuts opened (FOLD's split form). Each edge C or B becomes one B per side that
/// has a face. Each vertex becomes one per fan: a group of faces around it that cuts do not
/// separate. Faces keep their number and shape.
[[nodiscard]] PlanarGraph split_cuts(const PlanarGraph& graph);

}  // namespace popcut
