// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <numbers>
#include <string>
#include <vector>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// What a FOLD file holds besides the pattern.
struct FoldOptions {
  std::string creator{"popcut"};
  /// Opening angles of the deployed frames, in rad: pi is flat, pi/2 the designed shape, 0 shut.
  std::vector<double> psi_rad{std::numbers::pi, std::numbers::pi / 2, 1.1};
  /// Cuts as two borders B with vertices of their own, or as single edges C.
  bool split_cuts{true};
};

/// Writes `pattern` as FOLD 1.2 (edemaine/fold, doc/spec.md), as a stream: no copy is made of it.
///
/// The key frame is the flat sheet, `(u, v)` in mm, with the fold angles of the pi/2 pose. Then one
/// frame an opening angle, which inherits all but `vertices_coords` (three numbers, from `posed`)
/// and `edges_foldAngle`, and names its angle in `frame_popcut:psi_rad`. Split form: cuts are two
/// borders B with vertices of their own, told from the sheet's outline by `edges_popcut:role`
/// ("mountain", "valley", "slit", "outline"). Numbers read back as the same doubles.
///
/// A pattern with seams has them in `popcut:seams` (id, the other part's number, v_mm, u_mm from
/// and to) and its corner in the whole in `popcut:place_mm`.
///
/// `edges_faces` has the left face first and one entry along a border. A failing stream is left
/// failed for the caller to see.
///
/// Without `split_cuts` each cut is one edge C between vertices that both sides share, and the
/// frame has the attribute "cuts" (FOLD 1.2, optional there). Sides that part cannot be told then,
/// so there are no deployed frames.
///
/// @retval Internal    a coordinate is not finite, since JSON has no word for it
/// @retval OutOfRange  an opening angle is outside 0..pi; `place` is its index in the list
[[nodiscard]] Result<void> write_fold(const Pattern& pattern, const FoldOptions& options,
                                      std::ostream& out);

}  // namespace popcut
