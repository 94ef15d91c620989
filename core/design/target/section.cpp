// SPDX-License-Identifier: MIT
#include "core/design/target/section.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace popcut {
namespace {

/// A stretch [begin, end] of t = x - z on which one segment is the outermost.
struct Stretch {
  double begin{}, end{};
  std::uint32_t segment{};
};

/// A segment as a line over t = x - z, r = x + z.
struct Line {
  double t0{}, r0{}, t1{}, r1{};
  [[nodiscard]] double at(double t) const {
    if (t <= t0) return r0;
    if (t >= t1) return r1;
    const double share = (t - t0) / (t1 - t0);
    return r0 + share * (r1 - r0);
  }
};

/// Upper envelope of segments by divide and conquer: O(k log k).
class Envelope {
 public:
  explicit Envelope(std::vector<Line> lines) : lines_(std::move(lines)) {}

  std::vector<Stretch> run() {
    std::vector<Stretch> now, next;
    std::vector<std::size_t> first{0};
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      if (!(lines_[k].t1 > lines_[k].t0)) continue;  // seen edge on: hidden
      now.push_back({lines_[k].t0, lines_[k].t1, static_cast<std::uint32_t>(k)});
      first.push_back(now.size());
    }
    while (first.size() > 2) {  // merges neighbouring envelopes until one is left
      std::vector<std::size_t> joined{0};
      next.clear();
      for (std::size_t k = 0; k + 1 < first.size(); k += 2) {
        const std::span a(now.data() + first[k], first[k + 1] - first[k]);
        const bool pair = k + 2 < first.size();
        const std::span b(now.data() + first[k + 1], pair ? first[k + 2] - first[k + 1] : 0);
        merge(a, b, next, joined.back());
        joined.push_back(next.size());
      }
      std::swap(now, next);
      std::swap(first, joined);
    }
    return now;
  }

  [[nodiscard]] const Line& line(const Stretch& s) const { return lines_[s.segment]; }

 private:
  static void emit(std::vector<Stretch>& out, std::size_t from, double begin, double end,
                   std::uint32_t segment) {
    if (!(end > begin)) return;
    if (out.size() > from && out.back().segment == segment && out.back().end == begin)
      out.back().end = end;
    else
      out.push_back({begin, end, segment});
  }

  void merge(std::span<const Stretch> a, std::span<const Stretch> b, std::vector<Stretch>& out,
             std::size_t from) const {
    std::size_t i = 0, j = 0;
    double t = -std::numeric_limits<double>::infinity();
    while (i < a.size() || j < b.size()) {
      if (i < a.size() && a[i].end <= t) {
        ++i;
        continue;
      }
      if (j < b.size() && b[j].end <= t) {
        ++j;
        continue;
      }
      const double infinity = std::numeric_limits<double>::infinity();
      const double begin_a = i < a.size() ? std::max(t, a[i].begin) : infinity;
      const double begin_b = j < b.size() ? std::max(t, b[j].begin) : infinity;
      if (begin_a < begin_b) {
        const double end = std::min(a[i].end, begin_b);
        emit(out, from, begin_a, end, a[i].segment);
        t = end;
      } else if (begin_b < begin_a) {
        const double end = std::min(b[j].end, begin_a);
        emit(out, from, begin_b, end, b[j].segment);
        t = end;
      } else {
        t = both(a[i], b[j], begin_a, out, from);
      }
    }
  }

  /// The upper of two stretches from `begin` to where the first of them ends, which it returns.
  double both(const Stretch& a, const Stretch& b, double begin, std::vector<Stretch>& out,
              std::size_t from) const {
    const double end = std::min(a.end, b.end);
    const Line &p = lines_[a.segment], &q = lines_[b.segment];
    const double ahead0 = p.at(begin) - q.at(begin), ahead1 = p.at(end) - q.at(end);
    const bool a_first = ahead0 > 0.0 || (ahead0 == 0.0 && ahead1 >= 0.0);
    const bool crosses = (ahead0 > 0.0 && ahead1 < 0.0) || (ahead0 < 0.0 && ahead1 > 0.0);
    const double middle =
        crosses ? std::clamp(begin + (end - begin) * ahead0 / (ahead0 - ahead1), begin, end) : end;
    emit(out, from, begin, middle, a_first ? a.segment : b.segment);
    emit(out, from, middle, end, a_first ? b.segment : a.segment);
    return end;
  }

  std::vector<Line> lines_;
};

/// Takes out what is seen through a narrow gap: stretches that lie below both their neighbours by
/// more than twice the way from the one neighbour to the other.
void close_gaps(const Envelope& envelope, std::vector<Stretch>& stretches, double least_mm) {
  const auto begin_of = [&](const Stretch& s) { return envelope.line(s).at(s.begin); };
  const auto end_of = [&](const Stretch& s) { return envelope.line(s).at(s.end); };
  std::vector<Stretch> kept;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    kept.push_back(stretches[k]);
    const double level = end_of(stretches[k]), from = stretches[k].end;
    double top = -std::numeric_limits<double>::infinity();  // of what lies in the gap
    for (std::size_t next = k + 1; next < stretches.size(); ++next) {
      const Stretch& s = stretches[next];
      const double deep_enough = std::max(least_mm, 2.0 * (s.begin - from));
      if (level - top > deep_enough && begin_of(s) - top > deep_enough && next > k + 1) {
        k = next - 1;
        break;
      }
      top = std::max({top, begin_of(s), end_of(s)});
      if (level - top <= std::max(least_mm, 2.0 * (s.end - from))) break;
    }
  }
  stretches = std::move(kept);
}

