// SPDX-License-Identifier: MIT
#include "core/plan/route.hpp"

#include <algorithm>

#include "core/plan/linework.hpp"
#include "core/plan/point_grid.hpp"

namespace popcut {
namespace {

constexpr double kWorthwhile = 1e-7;  // mm; smaller gains are rounding
constexpr std::int64_t kLongestBlock = 3;

class Route {
 public:
  Route(const PagePoint& from, std::vector<RouteStop>& stops, std::vector<std::uint32_t>& sequence,
        const RouteEffort& effort)
      : from_(from), stops_(stops), sequence_(sequence), effort_(effort), place_(stops.size()) {
    for (std::size_t i = 0; i < sequence_.size(); ++i)
      place_[sequence_[i]] = static_cast<std::int64_t>(i);
    find_neighbours();
  }

  void improve() {
    for (int pass = 0; pass < effort_.passes; ++pass) {
      bool better = false;
      for (std::uint32_t stop = 0; stop < stops_.size(); ++stop)
        for (int tries = 0; tries < 8 && (try_reversals(stop) || try_shifts(stop)); ++tries)
          better = true;
      if (!better) return;
    }
  }

 private:
  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(sequence_.size()); }
  [[nodiscard]] const RouteStop& at(std::int64_t i) const {
    return stops_[sequence_[static_cast<std::size_t>(i)]];
  }
  [[nodiscard]] const PagePoint& end(std::int64_t i) const { return i < 0 ? from_ : at(i).end(); }
  // The way from a point to the start of stop i; none beyond the last one, where the route is free.
  [[nodiscard]] double way(const PagePoint& p, std::int64_t i) const {
    return i >= size() ? 0.0 : distance(p, at(i).start());
  }

  // End 2 s is `a` of stop s, 2 s + 1 its `b`.
  [[nodiscard]] const PagePoint& end_point(std::uint32_t e) const {
    return e % 2 == 0 ? stops_[e / 2].a : stops_[e / 2].b;
  }

