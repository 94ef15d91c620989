// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/overlap.hpp"

namespace popcut {

/// A straight part of a fold, and the kind of fold.
struct FoldPart {
  Segment segment;
  int kind{};
};

/// A straight fold that was drawn in parts: indices into `parts`, in order along the fold. A part
/// that is `turned` runs from b to a. Parts of one kind are chained where they meet end to end in a
/// straight line.
struct FoldChain {
  std::vector<std::uint32_t> parts;
  std::vector<bool> turned;
};

[[nodiscard]] std::vector<FoldChain> chain_folds(std::span<const FoldPart> parts);

}  // namespace popcut
