// SPDX-License-Identifier: MIT
#include "core/geometry/page_point.hpp"

#include <algorithm>

namespace popcut {

void Box::add(const PagePoint& p) {
  x0 = std::min(x0, p.x);
  y0 = std::min(y0, p.y);
  x1 = std::max(x1, p.x);
  y1 = std::max(y1, p.y);
}

double twice_area(std::span<const PagePoint> ring) {
  double twice = 0.0;
  const PagePoint& o = ring.front();
  for (std::size_t i = 1; i < ring.size(); ++i)
    twice += (ring[i - 1].x - o.x) * (ring[i].y - o.y) - (ring[i].x - o.x) * (ring[i - 1].y - o.y);
  return twice;
}

Box bounds(std::span<const PagePoint> points) {
  Box box;
  for (const PagePoint& p : points) box.add(p);
  return box;
}

double length(std::span<const PagePoint> line) {
  double sum = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += distance(line[i - 1], line[i]);
  return sum;
}

bool closed(std::span<const PagePoint> line) {
  return line.size() > 2 && line.front() == line.back();
}

}  // namespace popcut
