// SPDX-License-Identifier: MIT
#include "core/design/facets/contour.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/geometry/page_point.hpp"
#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

/// A place on the sheet, rounded so that places that differ by rounding only
/// are one.
using Spot = std::pair<std::int64_t, std::int64_t>;
Spot spot(double across_mm, double v_mm) {
  constexpr double kPerMm = 1e7;
  return {std::llround(across_mm * kPerMm), std::llround(v_mm * kPerMm)};
}

constexpr double kTouch_mm = 1e-6;

/// Corners that became one are one vertex, and edges between them are gone.
///
/// @param place  the vertex that each one became
void merge_vertices(Pattern& p, const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> number(p.vertices.size());
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < number.size(); ++k)
    if (place[k] == k) number[k] = kept, p.vertices[kept++] = p.vertices[k];
  p.vertices.resize(kept);
  const auto now = [&](std::uint32_t vertex) { return number[place[vertex]]; };
  for (PatternEdge& e : p.edges) e.from = now(e.from), e.to = now(e.to);
  std::erase_if(p.edges, [](const PatternEdge& e) { return e.from == e.to; });
  std::vector<std::uint32_t> first{0}, corners;
  for (std::size_t f = 0; f < p.faces(); ++f) {
    const std::size_t begin = corners.size();
    for (const std::uint32_t vertex : p.face(f))
      if (corners.size() == begin || corners.back() != now(vertex)) corners.push_back(now(vertex));
    if (corners.size() > begin + 1 && corners.back() == corners[begin]) corners.pop_back();
    first.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  p.face_first = std::move(first);
  p.face_vertices = std::move(corners);
}

/// Cuts as the edges are: those along and across the strips joined to
/// stretches, others once.
void draw_cuts(Pattern& p) {
  std::erase_if(p.lines, [](const SheetLine& line) { return line.role == EdgeRole::Slit; });
  std::map<std::pair<bool, std::int64_t>, std::vector<std::pair<double, double>>> straight;
  std::map<std::pair<Spot, Spot>, SheetLine> slanted;
  for (const PatternEdge& e : p.edges) {
    if (e.role != EdgeRole::Slit) continue;
    const PatternVertex &a = p.vertices[e.from], &b = p.vertices[e.to];
    const double ua = p.u(a), ub = p.u(b);
    const Spot from = spot(ua, a.v), to = spot(ub, b.v);
    if (from.second == to.second)
      straight[{true, from.second}].emplace_back(std::min(ua, ub), std::max(ua, ub));
    else if (from.first == to.first)
      straight[{false, from.first}].emplace_back(std::min(a.v, b.v), std::max(a.v, b.v));
    else
      slanted[std::minmax(from, to)] = {ua, a.v, ub, b.v, EdgeRole::Slit};
  }
  for (auto& [line, stretches] : straight) {
    std::sort(stretches.begin(), stretches.end());
    const double at = static_cast<double>(line.second) / 1e7;
    for (std::size_t k = 0; k < stretches.size();) {
      const double begin = stretches[k].first;
      double end = stretches[k].second;
      for (; k < stretches.size() && stretches[k].first <= end + kSamePlace_mm; ++k)
        end = std::max(end, stretches[k].second);
      if (line.first)
        p.lines.push_back({begin, at, end, at, EdgeRole::Slit});
      else
        p.lines.push_back({at, begin, at, end, EdgeRole::Slit});
    }
  }
  for (const auto& [ends, line] : slanted) p.lines.push_back(line);
}

/// A cut from one plane to another in two strips beside each other, at
/// different columns.
struct Step {
  Label before{}, after{};
  int left{}, right{};  ///< columns of the cut in the two strips
};

class ContourFollower {
 public:
  ContourFollower(LabelPattern& pattern, const LabelImage& labels, const FacetPlanes& planes,
                  const SeenTarget& target, double min_panel_mm)
      : pattern_(pattern.built.pattern),
        strips_(pattern.strips),
        labels_(labels),
        planes_(planes),
        target_(target),
        min_panel_mm_(min_panel_mm) {}

  std::size_t run() {
    for (int s = 0; s < grid().strips; ++s)
      runs_.push_back(runs_of(labels_.strip(s), planes_, grid()));
    place_.resize(pattern_.vertices.size());
    for (std::uint32_t k = 0; k < place_.size(); ++k) {
      place_[k] = k;
      const PatternVertex& p = pattern_.vertices[k];
      at_[spot(p.x - p.z, p.v)].push_back(k);
    }
    std::size_t moved = 0;
    for (int s = 0; s + 1 < labels_.grid.strips; ++s) moved += follow(s) ? taken_ : 0;
    if (moved == 0) return 0;
    merge_vertices(pattern_, place_);
    draw_cuts(pattern_);
    return moved;
  }

