// SPDX-License-Identifier: MIT
// Part of core/drawing/clean.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/drawing/clean.hpp"
#include "core/geometry/buckets.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/node_index.hpp"

namespace popcut {
namespace {

constexpr double kStraight = 0.9962;          // cosine of 5 degrees
constexpr double kStraightTolerance = 0.001;  // mm; far below one step of a machine
constexpr std::size_t kFewEnds = 12;          // at a node: up to this many, all pairs are compared
constexpr std::uint32_t kNoNode = 0xFFFFFFFF;

// Walks over pieces as disjoint sets: the walk of each piece, and whether that walk is closed.
class Walks {
 public:
  explicit Walks(std::size_t pieces) : sets_(pieces), open_(pieces, 0) {}
  std::uint32_t of(std::uint32_t piece) { return sets_.find(piece); }
  void unite(std::uint32_t a, std::uint32_t b) {
    const std::uint8_t open = open_[of(a)] | open_[of(b)];
    sets_.join(a, b);
    open_[of(a)] = open;
  }
  void mark_open(std::uint32_t piece) { open_[of(piece)] = 1; }
  bool is_open(std::uint32_t piece) { return open_[of(piece)] != 0; }

 private:
  DisjointSets sets_;
  std::vector<std::uint8_t> open_;
};

// Ends have numbers: 2 piece is its start, 2 piece + 1 its end.
class Joiner {
 public:
  Joiner(const std::vector<Piece>& pieces, std::span<const PagePoint> nodes)
      : pieces_(pieces),
        nodes_(nodes),
        partner_(2 * pieces.size(), kNoNode),
        walks_(pieces.size()) {
    ends_ = Buckets<std::uint32_t>(nodes.size(), [&](auto&& put) {
      for (std::uint32_t e = 0; e < partner_.size(); ++e) put(node(e), e);
    });
  }

  void pair_all() {
    for_each_meeting([&](std::span<std::uint32_t> ends) { pair_ends(ends); });
  }

  // Where a closed walk passes a node of another walk, merges the two.
  void merge_closed() {
    for (std::uint32_t e = 0; e < partner_.size(); ++e)
      if (partner_[e] == kNoNode) walks_.mark_open(e / 2);
    for_each_meeting([&](std::span<std::uint32_t> ends) {
      if (ends.size() > 2 && !is_fold(piece(ends[0]).operation)) merge_at(ends);
    });
  }

  void trace(LineWork& out) {
    std::vector<std::uint8_t> done(pieces_.size(), 0);
    std::vector<PagePoint> line;
    // A closed line has its first point twice; it has three others at least.
    out.points.reserve(out.points.size() + nodes_.size() + nodes_.size() / 3);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      if (done[i] != 0) continue;
      walk(first_end(2 * i), done, line);
      put(pieces_[i].operation, line, out);
    }
  }

 private:
  [[nodiscard]] const Piece& piece(std::uint32_t e) const { return pieces_[e / 2]; }
  [[nodiscard]] std::uint32_t node(std::uint32_t e) const {
    return e % 2 == 0 ? piece(e).a : piece(e).b;
  }
  [[nodiscard]] const PagePoint& point(std::uint32_t e) const { return nodes_[node(e)]; }

  // Visits the ends of one operation that meet in a node, for all nodes.
  template <typename Visit>
  void for_each_meeting(Visit&& visit) {
    for (std::size_t n = 0; n < ends_.size(); ++n) {
      const auto begin = ends_[n].begin(), end = ends_[n].end();
      if (end - begin < 2) continue;
      const auto operation = [&](std::uint32_t e) { return piece(e).operation; };
      std::sort(begin, end, [&](std::uint32_t e, std::uint32_t f) {
        return operation(e) != operation(f) ? operation(e) < operation(f) : e < f;
      });
      for (auto from = begin; from != end;) {
        const auto to = std::find_if(
            from, end, [&](std::uint32_t e) { return operation(e) != operation(*from); });
        if (to - from > 1) visit(std::span(from, to));
        from = to;
      }
    }
  }

