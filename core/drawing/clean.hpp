// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

inline constexpr double kOverlapTolerance = 0.01;  ///< mm beside a line that still lie on it
inline constexpr double kSnapTolerance = 0.05;     ///< mm between ends that are one point

struct CleanOptions {
  double snap_mm{kSnapTolerance};  ///< 0 to `kMostSnap`; 0: only what is the same to 0.001 mm
};
inline constexpr double kMostSnap = 1.0;

/// Moves the ends of lines that lie within `snap_mm` of another end or vertex onto it, but not back
/// along their own line. Vertices within a line stay, or go to one within 0.001 mm.
/// `clean` begins so. O(n) for lines that do not pile up.
[[nodiscard]] LineWork with_ends_snapped(const LineWork& work, double snap_mm);

/// Leaves each place of the drawing to one line: ends are snapped; what lies on a stronger line, or
/// on a longer one of the same kind, is taken away (to `kOverlapTolerance` beside it). Outline is
/// stronger than cut, cut than fold, fold than score; what is drawn with a pen only gives way to
/// what is drawn. Lines that cross are not touched. Afterwards the lines of each operation are put
/// together to the fewest strokes (see `join`) and vertices on a straight line are dropped. Nothing
/// moves by more than `snap_mm`.
///
/// O(n log n) in the number of segments for drawings whose lines do not pile up.
[[nodiscard]] LineWork clean(const LineWork& work, const CleanOptions& options = {});
/// The same; the points of `work` are given back as soon as they have been read.
[[nodiscard]] LineWork clean(LineWork&& work, const CleanOptions& options = {});

/// The part of `line` without the vertices that lie within `tolerance` of the chord beside them.
[[nodiscard]] std::vector<PagePoint> without_straight_vertices(std::span<const PagePoint> line,
                                                               double tolerance);

}  // namespace popcut