 private:
  [[nodiscard]] const FacetGrid& grid() const { return labels_.grid; }
  [[nodiscard]] double mm(int column) const { return grid().across(column) * grid().step_mm; }

  /// The cuts between strips s and s + 1 that go from plane to plane in both.
  [[nodiscard]] std::vector<Step> steps(int s) const {
    const std::vector<LabelRun>&a = runs_[static_cast<std::size_t>(s)],
          &b = runs_[static_cast<std::size_t>(s) + 1];
    std::vector<Step> out;
    for (std::size_t i = 1; i < a.size(); ++i)
      for (std::size_t j = 1; j < b.size(); ++j) {
        const int first = std::min(a[i].begin, b[j].begin), last = std::max(a[i].begin, b[j].begin);
        if (a[i].label == kNoLabel || a[i - 1].label == kNoLabel || a[i].folds_on ||
            b[j].folds_on || first == last || a[i].label != b[j].label ||
            a[i - 1].label != b[j - 1].label)
          continue;
        // Both planes go on across the line, on their own sides of the cut.
        const int least = least_run(last - first);
        if (std::max(a[i - 1].begin, b[j - 1].begin) > first - least ||
            std::min(a[i].end, b[j].end) < last + least)
          continue;
        const Step step{a[i - 1].label, a[i].label, a[i].begin, b[j].begin};
        if (has_room(s, -1, step, step.left, last - first) &&
            has_room(s + 1, 1, step, step.right, last - first))
          out.push_back(step);
      }
    return out;
  }

  /// What a panel must be long beside a cut with a step of `reach` columns: measured across the cut
  /// it is narrower than along the strip. Where the cut has such a step at both sides of a strip,
  /// it slants by up to twice as much.
  [[nodiscard]] int least_run(int reach) const {
    const double slope = 2 * reach * grid().step_mm / grid().strip_mm;
    return static_cast<int>(
        std::ceil(min_panel_mm_ * std::hypot(1.0, slope) / grid().step_mm - 1e-9));
  }

  /// The run of a strip that begins at a column, or none: as many as there are.
  [[nodiscard]] std::size_t run_at(int s, int column) const {
    const std::vector<LabelRun>& runs = runs_[static_cast<std::size_t>(s)];
    std::size_t r = 1;
    while (r < runs.size() && runs[r].begin != column) ++r;
    return r;
  }
  /// Whether a window ends the run: on the line where that begins, a slit opens it as far as here.
  [[nodiscard]] bool ends_at_window(int s, int column) const {
    const std::vector<LabelRun>& runs = runs_[static_cast<std::size_t>(s)];
    const std::size_t r = run_at(s, column);
    return r + 1 < runs.size() && runs[r + 1].label == kNoLabel;
  }

  /// Where the cut goes straight on through more strips, it will slant through
  /// all of them: whether both planes are wide enough there.
  [[nodiscard]] bool has_room(int s, int way, const Step& step, int column, int reach) const {
    for (int k = s + way; k >= 0 && k < grid().strips; k += way) {
      const std::vector<LabelRun>& runs = runs_[static_cast<std::size_t>(k)];
      const std::size_t r = run_at(k, column);
      if (r == runs.size() || runs[r].folds_on) return true;
      const bool same_before = runs[r - 1].label == step.before,
                 same_after = runs[r].label == step.after;
      if (!same_before && !same_after) return true;
      if (same_before != same_after) return false;  // one side goes on straight, the other does not
      if (ends_at_window(k, column) != ends_at_window(k - way, column)) return false;
      const int room = std::min(runs[r - 1].end - runs[r - 1].begin, runs[r].end - runs[r].begin);
      if (room < reach + least_run(reach)) return false;
    }
    return true;
  }

