// SPDX-License-Identifier: MIT
// Part of core/drawing/nesting.hpp.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/drawing/linework.hpp"
#include "core/drawing/nesting.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

constexpr double kMeet = 0.002;           // mm; twice the tolerance of dropped vertices
constexpr std::size_t kFewSegments = 24;  // up to this many, all pairs are compared
constexpr std::size_t kPairsEach = 64;

// A place on a stroke: the vertex `segment` if `part` is 0, else a point after it. Places with the
// same number are the same point.
struct Place {
  std::uint32_t segment{};
  double part{};
  std::uint32_t number{};
  PagePoint point;
};

class Meetings {
 public:
  explicit Meetings(std::span<const PagePoint> stroke) : stroke_(stroke), sets_(stroke.size()) {
    const auto n = static_cast<std::uint32_t>(stroke.size());
    for (std::uint32_t i = 0; i < n; ++i) places_.push_back({i, 0.0, i, stroke[i]});
    join_equal_vertices();
    join_crossings();
  }

  // All places along the stroke. Places that meet have the same number.
  [[nodiscard]] std::vector<Place> along() {
    std::vector<Place> all = places_;
    for (Place& place : all) place.number = sets_.find(place.number);
    std::stable_sort(all.begin(), all.end(), [](const Place& a, const Place& b) {
      return std::tie(a.segment, a.part) < std::tie(b.segment, b.part);
    });
    return all;
  }
  [[nodiscard]] bool any() const { return meetings_ > (closed(stroke_) ? 1u : 0u); }

 private:
  void unite(std::uint32_t a, std::uint32_t b) {
    if (sets_.join(a, b)) ++meetings_;
  }

  void join_equal_vertices() {
    std::vector<std::uint32_t> order(stroke_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(stroke_[a].x, stroke_[a].y, a) < std::tie(stroke_[b].x, stroke_[b].y, b);
    });
    std::uint32_t first = order.front();  // among equal places
    for (std::size_t i = 1; i < order.size(); ++i)
      if (stroke_[order[i]] == stroke_[first])
        unite(first, order[i]);
      else
        first = order[i];
  }

  void join_crossings() {
    const auto n = static_cast<std::uint32_t>(stroke_.size() - 1);
    if (n <= kFewSegments) {
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t k = i + 2; k < n; ++k) cross(i, k);
      return;
    }
    std::vector<Segment> segments;
    segments.reserve(n);
    for (std::uint32_t i = 0; i < n; ++i) segments.push_back({stroke_[i], stroke_[i + 1]});
    SegmentGrid grid(segments, kMeet);
    std::vector<std::uint32_t> near;
    std::size_t budget = kPairsEach * n;
    for (std::uint32_t i = 0; i < n; ++i) {
      grid.near(segments[i], near);
      if (near.size() > budget) return;
      budget -= near.size();
      for (const std::uint32_t k : near)
        if (k > i + 1) cross(i, k);
    }
  }

  // The number of a place; a place within `kMeet` of a vertex is that vertex.
  std::uint32_t place_at(std::uint32_t segment, double part, double l) {
    if (part * l <= kMeet) return segment;
    if ((1.0 - part) * l <= kMeet) return segment + 1;
    const std::uint32_t number = sets_.add();
    places_.push_back({segment, part, number, lerp(stroke_[segment], stroke_[segment + 1], part)});
    return number;
  }

  // Joins the places where two segments that are not neighbours meet.
  void cross(std::uint32_t i, std::uint32_t k) {
    const PagePoint &a = stroke_[i], &b = stroke_[i + 1], &c = stroke_[k], &d = stroke_[k + 1];
    if (std::max(a.x, b.x) + kMeet < std::min(c.x, d.x) ||
        std::max(c.x, d.x) + kMeet < std::min(a.x, b.x) ||
        std::max(a.y, b.y) + kMeet < std::min(c.y, d.y) ||
        std::max(c.y, d.y) + kMeet < std::min(a.y, b.y))
      return;
    const double ux = b.x - a.x, uy = b.y - a.y, wx = d.x - c.x, wy = d.y - c.y;
    const double lu = std::hypot(ux, uy), lw = std::hypot(wx, wy), turn = ux * wy - uy * wx;
    if (!(std::abs(turn) > 1e-6 * lu * lw))
      return;  // parallel: their vertices tell where they meet
    const double s = ((c.x - a.x) * wy - (c.y - a.y) * wx) / turn;
    const double t = ((c.x - a.x) * uy - (c.y - a.y) * ux) / turn;
    const double s_over = std::max({0.0, -s, s - 1.0}) * lu;
    const double t_over = std::max({0.0, -t, t - 1.0}) * lw;
    if (s_over > kMeet || t_over > kMeet) return;
    unite(place_at(i, std::clamp(s, 0.0, 1.0), lu), place_at(k, std::clamp(t, 0.0, 1.0), lw));
  }

  std::span<const PagePoint> stroke_;
  std::vector<Place> places_;
  DisjointSets sets_;  ///< of the places, by number
  std::size_t meetings_{0};
};

}  // namespace

void append_stroke_loops(std::span<const PagePoint> stroke, Polylines& out) {
  if (stroke.size() < 4) return;
  Meetings meetings(stroke);
  if (!meetings.any()) return;
  constexpr std::uint32_t kNowhere = 0xffffffffu;
  const std::vector<Place> all = meetings.along();
  std::vector<std::uint32_t> height(all.size(),
                                    kNowhere);  // per number: its index on the current path
  std::vector<const Place*> way;
  for (const Place& place : all) {
    const std::uint32_t at = height[place.number];
    if (at == kNowhere) {
      height[place.number] = static_cast<std::uint32_t>(way.size());
      way.push_back(&place);
      continue;
    }
    if (way.size() - at >= 3) {
      for (std::size_t i = at; i < way.size(); ++i) out.points.push_back(way[i]->point);
      out.points.push_back(way[at]->point);
      out.ends.push_back(static_cast<std::uint32_t>(out.points.size()));
    }
    for (std::size_t i = at + 1; i < way.size(); ++i) height[way[i]->number] = kNowhere;
    way.resize(at + 1);
  }
}

}  // namespace popcut
