// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/formats/csv/segments_reader.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// A pattern of loose rectangles, a face a row and in the order of the rows, with the corners
/// `(x0, z0)`, `(x1, z1)` at the panel's lower v, then back at its upper v. Panels of one strip
/// that share an end are hinged there (mountain where a level one is followed by an upright one,
/// else valley). A table does not say where neighbouring strips are joined, so they are not.
/// `lines` are left empty, and there is no card.
[[nodiscard]] Pattern pattern_from_segments(const std::vector<SegmentPanel>& panels,
                                            std::string name);

}  // namespace popcut
