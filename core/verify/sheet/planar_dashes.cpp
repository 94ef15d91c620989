// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/geometry/cell_grid.hpp"
#include "core/verify/sheet/planar.hpp"

namespace popcut::verify {
namespace {

constexpr double kWidestGap_mm = 4.0;  ///< dashes farther apart do not form a row
constexpr double kInLine = 0.02;       ///< sine between dashes of one row
constexpr double kWider = 1.4;         ///< largest gap, relative to the usual gap
constexpr double kTouch_mm = 0.01;
constexpr double kShareInRows =
    0.5;  ///< share of all fold lines from which a drawing counts as dashed

bool is_fold(const DrawnEdge& edge) {
  return edge.kind == Assignment::Mountain || edge.kind == Assignment::Valley;
}

/// End `k` of edge `e`: 0 is `from`, 1 is `to`.
struct FoldEnd {
  std::uint32_t edge{};
  std::uint32_t end{};
  Vec2 at;
  Vec2 out;  ///< unit direction away from the dash
};

struct Link {
  std::uint32_t a{}, b{};  ///< fold ends
  double gap_mm{};
};

std::vector<FoldEnd> ends_of_folds(const std::vector<DrawnEdge>& edges) {
  std::vector<FoldEnd> ends;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const Vec2 way = edges[e].to - edges[e].from;
    const double length = norm(way);
    if (!is_fold(edges[e]) || !(length > 0.0)) continue;
    ends.push_back({e, 0, edges[e].from, (-1.0 / length) * way});
    ends.push_back({e, 1, edges[e].to, (1.0 / length) * way});
  }
  return ends;
}

/// Whether `b` begins the next dash of the row that `a` ends. Returns the gap.
std::optional<double> gap_between(const FoldEnd& a, const FoldEnd& b) {
  const Vec2 way = b.at - a.at;
  const double gap = norm(way);
  if (gap > kWidestGap_mm || gap < kTouch_mm) return {};
  const double slack = kTouch_mm + kInLine * gap;
  if (dot(a.out, way) <= 0.0 || std::abs(cross(a.out, way)) > slack) return {};
  if (dot(b.out, way) >= 0.0 || std::abs(cross(b.out, way)) > slack) return {};
  return gap;
}

/// For each end, the nearest other end that continues the row; only mutual ones.
std::vector<Link> links_of(const std::vector<DrawnEdge>& edges, const std::vector<FoldEnd>& ends) {
  std::vector<std::pair<double, std::uint32_t>> next(ends.size(), {kWidestGap_mm, 0});
  std::vector<std::uint8_t> touched(ends.size(), 0);
  const auto corners = [&](std::size_t i) {
    return std::array<Vec2, 2>{ends[i].at, ends[i].at + kWidestGap_mm * ends[i].out};
  };
  const CellGrid grid(ends.size(), kTouch_mm, corners);
  const bool all = grid.each_pair(pair_budget(ends.size()), [&](std::uint32_t i, std::uint32_t j) {
    if (edges[ends[i].edge].kind != edges[ends[j].edge].kind || ends[i].edge == ends[j].edge)
      return;
    if (norm(ends[i].at - ends[j].at) < kTouch_mm) touched[i] = touched[j] = 1;
    const auto gap = gap_between(ends[i], ends[j]);
    if (!gap) return;
    if (*gap < next[i].first) next[i] = {*gap, j};
    if (*gap < next[j].first) next[j] = {*gap, i};
  });
  std::vector<Link> links;
  if (!all) return links;
  for (std::uint32_t i = 0; i < ends.size(); ++i) {
    const auto [gap, j] = next[i];
    if (gap >= kWidestGap_mm || j < i || next[j].second != i || touched[i] != 0 || touched[j] != 0)
      continue;
    links.push_back({i, j, gap});
  }
  return links;
}

/// Where a ray from `at` along `out` (unit) first meets a segment, within `reach`; parallel
/// segments do not count.
std::optional<double> first_hit(Vec2 at, Vec2 out, double reach, Vec2 p, Vec2 q) {
  const double side_p = cross(out, p - at);
  const double side_q = cross(out, q - at);
  const double apart = side_p - side_q;
  if (std::abs(apart) < kInLine * norm(q - p)) {
    // In line with the ray: the nearer end of the segment.
    if (std::abs(side_p) > kTouch_mm) return {};
    const double t = std::min(dot(out, p - at), dot(out, q - at));
    return t > kTouch_mm && t <= reach ? std::optional(t) : std::nullopt;
  }
  if (std::min(side_p, side_q) > kTouch_mm || std::max(side_p, side_q) < -kTouch_mm) return {};
  const double s = std::clamp(side_p / apart, 0.0, 1.0);
  const double t = dot(out, p + s * (q - p) - at);
  if (t < -kTouch_mm || t > reach) return {};
  return std::max(t, 0.0);
}

}  // namespace

