// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <vector>

#include "core/plan/order/order.hpp"

namespace popcut::testing {

/// Even-odd rule, slow and independent of the planner.
inline bool lies_inside(std::span<const PagePoint> loop, const PagePoint& p) {
  int crossings = 0;
  for (std::size_t i = 0; i + 1 < loop.size(); ++i) {
    const PagePoint low = loop[i].y < loop[i + 1].y ? loop[i] : loop[i + 1];
    const PagePoint high = loop[i].y < loop[i + 1].y ? loop[i + 1] : loop[i];
    if (p.y < low.y || p.y >= high.y) continue;
    const double side = (high.x - low.x) * (p.y - low.y) - (high.y - low.y) * (p.x - low.x);
    if (side < 0) ++crossings;
  }
  return crossings % 2 == 1;
}

/// Lines all of whose points lie inside of a closed line of the same operation, cut or outline,
/// that comes before them.
inline std::size_t outer_before_inner_by_hand(const LineWork& work,
                                              const std::vector<Visit>& visits) {
  struct Done {
    std::uint32_t line;
    Box box;
  };
  std::vector<Done> loops;
  std::size_t count = 0;
  for (const Visit& visit : visits) {
    const DrawnLine& line = work.lines[visit.line];
    if (!is_cut(line.operation)) continue;
    const auto points = work.points_of(line);
    Box box;
    for (const PagePoint& p : points) box.add(p);
    for (const Done& done : loops) {
      if (work.lines[done.line].operation != line.operation) continue;
      if (box.x0 <= done.box.x0 || box.x1 >= done.box.x1 || box.y0 <= done.box.y0 ||
          box.y1 >= done.box.y1)
        continue;
      const auto loop = work.points_of(work.lines[done.line]);
      if (std::all_of(points.begin(), points.end(),
                      [&](const PagePoint& p) { return lies_inside(loop, p); })) {
        ++count;
        break;
      }
    }
    if (closed(points)) loops.push_back({visit.line, box});
  }
  return count;
}

}  // namespace popcut::testing
