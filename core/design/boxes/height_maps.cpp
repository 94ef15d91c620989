// SPDX-License-Identifier: MIT
#include "core/design/boxes/height_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/raster.hpp"

namespace popcut {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

/// A grid without maps on it.
BlockGrid grid_over(const TriangleSoup& target, std::size_t cells) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t t = 0; t < target.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      low = low.cwiseMin(target.corner(t, k)), high = high.cwiseMax(target.corner(t, k));
  BlockGrid grid;
  grid.low = low;
  const Vec3 size = high - low;
  grid.cell_mm = size.maxCoeff() / static_cast<double>(cells);
  const auto count = [&](double mm) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(mm / grid.cell_mm - 1e-6)));
  };
  grid.columns = count(size.x()), grid.rows = count(size.y()), grid.levels = count(size.z());
  return grid;
}

/// Calls `visit(cell, place, triangle)` for the cells of a view along axis `along`, whose pictures
/// have axis `across` in columns and axis `up` in rows; `place` is where the target is there.
template <typename Visit>
void draw_along(const TriangleSoup& target, const BlockGrid& grid, int along, int across, int up,
                const Visit& visit) {
  const std::array<std::size_t, 3> counts{grid.columns, grid.rows, grid.levels};
  const std::size_t columns = counts[static_cast<std::size_t>(across)],
                    rows = counts[static_cast<std::size_t>(up)];
  for (std::size_t t = 0; t < target.size(); ++t) {
    std::array<PagePoint, 3> at;
    std::array<double, 3> place{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = target.corner(t, k);
      at[k] = {(p[across] - grid.low[across]) / grid.cell_mm - 0.5,
               (p[up] - grid.low[up]) / grid.cell_mm - 0.5};
      place[k] = p[along];
    }
    for_each_pixel(columns, rows, at,
                   [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
                     visit(j * columns + i, w[0] * place[0] + w[1] * place[1] + w[2] * place[2], t);
                   });
  }
}

void keep_least(double& cell, double place) {
  if (!(cell <= place)) cell = place;
}
void keep_largest(double& cell, double place) {
  if (!(cell >= place)) cell = place;
}

}  // namespace

HeightMaps height_maps(const TriangleSoup& target, std::size_t cells) {
  HeightMaps out;
  out.grid = grid_over(target, cells);
  const BlockGrid& grid = out.grid;
  out.top.assign(grid.rows * grid.columns, 0.0);
  draw_along(target, grid, 2, 0, 1,
             [&](std::size_t cell, double z, std::size_t) { keep_largest(out.top[cell], z); });
  out.left.assign(grid.rows * grid.levels, kNowhere);
  out.right = out.left;
  draw_along(target, grid, 0, 2, 1, [&](std::size_t cell, double x, std::size_t) {
    keep_least(out.left[cell], x);
    keep_largest(out.right[cell], x);
  });
  return out;
}

EndMaps end_maps(const TriangleSoup& target, const BlockGrid& grid, double from_mm, double to_mm) {
  EndMaps out;
  out.first.assign(grid.levels * grid.columns, kNowhere);
  out.last = out.first;
  draw_along(target, grid, 1, 0, 2, [&](std::size_t cell, double y, std::size_t) {
    if (y < from_mm - 0.5 * grid.cell_mm || y > to_mm + 0.5 * grid.cell_mm) return;
    keep_least(out.first[cell], y);
    keep_largest(out.last[cell], y);
  });
  return out;
}

TriangleSoup seen_from_around(const TriangleSoup& target, std::size_t cells) {
  const BlockGrid grid = grid_over(target, cells);
  std::vector<bool> is_seen(target.size(), false);
  const auto look = [&](int along, int across, int up, std::size_t count, double sign) {
    std::vector<double> nearest(count, kNowhere);
    std::vector<std::size_t> of(count, target.size());
    draw_along(target, grid, along, across, up,
               [&](std::size_t cell, double place, std::size_t triangle) {
                 if (of[cell] < target.size() && sign * place <= nearest[cell]) return;
                 nearest[cell] = sign * place, of[cell] = triangle;
               });
    for (const std::size_t t : of)
      if (t < target.size()) is_seen[t] = true;
  };
  look(2, 0, 1, grid.columns * grid.rows, 1.0);
  for (const double sign : {-1.0, 1.0}) {
    look(0, 2, 1, grid.levels * grid.rows, sign);
    look(1, 0, 2, grid.columns * grid.levels, sign);
  }
  TriangleSoup out;
  for (std::size_t t = 0; t < target.size(); ++t)
    if (is_seen[t]) out.add(target.corner(t, 0), target.corner(t, 1), target.corner(t, 2));
  return out;
}

}  // namespace popcut