JoinedDashes join_dashes(std::vector<DrawnEdge>& edges) {
  JoinedDashes result;
  const std::vector<FoldEnd> ends = ends_of_folds(edges);
  std::vector<Link> links = links_of(edges, ends);
  if (static_cast<double>(links.size()) < kShareInRows * static_cast<double>(ends.size()) / 2.0)
    return result;
  if (links.size() < 3) return result;
  std::vector<double> gaps;
  gaps.reserve(links.size());
  for (const Link& link : links) gaps.push_back(link.gap_mm);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2),
                   gaps.end());
  result.gap_mm = gaps[gaps.size() / 2];
  const double reach = kWider * result.gap_mm;
  std::erase_if(links, [&](const Link& link) { return link.gap_mm > reach; });

  // Shapes: all edges, then the gaps, then a ray from each end.
  const std::size_t drawn = edges.size();
  const std::size_t rays = drawn + links.size();
  const auto corners = [&](std::size_t i) {
    if (i < drawn) return std::array<Vec2, 2>{edges[i].from, edges[i].to};
    if (i < rays)
      return std::array<Vec2, 2>{ends[links[i - drawn].a].at, ends[links[i - drawn].b].at};
    const FoldEnd& end = ends[i - rays];
    return std::array<Vec2, 2>{end.at, end.at + reach * end.out};
  };
  std::vector<std::uint8_t> touched(links.size(), 0);
  std::vector<double> hit(ends.size(), 2.0 * reach);
  const auto of_link = [&](std::size_t l, std::size_t e) {
    return ends[links[l].a].edge == e || ends[links[l].b].edge == e;
  };
  const CellGrid grid(rays + ends.size(), kTouch_mm, corners);
  const bool all =
      grid.each_pair(pair_budget(rays + ends.size()), [&](std::uint32_t i, std::uint32_t j) {
        if (i >= drawn && j < rays) return;  // both are gaps
        if (i < drawn && j >= drawn && j < rays) {
          if (of_link(j - drawn, i) || touched[j - drawn] != 0) return;
          const auto gap = corners(j);
          const Vec2 way = gap[1] - gap[0];
          const double length = norm(way);
          const auto t =
              first_hit(gap[0], (1.0 / length) * way, length, edges[i].from, edges[i].to);
          if (t) touched[j - drawn] = 1;
          return;
        }
        for (const auto& [ray, other] : {std::pair(j, i), std::pair(i, j)}) {
          if (ray < rays || (other >= drawn && other < rays)) continue;
          const FoldEnd& end = ends[ray - rays];
          if (other < drawn && end.edge == other) continue;
          if (other >= rays && ends[other - rays].edge == end.edge) continue;
          const auto at = corners(other);
          const auto t = first_hit(end.at, end.out, reach, at[0], at[1]);
          if (t) hit[ray - rays] = std::min(hit[ray - rays], *t);
        }
      });
  if (!all) return JoinedDashes{};
  std::vector<std::uint8_t> linked(ends.size(), 0);
  for (std::size_t l = 0; l < links.size(); ++l) {
    if (touched[l] != 0) continue;
    linked[links[l].a] = linked[links[l].b] = 1;
    DrawnEdge filler = edges[ends[links[l].a].edge];
    filler.from = ends[links[l].a].at;
    filler.to = ends[links[l].b].at;
    edges.push_back(filler);
    ++result.joined;
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (linked[i] != 0 || hit[i] > reach || hit[i] <= kTouch_mm) continue;
    DrawnEdge tail = edges[ends[i].edge];
    tail.from = ends[i].at;
    tail.to = ends[i].at + hit[i] * ends[i].out;
    edges.push_back(tail);
    ++result.extended;
  }
  return result;
}

}  // namespace popcut::verify
