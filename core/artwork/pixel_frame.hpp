// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "core/geometry/page_point.hpp"

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

/// The frame of pixels of `pixel_mm` that covers a box and `around_mm` more on each side.
[[nodiscard]] inline PixelFrame frame_around(const Box& box, double around_mm, double pixel_mm) {
  const auto count = [&](double mm) {
    return static_cast<std::size_t>(std::ceil((mm + 2 * around_mm) / pixel_mm - 1e-9));
  };
  return {box.x0 - around_mm, box.y0 - around_mm, pixel_mm, count(box.width()),
          count(box.height())};
}

}  // namespace popcut
