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

/// A crease pattern as a plane graph: lines meet in vertices only, each edge is there once.
struct PlanarGraph {
  std::vector<PagePoint> vertices;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<char> assignments;
  std::vector<std::uint32_t> lines;  ///< of each edge, the line that gave it its assignment
  /// Bounded faces, seen with x to the right and y up counter-clockwise; a vertex or edge may come
  /// twice (a slit that ends inside a face). What lies inside of a face without touching it is not
  /// of its loop.
  std::vector<std::vector<std::uint32_t>> faces;
  /// The faces to the left and right of each edge from its first to its second vertex, -1: none.
  std::vector<std::array<std::int32_t, 2>> edge_faces;

  /// Faces that hang together over edges of these assignments count as one: "F" gives the rigid
  /// panels, "FMVU" the pieces of paper.
  [[nodiscard]] std::size_t joined(std::string_view over) const;
};

/// Makes the graph: ends within `tolerance` are one vertex, lines are split where they cross or
/// where an end lies on them, and of lines upon each other the strongest stays (C, B, M and V, U,
/// F). O(n log n) for lines of which few cross.
///
/// @retval OutOfRange  coordinates beyond 100 m, or more than 20 million crossings
[[nodiscard]] Result<PlanarGraph> planar_graph(std::span<const CreaseLine> lines, double tolerance);

/// The graph with its cuts opened: FOLD's split form. Each edge C or B becomes one B a side that
/// has a face, and each vertex one a fan of faces that cuts part from the others. Faces keep their
/// number and their shape.
[[nodiscard]] PlanarGraph split_cuts(const PlanarGraph& graph);

}  // namespace popcut
