// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/overlap.hpp"

namespace popcut {

/// A straight part of a fold, and what kind of fold it is.
struct FoldPart {
  Segment segment;
  int kind{};
};

/// Straight folds that were drawn in parts: indices into `parts`, in order along the fold, those in
/// `turned` to be taken from b to a. Parts of one kind are chained where they meet end to end and
/// go straight on.
struct FoldChain {
  std::vector<std::uint32_t> parts;
  std::vector<bool> turned;
};

[[nodiscard]] std::vector<FoldChain> chain_folds(std::span<const FoldPart> parts);

}  // namespace popcut
