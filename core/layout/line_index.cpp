// SPDX-License-Identifier: MIT
#include "core/layout/line_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace popcut {
namespace {

// How far beside a seam to look for slivers, mm: wider than any min_panel_mm.
constexpr double kBeside = 1.0;

double low(const Segment& s, bool x) { return x ? std::min(s.a.x, s.b.x) : std::min(s.a.y, s.b.y); }
double high(const Segment& s, bool x) {
  return x ? std::max(s.a.x, s.b.x) : std::max(s.a.y, s.b.y);
}

}  // namespace

void merge_stretches(std::vector<SeamStretch>& stretches) {
  std::sort(stretches.begin(), stretches.end(),
            [](const SeamStretch& a, const SeamStretch& b) { return a.from < b.from; });
  std::size_t kept = 0;
  for (const SeamStretch& s : stretches) {
    if (kept > 0 && s.from <= stretches[kept - 1].to + kOn)
      stretches[kept - 1].to = std::max(stretches[kept - 1].to, s.to);
    else
      stretches[kept++] = s;
  }
  stretches.resize(kept);
}

void sort_places(std::vector<double>& at) {
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end(), [](double a, double b) { return b - a <= kOn; }),
           at.end());
}

LineIndex::Slices LineIndex::slices(bool by_x, const std::vector<std::uint32_t>& which,
                                    double reach) const {
  Slices out;
  out.items = IntervalBins(
      (by_x ? box_.x0 : box_.y0) - reach, (by_x ? box_.x1 : box_.y1) + reach,
      std::clamp<std::size_t>(which.size() / 2, 1, 8192), which, [&](std::uint32_t i) {
        return std::pair(low(segments_[i], by_x) - reach, high(segments_[i], by_x) + reach);
      });
  return out;
}

void LineIndex::sort_slices(bool by_x, Slices& slices) const {
  const double extent = by_x ? box_.height() : box_.width();
  const auto low_of = [&](std::uint32_t i) { return low(segments_[i], !by_x); };
  const auto high_of = [&](std::uint32_t i) { return high(segments_[i], !by_x); };
  Buckets<std::uint32_t>& bins = slices.items.bins();
  slices.begin.resize(bins.items().size());
  slices.reach.resize(bins.items().size());
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const std::span<std::uint32_t> of = bins[k];
    const auto rest = std::partition(of.begin(), of.end(), [&](std::uint32_t i) {
      return high_of(i) - low_of(i) > extent / 16;
    });
    std::sort(rest, of.end(),
              [&](std::uint32_t a, std::uint32_t b) { return low_of(a) < low_of(b); });
    auto at = bins.begin_of(k) + static_cast<std::size_t>(rest - of.begin());
    slices.first_short.push_back(static_cast<std::uint32_t>(at));
    double reach = -1e300;
    for (auto i = rest; i != of.end(); ++i, ++at) {
      reach = std::max(reach, high_of(*i));
      slices.begin[at] = low_of(*i);
      slices.reach[at] = reach;
    }
  }
}

// Visits all segments in the slice of the line that may lie over `from`..`to`.
template <typename Visit>
void LineIndex::visit(const AxisLine& line, double from, double to, Visit&& visit) const {
  const Slices& slices = slices_[line.vertical ? 0 : 1];
  const std::size_t k = slices.items.bin(line.at);
  const auto& bins = slices.items.bins();
  const auto items = bins.items();
  const std::size_t first = bins.begin_of(k), rest = slices.first_short[k];
  for (std::size_t i = first; i < rest; ++i) visit(items[i]);
  const auto begin = slices.begin.begin();
  auto i = static_cast<std::size_t>(
      std::upper_bound(begin + slices.first_short[k],
                       begin + static_cast<std::ptrdiff_t>(first + bins[k].size()), to + kOn) -
      begin);
  while (i-- > rest && slices.reach[i] >= from - kOn) visit(items[i]);
}

std::vector<std::uint32_t> LineIndex::read(const LineWork& work) {
  std::vector<std::uint32_t> borders;
  segments_.reserve(work.points.size());
  for (const DrawnLine& line : work.lines) {
    if (line.operation == Operation::Draw) continue;
    const auto points = work.points_of(line);
    const bool border = is_cut(line.operation) && closed(points);
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (points[i - 1] == points[i]) continue;
      if (border) borders.push_back(static_cast<std::uint32_t>(segments_.size()));
      segments_.push_back({points[i - 1], points[i]});
      operations_.push_back(line.operation);
    }
  }
  return borders;
}

LineIndex::LineIndex(const LineWork& work, double reach_mm)
    : borders_(read(work)), grid_(segments_, reach_mm) {
  for (const Segment& s : segments_) {
    box_.add(s.a);
    box_.add(s.b);
  }
  if (segments_.empty()) box_ = {0, 0, 0, 0};
  std::vector<std::uint32_t> all(segments_.size());
  std::iota(all.begin(), all.end(), 0u);
  slices_ = {slices(true, all, kBeside), slices(false, all, kBeside)};
  sort_slices(true, slices_[0]);
  sort_slices(false, slices_[1]);
  border_ = slices(false, borders_, 0.0);
}

