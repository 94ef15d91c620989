// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>
#include "core/drawing/linework.hpp"
#include "core/geometry/overlap.hpp"

namespace popcut {

/// A segment this close along a line lies on it, mm.
inline constexpr double kOverlapTolerance = 0.01;
inline constexpr double kSnapTolerance = 0.05;  ///< mm; line ends closer than this are joined

/// Options of `clean`.
struct CleanOptions {
  double snap_mm{kSnapTolerance};  ///< 0 to `kMostSnap`; 0: only points equal to 0.001 mm
  double one_pass_mm{0.0};         ///< above 0: what runs this near to a line is left out, too
};
inline constexpr double kMostSnap = 1.0;
inline constexpr double kMostOnePass = 1.0;  ///< mm

/// Snaps line ends to another end or vertex within `snap_mm`, but not back along their own line.
/// Vertices within a line do not move, except to a vertex within 0.001 mm. This is the first step
/// of `clean`. O(n) unless lines pile up in one place.
[[nodiscard]] LineWork with_ends_snapped(const LineWork& work, double snap_mm);

/// Makes each place of the drawing belong to one line. Line ends are snapped. A part that lies on a
/// stronger line, or on a longer line of the same kind, is removed (within `kOverlapTolerance`).
/// Outline is stronger than cut, cut than fold, fold than score; pen lines compete only with pen
/// lines. Crossing lines are not changed. Then the lines of each operation are joined into the
/// fewest strokes (see `join`), and vertices on straight lines are dropped. No point moves by more
/// than `snap_mm`. With `one_pass_mm`, what `in_one_pass` leaves out goes, too.
///
/// O(n log n) in the number of segments unless lines pile up in one place. Frees the points of
/// `work` as soon as they have been read.
[[nodiscard]] LineWork clean(LineWork work, const CleanOptions& options = {});

/// `line` without the vertices that lie within `tolerance` mm of the chord that replaces them.
[[nodiscard]] std::vector<PagePoint> without_straight_vertices(std::span<const PagePoint> line,
                                                               double tolerance);

/// A straight piece of a cleaned drawing, from node `a` to node `b`.
struct Piece {
  std::uint32_t a{}, b{};
  PenOperation operation;
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
