// SPDX-License-Identifier: MIT
#include "core/plan/clean.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/plan/collinear.hpp"
#include "core/plan/euler.hpp"
#include "core/plan/node_index.hpp"

namespace popcut {
namespace {

constexpr double kSame = 0.001;  // mm; vertices of different lines this near are one
constexpr std::uint32_t kNone = NodeIndex::kNone;

/// A straight part of a drawn line between two nodes.
struct DrawnSegment {
  std::uint32_t a{}, b{};
  Operation operation{};
  bool joins_next{false};     ///< the next segment goes on from its end
  std::int32_t loops_to{-1};  ///< first segment of a closed line, at its last
};

// The vertices of a drawing as nodes: those within lines first, then the ends, which go to a node
// that is near.
class Snapping {
 public:
  Snapping(const LineWork& work, double snap)
      : snap_(std::clamp(snap, kSame, kMostSnap)),
        nodes_(snap_, work.points.size()),
        node_of_(work.points.size(), kNone) {
    for (const DrawnLine& line : work.lines) set_within(work, line);
    for (const DrawnLine& line : work.lines) set_ends(work, line);
  }
  [[nodiscard]] std::uint32_t node(std::size_t point) const { return node_of_[point]; }
  [[nodiscard]] NodeIndex& nodes() { return nodes_; }
  [[nodiscard]] const NodeIndex& nodes() const { return nodes_; }
  [[nodiscard]] double reach() const { return snap_; }

 private:
  std::uint32_t same(const PagePoint& p) {
    const std::uint32_t found = nodes_.find(p, kSame);
    return found != kNone ? found : nodes_.add(p);
  }

  void set_within(const LineWork& work, const DrawnLine& line) {
    const auto points = work.points_of(line);
    const bool ring = closed(points);
    for (std::size_t k = ring ? 0 : 1; k + 1 < points.size(); ++k)
      node_of_[line.first + k] = same(points[k]);
    if (ring) node_of_[line.first + points.size() - 1] = node_of_[line.first];
  }

  // An end goes to the nearest node, but not back along its own line.
  void set_ends(const LineWork& work, const DrawnLine& line) {
    const std::size_t first = line.first, last = first + line.count - 1;
    if (node_of_[first] != kNone) return;  // closed
    for (const std::size_t end : {first, last}) {
      const PagePoint& p = work.points[end];
      list_just_before(work, end, end == first ? last : first);
      const std::uint32_t found = nodes_.find(p, snap_, [&](std::uint32_t n) {
        return std::find(just_before_.begin(), just_before_.end(), n) == just_before_.end() ||
               distance(nodes_.point(n), p) <= kSame;
      });
      node_of_[end] = found != kNone ? found : nodes_.add(p);
    }
  }

  // Nodes that the line from `end` to `other` passes within twice the snap from its end.
  void list_just_before(const LineWork& work, std::size_t end, std::size_t other) {
    just_before_.clear();
    double way = 0.0;
    for (std::size_t k = end; k != other;) {
      const std::size_t next = other > end ? k + 1 : k - 1;
      way += distance(work.points[k], work.points[next]);
      if (way > 2 * snap_) return;
      just_before_.push_back(node_of_[next]);
      k = next;
    }
  }

  double snap_;
  NodeIndex nodes_;
  std::vector<std::uint32_t> node_of_;
  std::vector<std::uint32_t> just_before_;
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

std::vector<DrawnSegment> segments_of(const LineWork& work, const Snapping& snapping) {
  std::vector<DrawnSegment> segments;
  segments.reserve(work.points.size() - std::min(work.points.size(), work.lines.size()));
  for (const DrawnLine& line : work.lines) {
    const auto first = static_cast<std::int32_t>(segments.size());
    for (std::uint32_t i = 1; i < line.count; ++i) {
      const std::uint32_t a = snapping.node(line.first + i - 1), b = snapping.node(line.first + i);
      if (a != b) segments.push_back({a, b, line.operation, true, -1});
    }
    if (static_cast<std::int32_t>(segments.size()) == first) continue;
    segments.back().joins_next = false;
    if (segments.back().b == segments[static_cast<std::size_t>(first)].a)
      segments.back().loops_to = first;
  }
  return segments;
}

// What is left of each segment once the stronger and the longer ones have taken their places.
class Taker {
 public:
  Taker(const std::vector<DrawnSegment>& segments, Snapping& snapping)
      : segments_(segments),
        snapping_(snapping),
        index_(plain(segments, snapping), kOverlapTolerance),
        first_(segments.size(), -1) {
    left_.reserve(segments.size());
  }

  void run() {
    std::vector<std::uint32_t> order(segments_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<float> lengths(segments_.size());
    for (std::size_t s = 0; s < segments_.size(); ++s)
      lengths[s] = static_cast<float>(length_of(segments_[s]));
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const int sa = strength(segments_[a].operation), sb = strength(segments_[b].operation);
      if (sa != sb) return sa > sb;
      return lengths[a] != lengths[b] ? lengths[a] > lengths[b] : a < b;
    });
    for (const std::uint32_t s : order) take(s);
  }

  [[nodiscard]] std::size_t contradictions() const { return contradictions_; }