  // Unit direction in which the piece leaves its end `e`.
  [[nodiscard]] PagePoint leaving(std::uint32_t e) const {
    const PagePoint& to = point(e);
    const PagePoint& from = point(e ^ 1u);
    const double l = distance(from, to);
    return {(to.x - from.x) / l, (to.y - from.y) / l};
  }
  // 1 if the walk continues straight from end `e` to end `f`, -1 if it turns back.
  [[nodiscard]] double onward(std::uint32_t e, std::uint32_t f) const {
    const PagePoint u = leaving(e), w = leaving(f);
    return -(u.x * w.x + u.y * w.y);
  }
  [[nodiscard]] bool drawn_as_one(std::uint32_t e, std::uint32_t f) const {
    const auto follows = [&](std::uint32_t a, std::uint32_t b) {
      return a % 2 == 1 && b % 2 == 0 && piece(a).next == static_cast<std::int32_t>(b / 2);
    };
    return follows(e, f) || follows(f, e);
  }
  void link(std::uint32_t e, std::uint32_t f) {
    partner_[e] = f;
    partner_[f] = e;
    walks_.unite(e / 2, f / 2);
  }

  void pair_ends(std::span<const std::uint32_t> ends) {
    const bool fold = is_fold(piece(ends[0]).operation);
    if (ends.size() == 2) {
      const bool joined = !fold || onward(ends[0], ends[1]) > kStraight;
      if (joined) link(ends[0], ends[1]);
    } else if (ends.size() <= kFewEnds) {
      pair_few(ends, fold);
    } else {
      pair_many(ends, fold);
    }
  }

  // Pairs the straightest ends first; among equals, those drawn as one line.
  void pair_few(std::span<const std::uint32_t> ends, bool fold) {
    struct Pair {
      double onward{};
      std::uint32_t e{}, f{};
    };
    std::array<Pair, kFewEnds*(kFewEnds - 1) / 2> pairs;
    std::size_t count = 0;
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t k = i + 1; k < ends.size(); ++k) {
        const double straight = onward(ends[i], ends[k]);
        if (fold && straight <= kStraight) continue;
        const double bonus = drawn_as_one(ends[i], ends[k]) ? 1e-6 : 0.0;
        pairs[count++] = {straight + bonus, ends[i], ends[k]};
      }
    std::stable_sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(count),
                     [](const Pair& p, const Pair& q) { return p.onward > q.onward; });
    for (std::size_t i = 0; i < count; ++i)
      if (partner_[pairs[i].e] == kNoNode && partner_[pairs[i].f] == kNoNode)
        link(pairs[i].e, pairs[i].f);
  }

  // Pairs each end with the free end whose direction is nearest to its opposite.
  void pair_many(std::span<const std::uint32_t> ends, bool fold) {
    std::vector<std::pair<double, std::uint32_t>> round;
    round.reserve(ends.size());
    for (const std::uint32_t e : ends) {
      const PagePoint u = leaving(e);
      round.emplace_back(std::atan2(u.y, u.x), e);
    }
    std::sort(round.begin(), round.end());
    std::vector<std::size_t> free(round.size());  // next free end from here on, around the circle
    for (std::size_t i = 0; i < free.size(); ++i) free[i] = i;
    const auto next_free = [&](std::size_t i) {
      while (free[i] != i) i = free[i] = free[free[i]];
      return i;
    };
    const auto take = [&](std::size_t i) { free[i] = (i + 1) % round.size(); };
    std::size_t left = round.size();
    for (std::size_t i = 0; i < round.size() && left > 1; ++i) {
      if (partner_[round[i].second] != kNoNode) continue;
      take(i);
      const double opposite =
          std::remainder(round[i].first + std::numbers::pi, 2 * std::numbers::pi);
      const auto at = std::lower_bound(round.begin(), round.end(), std::pair{opposite, 0u});
      const std::size_t after = static_cast<std::size_t>(at - round.begin()) % round.size();
      const std::size_t before = (after + round.size() - 1) % round.size();
      std::size_t k = next_free(after);
      const auto straight = [&](std::size_t other) {
        return onward(round[i].second, round[other].second);
      };
      if (free[before] == before && straight(before) > straight(k)) k = before;
      const bool joined = !fold || onward(round[i].second, round[k].second) > kStraight;
      --left;
      if (!joined) continue;
      take(k);
      --left;
      link(round[i].second, round[k].second);
    }
  }

  // Changes the pairs of a node until no closed walk passes it beside another walk.
  void merge_at(std::span<const std::uint32_t> ends) {
    const std::uint32_t base = ends.front();
    for (const std::uint32_t e : ends) {
      const bool other = walks_.of(base / 2) != walks_.of(e / 2);
      if (other && !(walks_.is_open(base / 2) && walks_.is_open(e / 2))) exchange(base, e);
    }
  }

  // Merges two walks, one of them closed: e continues to f or to f's former partner, whichever is
  // straighter. A loose end stays loose, or passes this on.
  void exchange(std::uint32_t e, std::uint32_t f) {
    if (partner_[f] == kNoNode) std::swap(e, f);  // a closed walk has no loose end
    const std::uint32_t e2 = partner_[e], f2 = partner_[f];
    const auto straight = [&](std::uint32_t a, std::uint32_t b) {
      return a == kNoNode || b == kNoNode ? 0.0 : onward(a, b);
    };
    const bool crossed = straight(e, f2) + straight(e2, f) > straight(e, f) + straight(e2, f2);
    const std::uint32_t to = crossed ? f2 : f, rest = crossed ? f : f2;
    link(e, to);
    if (e2 == kNoNode)
      partner_[rest] = kNoNode;
    else
      link(e2, rest);
  }

  // The first end of the walk that enters a piece at `e`.
  [[nodiscard]] std::uint32_t first_end(std::uint32_t e) const {
    const std::uint32_t start = e;
    while (partner_[e] != kNoNode) {
      e = partner_[e] ^ 1u;
      if (e == start) break;
    }
    return e;
  }

  // Follows the links from end `e`, first through its piece.
  void walk(std::uint32_t e, std::vector<std::uint8_t>& done, std::vector<PagePoint>& line) const {
    line.assign(1, point(e));
    while (e != kNoNode && done[e / 2] == 0) {
      done[e / 2] = 1;
      line.push_back(point(e ^ 1u));
      e = partner_[e ^ 1u];
    }
  }

  static bool seam_is_straight(std::span<const PagePoint> ring) {
    const std::array<PagePoint, 3> about{ring[ring.size() - 2], ring[0], ring[1]};
    return without_straight_vertices(about, kStraightTolerance).size() == 2;
  }

  static void put(PenOperation operation, std::vector<PagePoint>& line, LineWork& out) {
    if (line.size() == 2) return out.append(operation, line);
    std::vector<PagePoint> kept = without_straight_vertices(line, kStraightTolerance);
    if (closed(kept) && kept.size() > 4 && seam_is_straight(kept)) {
      kept.pop_back();
      kept.erase(kept.begin());
      kept.push_back(kept.front());
    }
    out.append(operation, kept);
  }

  const std::vector<Piece>& pieces_;
  std::span<const PagePoint> nodes_;
  std::vector<std::uint32_t> partner_;
  Walks walks_;
  Buckets<std::uint32_t> ends_;
};

}  // namespace

