// SPDX-License-Identifier: MIT
#include "core/plan/order/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/drawing/nesting.hpp"
#include "core/plan/order/order_group.hpp"

namespace popcut {
namespace {

constexpr std::uint64_t kQuickMoves = 3000;

// Which closed lines hold which lines: cuts among cuts, outlines among outlines.
Nesting nesting_of_cuts(const LineWork& work) {
  Nesting all;
  all.first.assign(work.lines.size() + 1, 0);
  std::vector<Nesting> parts;
  for (const Operation operation : {Operation::Cut, Operation::Outline}) {
    std::vector<std::uint8_t> counts;
    counts.reserve(work.lines.size());
    for (const DrawnLine& line : work.lines) counts.push_back(line.operation == operation ? 1 : 0);
    parts.push_back(nesting(work, counts));
  }
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    for (const Nesting& part : parts)
      all.holders.insert(all.holders.end(), part.around(i).begin(), part.around(i).end());
    all.first[i + 1] = static_cast<std::uint32_t>(all.holders.size());
  }
  return all;
}

// Appends the lines in their order; a line that holds others comes after them.
void append_own(const Nesting& nesting, const std::vector<std::uint32_t>& lines,
                std::vector<std::uint32_t>& waits, std::vector<Visit>& out) {
  for (const std::uint32_t line : lines)
    for (const std::uint32_t holder : nesting.around(line)) ++waits[holder];
  std::vector<std::uint8_t> due(waits.size(), 0);
  for (const std::uint32_t line : lines) {
    due[line] = 1;
    if (waits[line] > 0) continue;
    std::size_t next = out.size();
    out.push_back({line, false, 0});
    for (; next < out.size(); ++next)
      for (const std::uint32_t holder : nesting.around(out[next].line))
        if (--waits[holder] == 0 && due[holder] != 0) out.push_back({holder, false, 0});
  }
}

// Raises the rank of each line that holds others to the highest of theirs.
void lift_holders(const Nesting& nesting, std::vector<std::uint32_t>& rank) {
  std::vector<std::uint32_t> lines(rank.size()), waits(rank.size(), 0);
  std::iota(lines.begin(), lines.end(), 0u);
  std::vector<Visit> inner_first;
  append_own(nesting, lines, waits, inner_first);
  for (const Visit& visit : inner_first)
    for (const std::uint32_t holder : nesting.around(visit.line))
      rank[holder] = std::max(rank[holder], rank[visit.line]);
}

// Assigns lines to bands along the feed by where they end, but never before the lines inside them.
// Outlines form one band after all others.
std::vector<std::uint32_t> bands(const LineWork& work, const Nesting& nesting, double band_mm) {
  std::vector<std::uint32_t> band(work.lines.size(), 0);
  if (!(band_mm > 0.0)) return band;
  const Box box = bounds(work);
  for (std::size_t i = 0; i < band.size(); ++i) {
    double last = box.y0;
    for (const PagePoint& p : work.points_of(work.lines[i])) last = std::max(last, p.y);
    const bool outline = work.lines[i].operation == Operation::Outline;
    band[i] = static_cast<std::uint32_t>(
        std::min(outline ? 1e9 : std::floor((last - box.y0) / band_mm), 1e9));
  }
  lift_holders(nesting, band);
  return band;
}

// The pen of each line; a line that holds others comes with or after all of them.
std::vector<std::uint32_t> pens(const LineWork& work, const Nesting& nesting) {
  std::vector<std::uint32_t> pen(work.lines.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < pen.size(); ++i) {
    pen[i] = work.lines[i].operation.pen;
    any = any || pen[i] > 0;
  }
  if (any) lift_holders(nesting, pen);
  return pen;
}

// Groups that are cut one after the other; in each group the lines are in drawing order.
std::vector<OrderGroup> groups_of(const LineWork& work, const Nesting& nesting,
                                  const OrderOptions& options) {
  const std::vector<std::uint32_t> kind = cutting_groups(work);
  const std::vector<std::uint32_t> band = bands(work, nesting, options.band_mm);
  const std::vector<std::uint32_t> pen = pens(work, nesting);
  std::vector<std::uint32_t> lines(work.lines.size());
  std::iota(lines.begin(), lines.end(), 0u);
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    return band[a] == band[b] && kind[a] == kind[b] && pen[a] == pen[b];
  };
  std::stable_sort(lines.begin(), lines.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (band[a] != band[b]) return band[a] < band[b];
    return kind[a] != kind[b] ? kind[a] < kind[b] : pen[a] < pen[b];
  });
  std::vector<OrderGroup> groups;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i == 0 || !same(lines[i - 1], lines[i])) groups.emplace_back();
    groups.back().lines.push_back(lines[i]);
  }
  return groups;
}

