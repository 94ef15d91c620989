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
  std::int32_t next{-1};  ///< the piece that continues from its end in the drawing, -1: none
};

/// Joins `pieces` into the fewest strokes and appends these to `out`.
///
/// The pieces of one operation are the edges of a graph. At each node the ends are paired: first
/// those that continue straight, then those drawn as one line. Closed walks that share a node with
/// another walk are merged into it (Hierholzer 1873). So a component with 2 k odd nodes takes k
/// strokes, and a component without odd nodes takes one closed stroke, which is the least possible
/// number (Euler 1736). Folds are an exception: they join only straight on (within 5 degrees),
/// because dashes run from one end of a fold to the other.
///
/// Strokes are in the order of their first pieces and have their direction. Vertices within 0.001
/// mm of a straight line (0.002 mm at the seam of a closed one) are dropped. O(n log n).
void join(const std::vector<Piece>& pieces, std::span<const PagePoint> nodes, LineWork& out);

/// Joins the edges of faces into the loops around them, as outlines. Ends within `tolerance` mm are
/// the same; loops that share a vertex stay separate.
void join_loops(std::span<const Segment> edges, double tolerance, LineWork& out);

}  // namespace popcut
