// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// Options for the content of a FOLD file.
struct FoldOptions {
  std::string creator{"popcut"};
  /// Opening angles of the deployed frames, in rad: pi is flat, 0 shut. None: pi, the pattern's own
  /// design angle, and 1.1.
  std::optional<std::vector<double>> psi_rad{};
  /// true: cuts are pairs of borders B with their own vertices; false: single edges C.
  bool split_cuts{true};
};

/// Writes `pattern` as FOLD 1.2 (edemaine/fold, doc/spec.md), streaming, without a copy of it.
///
/// The key frame is the flat sheet, `(u, v)` in mm, with the fold angles of the pi/2 pose. One
/// frame per opening angle follows. It inherits everything except `vertices_coords` (three numbers,
/// from `posed`) and `edges_foldAngle`, and gives its angle in `frame_popcut:psi_rad`. In split
/// form a cut is two borders B with their own vertices; `edges_popcut:role` ("mountain", "valley",
/// "slit", "outline") distinguishes them from the sheet's outline. Numbers read back as the same
/// doubles.
///
/// `popcut:design_psi_rad` is the pattern's design angle, where that is not pi/2.
///
/// `popcut:model_placement` is where the model stands that a file gave
/// (`Pattern::model_placement`).
///
/// A pattern with seams lists them in `popcut:seams` (id, the other part's number, v_mm, u_mm from
/// and to) and gives its corner in the whole in `popcut:place_mm`.
///
/// `edges_faces` lists the left face first, and has one entry along a border. If the stream fails
/// it stays failed; the caller checks it.
///
/// Without `split_cuts` each cut is one edge C between vertices that both sides share, and the
/// frame has the attribute "cuts" (FOLD 1.2, optional there). Then the two sides cannot have
/// different places, so there are no deployed frames.
///
/// @retval Internal    a coordinate is not finite, which JSON cannot express
/// @retval OutOfRange  an opening angle is outside 0..pi; `place` is its index in the list
[[nodiscard]] Result<void> write_fold(const Pattern& pattern, const FoldOptions& options,
                                      std::ostream& out);

/// Writes a drawing as a FOLD file without faces, one edge per straight line, for verify to trace.
/// The frame is (u, v) = (page y, page x) in mm, seen from the pop-up side. Cuts and outlines are C
/// (tracing the faces finds the borders among them), folds M and V, scores U. Pen lines are left
/// out.
[[nodiscard]] std::string fold_from_linework(const LineWork& work);

}  // namespace popcut
