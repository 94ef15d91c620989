// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

/// A segment this close along a line lies on it, mm.
inline constexpr double kOverlapTolerance = 0.01;
inline constexpr double kSnapTolerance = 0.05;  ///< mm; line ends closer than this are joined

/// Options of `clean`.
struct CleanOptions {
  double snap_mm{kSnapTolerance};  ///< 0 to `kMostSnap`; 0: only points equal to 0.001 mm
};
inline constexpr double kMostSnap = 1.0;

/// Snaps line ends to another end or vertex within `snap_mm`, but not back along their own line.
/// Vertices within a line do not move, except to a vertex within 0.001 mm. This is the first step
/// of `clean`. O(n) unless lines pile up in one place.
[[nodiscard]] LineWork with_ends_snapped(const LineWork& work, double snap_mm);

/// Makes each place of the drawing belong to one line. Line ends are snapped. A part that lies on a
/// stronger line, or on a longer line of the same kind, is removed (within `kOverlapTolerance`).
/// Outline is stronger than cut, cut than fold, fold than score; pen lines compete only with pen
/// lines. Crossing lines are not changed. Then the lines of each operation are joined into the
/// fewest strokes (see `join`), and vertices on straight lines are dropped. No point moves by more
/// than `snap_mm`.
///
/// O(n log n) in the number of segments unless lines pile up in one place.
[[nodiscard]] LineWork clean(const LineWork& work, const CleanOptions& options = {});
/// The same; frees the points of `work` as soon as they have been read.
[[nodiscard]] LineWork clean(LineWork&& work, const CleanOptions& options = {});

/// `line` without the vertices that lie within `tolerance` mm of the chord that replaces them.
[[nodiscard]] std::vector<PagePoint> without_straight_vertices(std::span<const PagePoint> line,
                                                               double tolerance);

}  // namespace popcut
