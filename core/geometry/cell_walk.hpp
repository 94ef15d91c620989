// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// A straight piece of a drawing.
struct Segment {
  PagePoint a;
  PagePoint b;
};

/// Visits the square cells that a corridor about a segment touches, column by column (or row by
/// row) along its longer extent: `visit(x, y)` by their numbers from the page's origin, until it
/// says false. `reach`: how far the corridor goes beyond the segment's ends and to its sides,
/// measured along the axes.
template <typename Visit>
void walk_cells(const Segment& s, double cell, double reach, Visit&& visit) {
  const bool flat = std::abs(s.b.x - s.a.x) >= std::abs(s.b.y - s.a.y);
  double m0 = flat ? s.a.x : s.a.y, n0 = flat ? s.a.y : s.a.x;
  double m1 = flat ? s.b.x : s.b.y, n1 = flat ? s.b.y : s.b.x;
  if (m0 > m1) {
    std::swap(m0, m1);
    std::swap(n0, n1);
  }
  const auto cell_of = [&](double value) {
    return static_cast<std::int64_t>(std::floor(value / cell));
  };
  const double slope = m1 > m0 ? (n1 - n0) / (m1 - m0) : 0.0;
  const std::int64_t last = cell_of(m1 + reach);
  for (std::int64_t c = cell_of(m0 - reach); c <= last; ++c) {
    const double from = std::clamp(static_cast<double>(c) * cell, m0, m1);
    const double to = std::clamp(static_cast<double>(c + 1) * cell, m0, m1);
    const double a = n0 + slope * (from - m0), b = n0 + slope * (to - m0);
    const std::int64_t top = cell_of(std::max(a, b) + reach);
    for (std::int64_t d = cell_of(std::min(a, b) - reach); d <= top; ++d)
      if (!(flat ? visit(c, d) : visit(d, c))) return;
  }
}

}  // namespace popcut
