// SPDX-License-Identifier: MIT
#include "core/geometry/sweep_triangles.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

namespace popcut {
namespace {

using Node = std::uint32_t;  // a place of one or more points, numbered from left to right

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// Twice the area of a, b, c: positive where they turn left.
std::int64_t turn(const WholePoint& a, const WholePoint& b, const WholePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

int sign(std::int64_t value) { return (value > 0) - (value < 0); }

/// What the sweep has not cut yet of a region is bounded on its left by a chain of places, from the
/// region's lower side up to its upper one. All but its ends and the place that was met last are
/// corners of more than 180 degrees, or straight ones.
class Chains {
 public:
  Chains(const std::vector<WholePoint>& places, std::vector<std::array<Node, 3>>& triangles)
      : places_(places), triangles_(triangles) {}

  std::uint32_t begin_at(Node p) {
    const std::uint32_t link = new_link(p);
    chains_.push_back({link, link, link});
    return static_cast<std::uint32_t>(chains_.size() - 1);
  }

  /// `p` ends a side above the region.
  void add_above(std::uint32_t chain, Node p) {
    Chain& c = chains_[chain];
    while (c.bottom != c.top) {
      const Node a = links_[links_[c.top].down].node, b = links_[c.top].node;
      if (turn(places_[a], places_[b], places_[p]) >= 0) break;
      triangles_.push_back({a, p, b});
      c.top = links_[c.top].down;
    }
    const std::uint32_t link = new_link(p);
    links_[link].down = c.top, links_[c.top].up = link;
    c.top = c.last = link;
  }

  /// `p` ends a side below the region.
  void add_below(std::uint32_t chain, Node p) {
    Chain& c = chains_[chain];
    while (c.bottom != c.top) {
      const Node a = links_[links_[c.bottom].up].node, b = links_[c.bottom].node;
      if (turn(places_[a], places_[b], places_[p]) <= 0) break;
      triangles_.push_back({a, b, p});
      c.bottom = links_[c.bottom].up;
    }
    const std::uint32_t link = new_link(p);
    links_[link].up = c.bottom, links_[c.bottom].down = link;
    c.bottom = c.last = link;
  }

  /// A line begins at `p` within the region: from there on it is two.
  /// @return the one above
  std::uint32_t part_at(std::uint32_t chain, Node p) {
    const std::uint32_t middle = chains_[chain].last;
    const std::uint32_t twin = new_link(links_[middle].node);
    const std::uint32_t top = chains_[chain].top;
    if (middle != top) {
      links_[twin].up = links_[middle].up;
      links_[links_[middle].up].down = twin;
    }
    chains_.push_back({twin, middle == top ? twin : top, twin});
    const auto above = static_cast<std::uint32_t>(chains_.size() - 1);
    chains_[chain].top = middle;
    add_above(chain, p);
    add_below(above, p);
    return above;
  }

  /// Both have just been ended by the same place, which parted them: they go on as `below`.
  void join(std::uint32_t below, std::uint32_t above) {
    Chain &c = chains_[below], &d = chains_[above];
    if (d.bottom == d.top) return;
    const std::uint32_t next = links_[d.bottom].up;
    links_[c.top].up = next, links_[next].down = c.top;
    c.last = c.top, c.top = d.top;
  }

  /// Both sides of the region end at `p`.
  void end_at(std::uint32_t chain, Node p) {
    add_above(chain, p);
    Chain& c = chains_[chain];
    while (c.bottom != c.top && links_[c.bottom].up != c.top) {
      const Node a = links_[links_[c.bottom].up].node, b = links_[c.bottom].node;
      if (turn(places_[a], places_[b], places_[p]) > 0) triangles_.push_back({a, b, p});
      c.bottom = links_[c.bottom].up;
    }
  }

 private:
  struct Link {
    Node node{};
    std::uint32_t down{kNone}, up{kNone};
  };
  struct Chain {
    std::uint32_t bottom{}, top{};
    std::uint32_t last{};  ///< the place that was met last: all to its right sees it
  };

  std::uint32_t new_link(Node p) {
    links_.push_back({p, kNone, kNone});
    return static_cast<std::uint32_t>(links_.size() - 1);
  }

  const std::vector<WholePoint>& places_;
  std::vector<std::array<Node, 3>>& triangles_;
  std::vector<Link> links_;
  std::vector<Chain> chains_;
};

class Sweep {
 public:
  Sweep(std::span<const WholePoint> points, std::span<const std::uint32_t> ends)
      : chains_(places_, triangles_), now_({this}) {
    number_places(points);
    std::uint32_t first = 0;
    for (const std::uint32_t end : ends) {
      for (std::uint32_t k = first; k < end; ++k)
        add_side(node_of_[k], node_of_[k + 1 == end ? first : k + 1]);
      first = end;
    }
  }

  bool run() {
    for (Node p = 0; p < places_.size(); ++p)
      if (!pass(p)) return false;
    return now_.empty();
  }

  /// Triangles of the points that were given.
  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> out;
    out.reserve(triangles_.size());
    for (const auto& [a, b, c] : triangles_)
      out.push_back({point_of_[a], point_of_[b], point_of_[c]});
    return out;
  }

 private:
  struct Side {
    Node left{}, right{};
    mutable std::uint32_t above{kNone};  ///< chain of the region above it; none: that is outside
  };
  /// From the lowest to the highest, of sides that the sweep crosses at the same time.
  struct Lower {
    using is_transparent = void;
    const Sweep* sweep;
    bool operator()(const Side& a, const Side& b) const {
      const auto& at = sweep->places_;
      if (a.left == b.left) return turn(at[a.left], at[a.right], at[b.right]) > 0;
      if (a.left < b.left) {
        const std::int64_t where = turn(at[a.left], at[a.right], at[b.left]);
        return where != 0 ? where > 0 : turn(at[a.left], at[a.right], at[b.right]) > 0;
      }
      const std::int64_t where = turn(at[b.left], at[b.right], at[a.left]);
      return where != 0 ? where < 0 : turn(at[b.left], at[b.right], at[a.right]) < 0;
    }
    bool operator()(const Side& a, Node p) const { return sweep->where(a, p) > 0; }
  };
  using Sides = std::set<Side, Lower>;

  void number_places(std::span<const WholePoint> points) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const WholePoint &p = points[a], &q = points[b];
      if (p.x != q.x) return p.x < q.x;
      return p.y != q.y ? p.y < q.y : a < b;
    });
    node_of_.resize(points.size());
    for (const std::uint32_t k : order) {
      if (places_.empty() || !(places_.back() == points[k]))
        places_.push_back(points[k]), point_of_.push_back(k);
      node_of_[k] = static_cast<Node>(places_.size() - 1);
    }
    from_.resize(places_.size());
  }

  void add_side(Node a, Node b) {
    if (a != b) from_[std::min(a, b)].push_back(std::max(a, b));
  }

  /// More than 0 where `p` is above the side, 0 where it is on its line.
  [[nodiscard]] std::int64_t where(const Side& side, Node p) const {
    return turn(places_[side.left], places_[side.right], places_[p]);
  }

  /// The right ends of the sides that begin at `p`, from the lowest to the highest. Where two lie
  /// over each other, nothing is between them: only what one of them is longer is left.
  const std::vector<Node>& beginning_at(Node p) {
    std::vector<Node>& all = from_[p];
    std::sort(all.begin(), all.end(), [&](Node a, Node b) {
      const std::int64_t way = turn(places_[p], places_[a], places_[b]);
      return way != 0 ? way > 0 : a < b;
    });
    std::size_t kept = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool same = kept > 0 && turn(places_[p], places_[all[kept - 1]], places_[all[k]]) == 0;
      if (same)
        add_side(all[--kept], all[k]);  // at a place farther right
      else
        all[kept++] = all[k];
    }
    all.resize(kept);
    return all;
  }

  [[nodiscard]] bool cross(const Side& a, const Side& b) const {
    return sign(where(a, b.left)) * sign(where(a, b.right)) < 0 &&
           sign(where(b, a.left)) * sign(where(b, a.right)) < 0;
  }

  /// False if the side at `it` and the one below it cross.
  [[nodiscard]] bool apart(Sides::iterator it) const {
    return it == now_.begin() || it == now_.end() || !cross(*std::prev(it), *it);
  }

  /// Moves the sweep over a place. @return false where sides cross
  bool pass(Node p) {
    auto first = now_.lower_bound(p), last = first;
    const std::uint32_t below = first == now_.begin() ? kNone : std::prev(first)->above;
    std::uint32_t above = below;
    bool ended = false;
    for (; last != now_.end() && where(*last, p) == 0; ++last) {
      if (ended && above != kNone) chains_.end_at(above, p);
      ended = true;
      above = last->above;
      if (last->right != p) add_side(p, last->right);  // a corner touches it
    }
    now_.erase(first, last);
    const std::vector<Node>& begun = beginning_at(p);
    if (ended) {
      if (below != kNone) chains_.add_above(below, p);
      if (above != kNone) chains_.add_below(above, p);
      if (begun.empty() && below != kNone && above != kNone) chains_.join(below, above);
    } else if (below != kNone && !begun.empty()) {
      above = chains_.part_at(below, p);
    }
    return begin(p, begun, below != kNone, above) && apart(last);
  }

  bool begin(Node p, const std::vector<Node>& begun, bool inside, std::uint32_t above) {
    if ((begun.size() % 2 == 1) != (inside != (above != kNone))) return false;
    for (std::size_t k = 0; k < begun.size(); ++k) {
      inside = !inside;
      const bool is_last = k + 1 == begun.size();
      const std::uint32_t chain = is_last ? above : inside ? chains_.begin_at(p) : kNone;
      const auto [at, is_new] = now_.insert({p, begun[k], chain});
      if (!is_new || !apart(at)) return false;
    }
    return true;
  }

  std::vector<WholePoint> places_;  ///< from left to right, and from low to high
  std::vector<std::uint32_t> point_of_;
  std::vector<Node> node_of_;  ///< one a point
  std::vector<std::vector<Node>> from_;
  std::vector<std::array<Node, 3>> triangles_;
  Chains chains_;
  Sides now_;
};

}  // namespace

std::optional<std::vector<Triangle>> sweep_triangles(std::span<const WholePoint> points,
                                                     std::span<const std::uint32_t> ends) {
  Sweep sweep(points, ends);
  if (!sweep.run()) return std::nullopt;
  return sweep.triangles();
}

}  // namespace popcut
