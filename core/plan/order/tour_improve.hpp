// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "core/plan/order/order.hpp"
#include "core/plan/order/tour_stops.hpp"

namespace popcut {

/// Options of `improve_tour`.
struct ImproveOptions {
  std::uint64_t kicks{0};  ///< random disturbances to try after the first local search
  std::uint64_t seed{1};
};

/// What `improve_tour` did.
struct Improved {
  std::uint64_t kicks{0};  ///< disturbances tried
  bool finished{true};     ///< false: `keep_going` stopped it early
};

/// Makes the tour cheaper, never dearer. Keeps the precedence of the stops if `order` does.
///
/// Local search: sequential exchanges of two or three links whose first new link leads to a near
/// node (Lin and Kernighan 1973, with depth 3), moves of a closed stroke to a place nearby through
/// its best door, and changes of seams. Nodes without an improvement rest until a neighbour
/// changes. Then come random disturbances: two short consecutive pieces swap places and the local
/// search repairs around them. The result is kept if it costs no more, else undone (Johnson and
/// McGeoch 1997, iterated local search with segments of at most 30 stops).
Improved improve_tour(TourStops& stops, const NearNodes& near, TourOrder& order,
                      const ImproveOptions& options, const KeepGoing& keep_going);

}  // namespace popcut
