// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/pattern/pattern.hpp"

namespace popcut::hands {

/// The pieces of paper that fall out of a pattern: the holes between its faces. O(edges).
[[nodiscard]] std::size_t waste_pieces(const Pattern& pattern);

}  // namespace popcut::hands
