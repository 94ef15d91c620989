// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/page_point.hpp"
#include "core/geometry/raster.hpp"

namespace popcut {

/// Where the pixels of a picture lie on a page, in mm: pixel (i, j) is the square between
/// `left_mm + i pixel_mm` and the next one across, `top_mm + j pixel_mm` and the next one down.
struct PixelFrame {
  double left_mm{}, top_mm{};
  double pixel_mm{};
  std::size_t width{}, height{};  ///< pixels

  [[nodiscard]] std::size_t pixels() const { return width * height; }
  /// The middle of a pixel, mm.
  [[nodiscard]] PagePoint middle(std::size_t i, std::size_t j) const {
    return {left_mm + (static_cast<double>(i) + 0.5) * pixel_mm,
            top_mm + (static_cast<double>(j) + 0.5) * pixel_mm};
  }
  /// A place in pixels, counted so that the middle of pixel (i, j) is at (i, j).
  [[nodiscard]] PagePoint in_pixels(const PagePoint& p) const {
    return {(p.x - left_mm) / pixel_mm - 0.5, (p.y - top_mm) / pixel_mm - 0.5};
  }
};

/// Visits the pixels of a frame that a triangle covers (`for_each_pixel`).
///
/// @param corners  in mm of the page
template <typename Visit>
void each_pixel(const PixelFrame& frame, const std::array<PagePoint, 3>& corners, Visit&& visit) {
  for_each_pixel(
      frame.width, frame.height,
      {frame.in_pixels(corners[0]), frame.in_pixels(corners[1]), frame.in_pixels(corners[2])},
      visit);
}

/// The frame of pixels of `pixel_mm` that covers a box and `around_mm` more on each side.
[[nodiscard]] inline PixelFrame frame_around(const Box& box, double around_mm, double pixel_mm) {
  const auto count = [&](double mm) {
    return static_cast<std::size_t>(std::ceil((mm + 2 * around_mm) / pixel_mm - 1e-9));
  };
  return {box.x0 - around_mm, box.y0 - around_mm, pixel_mm, count(box.width()),
          count(box.height())};
}

}  // namespace popcut
