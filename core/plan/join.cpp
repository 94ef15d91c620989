// SPDX-License-Identifier: MIT
#include "core/plan/join.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "core/plan/clean.hpp"

namespace popcut {
namespace {

constexpr double kStraight = 0.9962;          // cosine of 5 degrees
constexpr double kStraightTolerance = 0.001;  // mm; far below a machine's step

// Ends are numbered 2 piece (its start) and 2 piece + 1 (its end).
class Joiner {
 public:
  Joiner(const std::vector<Piece>& pieces, double tolerance)
      : pieces_(pieces), tolerance_(tolerance), link_(2 * pieces.size(), -1) {}

  void link_drawn() {
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (const std::int32_t next = pieces_[i].next; next >= 0)
        link(static_cast<std::int32_t>(2 * i + 1), 2 * next);
  }

  void link_meeting() {
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> cells;
    for (std::int32_t e = 0; e < ends(); ++e)
      if (link_[at(e)] < 0) cells[key(cell(e).first, cell(e).second)].push_back(e);
    std::vector<std::int32_t> near;
    for (const bool straight : {true, false})
      for (std::int32_t e = 0; e < ends(); ++e) {
        if (link_[at(e)] >= 0) continue;
        meeting(cells, e, near);
        const std::int32_t f = straight ? straight_on(e, near) : near.size() == 1 ? near[0] : -1;
        if (f >= 0 && (straight || !is_fold(piece(e).operation))) link(e, f);
      }
  }

  void trace(LineWork& out) {
    std::vector<std::uint8_t> done(pieces_.size(), 0);
    std::vector<PagePoint> line;
    for (const bool open : {true, false})
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        if (done[i] != 0) continue;
        const auto start = static_cast<std::int32_t>(2 * i);
        if (open && link_[at(start)] >= 0 && link_[at(start + 1)] >= 0) continue;
        walk(open && link_[at(start)] >= 0 ? start + 1 : start, done, line);
        if (!open) line.back() = line.front();
        out.append(pieces_[i].operation, without_straight_vertices(line, kStraightTolerance));
      }
  }

 private:
  static std::size_t at(std::int32_t e) { return static_cast<std::size_t>(e); }
  [[nodiscard]] std::int32_t ends() const { return static_cast<std::int32_t>(link_.size()); }
  [[nodiscard]] const Piece& piece(std::int32_t e) const { return pieces_[at(e / 2)]; }
  [[nodiscard]] const PagePoint& point(std::int32_t e) const {
    return e % 2 == 0 ? piece(e).segment.a : piece(e).segment.b;
  }
  void link(std::int32_t e, std::int32_t f) {
    link_[at(e)] = f;
    link_[at(f)] = e;
  }
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> cell(std::int32_t e) const {
    return {static_cast<std::int64_t>(std::floor(point(e).x / tolerance_)),
            static_cast<std::int64_t>(std::floor(point(e).y / tolerance_))};
  }
  static std::uint64_t key(std::int64_t cx, std::int64_t cy) {
    return static_cast<std::uint64_t>(cx) * 0x9E3779B97F4A7C15ULL ^ static_cast<std::uint64_t>(cy);
  }

  void meeting(const std::unordered_map<std::uint64_t, std::vector<std::int32_t>>& cells,
               std::int32_t e, std::vector<std::int32_t>& near) const {
    constexpr std::size_t kCrowd = 64;  // more ends in one point than a drawing needs
    near.clear();
    const auto [cx, cy] = cell(e);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = cells.find(key(cx + dx, cy + dy));
        if (found == cells.end()) continue;
        for (const std::int32_t f : found->second) {
          if (near.size() >= kCrowd) return;
          if (f / 2 != e / 2 && link_[at(f)] < 0 && piece(f).operation == piece(e).operation &&
              distance(point(e), point(f)) <= tolerance_)
            near.push_back(f);
        }
      }
  }

  // Unit direction in which the piece leaves at its end `e`.
  [[nodiscard]] PagePoint leaving(std::int32_t e) const {
    const PagePoint& to = point(e);
    const PagePoint& from = point(e ^ 1);
    const double l = distance(from, to);
    return {(to.x - from.x) / l, (to.y - from.y) / l};
  }

  [[nodiscard]] std::int32_t straight_on(std::int32_t e,
                                         const std::vector<std::int32_t>& near) const {
    const PagePoint u = leaving(e);
    std::int32_t best = -1;
    double best_cosine = kStraight;
    for (const std::int32_t f : near) {
      const PagePoint w = leaving(f);
      const double cosine = -(u.x * w.x + u.y * w.y);
      if (cosine > best_cosine) {
        best_cosine = cosine;
        best = f;
      }
    }
    return best;
  }

  // Follows the links from end `e`, into its piece first.
  void walk(std::int32_t e, std::vector<std::uint8_t>& done, std::vector<PagePoint>& line) const {
    line.assign(1, point(e));
    while (e >= 0 && done[at(e / 2)] == 0) {
      done[at(e / 2)] = 1;
      line.push_back(point(e ^ 1));
      e = link_[at(e ^ 1)];
    }
  }

  const std::vector<Piece>& pieces_;
  double tolerance_;
  std::vector<std::int32_t> link_;
};

}  // namespace

void join(const std::vector<Piece>& pieces, double tolerance, LineWork& out) {
  Joiner joiner(pieces, tolerance);
  joiner.link_drawn();
  joiner.link_meeting();
  joiner.trace(out);
}

// A vertex may go while some direction from the last kept one passes all that were dropped since
// within the tolerance: the cone of such directions only narrows (Sklansky and Gonzalez 1980).
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
