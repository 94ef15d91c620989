// SPDX-License-Identifier: MIT
#include "core/drawing/clean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/collinear.hpp"
#include "core/drawing/near_lines.hpp"
#include "core/geometry/node_index.hpp"

namespace popcut {
namespace {

constexpr double kSeenMm = 0.1;  // lines that only touch share less

constexpr double kMoved = 1e-4;  // mm; ends that move by less are only rounded
constexpr double kSame = 0.001;  // mm; vertices of different lines this near are the same
constexpr std::uint32_t kNone = NodeIndex::kNone;

/// The straight parts of the lines, in drawing order.
struct DrawnSegments {
  struct Kind {
    PenOperation operation;
    bool joins_next{false};  ///< the next segment continues from its end
    bool loops{
        false};  ///< last segment of a closed line: the line's first segment continues from its end
  };
  std::vector<NodeEdge> edges;
  std::vector<Kind> kinds;
};

// Turns the vertices of a drawing into nodes: first the vertices within lines, then line ends,
// which snap to a node nearby. Where ends move, which node an end meets depends on the order of the
// lines; they are taken by their places then, so that a drawing means the same in all formats.
class Snapping {
 public:
  Snapping(const LineWork& work, double snap)
      : snap_(std::clamp(snap, kSame, kMostSnap)),
        nodes_(snap_, work.points.size()),
        node_of_(work.points.size(), kNone) {
    for (const DrawnLine& line : work.lines) set_within(work, line);
    for (const DrawnLine& line : work.lines)
      for (const std::size_t end : ends_of(line)) set_end(work, line, end);
    if (!moved_) return;
    nodes_ = NodeIndex(snap_, work.points.size());
    std::fill(node_of_.begin(), node_of_.end(), kNone);
    for (const DrawnLine& line : work.lines) set_within(work, line);
    for (const auto& [line, end] : ends_by_place(work)) set_end(work, *line, end);
  }
  [[nodiscard]] std::uint32_t node(std::size_t point) const { return node_of_[point]; }
  [[nodiscard]] NodeIndex& nodes() { return nodes_; }
  [[nodiscard]] const NodeIndex& nodes() const { return nodes_; }
  [[nodiscard]] double reach() const { return snap_; }
  /// Frees the nodes of the points, which are not needed any more.
  void forget_points() { node_of_ = std::vector<std::uint32_t>(); }

 private:
  void set_within(const LineWork& work, const DrawnLine& line) {
    const auto points = work.points_of(line);
    const bool ring = closed(points);
    for (std::size_t k = ring ? 0 : 1; k + 1 < points.size(); ++k)
      node_of_[line.first + k] = nodes_.find_or_add(points[k], kSame);
    if (ring) node_of_[line.first + points.size() - 1] = node_of_[line.first];
  }

  static std::array<std::size_t, 2> ends_of(const DrawnLine& line) {
    return {line.first, line.first + line.count - 1};
  }

  using LineEnd = std::pair<const DrawnLine*, std::size_t>;
  static std::vector<LineEnd> ends_by_place(const LineWork& work) {
    constexpr double kDigit = 1e-5;  // formats round to a millionth
    const auto place = [&](const LineEnd& end) {
      const PagePoint& p = work.points[end.second];
      return std::pair{std::round(p.y / kDigit), std::round(p.x / kDigit)};
    };
    std::vector<LineEnd> out;
    out.reserve(2 * work.lines.size());
    for (const DrawnLine& line : work.lines)
      for (const std::size_t end : ends_of(line)) out.emplace_back(&line, end);
    std::stable_sort(out.begin(), out.end(),
                     [&](const LineEnd& a, const LineEnd& b) { return place(a) < place(b); });
    return out;
  }

  // Snaps an end to the nearest node, but not back along its own line.
  void set_end(const LineWork& work, const DrawnLine& line, std::size_t end) {
    if (node_of_[end] != kNone) return;  // closed
    const auto [first, last] = ends_of(line);
    const PagePoint& p = work.points[end];
    list_just_before(work, end, end == first ? last : first);
    const std::uint32_t found = nodes_.find(p, snap_, [&](std::uint32_t n) {
      return std::find(just_before_.begin(), just_before_.end(), n) == just_before_.end() ||
             distance(nodes_.point(n), p) <= kSame;
    });
    moved_ = moved_ || (found != kNone && distance(nodes_.point(found), p) > kMoved);
    node_of_[end] = found != kNone ? found : nodes_.add(p);
  }

