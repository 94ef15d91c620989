// SPDX-License-Identifier: MIT
#include "core/plan/order/order_group.hpp"

#include <algorithm>
#include <numeric>

#include "core/plan/order/tour_improve.hpp"
#include "core/plan/order/tour_stops.hpp"

namespace popcut {
namespace {

constexpr std::uint32_t kMostDoors = 32;

// The vertex at door `d` of a closed line with `vertices` vertices.
std::uint32_t door_vertex(std::uint32_t d, std::uint32_t vertices) {
  if (vertices <= kMostDoors) return d;
  return static_cast<std::uint32_t>(std::uint64_t{d} * vertices / kMostDoors);
}

// Numbers the lines along a Z curve through their first points, so that near lines get near
// numbers.
std::vector<std::uint32_t> along_the_page(const LineWork& work,
                                          const std::vector<std::uint32_t>& lines) {
  Box box;
  for (const std::uint32_t line : lines) box.add(work.points[work.lines[line].first]);
  const double side = std::max({box.width(), box.height(), 1e-9});
  const auto spread = [](std::uint64_t v) {
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keyed;
  keyed.reserve(lines.size());
  for (const std::uint32_t line : lines) {
    const PagePoint& p = work.points[work.lines[line].first];
    const auto x = static_cast<std::uint64_t>((p.x - box.x0) / side * 65535.0);
    const auto y = static_cast<std::uint64_t>((p.y - box.y0) / side * 65535.0);
    keyed.emplace_back(static_cast<std::uint32_t>(spread(x) | (spread(y) << 1)), line);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> sorted;
  sorted.reserve(lines.size());
  for (const auto& [key, line] : keyed) sorted.push_back(line);
  return sorted;
}

class Group {
 public:
  Group(const LineWork& work, const Nesting& nesting, const OrderGroup& group,
        const OrderOptions& options, std::vector<std::uint32_t>& scratch)
      : work_(work), line_of_(along_the_page(work, group.lines)), stop_of_(scratch) {
    for (std::uint32_t i = 0; i < line_of_.size(); ++i) stop_of_[line_of_[i]] = i + 1;
    stops_.cost = options.cost;
    stops_.free_start = !group.start;
    stops_.free_end = !group.end;
    add_ends(group);
    if (options.any_seam) add_doors();
    add_precedence(nesting);
  }
  ~Group() {
    for (const std::uint32_t line : line_of_) stop_of_[line] = 0;
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  Ordered run(const OrderGroup& group, const OrderOptions& options, const KeepGoing& keep_going) {
    return group.known.empty() ? find(group, options, keep_going)
                               : improve(group, options, keep_going);
  }

 private:
  Ordered find(const OrderGroup& group, const OrderOptions& options, const KeepGoing& keep_going) {
    const TourOrder own = with_precedence(stops_, order_of(group.lines));
    const double own_cost = tour_cost(stops_, own);
    const std::vector<std::uint32_t> drawn_seams = stops_.seam;
    NearNodes near = near_nodes(stops_, neighbours(options));
    TourOrder best = first_order(near);
    if (stops_.doors.empty()) near.mm = std::vector<float>();
    ImproveOptions how{0, options.seed};
    const double greedy_cost = tour_cost(stops_, best);
    bool finished = improve_tour(stops_, near, best, how, keep_going).finished;
    if (finished && own_cost < 1.5 * greedy_cost) {
      const double cost = tour_cost(stops_, best);
      const std::vector<std::uint32_t> seams = stops_.seam;
      choose_seams(drawn_seams);
      TourOrder other = own;
      finished = improve_tour(stops_, near, other, how, keep_going).finished;
      if (tour_cost(stops_, other) < cost)
        best = std::move(other);
      else
        choose_seams(seams);
    }
    if (tour_cost(stops_, best) > own_cost) {
      best = own;
      choose_seams(drawn_seams);
    }
    how.kicks = group.moves;
    const Improved improved =
        finished ? improve_tour(stops_, near, best, how, keep_going) : Improved{0, false};
    return {visits(best), tour_cost(stops_, best), own_cost, improved.kicks,
            group.moves,  improved.finished};
  }

  // Improves the known order.
  Ordered improve(const OrderGroup& group, const OrderOptions& options,
                  const KeepGoing& keep_going) {
    TourOrder best{{0}, std::vector<std::uint8_t>(stops_.size(), 0)};
    best.sequence.reserve(stops_.size());
    for (const Visit& visit : group.known) {
      const std::uint32_t s = stop_of_[visit.line];
      best.sequence.push_back(s);
      best.flipped[s] = visit.reversed ? 1 : 0;
      if (stops_.has_doors(s)) stops_.choose_seam(s, door_at(s, visit));
    }
    const NearNodes near = near_nodes(stops_, neighbours(options));
    const Improved improved =
        improve_tour(stops_, near, best, {group.moves, options.seed}, keep_going);
    const double cost = tour_cost(stops_, best);
    return {visits(best), cost, cost, improved.kicks, group.moves, improved.finished};
  }

  [[nodiscard]] std::uint32_t door_at(std::uint32_t stop, const Visit& visit) const {
    const std::uint32_t first = stops_.first_door[stop];
    std::uint32_t d = first;
    while (d + 1 < stops_.first_door[stop + 1] &&
           door_vertex(d - first, vertices(visit.line)) < visit.start)
      ++d;
    return d;
  }

  [[nodiscard]] std::uint32_t vertices(std::uint32_t line) const {
    const auto points = work_.points_of(work_.lines[line]);
    return closed(points) ? static_cast<std::uint32_t>(points.size()) - 1 : 0;
  }

  void add_ends(const OrderGroup& group) {
    stops_.node.reserve(2 * line_of_.size() + 2);
    stops_.node.push_back(group.end.value_or(PagePoint{}));
    stops_.node.push_back(group.start.value_or(PagePoint{}));
    for (const std::uint32_t line : line_of_) {
      const auto points = work_.points_of(work_.lines[line]);
      stops_.node.push_back(points.front());
      stops_.node.push_back(points.back());
    }
  }

  void add_doors() {
    const bool any = std::any_of(line_of_.begin(), line_of_.end(),
                                 [&](std::uint32_t line) { return vertices(line) > 0; });
    if (!any) return;
    stops_.first_door.assign(2, 0);
    stops_.seam.assign(1, 0);
    for (const std::uint32_t line : line_of_) {
      const std::uint32_t all = vertices(line);
      const PagePoint* points = &work_.points[work_.lines[line].first];
      stops_.seam.push_back(static_cast<std::uint32_t>(stops_.doors.size()));
      for (std::uint32_t d = 0; d < std::min(all, kMostDoors); ++d)
        stops_.doors.push_back(points[door_vertex(d, all)]);
      stops_.first_door.push_back(static_cast<std::uint32_t>(stops_.doors.size()));
    }
  }

  void add_precedence(const Nesting& nesting) {
    if (nesting.holders.empty()) return;
    std::vector<std::uint32_t> counts(stops_.size() + 1, 0);
    stops_.first_later.assign(2, 0);
    for (const std::uint32_t line : line_of_) {
      for (const std::uint32_t holder : nesting.around(line)) {
        if (stop_of_[holder] == 0) continue;
        stops_.later.push_back(stop_of_[holder]);
        ++counts[stop_of_[holder] + 1];
      }
      stops_.first_later.push_back(static_cast<std::uint32_t>(stops_.later.size()));
    }
    std::partial_sum(counts.begin(), counts.end(), counts.begin());
    stops_.first_earlier = counts;
    stops_.earlier.resize(stops_.later.size());
    for (std::uint32_t s = 1; s < stops_.size(); ++s)
      for (const std::uint32_t t : stops_.later_than(s)) stops_.earlier[counts[t]++] = s;
  }

  [[nodiscard]] TourOrder order_of(const std::vector<std::uint32_t>& lines) const {
    TourOrder order{{0}, std::vector<std::uint8_t>(stops_.size(), 0)};
    for (const std::uint32_t line : lines) order.sequence.push_back(stop_of_[line]);
    return order;
  }

  // Takes more neighbours where they cost little, or where some are the same stroke twice.
  [[nodiscard]] std::uint32_t neighbours(const OrderOptions& options) const {
    if (!stops_.doors.empty()) return line_of_.size() > 3000 ? 8 : 10;
    if (line_of_.size() <= 3000) return 8;
    return options.method == OrderMethod::Best ? 6 : 5;
  }

  void choose_seams(const std::vector<std::uint32_t>& seams) {
    for (std::uint32_t s = 1; s < stops_.size(); ++s)
      if (stops_.has_doors(s)) stops_.choose_seam(s, seams[s]);
  }

  // The greedy order, forwards or backwards: whichever breaks the inner-first rule less.
  TourOrder first_order(const NearNodes& near) {
    TourOrder forward = greedy_tour(stops_, near);
    TourOrder backward = forward;
    std::reverse(backward.sequence.begin() + 1, backward.sequence.end());
    for (std::uint32_t s = 1; s < stops_.size(); ++s) backward.flipped[s] ^= 1u;
    forward = with_precedence(stops_, forward);
    backward = with_precedence(stops_, backward);
    sweep_seams(forward);
    return tour_cost(stops_, forward) <= tour_cost(stops_, backward) ? forward : backward;
  }

  // Puts each seam in turn where the way in and out is shortest.
  void sweep_seams(const TourOrder& order) {
    if (stops_.doors.empty()) return;
    const auto enter = [&](std::size_t i) {
      const std::uint32_t s = order.sequence[i];
      return 2 * s + order.flipped[s];
    };
    const std::size_t n = order.sequence.size();
    for (int round = 0; round < 3; ++round)
      for (std::size_t i = 1; i < n; ++i) {
        const std::uint32_t s = order.sequence[i];
        if (!stops_.has_doors(s)) continue;
        const std::uint32_t before = enter(i - 1) ^ 1u, after = i + 1 < n ? enter(i + 1) : 0;
        double least = 1e300;
        std::uint32_t best = stops_.seam[s];
        for (std::uint32_t d = stops_.first_door[s]; d < stops_.first_door[s + 1]; ++d) {
          const double cost =
              stops_.between(before, stops_.doors[d]) + stops_.between(after, stops_.doors[d]);
          if (cost < least) {
            least = cost;
            best = d;
          }
        }
        stops_.choose_seam(s, best);
      }
  }

  [[nodiscard]] std::vector<Visit> visits(const TourOrder& order) const {
    std::vector<Visit> out;
    out.reserve(line_of_.size());
    for (std::size_t i = 1; i < order.sequence.size(); ++i) {
      const std::uint32_t s = order.sequence[i], line = line_of_[s - 1];
      const std::uint32_t all = vertices(line);
      Visit visit{line, all == 0 && order.flipped[s] != 0, 0};
      if (stops_.has_doors(s))
        visit.start = door_vertex(stops_.seam[s] - stops_.first_door[s], all);
      out.push_back(visit);
    }
    return out;
  }

  const LineWork& work_;
  std::vector<std::uint32_t> line_of_;  // of stops 1, 2, ...
  std::vector<std::uint32_t>& stop_of_;
  TourStops stops_;
};

}  // namespace

Ordered order_group(const LineWork& work, const Nesting& nesting, const OrderGroup& group,
                    const OrderOptions& options, const KeepGoing& keep_going,
                    std::vector<std::uint32_t>& scratch) {
  return Group(work, nesting, group, options, scratch).run(group, options, keep_going);
}

}  // namespace popcut
