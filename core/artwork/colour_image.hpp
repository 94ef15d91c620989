// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/model/model.hpp"

namespace popcut {

/// A colour as screens and printers take it (sRGB), each part from 0 to 255. `a` is how much ink
/// there is: 0 for the bare paper.
struct Colour {
  float r{255}, g{255}, b{255}, a{255};
};

/// The colour at share `t` of the way from `p` to `q`. Where one of them is bare paper, the other
/// one's colour fades.
[[nodiscard]] Colour mixed(const Colour& p, const Colour& q, float t);

/// Pixels row by row from the top, four bytes each: red, green, blue and ink.
struct ColourImage {
  std::size_t width{}, height{};
  std::vector<std::uint8_t> rgba;

  ColourImage() = default;
  /// Without ink.
  ColourImage(std::size_t pixels_across, std::size_t pixels_down)
      : width(pixels_across), height(pixels_down), rgba(4 * pixels_across * pixels_down, 0) {}

  [[nodiscard]] std::uint8_t* at(std::size_t i, std::size_t j) {
    return rgba.data() + 4 * (j * width + i);
  }
  [[nodiscard]] const std::uint8_t* at(std::size_t i, std::size_t j) const {
    return rgba.data() + 4 * (j * width + i);
  }
  [[nodiscard]] Colour colour(std::size_t i, std::size_t j) const;
  void set(std::size_t i, std::size_t j, const Colour& colour);
};

/// The image printed on white paper: no pixel is without ink.
[[nodiscard]] ColourImage on_paper(const ColourImage& image);

/// The largest image that is read or made: pixels.
inline constexpr std::size_t kMaxPixels = 200'000'000;

/// The colour between pixels (bilinear), in pixels counted so that the middle of pixel (i, j) is at
/// (i, j). Beyond the borders the outermost pixels go on.
[[nodiscard]] Colour colour_between(const ColourImage& image, double x, double y);

/// An image in halves: itself, half as large, a quarter, down to one pixel. So a picture that is
/// looked at from afar does not flicker (mip maps).
class Texture {
 public:
  Texture() = default;
  explicit Texture(ColourImage image);

  /// The colour at (s, t), from 0 to 1 across from the left and down from the top; `wraps` says how
  /// it goes on beyond.
  ///
  /// @param texels  how many pixels of the whole image one pixel of what is drawn covers, across
  [[nodiscard]] Colour at(double s, double t, double texels) const;

  [[nodiscard]] std::size_t width() const { return levels_.empty() ? 0 : levels_.front().width; }
  [[nodiscard]] std::size_t height() const { return levels_.empty() ? 0 : levels_.front().height; }

  PictureWraps wraps{};  ///< across and down

 private:
  std::vector<ColourImage> levels_;
};

}  // namespace popcut