  void find_neighbours() {
    std::vector<PagePoint> points;
    points.reserve(2 * stops_.size());
    for (const RouteStop& stop : stops_) {
      points.push_back(stop.a);
      points.push_back(stop.b);
    }
    const PointGrid grid(points);
    std::vector<std::uint32_t> near;
    neighbours_.reserve(points.size() * effort_.neighbours);
    first_.assign(1, 0);
    for (std::uint32_t e = 0; e < points.size(); ++e) {
      grid.nearest(
          points[e], effort_.neighbours, [&](std::uint32_t f) { return f / 2 != e / 2; }, near);
      neighbours_.insert(neighbours_.end(), near.begin(), near.end());
      first_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> near(std::uint32_t e) const {
    return std::span(neighbours_).subspan(first_[e], first_[e + 1] - first_[e]);
  }
  // Number of the end at which stop s is entered (left: the other one).
  [[nodiscard]] std::uint32_t start_end(std::uint32_t s) const {
    return 2 * s + (stops_[s].flipped ? 1 : 0);
  }

  [[nodiscard]] bool allowed(std::int64_t stops) const {
    return stops <= static_cast<std::int64_t>(effort_.longest_move);
  }

  // Reverses stops i..j if that makes the way shorter.
  bool reverse(std::int64_t i, std::int64_t j) {
    if (i > j || !allowed(j - i + 1)) return false;
    const double before = way(end(i - 1), i) + way(end(j), j + 1);
    const double after = distance(end(i - 1), at(j).end()) + way(at(i).start(), j + 1);
    if (after > before - kWorthwhile) return false;
    std::reverse(sequence_.begin() + i, sequence_.begin() + j + 1);
    for (std::int64_t k = i; k <= j; ++k) {
      RouteStop& stop = stops_[sequence_[static_cast<std::size_t>(k)]];
      stop.flipped = !stop.flipped;
      place_[sequence_[static_cast<std::size_t>(k)]] = k;
    }
    return true;
  }

  // Reversals that bring the way into, or out of, `stop` to a near end.
  bool try_reversals(std::uint32_t stop) {
    const std::int64_t i = place_[stop];
    const double out_now = way(end(i), i + 1);
    for (const std::uint32_t e : near(start_end(stop) ^ 1u)) {
      if (i + 1 < size() && distance(end(i), end_point(e)) >= out_now) break;
      const std::int64_t k = place_[e / 2];
      // end(i) -> end(k): what lies between is turned round.
      if ((k > i && reverse(i + 1, k)) || (k < i && reverse(k + 1, i))) return true;
    }
    const double in_now = way(end(i - 1), i);
    for (const std::uint32_t e : near(start_end(stop))) {
      if (distance(at(i).start(), end_point(e)) >= in_now) break;
      const std::int64_t k = place_[e / 2];
      // start(i) <- start(k): stops k.. before i, or i.. before k, are turned round.
      if ((k < i && reverse(k, i - 1)) || (k > i && reverse(i, k - 1))) return true;
    }
    return false;
  }

  // Takes block i..j out and puts it before stop `to` (outside of the block), turned or not.
  void shift(std::int64_t i, std::int64_t j, std::int64_t to, bool turned) {
    const auto begin = sequence_.begin();
    if (turned) {
      std::reverse(begin + i, begin + j + 1);
      for (std::int64_t k = i; k <= j; ++k) {
        RouteStop& stop = stops_[sequence_[static_cast<std::size_t>(k)]];
        stop.flipped = !stop.flipped;
      }
    }
    const std::int64_t low = std::min(i, to), high = std::max(j + 1, to);
    if (to < i)
      std::rotate(begin + to, begin + i, begin + j + 1);
    else
      std::rotate(begin + i, begin + j + 1, begin + to);
    for (std::int64_t k = low; k < high; ++k) place_[sequence_[static_cast<std::size_t>(k)]] = k;
  }

  // Puts block i..j between stops to-1 and to if that makes the way shorter.
  bool shift_if_shorter(std::int64_t i, std::int64_t j, std::int64_t to, double saved) {
    if (to >= i && to <= j + 1) return false;
    if (!allowed(to < i ? j - to : to - i)) return false;
    const PagePoint& before = end(to - 1);
    const double gap = way(before, to);
    const double straight = distance(before, at(i).start()) + way(at(j).end(), to) - gap;
    const double turned = distance(before, at(j).end()) + way(at(i).start(), to) - gap;
    if (std::min(straight, turned) > saved - kWorthwhile) return false;
    shift(i, j, to, turned < straight);
    return true;
  }

  // Moves of the block of one to three stops that begins with `stop` to places near its two ends.
  bool try_shifts(std::uint32_t stop) {
    const std::int64_t i = place_[stop];
    for (std::int64_t j = i; j < std::min(i + kLongestBlock, size()); ++j) {
      const double around = j + 1 < size() ? distance(end(i - 1), at(j + 1).start()) : 0.0;
      const double saved = way(end(i - 1), i) + way(end(j), j + 1) - around;
      if (saved <= kWorthwhile) continue;
      const std::uint32_t last = sequence_[static_cast<std::size_t>(j)];
      for (const std::uint32_t e : {start_end(stop), start_end(last) ^ 1u})
        for (const std::uint32_t f : near(e)) {
          if (distance(end_point(e), end_point(f)) >= saved) break;
          const std::int64_t k = place_[f / 2];
          if (k >= i && k <= j) continue;
          if (shift_if_shorter(i, j, k, saved) || shift_if_shorter(i, j, k + 1, saved)) return true;
        }
    }
    return false;
  }

  PagePoint from_;
  std::vector<RouteStop>& stops_;
  std::vector<std::uint32_t>& sequence_;
  RouteEffort effort_;
  std::vector<std::int64_t> place_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::uint32_t> first_;
};

}  // namespace

void improve_route(const PagePoint& from, std::vector<RouteStop>& stops,
                   std::vector<std::uint32_t>& sequence, const RouteEffort& effort) {
  if (stops.size() < 2) return;
  Route(from, stops, sequence, effort).improve();
}

}  // namespace popcut
