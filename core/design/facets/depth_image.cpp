// SPDX-License-Identifier: MIT
#include "core/design/facets/depth_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

const double kFacing = std::cos(radians(20.0));

/// A corner on the picture: columns and rows as numbers, and the depth.
struct Corner {
  double c{}, r{}, depth{};
};

Facing facing_of(const TriangleSoup& target, std::size_t t) {
  const Vec3 a = target.corner(t, 0), b = target.corner(t, 1), c = target.corner(t, 2);
  const Vec3 normal = unit(cross(Vec3(b - a), Vec3(c - a)));
  if (std::abs(normal[0]) >= kFacing) return Facing::Wall;
  if (std::abs(normal[2]) >= kFacing) return Facing::Ground;
  return Facing::Elsewhere;
}

class Painter {
 public:
  Painter(DepthImage& image, bool inward) : image_(image), raster_(image.raster) {
    image_.depth_mm.resize(raster_.columns * raster_.rows);
    image_.facing.assign(image_.depth_mm.size(), Facing::Card);
    const float nothing = -std::numeric_limits<float>::infinity();
    for (std::size_t r = 0; r < raster_.rows; ++r)
      for (std::size_t c = 0; c < raster_.columns; ++c)
        image_.depth_mm[r * raster_.columns + c] =
            inward ? nothing : static_cast<float>(std::abs(raster_.across_mm(c)));
  }

  void draw(const TriangleSoup& target, std::size_t t) {
    Corner p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 at = target.corner(t, k);
      p[k] = {(at[0] - at[2] - raster_.from_mm) / raster_.column_mm - 0.5,
              (at[1] - raster_.v_from_mm) / raster_.row_mm - 0.5, at[0] + at[2]};
    }
    const double area =
        (p[1].c - p[0].c) * (p[2].r - p[0].r) - (p[2].c - p[0].c) * (p[1].r - p[0].r);
    if (!(std::abs(area) > 0.0)) return;  // seen from its edge
    std::sort(p, p + 3, [](const Corner& a, const Corner& b) { return a.r < b.r; });
    const double last_row = static_cast<double>(raster_.rows) - 1.0;
    const double first = std::max(0.0, std::ceil(p[0].r)),
                 last = std::min(last_row, std::floor(p[2].r));
    const Facing facing = facing_of(target, t);
    for (double row = first; row <= last; row += 1.0) {
      const Corner a = at_row(p[0], p[2], row);
      const Corner b =
          row < p[1].r || !(p[2].r > p[1].r) ? at_row(p[0], p[1], row) : at_row(p[1], p[2], row);
      fill(a.c <= b.c ? a : b, a.c <= b.c ? b : a, static_cast<std::size_t>(row), facing);
    }
  }

  /// Where nothing at all is seen, the card is.
  void show_card() {
    for (std::size_t r = 0; r < raster_.rows; ++r)
      for (std::size_t c = 0; c < raster_.columns; ++c) {
        float& depth = image_.depth_mm[r * raster_.columns + c];
        if (!std::isfinite(depth)) depth = static_cast<float>(std::abs(raster_.across_mm(c)));
      }
  }

 private:
  static Corner at_row(const Corner& a, const Corner& b, double row) {
    const double t = b.r > a.r ? (row - a.r) / (b.r - a.r) : 0.0;
    return {a.c + t * (b.c - a.c), row, a.depth + t * (b.depth - a.depth)};
  }

  void fill(const Corner& a, const Corner& b, std::size_t row, Facing facing) {
    const double last_column = static_cast<double>(raster_.columns) - 1.0;
    const double first = std::max(0.0, std::ceil(a.c)),
                 last = std::min(last_column, std::floor(b.c));
    const double slope = b.c > a.c ? (b.depth - a.depth) / (b.c - a.c) : 0.0;
    for (double column = first; column <= last; column += 1.0) {
      const std::size_t at = row * raster_.columns + static_cast<std::size_t>(column);
      const auto depth = static_cast<float>(a.depth + slope * (column - a.c));
      if (!(depth > image_.depth_mm[at])) continue;
      image_.depth_mm[at] = depth;
      image_.facing[at] = facing;
    }
  }

  DepthImage& image_;
  const SheetRaster& raster_;
};

}  // namespace

DepthImage depth_image(const TriangleSoup& target, const SheetRaster& raster, bool inward) {
  DepthImage image{raster, {}, {}};
  Painter painter(image, inward);
  for (std::size_t t = 0; t < target.size(); ++t) painter.draw(target, t);
  if (inward) painter.show_card();
  return image;
}

}  // namespace popcut
