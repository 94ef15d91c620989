// SPDX-License-Identifier: MIT
#include "core/plan/clean.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/plan/join.hpp"
#include "core/plan/overlap.hpp"

namespace popcut {
namespace {

struct DrawnSegment {
  Segment segment;
  Operation operation{};
  double length{};
  bool joins_next{false};     ///< the next segment goes on from its end
  std::int64_t loops_to{-1};  ///< first segment of a closed line, at its last
};

int strength(Operation operation) {
  switch (operation) {
    case Operation::Outline:
      return 5;
    case Operation::Cut:
      return 4;
    case Operation::FoldMountain:
      return 3;
    case Operation::FoldValley:
      return 2;
    case Operation::Score:
      return 1;
    case Operation::Draw:
      break;
  }
  return 0;
}

std::vector<DrawnSegment> segments_of(const LineWork& work) {
  std::vector<DrawnSegment> segments;
  segments.reserve(work.points.size());
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    const auto first = static_cast<std::int64_t>(segments.size());
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double l = distance(points[i - 1], points[i]);
      if (l < 1e-9) continue;
      segments.push_back({{points[i - 1], points[i]}, line.operation, l, true, -1});
    }
    if (static_cast<std::int64_t>(segments.size()) == first) continue;
    segments.back().joins_next = false;
    if (closed(points)) segments.back().loops_to = first;
  }
  return segments;
}

PagePoint at(const DrawnSegment& s, double t) {
  if (t <= 0.0) return s.segment.a;
  if (t >= s.length) return s.segment.b;
  const double f = t / s.length;
  return {s.segment.a.x + f * (s.segment.b.x - s.segment.a.x),
          s.segment.a.y + f * (s.segment.b.y - s.segment.a.y)};
}

// What is left of each segment once the stronger and the longer ones have taken their places.
class Taker {
 public:
  explicit Taker(const std::vector<DrawnSegment>& segments)
      : segments_(segments), left_(segments.size()), index_(index_for(segments)) {}

  void take(std::uint32_t s) {
    const DrawnSegment& segment = segments_[s];
    index_.covered(segment.segment, s, covered_);
    double t = 0.0;
    for (const auto& part : covered_) {
      if (!gives_way(s, part.by)) continue;
      if (part.from > t) keep(s, t, part.from);
      t = std::max(t, part.to);
    }
    keep(s, t, segment.length);
  }

  [[nodiscard]] const std::vector<std::vector<std::pair<double, double>>>& left() const {
    return left_;
  }
  [[nodiscard]] std::size_t contradictions() const { return contradictions_; }

 private:
  static OverlapIndex index_for(const std::vector<DrawnSegment>& segments) {
    std::vector<Segment> plain;
    plain.reserve(segments.size());
    for (const DrawnSegment& s : segments) plain.push_back(s.segment);
    return {OverlapIndex::cell_for(plain), kOverlapTolerance, plain.size()};
  }

  bool gives_way(std::uint32_t s, std::uint32_t to) {
    const Operation mine = segments_[s].operation;
    const Operation other = segments_[to].operation;
    if ((mine == Operation::Draw) != (other == Operation::Draw)) return false;
    if (is_fold(mine) && is_fold(other) && mine != other) ++contradictions_;
    return true;
  }

  void keep(std::uint32_t s, double from, double to) {
    const DrawnSegment& segment = segments_[s];
    const bool whole = from <= 0.0 && to >= segment.length;
    if (to <= from || (!whole && to - from < 2 * kOverlapTolerance)) return;
    left_[s].emplace_back(from, to);
    index_.insert({at(segment, from), at(segment, to)}, s);
  }

  const std::vector<DrawnSegment>& segments_;
  std::vector<std::vector<std::pair<double, double>>> left_;
  OverlapIndex index_;
  std::vector<OverlapIndex::Covered> covered_;
  std::size_t contradictions_{};
};

std::vector<Piece> pieces_of(const std::vector<DrawnSegment>& segments, const Taker& taker) {
  std::vector<Piece> pieces;
  std::vector<std::int32_t> first_whole(segments.size(), -1);  // piece that begins where s begins
  std::vector<std::int32_t> last_whole(segments.size(), -1);   // piece that ends where s ends
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const auto& [from, to] : taker.left()[s]) {
      const auto id = static_cast<std::int32_t>(pieces.size());
      if (from <= 0.0) first_whole[s] = id;
      if (to >= segments[s].length) last_whole[s] = id;
      pieces.push_back({{at(segments[s], from), at(segments[s], to)}, segments[s].operation, -1});
    }
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const auto next =
        segments[s].joins_next ? static_cast<std::int64_t>(s) + 1 : segments[s].loops_to;
    if (last_whole[s] >= 0 && next >= 0)
      pieces[static_cast<std::size_t>(last_whole[s])].next =
          first_whole[static_cast<std::size_t>(next)];
  }
  return pieces;
}

}  // namespace

LineWork clean(const LineWork& work) {
  const std::vector<DrawnSegment> segments = segments_of(work);
  std::vector<std::uint32_t> order(segments.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int sa = strength(segments[a].operation), sb = strength(segments[b].operation);
    if (sa != sb) return sa > sb;
    if (segments[a].length != segments[b].length) return segments[a].length > segments[b].length;
    return a < b;
  });
  Taker taker(segments);
  for (const std::uint32_t s : order) taker.take(s);

  LineWork out;
  out.name = work.name;
  out.warnings = work.warnings;
  out.has_page = work.has_page;
  out.dashed = work.dashed;
  join(pieces_of(segments, taker), kJoinTolerance, out);
  if (taker.contradictions() > 0)
    out.warnings.push_back(
        fmt::format("{} places are both mountain and valley; they are folded as mountain",
                    taker.contradictions()));
  return out;
}

}  // namespace popcut
