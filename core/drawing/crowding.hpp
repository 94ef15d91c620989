// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A straight edge between two numbered points.
struct NodeEdge {
  std::uint32_t a{}, b{};
};

/// Tells which edges may share a part with another edge, within `tolerance` mm: 1 for those that
/// do, and for some that only nearly do. In most drawings these are few, and only they need a
/// closer look.
///
/// Short edges are found in cells of the page, by direction; long ones by the line that they lie on
/// (`LineBins`). O(n log n) time and about 30 bytes per edge unless lines pile up; edges that pile
/// up on one line end each other's search early.
[[nodiscard]] std::vector<std::uint8_t> crowded_edges(std::span<const NodeEdge> edges,
                                                      std::span<const PagePoint> nodes,
                                                      double tolerance);

}  // namespace popcut
