// SPDX-License-Identifier: MIT
#include "core/compare/picture.hpp"

#include <algorithm>
#include <cmath>

namespace popcut::likeness {
namespace {

constexpr Rgb kWhite{255, 255, 255};

/// Between two colours, `share` 0 to 1 of the second.
Rgb mixed(const Rgb& a, const Rgb& b, double share) {
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = static_cast<std::uint8_t>(std::llround((1.0 - share) * a[k] + share * b[k]));
  return out;
}

void put(Pixels& pixels, int column, int row, const Rgb& colour) {
  const auto size = static_cast<std::size_t>(pixels.size);
  const std::size_t at =
      3 * ((size - 1 - static_cast<std::size_t>(row)) * size + static_cast<std::size_t>(column));
  std::copy(colour.begin(), colour.end(), pixels.rgb.begin() + static_cast<std::ptrdiff_t>(at));
}

Pixels blank(int size) {
  const auto count = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  return {size, std::vector<std::uint8_t>(3 * count, 255)};
}

/// The slope of the depth at a pixel along one axis, a pixel: the lesser one of both sides, so that
/// it does not reach over a contour.
double slope_at(const DepthImage& image, int column, int row, int right, int up) {
  const auto depth = [&](int sign) {
    const int x = column + sign * right, y = row + sign * up;
    if (x < 0 || y < 0 || x >= image.pixels || y >= image.pixels) return kNothing;
    return image.at(x, y);
  };
  const float here = image.at(column, row), after = depth(1), before = depth(-1);
  const bool has_after = after != kNothing, has_before = before != kNothing;
  if (!has_after && !has_before) return 0.0;
  const auto ahead = static_cast<double>(after - here), back = static_cast<double>(here - before);
  if (!has_before) return ahead;
  if (!has_after) return back;
  return std::abs(ahead) < std::abs(back) ? ahead : back;
}

}  // namespace

Pixels shaded(const DepthImage& image, double pitch_mm, float jump_mm, const Rgb& colour) {
  Pixels out = blank(image.pixels);
  const Vec3 lamp = unit(Vec3(-0.45, 0.6, 0.75));
  constexpr double kShade = 0.42;  // of the colour, where no light falls
  for (int row = 0; row < image.pixels; ++row)
    for (int column = 0; column < image.pixels; ++column) {
      if (image.at(column, row) == kNothing) continue;
      const Vec3 normal = unit(Vec3(-slope_at(image, column, row, 1, 0) / pitch_mm,
                                    -slope_at(image, column, row, 0, 1) / pitch_mm, 1.0));
      const double light = kShade + (1.0 - kShade) * std::max(0.0, dot(normal, lamp));
      put(out, column, row, mixed(Rgb{0, 0, 0}, colour, std::min(1.0, light)));
    }
  ContourPixels contours;
  find_contours(image, jump_mm, contours);
  for (const std::uint32_t pixel : contours.pixels)
    put(out, static_cast<int>(pixel) % image.pixels, static_cast<int>(pixel) / image.pixels,
        Rgb{40, 36, 32});
  return out;
}

Pixels difference(const Target& target, std::size_t k, const DepthImage& structure) {
  const DepthImage& own = target.image(k);
  Pixels out = blank(own.pixels);
  const double full = kFullColour * target.box().diagonal();
  std::size_t pixel = 0;
  for (int row = 0; row < own.pixels; ++row)
    for (int column = 0; column < own.pixels; ++column, ++pixel) {
      const bool is_there = own.depth[pixel] != kNothing;
      const bool is_made = structure.depth[pixel] != kNothing;
      if (!is_there && !is_made) {
        put(out, column, row, kWhite);
      } else if (is_there != is_made) {
        put(out, column, row, is_there ? kMissing : kBeyond);
      } else {
        const auto off = static_cast<double>(structure.depth[pixel] - own.depth[pixel]);
        put(out, column, row,
            mixed(kAgrees, off > 0 ? kNearer : kFarther, std::min(1.0, std::abs(off) / full)));
      }
    }
  return out;
}

}  // namespace popcut::likeness