void join(const std::vector<Piece>& pieces, std::span<const PagePoint> nodes, LineWork& out) {
  Joiner joiner(pieces, nodes);
  joiner.pair_all();
  joiner.merge_closed();
  joiner.trace(out);
}

void join_loops(std::span<const Segment> edges, double tolerance, LineWork& out) {
  NodeIndex nodes(tolerance, 2 * edges.size());
  const auto node_at = [&](const PagePoint& p) { return nodes.find_or_add(p, tolerance); };
  std::vector<Piece> pieces;
  pieces.reserve(edges.size());
  for (const Segment& edge : edges) {
    const Piece piece{node_at(edge.a), node_at(edge.b), Operation::Outline, -1};
    if (piece.a != piece.b) pieces.push_back(piece);
  }
  Joiner joiner(pieces, nodes.points());
  joiner.pair_all();
  joiner.trace(out);
}

// Drops a vertex while one direction from the last kept vertex passes all dropped ones within the
// tolerance: the cone of such directions only narrows (Sklansky and Gonzalez 1980).
std::vector<PagePoint> without_straight_vertices(std::span<const PagePoint> line,
                                                 double tolerance) {
  std::vector<PagePoint> kept;
  if (line.empty()) return kept;
  kept.push_back(line.front());
  double low = -1e9, high = 1e9, reach = 0.0, base = 0.0;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const PagePoint& from = kept.back();
    const PagePoint& p = line[i];
    const PagePoint& q = line[i + 1];
    const double r = distance(from, p);
    if (r <= tolerance) continue;
    if (reach == 0.0) base = std::atan2(p.y - from.y, p.x - from.x);
    const double angle =
        std::remainder(std::atan2(p.y - from.y, p.x - from.x) - base, 2 * std::numbers::pi);
    const double give = std::asin(std::min(1.0, tolerance / r));
    low = std::max(low, angle - give);
    high = std::min(high, angle + give);
    const double onward =
        std::remainder(std::atan2(q.y - from.y, q.x - from.x) - base, 2 * std::numbers::pi);
    reach = std::max(reach, r);
    if (onward >= low && onward <= high && distance(from, q) >= reach) continue;
    kept.push_back(p);
    low = -1e9;
    high = 1e9;
    reach = 0.0;
  }
  kept.push_back(line.back());
  return kept;
}

}  // namespace popcut
