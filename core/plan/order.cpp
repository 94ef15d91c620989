// SPDX-License-Identifier: MIT
#include "core/plan/order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/plan/nesting.hpp"
#include "core/plan/point_grid.hpp"
#include "core/plan/route.hpp"

namespace popcut {
namespace {

bool is_closed(const LineWork& work, std::uint32_t line) {
  return closed(work.points_of(work.lines[line]));
}

// Where the tool can go down: each vertex of a closed line, both ends of an open one.
struct Door {
  std::uint32_t line{};
  std::uint32_t vertex{};
};

// Always the nearest door of a line that is still to do. The grid is made anew whenever half of the
// doors are gone, so that cells keep about one each: O(n) on average in all.
class NearestFirst {
 public:
  NearestFirst(const LineWork& work, const std::vector<std::uint32_t>& lines)
      : work_(work), done_(work.lines.size(), 0), left_(lines.size()) {
    for (const std::uint32_t line : lines) {
      const std::uint32_t count = work.lines[line].count;
      if (is_closed(work, line))
        for (std::uint32_t v = 0; v + 1 < count; ++v) doors_.push_back({line, v});
      else
        doors_.insert(doors_.end(), {{line, 0}, {line, count - 1}});
    }
  }

  std::vector<Visit> run(PagePoint at) {
    std::vector<Visit> visits;
    visits.reserve(left_);
    while (left_ > 0) {
      std::erase_if(doors_, [&](const Door& door) { return done_[door.line] != 0; });
      std::vector<PagePoint> points;
      points.reserve(doors_.size());
      for (const Door& door : doors_) points.push_back(point(door));
      const PointGrid grid(points);
      for (std::size_t until = left_ / 2; left_ > until; --left_) {
        const auto to_do = [&](std::uint32_t d) { return done_[doors_[d].line] == 0; };
        grid.nearest(at, 1, to_do, near_);
        const Door door = doors_[near_.front()];
        done_[door.line] = 1;
        visits.push_back(through(door));
        at = leave(work_, visits.back());
      }
    }
    return visits;
  }

 private:
  [[nodiscard]] const PagePoint& point(const Door& door) const {
    return work_.points[work_.lines[door.line].first + door.vertex];
  }
  [[nodiscard]] Visit through(const Door& door) const {
    if (is_closed(work_, door.line)) return {door.line, false, door.vertex};
    return {door.line, door.vertex != 0, 0};
  }