void LineIndex::scan(const AxisLine& line, double from, double to, double min_panel_mm,
                     SeamScan& out) const {
  out = {};
  const auto n_of = [&](const PagePoint& p) { return (line.vertical ? p.x : p.y) - line.at; };
  const auto t_of = [&](const PagePoint& p) { return line.vertical ? p.y : p.x; };
  visit(line, from, to, [&](std::uint32_t i) {
    const Segment& s = segments_[i];
    const double na = n_of(s.a), nb = n_of(s.b);
    const double n0 = std::min(na, nb), n1 = std::max(na, nb);
    const double t0 = std::min(t_of(s.a), t_of(s.b)), t1 = std::max(t_of(s.a), t_of(s.b));
    if (t1 < from - kOn || t0 > to + kOn) return;
    const double overlap = std::min(t1, to) - std::max(t0, from);
    if (n1 - n0 <= kOn) {  // parallel to the seam
      if (n0 > min_panel_mm || n1 < -min_panel_mm || overlap <= kOn) return;
      if (std::abs(n0) > kOn)
        out.sliver_mm += overlap;
      else if (is_cut(operations_[i]))
        out.covered.push_back({std::max(t0, from), std::min(t1, to), 0, 0});
      else
        out.fold_mm += overlap;
      return;
    }
    if (n0 > kOn || n1 < -kOn) return;
    const double k = std::clamp(-na / (nb - na), 0.0, 1.0);
    const double t = t_of(s.a) + k * (t_of(s.b) - t_of(s.a));
    if (t <= from + kOn || t >= to - kOn) return;
    out.breaks.push_back(t);
    if (n0 < -kOn && n1 > kOn) ++(is_cut(operations_[i]) ? out.cuts_crossed : out.folds_crossed);
  });
  sort_places(out.breaks);
  merge_stretches(out.covered);
}

double LineIndex::free_depth(const AxisLine& line, double from, double to, int side, double most) {
  const Segment root{line.point(from, 0), line.point(to, 0)};
  grid_.near(root, near_);
  double depth = most;
  for (const std::uint32_t i : near_) {
    const Segment& s = segments_[i];
    const auto n_of = [&](const PagePoint& p) {
      return side * ((line.vertical ? p.x : p.y) - line.at);
    };
    const auto t_of = [&](const PagePoint& p) { return line.vertical ? p.y : p.x; };
    double ta = t_of(s.a), tb = t_of(s.b), na = n_of(s.a), nb = n_of(s.b);
    if (ta > tb) {
      std::swap(ta, tb);
      std::swap(na, nb);
    }
    if (tb <= from + kOn || ta >= to - kOn) {
      if (tb < from - kOn || ta > to + kOn || tb - ta > kOn) continue;
    }
    // The part of the segment that lies over the root.
    const double k0 = tb > ta ? std::clamp((from - ta) / (tb - ta), 0.0, 1.0) : 0.0;
    const double k1 = tb > ta ? std::clamp((to - ta) / (tb - ta), 0.0, 1.0) : 1.0;
    const double m0 = na + k0 * (nb - na), m1 = na + k1 * (nb - na);
    const double n1 = std::max(m0, m1);
    if (n1 <= kOn) continue;  // on the other side of the seam, or on it
    depth = std::min(depth, std::max(0.0, std::min(m0, m1)));
  }
  return depth;
}

bool LineIndex::is_paper(const PagePoint& p) const {
  if (p.x <= box_.x0 || p.x >= box_.x1 || p.y <= box_.y0 || p.y >= box_.y1) return false;
  if (borders_.empty()) return true;
  bool inside = false;
  for (const std::uint32_t i : border_.items.at(p.y)) {
    const Segment& s = segments_[i];
    if ((s.a.y > p.y) == (s.b.y > p.y)) continue;
    const double x = s.a.x + (p.y - s.a.y) / (s.b.y - s.a.y) * (s.b.x - s.a.x);
    if (x < p.x) inside = !inside;
  }
  return inside;
}

std::vector<std::uint32_t> LineIndex::between(bool by_x, double from, double to) const {
  const Slices& slices = slices_[by_x ? 0 : 1];
  const std::size_t first = slices.items.bin(from), last = slices.items.bin(to);
  std::vector<std::uint32_t> out;
  for (std::size_t k = first; k <= last; ++k)
    for (const std::uint32_t i : slices.items.bins()[k]) {
      const double begin = low(segments_[i], by_x);
      if (begin > to + kOn || high(segments_[i], by_x) < from - kOn) continue;
      // Where it lies in several slices it counts in the first of them.
      if (k == first || k == slices.items.bin(begin - kBeside)) out.push_back(i);
    }
  return out;
}

}  // namespace popcut
