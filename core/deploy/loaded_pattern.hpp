// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/formats/csv/segments_reader.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// The pattern behind a FOLD file whose panels are parallel to wall or ground, or kites, V-folds on
/// their creases or none: from the flat frame and one deployed frame every vertex gets its place in
/// the designed pose, and so in every pose (docs/geometry.md, sections 2 and 7). A deployed frame's
/// angle is its `frame_popcut:psi_rad`, or what its fold angles say: 180 degrees less a valley's.
///
/// All frames of known angle are checked against the result, within 1e-5 of the sheet's size. The
/// pattern has faces, edges and their folds; `lines` are left empty, and borders are outlines.
///
/// @retval Malformed   no flat frame with faces, or no deployed one; `place` says which
/// @retval OutOfRange  the frames are not those of such panels; `place` is the vertex
[[nodiscard]] Result<Pattern> pattern_from_fold(const FoldFile& file);

/// Adds the faces and edges of a flat frame to a pattern that has neither. Mountains and valleys
/// are folds; all other edges are outlines.
void add_faces_and_edges(const FoldFrame& flat, Pattern& pattern);

/// A pattern of loose rectangles, a face a row and in the order of the rows, with the corners
/// `(x0, z0)`, `(x1, z1)` at the panel's lower v, then back at its upper v. Panels of one strip
/// that share an end are hinged there (mountain where a level one is followed by an upright one,
/// else valley). A table does not say where neighbouring strips are joined, so they are not.
/// `lines` are left empty, and there is no card.
[[nodiscard]] Pattern pattern_from_segments(const std::vector<SegmentPanel>& panels,
                                            std::string name);

}  // namespace popcut