  const LineWork& work_;
  std::vector<std::uint8_t> done_;
  std::size_t left_;
  std::vector<Door> doors_;
  std::vector<std::uint32_t> near_;
};

double way_through(const LineWork& work, const PagePoint& from, const std::vector<Visit>& visits) {
  if (visits.empty()) return 0.0;
  return distance(from, entry(work, visits.front())) + travel_mm(work, visits);
}

// Moves the seam of each closed line to where the way in and out is shortest.
void move_seams(const LineWork& work, const PagePoint& from, std::vector<Visit>& visits) {
  for (std::size_t i = 0; i < visits.size(); ++i) {
    Visit& visit = visits[i];
    if (!is_closed(work, visit.line)) continue;
    const PagePoint before = i == 0 ? from : leave(work, visits[i - 1]);
    const bool last = i + 1 == visits.size();
    const PagePoint after = last ? before : entry(work, visits[i + 1]);
    const auto points = work.points_of(work.lines[visit.line]);
    const auto detour = [&](std::uint32_t v) {
      return distance(before, points[v]) + (last ? 0.0 : distance(points[v], after));
    };
    for (std::uint32_t v = 0; v + 1 < points.size(); ++v)
      if (detour(v) < detour(visit.start)) visit.start = v;
  }
}

void improve(const LineWork& work, const PagePoint& from, std::vector<Visit>& visits,
             const RouteEffort& effort) {
  std::vector<RouteStop> stops;
  stops.reserve(visits.size());
  for (const Visit& visit : visits) {
    Visit forward = visit;
    forward.reversed = false;
    stops.push_back({entry(work, forward), leave(work, forward), visit.reversed});
  }
  std::vector<std::uint32_t> sequence(visits.size());
  std::iota(sequence.begin(), sequence.end(), 0u);
  improve_route(from, stops, sequence, effort);
  std::vector<Visit> better;
  better.reserve(visits.size());
  for (const std::uint32_t s : sequence) {
    better.push_back(visits[s]);
    better.back().reversed = stops[s].flipped && !is_closed(work, visits[s].line);
  }
  visits = std::move(better);
}

RouteEffort effort_for(std::size_t n, OrderEffort effort) {
  const bool best = effort == OrderEffort::Best;
  const std::size_t most = best ? 4'000'000'000 : 400'000'000;  // stops moved in all, about
  return {.neighbours = best ? 10u : 8u,
          .passes = best ? 30 : 8,
          .longest_move = std::clamp<std::size_t>(most / (n + 1), 1000, 100'000)};
}

std::vector<Visit> short_way(const LineWork& work, const PagePoint& from,
                             const std::vector<std::uint32_t>& lines, OrderEffort effort) {
  std::vector<Visit> best;
  best.reserve(lines.size());
  for (const std::uint32_t line : lines) best.push_back({line, false, 0});
  double shortest = way_through(work, from, best);
  std::vector<Visit> visits = NearestFirst(work, lines).run(from);
  for (int round = 0; round < (effort == OrderEffort::Best ? 3 : 1); ++round) {
    improve(work, from, visits, effort_for(lines.size(), effort));
    move_seams(work, from, visits);
    const double way = way_through(work, from, visits);
    if (way >= shortest) break;
    shortest = way;
    best = visits;
  }
  return best;
}

}  // namespace

PagePoint entry(const LineWork& work, const Visit& visit) {
  const auto points = work.points_of(work.lines[visit.line]);
  return visit.reversed ? points.back() : points[visit.start];
}

PagePoint leave(const LineWork& work, const Visit& visit) {
  const auto points = work.points_of(work.lines[visit.line]);
  if (closed(points)) return points[visit.start];
  return visit.reversed ? points.front() : points.back();
}

double travel_mm(const LineWork& work, const std::vector<Visit>& visits) {
  double sum = 0.0;
  for (std::size_t i = 1; i < visits.size(); ++i)
    sum += distance(leave(work, visits[i - 1]), entry(work, visits[i]));
  return sum;
}

std::vector<std::uint32_t> cutting_groups(const LineWork& work) {
  std::vector<std::uint8_t> cuts;
  cuts.reserve(work.lines.size());
  for (const DrawnLine& line : work.lines) cuts.push_back(is_cut(line.operation) ? 1 : 0);
  const std::vector<std::uint32_t> depth = nesting_depth(work, cuts);
  const std::uint32_t deepest = depth.empty() ? 0 : *std::max_element(depth.begin(), depth.end());
  std::vector<std::uint32_t> groups;
  groups.reserve(work.lines.size());
  for (std::size_t i = 0; i < work.lines.size(); ++i) {
    const std::uint32_t inner_first = deepest - depth[i];
    switch (work.lines[i].operation) {
      case Operation::Draw:
        groups.push_back(0);
        break;
      case Operation::Score:
        groups.push_back(1);
        break;
      case Operation::FoldMountain:
      case Operation::FoldValley:
        groups.push_back(2);
        break;
      case Operation::Cut:
        groups.push_back(3 + inner_first);
        break;
      case Operation::Outline:
        groups.push_back(4 + deepest + inner_first);
        break;
    }
  }
  return groups;
}

std::vector<Visit> order(const LineWork& work, const OrderOptions& options) {
  const std::vector<std::uint32_t> groups = cutting_groups(work);
  std::vector<std::uint32_t> lines(work.lines.size());
  std::iota(lines.begin(), lines.end(), 0u);
  std::stable_sort(lines.begin(), lines.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return groups[a] < groups[b]; });
  std::vector<Visit> plain, visits;
  PagePoint at = options.home;
  for (std::size_t i = 0; i < lines.size();) {
    std::size_t j = i;
    while (j < lines.size() && groups[lines[j]] == groups[lines[i]]) ++j;
    const std::vector<std::uint32_t> group(lines.begin() + static_cast<std::ptrdiff_t>(i),
                                           lines.begin() + static_cast<std::ptrdiff_t>(j));
    for (const std::uint32_t line : group) plain.push_back({line, false, 0});
    const std::vector<Visit> part = short_way(work, at, group, options.effort);
    visits.insert(visits.end(), part.begin(), part.end());
    at = leave(work, visits.back());
    i = j;
  }
  return travel_mm(work, visits) <= travel_mm(work, plain) ? visits : plain;
}

}  // namespace popcut