  // Collects the nodes that the line from `end` to `other` passes within twice the snap of its end.
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
  bool moved_{};  // some end by more than rounding
};

DrawnSegments segments_of(const LineWork& work, const Snapping& snapping) {
  DrawnSegments out;
  const std::size_t most = work.points.size() - std::min(work.points.size(), work.lines.size());
  out.edges.reserve(most);
  out.kinds.reserve(most);
  for (const DrawnLine& line : work.lines) {
    const std::size_t first = out.edges.size();
    for (std::uint32_t i = 1; i < line.count; ++i) {
      const std::uint32_t a = snapping.node(line.first + i - 1), b = snapping.node(line.first + i);
      if (a == b) continue;
      out.edges.push_back({a, b});
      out.kinds.push_back({line.operation, true, false});
    }
    if (out.edges.size() == first) continue;
    out.kinds.back().joins_next = false;
    out.kinds.back().loops = out.edges.back().b == out.edges[first].a;
  }
  return out;
}

// What remains of each segment after stronger and longer ones have taken their places. Segments
// that share no part with another stay whole and are not examined.
class OverlapRemover {
 public:
  OverlapRemover(const DrawnSegments& segments, Snapping& snapping)
      : edges_(segments.edges),
        kinds_(segments.kinds),
        snapping_(snapping),
        first_(segments.edges.size(), kWhole) {
    const auto crowded = crowded_edges(edges_, snapping.nodes().points(), kOverlapTolerance);
    for (std::uint32_t s = 0; s < crowded.size(); ++s)
      if (crowded[s] != 0) order_.push_back(s);
  }

  void run() {
    if (order_.empty()) return;
    std::vector<Segment> plain;
    plain.reserve(order_.size());
    for (const std::uint32_t s : order_) plain.push_back(segment_of(s));
    index_.emplace(plain, kOverlapTolerance);
    plain = std::vector<Segment>();
    left_.reserve(order_.size());
    sort_strongest_first();
    for (const std::uint32_t s : order_) take(s);
  }

  [[nodiscard]] std::size_t contradictions() const { return contradictions_; }
  [[nodiscard]] std::size_t cut_folds() const { return cut_folds_; }

  /// The pieces, in drawing order.
  [[nodiscard]] std::vector<Piece> pieces() const {
    std::vector<Piece> pieces;
    pieces.reserve(edges_.size() + left_.size());
    std::int32_t before = -1;      // the piece that ends where segment s begins
    std::int32_t line_first = -1;  // the line's first piece
    bool begins = true;
    for (std::uint32_t s = 0; s < edges_.size(); ++s) {
      std::int32_t first = -1, last = -1;  // pieces at its ends
      const auto add = [&](const NodeEdge& part) {
        const auto id = static_cast<std::int32_t>(pieces.size());
        if (part.a == edges_[s].a) first = id;
        if (part.b == edges_[s].b) last = id;
        pieces.push_back({part.a, part.b, kinds_[s].operation, -1});
      };
      if (first_[s] == kWhole) add(edges_[s]);
      for (std::int32_t l = first_[s]; l >= 0; l = left_[static_cast<std::size_t>(l)].next)
        add(left_[static_cast<std::size_t>(l)].edge);
      if (first >= 0 && before >= 0) pieces[static_cast<std::size_t>(before)].next = first;
      if (begins) line_first = first;
      if (kinds_[s].loops && last >= 0) pieces[static_cast<std::size_t>(last)].next = line_first;
      before = kinds_[s].joins_next ? last : -1;
      begins = !kinds_[s].joins_next;
    }
    return pieces;
  }

 private:
  static constexpr std::int32_t kNothing = -1, kWhole = -2;  ///< in `first_`

  /// A part of a segment between two nodes.
  struct Remainder {
    NodeEdge edge;
    std::int32_t next{-1};  ///< the next part of the same segment
  };

  [[nodiscard]] Segment segment_of(std::uint32_t s) const {
    return {snapping_.nodes().point(edges_[s].a), snapping_.nodes().point(edges_[s].b)};
  }

  void sort_strongest_first() {
    struct Key {
      int strength;
      float mm;
      std::uint32_t segment;
    };
    std::vector<Key> keys;
    keys.reserve(order_.size());
    for (const std::uint32_t s : order_) {
      const Segment segment = segment_of(s);
      keys.push_back(
          {strength(kinds_[s].operation), static_cast<float>(distance(segment.a, segment.b)), s});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& p, const Key& q) {
      if (p.strength != q.strength) return p.strength > q.strength;
      return p.mm != q.mm ? p.mm > q.mm : p.segment < q.segment;
    });
    for (std::size_t i = 0; i < keys.size(); ++i) order_[i] = keys[i].segment;
  }

