// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/plan/linework.hpp"

namespace popcut {

/// For each line of which `counts(line)` holds, the number of closed ones among them that hold its
/// middle point inside; 0 for all others. Even-odd rule; a line is never inside itself.
[[nodiscard]] std::vector<std::uint32_t> nesting_depth(const LineWork& work,
                                                       const std::vector<std::uint8_t>& counts);

}  // namespace popcut
