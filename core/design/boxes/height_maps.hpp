// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/fit/triangle_soup.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

/// A grid of square cells over a target: columns across the spine (x), rows along it (y), levels
/// from its foot up (z).
struct BlockGrid {
  double cell_mm{};
  Vec3 low{0.0, 0.0, 0.0};
  std::size_t columns{}, rows{}, levels{};

  [[nodiscard]] double x_of(std::size_t column) const { return middle(low.x(), column); }
  [[nodiscard]] double y_of(std::size_t row) const { return middle(low.y(), row); }
  [[nodiscard]] double z_of(std::size_t level) const { return middle(low.z(), level); }

 private:
  [[nodiscard]] double middle(double from, std::size_t k) const {
    return from + (static_cast<double>(k) + 0.5) * cell_mm;
  }
};

/// How far a target reaches, as it is seen from above and from both sides. Its foot is at z = 0.
struct HeightMaps {
  BlockGrid grid;
  std::vector<double> top;          ///< z by row and column; 0 where there is nothing
  std::vector<double> left, right;  ///< x by row and level; NaN where there is nothing

  [[nodiscard]] double top_at(std::size_t row, std::size_t column) const {
    return top[row * grid.columns + column];
  }
};

/// Draws a target in at most `cells` cells along each axis.
[[nodiscard]] HeightMaps height_maps(const TriangleSoup& target, std::size_t cells);

/// The triangles of a target that are seen from above or from one of its four sides, each whole.
/// What is inside of walls and roofs, and what only shows from below, is left out.
[[nodiscard]] TriangleSoup seen_from_around(const TriangleSoup& target, std::size_t cells);

/// Where the walls of a target are that look along the spine, of what it has between two places
/// of it (half a cell more): y by level and column, the least and the largest; NaN where there is
/// nothing.
struct EndMaps {
  std::vector<double> first, last;
};
[[nodiscard]] EndMaps end_maps(const TriangleSoup& target, const BlockGrid& grid, double from_mm,
                               double to_mm);

}  // namespace popcut
