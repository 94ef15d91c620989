// SPDX-License-Identifier: MIT
#pragma once

#include "core/plan/linework.hpp"

namespace popcut {

inline constexpr double kOverlapTolerance = 0.01;  ///< mm beside a line that still lie on it
inline constexpr double kJoinTolerance = 0.02;     ///< mm between ends that are one point

/// Leaves each place of the drawing to one line: what lies on a stronger line, or on a longer one
/// of the same kind, is taken away (to `kOverlapTolerance` beside it). Outline is stronger than
/// cut, cut than fold, fold than score; what is drawn with a pen only gives way to what is drawn.
/// Lines that cross are not touched. Afterwards lines are joined end to end where only two of a
/// kind meet, or where two go straight on, and vertices on a straight line are dropped.
///
/// O(n log n) in the number of segments for drawings whose lines do not pile up.
[[nodiscard]] LineWork clean(const LineWork& work);

/// The part of `line` without the vertices that lie within `tolerance` of the chord beside them.
[[nodiscard]] std::vector<PagePoint> without_straight_vertices(std::span<const PagePoint> line,
                                                               double tolerance);

}  // namespace popcut
