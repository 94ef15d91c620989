// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "tests/support/paths.hpp"

namespace popcut::testing {

/// A line of a drawing from a list of points.
inline void draw(LineWork& work, Operation operation, const std::vector<PagePoint>& points) {
  work.append(operation, points);
}

/// Length of all lines of one operation.
inline double total_mm(const LineWork& work, Operation operation) {
  double sum = 0.0;
  for (const DrawnLine& line : work.lines)
    if (line.operation == operation) sum += length(work.points_of(line));
  return sum;
}

inline std::size_t count(const LineWork& work, Operation operation) {
  std::size_t n = 0;
  for (const DrawnLine& line : work.lines) n += line.operation == operation ? 1 : 0;
  return n;
}

/// Distance of `p` from the segment a-b.
inline double distance_to(const PagePoint& p, const PagePoint& a, const PagePoint& b) {
  const double l2 = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
  double t = l2 > 0.0 ? ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / l2 : 0.0;
  t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
  return std::hypot(a.x + t * (b.x - a.x) - p.x, a.y + t * (b.y - a.y) - p.y);
}

/// Twice the signed area that a line encloses; its sign is its handedness.
inline double turning(std::span<const PagePoint> line) {
  double sum = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i)
    sum += line[i - 1].x * line[i].y - line[i].x * line[i - 1].y;
  return sum;
}

/// A shared sample file; empty if it does not exist.
inline std::string sample(const std::string& name) {
  std::ifstream file(popcut::testing::source_file("../shared/data/") + name, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace popcut::testing