  void take(std::uint32_t s) {
    first_[s] = kNothing;
    const Segment segment = segment_of(s);
    const double l = distance(segment.a, segment.b);
    index_->covered(segment, s, covered_);
    double t = 0.0;
    last_ = -1;
    for (const auto& part : covered_) {
      if (!gives_way(s, part.by, part.to - part.from)) continue;
      if (part.from > t) keep(s, segment, l, t, part.from);
      t = std::max(t, part.to);
    }
    keep(s, segment, l, t, l);
  }

  bool gives_way(std::uint32_t s, std::uint32_t to, double shared_mm) {
    const Operation mine = kinds_[s].operation;
    const Operation other = kinds_[to].operation;
    if ((mine == Operation::Draw) != (other == Operation::Draw)) return false;
    if (is_fold(mine) && is_fold(other) && mine != other) ++contradictions_;
    if (is_fold(mine) && is_cut(other) && shared_mm > kSeenMm) ++cut_folds_;
    return true;
  }

  void keep(std::uint32_t s, const Segment& segment, double l, double from, double to) {
    const bool whole = from <= 0.0 && to >= l;
    if (to <= from || (!whole && to - from < 2 * kOverlapTolerance)) return;
    const PagePoint p = between(segment.a, segment.b, from / l);
    const PagePoint q = between(segment.a, segment.b, to / l);
    const std::uint32_t a = from <= 0.0 ? edges_[s].a : node_near(p);
    const std::uint32_t b = to >= l ? edges_[s].b : node_near(q);
    if (a == b) return;
    const auto index = static_cast<std::int32_t>(left_.size());
    (last_ < 0 ? first_[s] : left_[static_cast<std::size_t>(last_)].next) = index;
    last_ = index;
    left_.push_back({{a, b}, -1});
    index_->insert({p, q}, s);  // as drawn: the index compares directions
  }

  // If a part ends because a line takes over from there, a node of that line is near.
  std::uint32_t node_near(const PagePoint& p) {
    const double reach = std::min(snapping_.reach(), 2 * kOverlapTolerance);
    return snapping_.nodes().find_or_add(p, reach);
  }

  const std::vector<NodeEdge>& edges_;
  const std::vector<DrawnSegments::Kind>& kinds_;
  Snapping& snapping_;
  std::vector<std::uint32_t> order_;  ///< crowded segments
  std::optional<CollinearIndex> index_;
  std::vector<CollinearIndex::Covered> covered_;
  std::vector<std::int32_t> first_;  ///< per segment: its first part in `left_`
  std::vector<Remainder> left_;
  std::int32_t last_{-1};
  std::size_t contradictions_{}, cut_folds_{};
};

}  // namespace

LineWork with_ends_snapped(const LineWork& work, double snap_mm) {
  const Snapping snapping(work, snap_mm);
  LineWork out = work;
  for (std::size_t i = 0; i < out.points.size(); ++i)
    if (const std::uint32_t node = snapping.node(i); node != kNone)
      out.points[i] = snapping.nodes().point(node);
  return out;
}

LineWork clean(LineWork work, const CleanOptions& options) {
  LineWork out = work.without_lines();
  std::vector<Piece> pieces;
  std::vector<PagePoint> nodes;
  std::size_t contradictions = 0, cut_folds = 0;
  {
    Snapping snapping(work, options.snap_mm);
    const DrawnSegments segments = segments_of(work, snapping);
    work = {};
    snapping.forget_points();
    OverlapRemover remover(segments, snapping);
    remover.run();
    pieces = remover.pieces();
    contradictions = remover.contradictions();
    cut_folds = remover.cut_folds();
    nodes = std::move(snapping.nodes()).take_points();
  }
  join(pieces, nodes, out);
  if (options.one_pass_mm > 0.0) {
    SinglePass single = in_one_pass(out, options.one_pass_mm);
    if (single.cut_folds_mm > kSeenMm) ++cut_folds;
    if (single.doubled_mm > 0.0) {
      single.once.warnings = std::move(out.warnings);
      out = clean(std::move(single.once), {options.snap_mm, 0.0});
    }
  }
  if (contradictions > 0)
    out.warnings.push_back(
        {.code = "mountain_and_valley",
         .message = fmt::format(
             "{} places are both mountain and valley folds; they are made mountain folds",
             contradictions)});
  if (cut_folds > 0)
    out.warnings.push_back(
        {.code = "fold_is_cut",
         .message = cut_folds == 1
                        ? "1 place is both fold and cut; it is cut"
                        : fmt::format("{} places are both fold and cut; they are cut", cut_folds),
         .spoils = true});
  return out;
}

}  // namespace popcut
