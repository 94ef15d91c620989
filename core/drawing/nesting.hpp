// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// For each line of which `counts(line)` holds, the number of closed ones among them that hold its
/// middle point inside and its box in theirs; 0 for all others. Even-odd rule; a line is never
/// inside itself.
[[nodiscard]] std::vector<std::uint32_t> nesting_depth(const LineWork& work,
                                                       const std::vector<std::uint8_t>& counts);

/// The closed lines around each line, without those that follow from the others: `around(i)` holds
/// the innermost one, whose own `around` has the next; more than one only where lines cross.
struct Nesting {
  std::vector<std::uint32_t> first;  ///< by line, and one more: into `holders`
  std::vector<std::uint32_t> holders;
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t line) const {
    return std::span(holders).subspan(first[line], first[line + 1] - first[line]);
  }
};

/// Nesting of the lines that count, as `nesting_depth`; of two closed lines that each hold the
/// other's middle, the one of the larger area is outside. A stroke that meets itself, as a lollipop
/// does, holds what lies in its loops. O(n log n) and what is found, for lines
/// that are not nested thousands deep.
[[nodiscard]] Nesting nesting(const LineWork& work, const std::vector<std::uint8_t>& counts);

}  // namespace popcut
