// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/layout/partition.hpp"

namespace popcut {

/// The drawing parted at the seams: each line in the pieces it runs through, in the drawing's own
/// coordinates. What runs along a seam is left to `add_borders`.
[[nodiscard]] std::vector<LineWork> split_lines(const LineWork& drawing,
                                                const Partition& partition);

/// Adds each piece's border along its seams: the cuts that are there anyway, straight lines, and
/// the way round its tabs. `tabs` are those of all runs, in order. `border` is what the drawing's
/// own border is, so that the two join to closed lines, inside of which all is cut first.
void add_borders(const std::vector<SeamRun>& runs, const std::vector<Tab>& tabs,
                 const LineIndex& lines, Operation border, std::vector<LineWork>& pieces);

}  // namespace popcut
