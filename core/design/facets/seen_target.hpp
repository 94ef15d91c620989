// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// Points of the flat sheet in rows along the spine: point (row, column) is the middle of its cell,
/// at `across = from_mm + (column + 1/2) column_mm` and `v = v_from_mm + (row + 1/2) row_mm`.
/// `across = x - z` is 0 on the spine, grows into the ground, and is the sheet's u less the wall's
/// height.
struct SheetRaster {
  double from_mm{}, column_mm{};
  double v_from_mm{}, row_mm{};
  std::size_t columns{}, rows{};

  [[nodiscard]] double across_mm(std::size_t column) const {
    return from_mm + (static_cast<double>(column) + 0.5) * column_mm;
  }
  [[nodiscard]] double v_mm(std::size_t row) const {
    return v_from_mm + (static_cast<double>(row) + 0.5) * row_mm;
  }
};

/// What a point of a target's picture shows.
enum class Facing : unsigned char {
  Card,      ///< wall or ground of the card: nothing stands there
  Wall,      ///< a part of the target within 20 degrees of the wall's direction
  Ground,    ///< within 20 degrees of the ground's
  Elsewhere  ///< any other part
};

/// The target as it is seen along (1, 0, 1), from outside of the corner: at each point of the sheet
/// the nearest part of it. Where nothing is in front of the card, the card is seen.
struct SeenTarget {
  SheetRaster raster;
  std::vector<float> depth_mm;  ///< x + z, row by row
  std::vector<Facing> facing;

  /// Distance from the wall and height above the ground of what is seen.
  [[nodiscard]] double x_mm(std::size_t row, std::size_t column) const {
    return 0.5 * (static_cast<double>(depth_mm[row * raster.columns + column]) +
                  raster.across_mm(column));
  }
  [[nodiscard]] double z_mm(std::size_t row, std::size_t column) const {
    return 0.5 * (static_cast<double>(depth_mm[row * raster.columns + column]) -
                  raster.across_mm(column));
  }
};

/// Draws triangles with a z-buffer. O(triangles + points that they cover).
///
/// @param inward  parts behind wall and ground are seen too where nothing is in front of them, as
///                if the card had an opening there
[[nodiscard]] SeenTarget seen_target(const TriangleSoup& target, const SheetRaster& raster,
                                     bool inward);

}  // namespace popcut