  /// Where a row of the picture goes over from one plane to the other between
  /// two places: the split with the least distance.
  [[nodiscard]] double split_of(std::size_t row, const Step& step, double first_mm,
                                double last_mm) const {
    const SheetRaster& raster = target_.raster;
    const auto column = [&](double across_mm) -> std::int64_t {
      const std::int64_t at = std::llround((across_mm - raster.from_mm) / raster.column_mm);
      return std::clamp<std::int64_t>(at, 0, static_cast<std::int64_t>(raster.columns));
    };
    const std::int64_t begin = column(first_mm), end = column(last_mm);
    const auto off = [&](Label label, std::int64_t c) {
      const FacetPlane& p = planes_[label];
      const auto at = static_cast<std::size_t>(c);
      return std::abs(p.offset * grid().step_mm -
                      (p.upright ? target_.x_mm(row, at) : target_.z_mm(row, at)));
    };
    double cost = 0.0, least = 0.0;
    std::int64_t best = begin;
    for (std::int64_t c = begin; c < end; ++c) {
      cost += off(step.before, c) - off(step.after, c);
      if (cost < least) least = cost, best = c + 1;
    }
    return raster.from_mm + static_cast<double>(best) * raster.column_mm;
  }

  /// The vertices of both planes at a corner of the cut, if there are just
  /// these two.
  [[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> sides_at(const Step& step,
                                                                                double across_mm,
                                                                                double v_mm) const {
    const auto found = at_.find(spot(across_mm, v_mm));
    if (found == at_.end() || found->second.size() != 2) return std::nullopt;
    std::optional<std::uint32_t> before, after;
    for (const std::uint32_t k : found->second) {
      if (lies_in(pattern_.vertices[k], step.before)) before = k;
      if (lies_in(pattern_.vertices[k], step.after)) after = k;
    }
    if (!before || !after || *before == *after) return std::nullopt;
    return std::pair{*before, *after};
  }
  [[nodiscard]] bool lies_in(const PatternVertex& p, Label label) const {
    const FacetPlane& plane = planes_[label];
    return std::abs((plane.upright ? p.x : p.z) - plane.offset * grid().step_mm) <= kSamePlace_mm;
  }
  void move(std::uint32_t vertex, Label label, double across_mm) {
    const FacetPlane& plane = planes_[label];
    const double offset = plane.offset * grid().step_mm;
    PatternVertex& p = pattern_.vertices[vertex];
    p.x = plane.upright ? offset : offset + across_mm;
    p.z = plane.upright ? offset - across_mm : offset;
  }

  /// All steps on the line after strip s.
  bool follow(int s) {
    taken_ = 0;
    if (strips_.strip_of[static_cast<std::size_t>(s)] ==
        strips_.strip_of[static_cast<std::size_t>(s) + 1])
      return false;
    const double v = strips_.strips.v_begin[strips_.strip_of[static_cast<std::size_t>(s) + 1]];
    const std::size_t along = target_.raster.rows / static_cast<std::size_t>(grid().strips);
    const std::size_t row = (static_cast<std::size_t>(s) + 1) * along;  // the first after the line
    for (const Step& step : steps(s)) {
      const double first = mm(std::min(step.left, step.right)),
                   last = mm(std::max(step.left, step.right));
      if (last - first > kSteepest * grid().strip_mm) continue;
      const double a = split_of(row - 1, step, first, last), b = split_of(row, step, first, last);
      if (std::abs(a - b) > kOneContour * (last - first)) continue;  // it does go along the line
      const auto left = sides_at(step, mm(step.left), v), right = sides_at(step, mm(step.right), v);
      if (!left || !right) continue;
      const double across = std::clamp(0.5 * (a + b), first, last);
      move(left->first, step.before, across);
      move(left->second, step.after, across);
      place_[right->first] = left->first;
      place_[right->second] = left->second;
      at_.erase(spot(mm(step.left), v));
      at_.erase(spot(mm(step.right), v));
      taken_ += 2;
    }
    return taken_ > 0;
  }

  static constexpr double kSteepest = 2.0;    ///< of a strip's width: what is steeper is a side
  static constexpr double kOneContour = 0.7;  ///< of a step: more is two contours

  Pattern& pattern_;
  const LabelStrips& strips_;
  const LabelImage& labels_;
  const FacetPlanes& planes_;
  const SeenTarget& target_;
  double min_panel_mm_;
  StripRuns runs_;  ///< without the card's
  std::map<Spot, std::vector<std::uint32_t>> at_;
  std::vector<std::uint32_t> place_;  ///< the vertex that each one became
  std::size_t taken_{};
};

/// Cuts as chains of places on the sheet: between two places where something else happens than that
/// one cut goes on.
class ContourSmoother {
 public:
  explicit ContourSmoother(Pattern& pattern) : pattern_(pattern) {
    for (std::uint32_t k = 0; k < pattern_.vertices.size(); ++k) {
      const PatternVertex& p = pattern_.vertices[k];
      Place& place = places_[spot(p.x - p.z, p.v)];
      place.at = {p.x - p.z, p.v};
      place.vertices.push_back(k);
    }
    faces_.resize(pattern_.vertices.size());
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      const auto corners = pattern_.face(f);
      const double x = pattern_.vertices[corners[0]].x;
      upright_.push_back(std::all_of(corners.begin(), corners.end(),
                                     [&](std::uint32_t k) {
                                       return std::abs(pattern_.vertices[k].x - x) <= kTouch_mm;
                                     })
                             ? 1
                             : 0);
      for (const std::uint32_t k : corners) faces_[k].push_back(static_cast<std::uint32_t>(f));
    }
    for (const PatternEdge& e : pattern_.edges) {
      const Spot a = spot_of(e.from), b = spot_of(e.to);
      for (const auto& [here, there] : {std::pair{a, b}, std::pair{b, a}}) {
        Place& place = places_.at(here);
        place.is_free &= e.role == EdgeRole::Slit;
        if (std::find(place.next.begin(), place.next.end(), there) == place.next.end())
          place.next.push_back(there);
      }
    }
    for (auto& [at, place] : places_)
      place.is_free &= place.next.size() == 2 &&
                       std::all_of(place.vertices.begin(), place.vertices.end(),
                                   [&](std::uint32_t k) { return faces_[k].size() == 1; });
  }

  std::size_t run() {
    const Pattern before = pattern_;
    place_.resize(pattern_.vertices.size());
    for (std::uint32_t k = 0; k < place_.size(); ++k) place_[k] = k;
    for (const auto& [at, place] : places_) {
      if (place.is_free) continue;
      for (const Spot& next : place.next)
        if (places_.at(next).is_free && seen_.count(next) == 0) smooth(chain_from(at, next));
    }
    if (moved_ == 0) return 0;
    merge_vertices(pattern_, place_);
    draw_cuts(pattern_);
    if (any_cross()) {
      pattern_ = before;
      return 0;
    }
    return moved_;
  }

 private:
  struct Place {
    PagePoint at{};
    std::vector<std::uint32_t> vertices;
    std::vector<Spot> next;
    bool is_free{true};
  };

  [[nodiscard]] Spot spot_of(std::uint32_t vertex) const {
    const PatternVertex& p = pattern_.vertices[vertex];
    return spot(p.x - p.z, p.v);
  }

  /// All places of a chain, with its fixed ends.
  std::vector<Spot> chain_from(const Spot& end, const Spot& first) {
    std::vector<Spot> out{end, first};
    while (places_.at(out.back()).is_free) {
      const Place& here = places_.at(out.back());
      seen_.insert(out.back());
      out.push_back(here.next[0] == out[out.size() - 2] ? here.next[1] : here.next[0]);
    }
    return out;
  }

  /// Moves the inner places towards their neighbours, and leaves out those that then lie in line.
  void smooth(const std::vector<Spot>& chain) {
    if (chain.front() == chain.back()) return;
    std::vector<PagePoint> first, now;
    for (const Spot& at : chain) first.push_back(places_.at(at).at);
    now = first;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<PagePoint> then = now;
      for (std::size_t k = 1; k + 1 < now.size(); ++k) {
        const PagePoint a = towards(now[k], now[k - 1]), b = towards(now[k], now[k + 1]);
        then[k] = {now[k].x + a.x + b.x, now[k].y + a.y + b.y};
        const double dx = then[k].x - first[k].x, dy = then[k].y - first[k].y;
        const double far = std::hypot(dx, dy);
        if (far > kFarthest_mm)
          then[k] = {first[k].x + dx * kFarthest_mm / far, first[k].y + dy * kFarthest_mm / far};
      }
      now = std::move(then);
    }
    std::vector<std::uint8_t> kept(chain.size(), 0);
    keep(now, 0, now.size() - 1, kept);
    std::size_t last = 0;
    for (std::size_t k = 1; k + 1 < chain.size(); ++k) {
      const Place& place = places_.at(chain[k]);
      for (const std::uint32_t vertex : place.vertices) move(vertex, now[k]);
      ++moved_;
      if (kept[k] != 0) {
        last = k;
        continue;
      }
      for (const std::uint32_t vertex : place.vertices)
        for (const std::uint32_t other : places_.at(chain[last]).vertices)
          if (std::find(faces_[other].begin(), faces_[other].end(), faces_[vertex].front()) !=
              faces_[other].end())
            place_[vertex] = other;
    }
  }

