// SPDX-License-Identifier: MIT
#include "core/drawing/clip_line.hpp"

#include <algorithm>

namespace popcut {
namespace {

// The part of a..b within the area, as parameters t0, t1 in 0..1 (Liang and Barsky 1984).
bool clip_segment(const PagePoint& a, const PagePoint& b, const Box& area, double& t0, double& t1) {
  t0 = 0.0;
  t1 = 1.0;
  const auto side = [&](double p, double q) {  // p t <= q
    if (p == 0.0) return q >= 0.0;
    const double r = q / p;
    if (p < 0.0) t0 = std::max(t0, r);
    if (p > 0.0) t1 = std::min(t1, r);
    return t0 <= t1;
  };
  return side(a.x - b.x, a.x - area.x0) && side(b.x - a.x, area.x1 - a.x) &&
         side(a.y - b.y, a.y - area.y0) && side(b.y - a.y, area.y1 - a.y);
}

PagePoint between(const PagePoint& a, const PagePoint& b, double t) {
  if (t <= 0.0) return a;
  if (t >= 1.0) return b;
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

}  // namespace

void clip_line(std::span<const PagePoint> line, Operation operation, const Box& area,
               std::vector<PagePoint>& run, LineWork& out) {
  const std::size_t first_line = out.lines.size();
  run.clear();
  for (std::size_t i = 1; i < line.size(); ++i) {
    double t0 = 0.0, t1 = 0.0;
    const bool some = clip_segment(line[i - 1], line[i], area, t0, t1) && t1 > t0;
    if (!some || t0 > 0.0) {
      out.append(operation, run);
      run.clear();
    }
    if (!some) continue;
    if (run.empty()) run.push_back(between(line[i - 1], line[i], t0));
    run.push_back(between(line[i - 1], line[i], t1));
    if (t1 < 1.0) {
      out.append(operation, run);
      run.clear();
    }
  }
  // A closed line that was cut open continues through its seam.
  const bool through_seam = closed(line) && run.size() > 1 && out.lines.size() > first_line &&
                            out.points[out.lines[first_line].first] == run.back();
  if (through_seam) {
    const auto head = out.points_of(out.lines[first_line]);
    run.insert(run.end(), head.begin() + 1, head.end());
    out.lines.erase(out.lines.begin() + static_cast<std::ptrdiff_t>(first_line));
  }
  out.append(operation, run);
  run.clear();
}

}  // namespace popcut
