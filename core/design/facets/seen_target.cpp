// SPDX-License-Identifier: MIT
#include "core/design/facets/seen_target.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/raster.hpp"

namespace popcut {
namespace {

const double kFacing = std::cos(20.0 * 3.14159265358979323846 / 180.0);

Facing facing_of(const TriangleSoup& target, std::size_t t) {
  const Vec3 a = target.corner(t, 0), b = target.corner(t, 1), c = target.corner(t, 2);
  const Vec3 normal = unit(cross(Vec3(b - a), Vec3(c - a)));
  if (std::abs(normal[0]) >= kFacing) return Facing::Wall;
  if (std::abs(normal[2]) >= kFacing) return Facing::Ground;
  return Facing::Elsewhere;
}

/// Draws one triangle in front of what is there.
void draw(const TriangleSoup& target, std::size_t t, SeenTarget& image) {
  const SheetRaster& raster = image.raster;
  std::array<PagePoint, 3> at;
  std::array<double, 3> depth{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 corner = target.corner(t, k);
    at[k] = {(corner[0] - corner[2] - raster.from_mm) / raster.column_mm - 0.5,
             (corner[1] - raster.v_from_mm) / raster.row_mm - 0.5};
    depth[k] = corner[0] + corner[2];
  }
  const Facing facing = facing_of(target, t);
  for_each_pixel(raster.columns, raster.rows, at,
                 [&](std::size_t column, std::size_t row, const std::array<double, 3>& w) {
                   const auto here =
                       static_cast<float>(w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]);
                   const std::size_t point = row * raster.columns + column;
                   if (!(here > image.depth_mm[point])) return;
                   image.depth_mm[point] = here;
                   image.facing[point] = facing;
                 });
}

}  // namespace

SeenTarget seen_target(const TriangleSoup& target, const SheetRaster& raster, bool inward) {
  constexpr float kNothing = -std::numeric_limits<float>::infinity();
  const std::size_t points = raster.columns * raster.rows;
  SeenTarget image{raster, std::vector<float>(points, kNothing),
                   std::vector<Facing>(points, Facing::Card)};
  const auto show_card = [&] {  // where nothing is seen
    for (std::size_t row = 0, point = 0; row < raster.rows; ++row)
      for (std::size_t column = 0; column < raster.columns; ++column, ++point)
        if (image.depth_mm[point] == kNothing)
          image.depth_mm[point] = static_cast<float>(std::abs(raster.across_mm(column)));
  };
  if (!inward) show_card();
  for (std::size_t t = 0; t < target.size(); ++t) draw(target, t, image);
  if (inward) show_card();
  return image;
}

}  // namespace popcut
