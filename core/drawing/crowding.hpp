// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A straight line between two numbered points.
struct NodeEdge {
  std::uint32_t a{}, b{};
};

/// Which edges may share a part with another one, to `tolerance`: 1 for those that do and for some
/// that only nearly do. In most drawings these are few, and only they have to be looked at again.
///
/// Short edges are found in cells of the page, by direction; long ones by the line that they lie on
/// (`LineBins`). O(n log n) time and about 30 bytes an edge for drawings whose lines do not pile
/// up; edges of one line that pile up end each other's search early.
[[nodiscard]] std::vector<std::uint8_t> crowded_edges(std::span<const NodeEdge> edges,
                                                      std::span<const PagePoint> nodes,
                                                      double tolerance);

}  // namespace popcut