// Shares the moves to try among the groups.
void share_moves(std::vector<OrderGroup>& groups, std::uint64_t moves) {
  double lines = 0.0;
  for (const OrderGroup& group : groups) lines += static_cast<double>(group.lines.size());
  for (OrderGroup& group : groups)
    group.moves = static_cast<std::uint64_t>(static_cast<double>(moves) *
                                             static_cast<double>(group.lines.size()) / lines);
}

std::vector<Visit> own_order(const LineWork& work, const Nesting& nesting,
                             const std::vector<OrderGroup>& groups) {
  std::vector<Visit> out;
  out.reserve(work.lines.size());
  std::vector<std::uint32_t> waits(work.lines.size(), 0);
  for (const OrderGroup& group : groups) append_own(nesting, group.lines, waits, out);
  return out;
}

// Moves the seam of each closed line to the vertex where the way in and out costs least.
void settle_seams(const LineWork& work, const OrderOptions& options, std::vector<Visit>& visits) {
  for (std::size_t i = 0; i < visits.size(); ++i) {
    Visit& visit = visits[i];
    const auto points = work.points_of(work.lines[visit.line]);
    if (!closed(points)) continue;
    const bool last = i + 1 == visits.size();
    const auto before = i == 0 ? options.start : std::optional(leave(work, visits[i - 1]));
    const auto after = last ? options.end : std::optional(entry(work, visits[i + 1]));
    const auto detour = [&](std::uint32_t v) {
      return (before ? options.cost(distance(*before, points[v])) : 0.0) +
             (after ? options.cost(distance(points[v], *after)) : 0.0);
    };
    double least = detour(visit.start);
    for (std::uint32_t v = 0; v + 1 < points.size(); ++v)
      if (const double way = detour(v); way < least) {
        least = way;
        visit.start = v;
      }
  }
}

const PagePoint& last_point(std::span<const PagePoint> points, const Visit& visit) {
  if (visit.count > 0)
    return points[(visit.start + visit.count - 1) % (points.size() - (closed(points) ? 1 : 0))];
  return closed(points) ? points[visit.start] : points.back();
}

// Orders group by group, each from where the last one ends. Stores each group's order in its
// `known`.
Ordered order_groups(const LineWork& work, const Nesting& nesting, std::vector<OrderGroup>& groups,
                     const OrderOptions& options, const KeepGoing& keep_going) {
  double all = 0.0, done = 0.0;
  const auto weight = [](const OrderGroup& group) {
    return static_cast<double>(group.lines.size() + group.moves);
  };
  for (const OrderGroup& group : groups) all += weight(group);
  Ordered out;
  out.visits.reserve(work.lines.size());
  std::optional<PagePoint> at = options.start;
  std::vector<std::uint32_t> scratch(work.lines.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    OrderGroup& group = groups[g];
    group.start = at;
    if (g + 1 == groups.size()) group.end = options.end;
    KeepGoing part_goes_on;
    if (keep_going)
      part_goes_on = [&](double part) { return keep_going((done + part * weight(group)) / all); };
    Ordered part = order_group(work, nesting, group, options, part_goes_on, scratch);
    out.visits.insert(out.visits.end(), part.visits.begin(), part.visits.end());
    out.moves += part.moves;
    out.moves_wanted += part.moves_wanted;
    out.finished = out.finished && part.finished;
    done += weight(group);
    at = leave(work, out.visits.back());
    group.known = std::move(part.visits);
  }
  if (options.any_seam) settle_seams(work, options, out.visits);
  out.cost = travel_cost(work, out.visits, options);
  return out;
}

// Best improves the order that Quick finds, which no clock interrupts; so Best never costs more.
void make_better(const LineWork& work, const Nesting& nesting, std::vector<OrderGroup>& groups,
                 const OrderOptions& options, Ordered& quick) {
  share_moves(groups, order_moves(work.lines.size(), options.effort));
  Ordered best = order_groups(work, nesting, groups, options, options.keep_going);
  if (best.cost > quick.cost) {
    best.visits = std::move(quick.visits);
    best.cost = quick.cost;
  }
  quick = std::move(best);
}

