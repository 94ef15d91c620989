// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/plan/linework.hpp"
#include "core/plan/overlap.hpp"

namespace popcut {

/// A straight piece that is to become part of a line.
struct Piece {
  Segment segment;
  Operation operation{};
  std::int32_t next{-1};  ///< piece that goes on from its end in the drawing, -1 for none
};

/// Joins pieces of the same operation to long lines: along `next`, then at ends that meet within
/// `tolerance` where no third end is, or where two pieces go straight on (within 5 degrees). Folds
/// are joined only straight on. Order and direction follow the first piece of each line.
void join(const std::vector<Piece>& pieces, double tolerance, LineWork& out);

}  // namespace popcut
