// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <span>

#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// Writes one row per panel in the twelve columns of the paper's code, like it without column
/// names:
///
///     x1, y1, z1, x2, y2, z2, length, tag, level, slice, flag, width
///
/// - `(x1, y1, z1) -> (x2, y2, z2)`: the panel's centre line in the designed pose, from the wall
///   outward, as (X, v, Z) in mm. (The paper's own file has X = x, Z = 1 - y, v = z, unitless.)
/// - `length`: length of that line, mm.
/// - `tag`: 7 for panels of slices, boxes and margins. Panels of connectors have 8 on odd levels
///   and 6 on even ones, as in the published file; 6 also for a connector's panel in the wall or
///   the ground.
/// - `level`: level of the panel's plane; -1 for wall and ground.
/// - `slice`: counted from 1; a connector has the number of its left slice; 0 for a margin.
/// - `flag`: 1 for a connector between two branches (after an even-numbered slice), else 0.
/// - `width`: twice the strip's width, mm: the drawn rectangle is half as wide as this column, in
///   popcut's file as in the paper's, where a slice of width w is a strip of width w/2.
///
/// @param kites  of the pattern: their panels are where they stand, at psi = pi/2
void write_segments_csv(const Strips& strips, std::ostream& out, std::span<const Kite> kites = {});

}  // namespace popcut
