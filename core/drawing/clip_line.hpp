// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Appends the parts of `line` that lie in `area`, cut exactly at its border; a closed line that is
/// cut open goes on through its seam. `run` is for work and need not be kept.
void clip_line(std::span<const PagePoint> line, Operation operation, const Box& area,
               std::vector<PagePoint>& run, LineWork& out);

}  // namespace popcut
