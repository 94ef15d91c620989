// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut::hands {

/// The vertices around each piece of paper that falls out of a pattern: the holes between its
/// faces. O(edges).
[[nodiscard]] std::vector<std::vector<std::uint32_t>> waste_outlines(const Pattern& pattern);
/// How many these are.
[[nodiscard]] std::size_t waste_pieces(const Pattern& pattern);

}  // namespace popcut::hands