  /// A quarter of the way to a neighbour, which counts as no farther than `kNear_mm`.
  [[nodiscard]] static PagePoint towards(const PagePoint& from, const PagePoint& to) {
    const double dx = to.x - from.x, dy = to.y - from.y;
    const double far = std::hypot(dx, dy);
    const double share = far > kNear_mm ? 0.25 * kNear_mm / far : 0.25;
    return {share * dx, share * dy};
  }

  /// Which places of a line stay so that it strays no farther than `kStray_mm` (Douglas and Peucker
  /// 1973).
  static void keep(const std::vector<PagePoint>& line, std::size_t from, std::size_t to,
                   std::vector<std::uint8_t>& kept) {
    std::vector<std::pair<std::size_t, std::size_t>> open{{from, to}};
    kept[from] = kept[to] = 1;
    while (!open.empty()) {
      const auto [a, b] = open.back();
      open.pop_back();
      double most = kStray_mm;
      std::size_t far = a;
      const double dx = line[b].x - line[a].x, dy = line[b].y - line[a].y;
      const double length2 = dx * dx + dy * dy;
      for (std::size_t k = a + 1; k < b; ++k) {
        const double px = line[k].x - line[a].x, py = line[k].y - line[a].y;
        const double t = length2 > 0.0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
        const double off = std::hypot(px - t * dx, py - t * dy);
        if (off > most) most = off, far = k;
      }
      if (far == a) continue;
      kept[far] = 1;
      open.emplace_back(a, far), open.emplace_back(far, b);
    }
  }

