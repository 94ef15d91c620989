// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/geometry/overlap.hpp"

namespace popcut {

/// A straight piece of a cleaned drawing, from node `a` to node `b`.
struct Piece {
  std::uint32_t a{}, b{};
  Operation operation{};
  std::int32_t next{-1};  ///< piece that goes on from its end in the drawing, -1 for none
};

/// Draws `pieces` with the fewest strokes and appends them to `out`.
///
/// The pieces of one operation are the edges of a graph. At each node its ends are paired, those
/// that go straight on first, then those that were drawn as one line; closed walks that share a
/// node with another walk are then taken into it (Hierholzer 1873). So a component with 2 k odd
/// nodes takes k strokes, and one without any takes one closed stroke: the least number there is
/// (Euler 1736). Folds are the exception: they are joined straight on only (within 5 degrees), for
/// a fold is dashed from one end to the other.
///
/// Strokes stand in the order of their first pieces and run as those do. Vertices within 0.001 mm
/// of a straight line (0.002 mm at the seam of a closed one) are left out. O(n log n).
void join(const std::vector<Piece>& pieces, std::span<const PagePoint> nodes, LineWork& out);

/// Joins the edges of faces to the loops round them, as outlines: ends that meet within `tolerance`
/// are one, and loops that share a vertex stay apart.
void join_loops(std::span<const Segment> edges, double tolerance, LineWork& out);

}  // namespace popcut