  /// The pieces, in the order of the drawing.
  [[nodiscard]] std::vector<Piece> pieces() const {
    std::vector<Piece> pieces;
    pieces.reserve(left_.size());
    std::int32_t before = -1;  // piece that ends where segment s begins
    std::vector<std::int32_t> first_whole(segments_.size(), -1);
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      const DrawnSegment& segment = segments_[s];
      std::int32_t at_end = -1;
      for (std::int32_t l = first_[s]; l >= 0; l = left_[static_cast<std::size_t>(l)].next) {
        const Left& left = left_[static_cast<std::size_t>(l)];
        const auto id = static_cast<std::int32_t>(pieces.size());
        if (left.a == segment.a) {
          first_whole[s] = id;
          if (before >= 0) pieces[static_cast<std::size_t>(before)].next = id;
        }
        if (left.b == segment.b) at_end = id;
        pieces.push_back({left.a, left.b, segment.operation, -1});
      }
      if (segment.loops_to >= 0 && at_end >= 0)
        pieces[static_cast<std::size_t>(at_end)].next =
            first_whole[static_cast<std::size_t>(segment.loops_to)];
      before = segment.joins_next ? at_end : -1;
    }
    return pieces;
  }

 private:
  /// A part of a segment between two nodes.
  struct Left {
    std::uint32_t a{}, b{};
    std::int32_t next{-1};  ///< the next part of the same segment
  };

  [[nodiscard]] Segment segment_of(const DrawnSegment& s) const {
    return {snapping_.nodes().point(s.a), snapping_.nodes().point(s.b)};
  }
  [[nodiscard]] double length_of(const DrawnSegment& s) const {
    return distance(snapping_.nodes().point(s.a), snapping_.nodes().point(s.b));
  }
  static std::vector<Segment> plain(const std::vector<DrawnSegment>& segments,
                                    const Snapping& snapping) {
    std::vector<Segment> out;
    out.reserve(segments.size());
    for (const DrawnSegment& s : segments)
      out.push_back({snapping.nodes().point(s.a), snapping.nodes().point(s.b)});
    return out;
  }

  void take(std::uint32_t s) {
    const DrawnSegment& drawn = segments_[s];
    const Segment segment = segment_of(drawn);
    const double l = distance(segment.a, segment.b);
    index_.covered(segment, s, covered_);
    double t = 0.0;
    last_ = -1;
    for (const auto& part : covered_) {
      if (!gives_way(s, part.by)) continue;
      if (part.from > t) keep(s, segment, l, t, part.from);
      t = std::max(t, part.to);
    }
    keep(s, segment, l, t, l);
  }

  bool gives_way(std::uint32_t s, std::uint32_t to) {
    const Operation mine = segments_[s].operation;
    const Operation other = segments_[to].operation;
    if ((mine == Operation::Draw) != (other == Operation::Draw)) return false;
    if (is_fold(mine) && is_fold(other) && mine != other) ++contradictions_;
    return true;
  }

  void keep(std::uint32_t s, const Segment& segment, double l, double from, double to) {
    const bool whole = from <= 0.0 && to >= l;
    if (to <= from || (!whole && to - from < 2 * kOverlapTolerance)) return;
    const PagePoint p = at(segment, l, from), q = at(segment, l, to);
    const std::uint32_t a = from <= 0.0 ? segments_[s].a : node_near(p);
    const std::uint32_t b = to >= l ? segments_[s].b : node_near(q);
    if (a == b) return;
    const auto index = static_cast<std::int32_t>(left_.size());
    (last_ < 0 ? first_[s] : left_[static_cast<std::size_t>(last_)].next) = index;
    last_ = index;
    left_.push_back({a, b, -1});
    index_.insert({p, q}, s);  // as drawn: its direction tells what lies along it
  }

  static PagePoint at(const Segment& segment, double l, double t) {
    if (t <= 0.0) return segment.a;
    if (t >= l) return segment.b;
    const double f = t / l;
    return {segment.a.x + f * (segment.b.x - segment.a.x),
            segment.a.y + f * (segment.b.y - segment.a.y)};
  }

  // Where a part ends because a line takes the place from there on, a node of that line is near.
  std::uint32_t node_near(const PagePoint& p) {
    const double reach = std::min(snapping_.reach(), 2 * kOverlapTolerance);
    const std::uint32_t found = snapping_.nodes().find(p, reach);
    return found != kNone ? found : snapping_.nodes().add(p);
  }

  const std::vector<DrawnSegment>& segments_;
  Snapping& snapping_;
  CollinearIndex index_;
  std::vector<CollinearIndex::Covered> covered_;
  std::vector<std::int32_t> first_;  ///< of a segment: its first part in `left_`
  std::vector<Left> left_;
  std::int32_t last_{-1};
  std::size_t contradictions_{};
};

LineWork without_lines(const LineWork& work) {
  LineWork out;
  out.name = work.name;
  out.warnings = work.warnings;
  out.has_page = work.has_page;
  out.dashed = work.dashed;
  return out;
}

}  // namespace

LineWork with_ends_snapped(const LineWork& work, double snap_mm) {
  const Snapping snapping(work, snap_mm);
  LineWork out = work;
  for (std::size_t i = 0; i < out.points.size(); ++i)
    if (const std::uint32_t node = snapping.node(i); node != kNone)
      out.points[i] = snapping.nodes().point(node);
  return out;
}

LineWork clean(const LineWork& work, const CleanOptions& options) {
  Snapping snapping(work, options.snap_mm);
  std::vector<Piece> pieces;
  std::size_t contradictions = 0;
  {
    const std::vector<DrawnSegment> segments = segments_of(work, snapping);
    Taker taker(segments, snapping);
    taker.run();
    pieces = taker.pieces();
    contradictions = taker.contradictions();
  }
  LineWork out = without_lines(work);
  join(pieces, snapping.nodes().points(), out);
  if (contradictions > 0)
    out.warnings.push_back(fmt::format(
        "{} places are both mountain and valley; they are folded as mountain", contradictions));
  return out;
}

}  // namespace popcut