SectionPoint point_of(double t, double r) {
  return {std::max(0.0, 0.5 * (r + t)), std::max(0.0, 0.5 * (r - t))};
}

std::optional<SectionPoint> visible_end(const Section& section, const Envelope& envelope,
                                        const std::vector<Stretch>& stretches, double near_mm) {
  for (const SectionPoint& p : section.open_ends) {
    const double t = p.x - p.z, r = p.x + p.z;
    auto it = std::partition_point(stretches.begin(), stretches.end(),
                                   [&](const Stretch& s) { return s.end < t - near_mm; });
    bool hidden = false;  // by anything clearly in front of it
    for (; it != stretches.end() && it->begin <= t + near_mm; ++it)
      hidden = hidden || envelope.line(*it).at(t) > r + near_mm;
    if (!hidden) return p;
  }
  return std::nullopt;
}

}  // namespace

void add_clipped(Section& section, SectionPoint a, SectionPoint b, double touch_mm) {
  if ((a.x <= touch_mm && b.x <= touch_mm) || (a.z <= touch_mm && b.z <= touch_mm)) return;
  const auto cut = [](SectionPoint p, SectionPoint q, bool wall) {
    const double from = wall ? p.x : p.z, to = wall ? q.x : q.z;
    if (!(from < 0.0)) return p;
    const double share = from / (from - to);
    return wall ? SectionPoint{0.0, p.z + share * (q.z - p.z)}
                : SectionPoint{p.x + share * (q.x - p.x), 0.0};
  };
  for (const bool wall : {true, false}) {
    if ((wall ? a.x : a.z) < 0.0 && (wall ? b.x : b.z) < 0.0) return;
    const SectionPoint kept = cut(a, b, wall);
    b = cut(b, a, wall);
    a = kept;
  }
  if (a.x < 0.0 || a.z < 0.0 || b.x < 0.0 || b.z < 0.0) return;  // beside the corner's edge
  section.segments.push_back({a, b});
}

Outline seen_from_outside(const Section& section, int samples) {
  Outline out;
  std::vector<Line> lines;
  lines.reserve(section.segments.size());
  double most_x = 0.0, most_z = 0.0;
  for (const SectionSegment& s : section.segments) {
    const double ta = s.a.x - s.a.z, tb = s.b.x - s.b.z;
    const double ra = s.a.x + s.a.z, rb = s.b.x + s.b.z;
    lines.push_back(ta <= tb ? Line{ta, ra, tb, rb} : Line{tb, rb, ta, ra});
    out.length_mm += std::hypot(s.b.x - s.a.x, s.b.z - s.a.z);
    most_x = std::max({most_x, s.a.x, s.b.x});
    most_z = std::max({most_z, s.a.z, s.b.z});
  }
  out.size_mm = most_x + most_z;
  Envelope envelope(std::move(lines));
  std::vector<Stretch> stretches = envelope.run();
  if (stretches.empty()) return out;
  out.hole = visible_end(section, envelope, stretches, 1e-6 * out.size_mm);
  close_gaps(envelope, stretches, 0.02 * out.size_mm);
  const double spacing = (stretches.back().end - stretches.front().begin) / samples;
  for (const Stretch& s : stretches) {
    const Line& line = envelope.line(s);
    const double r0 = line.at(s.begin), r1 = line.at(s.end);
    const double length = std::hypot(s.end - s.begin, r1 - r0) / std::sqrt(2.0);
    out.visible_mm += length;
    if (!out.points.empty()) {
      const SectionPoint begin = point_of(s.begin, r0), last = out.points.back().p;
      const double gap = std::hypot(begin.x - last.x, begin.z - last.z);
      if (gap > out.gap_mm) out.gap_mm = gap, out.gap_at = last;
    }
    const double rise = std::max(s.end - s.begin, std::abs(r1 - r0));
    const int pieces = static_cast<int>(std::clamp(std::ceil(rise / spacing), 1.0, 4.0 * samples));
    for (int k = 0; k <= pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      const double weight = length / pieces * (k == 0 || k == pieces ? 0.5 : 1.0);
      const SectionPoint p = point_of(s.begin + share * (s.end - s.begin), r0 + share * (r1 - r0));
      if (!out.points.empty() && out.points.back().p.x == p.x && out.points.back().p.z == p.z)
        out.points.back().weight_mm += weight;
      else
        out.points.push_back({p, weight});
    }
  }
  out.visible_mm = std::min(out.visible_mm, out.length_mm);
  return out;
}

}  // namespace popcut
