// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "core/geometry/point_tree.hpp"
#include "core/plan/order/tour_stops.hpp"

namespace popcut {
namespace {

constexpr std::uint32_t kNone = NearNodes::kNone;

class Greedy {
 public:
  explicit Greedy(const TourStops& stops)
      : stops_(stops), mate_(stops.node.size(), kNone), far_end_(stops.node.size()) {
    for (std::uint32_t n = 0; n < far_end_.size(); ++n) far_end_[n] = n ^ 1u;
  }

  TourOrder run(const NearNodes& near) {
    std::size_t count = 0;
    visit_pairs(near, [&](std::uint32_t, std::uint32_t, float) { ++count; });
    links_.reserve(count);
    visit_pairs(near, [&](std::uint32_t n, std::uint32_t m, float mm) {
      links_.push_back({mm, std::min(n, m), std::max(n, m)});
    });
    take_shortest();
    for (std::vector<std::uint32_t> ends = loose(); ends.size() > 2; ends = loose()) {
      offer_near(ends);
      take_shortest();
    }
    close();
    return walk();
  }

 private:
  struct Link {
    float mm;
    std::uint32_t a, b;
  };

  // Visits each pair of near nodes once.
  template <typename Visit>
  void visit_pairs(const NearNodes& near, Visit&& visit) const {
    for (std::uint32_t n = 0; n < stops_.node.size(); ++n) {
      const auto row = near.near(n);
      for (std::size_t k = 0; k < row.size() && row[k] != kNone; ++k) {
        const auto back = near.near(row[k]);
        const bool both = std::find(back.begin(), back.end(), n) != back.end();
        if (!both || n < row[k]) visit(n, row[k], near.mm[std::size_t{n} * near.each + k]);
      }
    }
  }

  // A loose end of the stop of `n`: of a closed stop, either node.
  [[nodiscard]] std::uint32_t loose_end(std::uint32_t n) const {
    if (mate_[n] == kNone) return n;
    return stops_.has_doors(n / 2) && mate_[n ^ 1u] == kNone ? n ^ 1u : kNone;
  }

  void take_shortest() {
    std::sort(links_.begin(), links_.end(), [](const Link& p, const Link& q) {
      return p.mm != q.mm ? p.mm < q.mm : p.a != q.a ? p.a < q.a : p.b < q.b;
    });
    for (const Link& link : links_) {
      const std::uint32_t a = loose_end(link.a), b = loose_end(link.b);
      if (a != kNone && b != kNone && far_end_[a] != b) join(a, b);
    }
    links_.clear();
  }

  void join(std::uint32_t a, std::uint32_t b) {
    mate_[a] = b;
    mate_[b] = a;
    const std::uint32_t p = far_end_[a], q = far_end_[b];
    far_end_[p] = q;
    far_end_[q] = p;
  }

  [[nodiscard]] std::vector<std::uint32_t> loose() const {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t n = 0; n < mate_.size(); ++n)
      if (mate_[n] == kNone && !stops_.is_free(n)) ends.push_back(n);
    return ends;
  }

  void offer_near(const std::vector<std::uint32_t>& ends) {
    std::vector<PagePoint> points;
    points.reserve(ends.size());
    for (const std::uint32_t n : ends) points.push_back(stops_.node[n]);
    const PointTree tree(points, ends);
    PointTree::NearList found(5);
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
      const std::uint32_t n = ends[i];
      tree.nearest(i, found, [&](std::uint32_t m) { return m != far_end_[n]; });
      for (const PointTree::Near& near : found.all())
        links_.push_back({static_cast<float>(std::sqrt(near.squared)), std::min(n, near.tag),
                          std::max(n, near.tag)});
    }
  }

  // Joins the last loose ends: the two ends of the one piece, and home if it is not linked yet.
  void close() {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t n = 0; n < mate_.size(); ++n)
      if (mate_[n] == kNone) ends.push_back(n);
    if (ends.size() == 4) {
      join(1, ends[2]);
      join(0, ends[3]);
    } else if (ends.size() == 2) {
      join(ends[0], ends[1]);
    }
  }

  [[nodiscard]] TourOrder walk() const {
    TourOrder order;
    order.sequence.reserve(stops_.size());
    order.flipped.assign(stops_.size(), 0);
    order.sequence.push_back(0);
    for (std::uint32_t n = mate_[1]; n > 1; n = mate_[n ^ 1u]) {
      order.sequence.push_back(n / 2);
      order.flipped[n / 2] = static_cast<std::uint8_t>(n % 2);
    }
    return order;
  }

  const TourStops& stops_;
  std::vector<std::uint32_t> mate_, far_end_;  // far_end_: the other end of a loose end's piece
  std::vector<Link> links_;
};

}  // namespace

TourOrder greedy_tour(const TourStops& stops, const NearNodes& near) {
  return Greedy(stops).run(near);
}

}  // namespace popcut
