// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "core/plan/order/order.hpp"
#include "core/plan/order/tour_stops.hpp"

namespace popcut {

struct ImproveOptions {
  std::uint64_t kicks{0};  ///< disturbances to try after the first descent
  std::uint64_t seed{1};
};

struct Improved {
  std::uint64_t kicks{0};  ///< tried
  bool finished{true};     ///< false: `keep_going` ended it early
};

/// Makes the tour cheaper and never dearer, and keeps the precedence of the stops if `order` does.
///
/// Local search: sequential exchanges of two or three links whose first new link leads to a near
/// node (Lin and Kernighan 1973, with depth 3), moves of a closed stroke to a place near by with
/// the best of its doors, and changes of seams; nodes that found nothing rest until a neighbour
/// changes. Then disturbances: two short pieces, one after the other, change places, the local
/// search repairs around them, and the result is kept if it is no dearer, else taken back
/// (Johnson and McGeoch 1997, iterated local search with segment lengths of at most 30).
Improved improve_tour(TourStops& stops, const NearNodes& near, TourOrder& order,
                      const ImproveOptions& options, const KeepGoing& keep_going);

}  // namespace popcut
