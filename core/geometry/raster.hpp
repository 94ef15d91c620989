// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// Calls `visit(column, row, weights)` for each pixel whose middle lies in a triangle, its sides
/// included, with the weights of the three corners there (their sum is 1). Row by row. A middle on
/// a side that two triangles share is visited for both.
///
/// Weight k falls from 1 at its corner to 0 on the side across from it (barycentric coordinates).
/// Middles within 1e-9 pixels of a side are on it.
///
/// @param columns, rows  of the picture, at least one
/// @param p  corners in pixels: the middle of pixel (i, j) is at (i, j)
template <typename Visit>
void for_each_pixel(std::size_t columns, std::size_t rows, const std::array<PagePoint, 3>& p,
                    Visit&& visit) {
  const double twice =
      (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  if (!(std::abs(twice) > 1e-12)) return;
  // At (x, y) weight k is along[k] x + down[k] y + rest[k].
  std::array<double, 3> along, down, rest;
  for (std::size_t k = 0; k < 3; ++k) {
    const PagePoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    along[k] = (a.y - b.y) / twice;
    down[k] = (b.x - a.x) / twice;
    rest[k] = (a.x * b.y - a.y * b.x) / twice;
  }
  constexpr double kOn = 1e-9;
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const double last_row = static_cast<double>(rows) - 1;
  const double last_column = static_cast<double>(columns) - 1;
  if (!(bottom >= 0) || !(top <= last_row)) return;
  const auto from_row = static_cast<std::size_t>(std::max(0.0, std::ceil(top - kOn)));
  const auto to_row = static_cast<std::size_t>(std::floor(std::min(last_row, bottom + kOn)));
  for (std::size_t j = from_row; j <= to_row; ++j) {
    const auto y = static_cast<double>(j);
    double from = 0.0, to = last_column;
    for (std::size_t k = 0; k < 3; ++k) {
      const double here = down[k] * y + rest[k];  // 0 <= along x + here
      if (std::abs(along[k]) < 1e-15) {
        if (here < -kOn) to = -1.0;
      } else if (along[k] > 0) {
        from = std::max(from, (-kOn - here) / along[k]);
      } else {
        to = std::min(to, (-kOn - here) / along[k]);
      }
    }
    if (!(from <= to)) continue;
    const auto from_column = static_cast<std::size_t>(std::ceil(from));
    const auto to_column = static_cast<std::size_t>(std::floor(to));
    for (std::size_t i = from_column; i <= to_column; ++i) {
      const auto x = static_cast<double>(i);
      visit(i, j,
            std::array<double, 3>{along[0] * x + down[0] * y + rest[0],
                                  along[1] * x + down[1] * y + rest[1],
                                  along[2] * x + down[2] * y + rest[2]});
    }
  }
}

}  // namespace popcut
