// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/toolpath.hpp"

namespace popcut {

/// A stroke as a route sees it: its two ends. A closed one has both at the vertex it is entered by.
struct RouteStop {
  PagePoint a;
  PagePoint b;
  bool flipped{false};  ///< entered at b, left at a
  [[nodiscard]] const PagePoint& start() const { return flipped ? b : a; }
  [[nodiscard]] const PagePoint& end() const { return flipped ? a : b; }
};

struct RouteEffort {
  std::size_t neighbours{6};
  int passes{3};
  std::size_t longest_move{1000};  ///< stops that one move may reverse or shift
};

/// Shortens the way `from` -> stops in `sequence` -> anywhere by 2-opt and Or-opt moves among near
/// neighbours; each move makes it shorter. Changes `sequence` and the `flipped` of the stops.
void improve_route(const PagePoint& from, std::vector<RouteStop>& stops,
                   std::vector<std::uint32_t>& sequence, const RouteEffort& effort);

}  // namespace popcut
