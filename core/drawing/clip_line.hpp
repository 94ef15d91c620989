// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Appends the parts of `line` inside `area`, cut exactly at its border. A closed line that is cut
/// open continues through its seam. `run` is a reusable buffer.
void clip_line(std::span<const PagePoint> line, Operation operation, const Box& area,
               std::vector<PagePoint>& run, LineWork& out);

}  // namespace popcut
