// SPDX-License-Identifier: MIT
#include "core/plan/order/tour_stops.hpp"

#include <algorithm>
#include <array>

#include "core/geometry/point_tree.hpp"

namespace popcut {
namespace {

// Number of doors per stop that the search for neighbours uses.
constexpr std::uint32_t kMostPlaces = 6, kPlacesOfMany = 3, kMany = 3000;

// Places where the tool may go down: both ends of open stops, and some doors of closed stops, which
// share one tag.
struct Places {
  std::vector<PagePoint> points;
  std::vector<std::uint32_t> tags;

  explicit Places(const TourStops& stops) {
    points.reserve(stops.node.size());
    tags.reserve(stops.node.size());
    for (std::uint32_t n = 0; n < stops.node.size(); ++n) {
      if (stops.is_free(n)) continue;
      const std::uint32_t stop = n / 2;
      if (!stops.has_doors(stop)) {
        add(stops.node[n], n);
      } else if (n % 2 == 0) {
        const std::uint32_t first = stops.first_door[stop];
        const std::uint32_t doors = stops.first_door[stop + 1] - first;
        const std::uint32_t some =
            std::min(doors, stops.size() > kMany ? kPlacesOfMany : kMostPlaces);
        for (std::uint32_t d = 0; d < some; ++d) add(stops.doors[first + d * doors / some], n);
      }
    }
  }
  void add(const PagePoint& p, std::uint32_t tag) {
    points.push_back(p);
    tags.push_back(tag);
  }
};

void write_row(const TourStops& stops, const PointTree::NearList& list, std::uint32_t n,
               NearNodes& near) {
  std::size_t at = std::size_t{n} * near.each;
  const std::size_t end = at + near.each;
  const auto put = [&](std::uint32_t node, double squared) {
    if (at == end) return;
    near.nodes[at] = node;
    near.mm[at++] = static_cast<float>(std::sqrt(squared));
  };
  for (const PointTree::Near& one : list.all()) {
    put(one.tag, one.squared);
    if (stops.has_doors(one.tag / 2)) put(one.tag + 1, one.squared);
  }
}

}  // namespace

double tour_cost(const TourStops& stops, const TourOrder& order) {
  double sum = 0.0;
  std::uint32_t leave = 1;
  for (std::size_t i = 1; i < order.sequence.size(); ++i) {
    const std::uint32_t enter = 2 * order.sequence[i] + order.flipped[order.sequence[i]];
    sum += stops.between(leave, enter);
    leave = enter ^ 1u;
  }
  return sum + stops.between(leave, std::uint32_t{0});
}

NearNodes near_nodes(const TourStops& stops, std::uint32_t each) {
  NearNodes near{each, {}, {}};
  near.nodes.assign(stops.node.size() * each, NearNodes::kNone);
  near.mm.assign(near.nodes.size(), 0.0F);
  Places places(stops);
  const PointTree tree(places.points, places.tags);
  places.points = std::vector<PagePoint>();
  PointTree::NearList found(each), list(each);  // near a door, and near any door of a node
  for (std::uint32_t i = 0; i < places.tags.size(); ++i) {
    const std::uint32_t n = places.tags[i];
    const bool first = i == 0 || places.tags[i - 1] != n;
    const bool last = i + 1 == places.tags.size() || places.tags[i + 1] != n;
    if (first) list.clear();
    tree.nearest(i, found, [n](std::uint32_t tag) { return tag / 2 != n / 2; });
    for (const PointTree::Near& one : found.all()) list.add(one);
    if (!last) continue;
    write_row(stops, list, n, near);
    if (stops.has_doors(n / 2)) write_row(stops, list, n + 1, near);
  }
  return near;
}

TourOrder with_precedence(const TourStops& stops, const TourOrder& order) {
  if (stops.later.empty()) return order;
  std::vector<std::uint32_t> waits(stops.size());  // how many stops must still come before it
  for (std::uint32_t s = 0; s < stops.size(); ++s)
    waits[s] = static_cast<std::uint32_t>(stops.earlier_than(s).size());
  std::vector<std::uint8_t> due(stops.size(), 0);  // `order` has reached it
  TourOrder out{{}, order.flipped};
  out.sequence.reserve(order.sequence.size());
  for (const std::uint32_t stop : order.sequence) {
    due[stop] = 1;
    if (waits[stop] > 0) continue;
    std::size_t next = out.sequence.size();
    out.sequence.push_back(stop);
    for (; next < out.sequence.size(); ++next)
      for (const std::uint32_t t : stops.later_than(out.sequence[next]))
        if (--waits[t] == 0 && due[t] != 0) out.sequence.push_back(t);
  }
  return out;
}

}  // namespace popcut
