// SPDX-License-Identifier: MIT
// Part of core/plan/knife/blade.hpp.
#include <algorithm>

#include "core/plan/knife/blade.hpp"

namespace popcut {

double overcut_for(double round_mm, double wanted_mm) {
  return std::max(0.0, std::min(wanted_mm, round_mm / 4));
}

bool takes_overcut(Operation operation, std::span<const PagePoint> points) {
  return is_cut(operation) && points.size() > 3 && closed(points);
}

void append_head(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out) {
  if (points.empty()) return;
  out.push_back(points[0]);
  for (std::size_t i = 1; i < points.size() && mm > 0.0; ++i) {
    const double l = distance(points[i - 1], points[i]);
    out.push_back(l > mm ? lerp(points[i - 1], points[i], mm / l) : points[i]);
    mm -= l;
  }
}

void append_tail(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out) {
  if (points.empty()) return;
  const std::size_t first = out.size();
  out.push_back(points.back());
  for (std::size_t i = points.size() - 1; i > 0 && mm > 0.0; --i) {
    const double l = distance(points[i - 1], points[i]);
    out.push_back(l > mm ? lerp(points[i], points[i - 1], mm / l) : points[i - 1]);
    mm -= l;
  }
  std::reverse(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
}

void append_with_overcut(std::span<const PagePoint> points, double overcut_mm,
                         std::vector<PagePoint>& out) {
  append_tail(points, overcut_mm, out);
  out.pop_back();  // the tail repeats the seam
  out.insert(out.end(), points.begin(), points.end() - 1);
  append_head(points, overcut_mm, out);
}

double round_mm(std::span<const PagePoint> points, int passes) {
  return length(points) / std::max(1, passes);
}

}  // namespace popcut