  /// A vertex goes to another place of the sheet, in the plane of its face.
  void move(std::uint32_t vertex, const PagePoint& to) {
    PatternVertex& p = pattern_.vertices[vertex];
    (upright_[faces_[vertex].front()] ? p.z : p.x) +=
        upright_[faces_[vertex].front()] ? p.x - p.z - to.x : to.x - (p.x - p.z);
    p.v = to.y;
  }

  /// Whether lines cross that did not, or a face has lost its area.
  [[nodiscard]] bool any_cross() const {
    std::map<std::pair<Spot, Spot>, int> sides;
    for (const PatternEdge& e : pattern_.edges)
      if (++sides[std::minmax(spot_of(e.from), spot_of(e.to))] > 2) return true;
    std::vector<Segment> lines;
    for (const SheetLine& line : pattern_.lines)
      lines.push_back({{line.u0, line.v0}, {line.u1, line.v1}});
    SegmentGrid grid(lines, kTouch_mm);
    std::vector<std::uint32_t> near;
    const auto side = [](const Segment& s, const PagePoint& p) {
      const double turn = (s.b.x - s.a.x) * (p.y - s.a.y) - (s.b.y - s.a.y) * (p.x - s.a.x);
      const double length = std::hypot(s.b.x - s.a.x, s.b.y - s.a.y);
      return std::abs(turn) <= kTouch_mm * length ? 0 : turn > 0.0 ? 1 : -1;
    };
    for (const Segment& line : lines) {
      near.clear();
      grid.near(line, near);
      for (const std::uint32_t k : near)
        if (side(line, lines[k].a) * side(line, lines[k].b) < 0 &&
            side(lines[k], line.a) * side(lines[k], line.b) < 0)
          return true;
    }
    return false;
  }

  static constexpr int kRounds = 3;
  static constexpr double kNear_mm = 1.0, kFarthest_mm = 0.6, kStray_mm = 0.2;

  Pattern& pattern_;
  std::map<Spot, Place> places_;
  std::set<Spot> seen_;
  std::vector<std::vector<std::uint32_t>> faces_;  ///< of each vertex
  std::vector<std::uint8_t> upright_;              ///< one a face
  std::vector<std::uint32_t> place_;               ///< the vertex that each one became
  std::size_t moved_{};
};

}  // namespace

std::size_t follow_contours(LabelPattern& pattern, const LabelImage& labels,
                            const FacetPlanes& planes, const SeenTarget& target,
                            double min_panel_mm) {
  return ContourFollower(pattern, labels, planes, target, min_panel_mm).run();
}

std::size_t smooth_contours(Pattern& pattern) { return ContourSmoother(pattern).run(); }

}  // namespace popcut
