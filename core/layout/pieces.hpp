// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/layout/partition.hpp"

namespace popcut {

/// Splits the drawing at the seams: for each piece the parts of lines inside it, in drawing mm.
/// Leaves out what runs along a seam; `add_borders` adds it.
[[nodiscard]] std::vector<LineWork> split_lines(const LineWork& drawing,
                                                const Partition& partition);

/// Adds each piece's border along its seams: existing cuts, straight lines, and the way around its
/// tabs. `tabs` holds the tabs of all runs in order. `border` is the operation of the drawing's own
/// border, so that both join into closed lines; then everything inside them is cut first.
void add_borders(const std::vector<SeamRun>& runs, const std::vector<Tab>& tabs,
                 const LineIndex& lines, Operation border, std::vector<LineWork>& pieces);

}  // namespace popcut