Ordered order_lines(const LineWork& work, const Nesting& nesting, const OrderOptions& options) {
  std::vector<OrderGroup> groups = groups_of(work, nesting, options);
  share_moves(groups, kQuickMoves);
  const bool best = options.method == OrderMethod::Best;
  OrderOptions quick = options;
  quick.method = OrderMethod::Quick;
  Ordered out = order_groups(work, nesting, groups, quick, best ? KeepGoing{} : options.keep_going);
  if (best) make_better(work, nesting, groups, options, out);
  std::vector<Visit> own = own_order(work, nesting, groups);
  out.own_cost = travel_cost(work, own, options);
  if (out.cost > out.own_cost) {
    out.visits = std::move(own);
    out.cost = out.own_cost;
  }
  return out;
}

Ordered as_drawn(const LineWork& work, const OrderOptions& options) {
  Ordered out;
  out.visits.resize(work.lines.size());
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) out.visits[i].line = i;
  out.cost = out.own_cost = travel_cost(work, out.visits, options);
  return out;
}

}  // namespace

void points_of_visit(const LineWork& work, const Visit& visit, std::vector<PagePoint>& out) {
  const auto points = work.points_of(work.lines[visit.line]);
  if (visit.count == 0 && visit.start == 0) {
    out.assign(points.begin(), points.end());
  } else {
    const auto round = static_cast<std::uint32_t>(points.size() - (closed(points) ? 1 : 0));
    const std::uint32_t count = visit.count > 0 ? visit.count : round + 1;
    out.clear();
    for (std::uint32_t i = 0; i < count; ++i) out.push_back(points[(visit.start + i) % round]);
  }
  if (visit.reversed) std::reverse(out.begin(), out.end());
}

PagePoint entry(const LineWork& work, const Visit& visit) {
  const auto points = work.points_of(work.lines[visit.line]);
  return visit.reversed ? last_point(points, visit) : points[visit.start];
}

PagePoint leave(const LineWork& work, const Visit& visit) {
  const auto points = work.points_of(work.lines[visit.line]);
  return visit.reversed ? points[visit.start] : last_point(points, visit);
}

double travel_mm(const LineWork& work, const std::vector<Visit>& visits) {
  return travel_cost(work, visits, {.start = std::nullopt, .end = std::nullopt});
}

double travel_cost(const LineWork& work, const std::vector<Visit>& visits,
                   const OrderOptions& options) {
  if (visits.empty()) return 0.0;
  double sum = 0.0;
  if (options.start) sum += options.cost(distance(*options.start, entry(work, visits.front())));
  for (std::size_t i = 1; i < visits.size(); ++i)
    sum += options.cost(distance(leave(work, visits[i - 1]), entry(work, visits[i])));
  if (options.end) sum += options.cost(distance(leave(work, visits.back()), *options.end));
  return sum;
}

std::uint64_t order_moves(std::size_t lines, double effort) {
  const double moves = 2000.0 * std::sqrt(static_cast<double>(lines)) * effort;
  return static_cast<std::uint64_t>(std::clamp(moves, 0.0, 1e15));
}

std::vector<std::uint32_t> cutting_groups(const LineWork& work) {
  constexpr std::array<std::uint32_t, 6> kGroups{0, 1, 2, 2, 3, 4};  // by operation
  std::vector<std::uint32_t> groups;
  groups.reserve(work.lines.size());
  for (const DrawnLine& line : work.lines)
    groups.push_back(kGroups.at(static_cast<std::size_t>(line.operation.operation)));
  return groups;
}

std::size_t outer_before_inner(const LineWork& work, const std::vector<Visit>& visits) {
  const Nesting nesting = nesting_of_cuts(work);
  std::vector<std::size_t> place(work.lines.size());
  for (std::size_t i = 0; i < visits.size(); ++i) place[visits[i].line] = i;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    const auto around = nesting.around(i);
    count += std::any_of(around.begin(), around.end(),
                         [&](std::uint32_t holder) { return place[holder] < place[i]; });
  }
  return count;
}

Ordered order(const LineWork& work, const OrderOptions& options) {
  if (options.method == OrderMethod::Keep) return as_drawn(work, options);
  Nesting nesting;
  nesting.first.assign(work.lines.size() + 1, 0);
  if (options.inner_first) nesting = nesting_of_cuts(work);
  if (!(options.corner_deg > 0.0)) return order_lines(work, nesting, options);
  const LinePieces pieces = split_at_corners(work, nesting, options.corner_deg);
  Ordered out = order_lines(pieces.work, nesting_of_pieces(pieces, nesting), options);
  for (Visit& visit : out.visits) visit = pieces.visit_of(visit);
  out.cost = travel_cost(work, out.visits, options);
  return out;
}

}  // namespace popcut
