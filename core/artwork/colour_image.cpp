// SPDX-License-Identifier: MIT
#include "core/artwork/colour_image.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace popcut {
namespace {

ColourImage halved(const ColourImage& from) {
  ColourImage half(std::max<std::size_t>(1, from.width / 2),
                   std::max<std::size_t>(1, from.height / 2));
  for (std::size_t j = 0; j < half.height; ++j)
    for (std::size_t i = 0; i < half.width; ++i) {
      const std::size_t x = std::min(2 * i + 1, from.width - 1);
      const std::size_t y = std::min(2 * j + 1, from.height - 1);
      const std::uint8_t* const p[4] = {from.at(2 * i, 2 * j), from.at(x, 2 * j), from.at(2 * i, y),
                                        from.at(x, y)};
      for (std::size_t k = 0; k < 4; ++k)
        half.at(i, j)[k] =
            static_cast<std::uint8_t>((p[0][k] + p[1][k] + p[2][k] + p[3][k] + 2) / 4);
    }
  return half;
}

std::size_t wrapped(long long i, std::size_t size, PictureWrap wrap) {
  const auto n = static_cast<long long>(size);
  if (wrap != PictureWrap::Repeat) return static_cast<std::size_t>(std::clamp(i, 0LL, n - 1));
  const long long rest = i % n;
  return static_cast<std::size_t>(rest < 0 ? rest + n : rest);
}

Colour bilinear(const ColourImage& image, double x, double y, const PictureWraps& wraps) {
  const double x0 = std::floor(x), y0 = std::floor(y);
  const auto i = static_cast<long long>(x0), j = static_cast<long long>(y0);
  const std::size_t left = wrapped(i, image.width, wraps[0]);
  const std::size_t right = wrapped(i + 1, image.width, wraps[0]);
  const std::size_t up = wrapped(j, image.height, wraps[1]);
  const std::size_t down = wrapped(j + 1, image.height, wraps[1]);
  const auto s = static_cast<float>(x - x0), t = static_cast<float>(y - y0);
  return mixed(mixed(image.colour(left, up), image.colour(right, up), s),
               mixed(image.colour(left, down), image.colour(right, down), s), t);
}

/// A place beyond the borders as one from 0 to 1.
double within_picture(double place, PictureWrap wrap) {
  if (wrap == PictureWrap::Clamp) return std::clamp(place, 0.0, 1.0);
  const double whole = std::floor(place), rest = place - whole;
  return wrap == PictureWrap::Mirror && std::fmod(whole, 2.0) != 0.0 ? 1.0 - rest : rest;
}

}  // namespace

Colour mixed(const Colour& p, const Colour& q, float t) {
  const float of_p = (1 - t) * p.a, of_q = t * q.a, a = of_p + of_q;
  if (!(a > 0)) return {255, 255, 255, 0};
  return {(of_p * p.r + of_q * q.r) / a, (of_p * p.g + of_q * q.g) / a,
          (of_p * p.b + of_q * q.b) / a, a};
}

Colour ColourImage::colour(std::size_t i, std::size_t j) const {
  const std::uint8_t* p = at(i, j);
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
          static_cast<float>(p[3])};
}

void ColourImage::set(std::size_t i, std::size_t j, const Colour& colour) {
  std::uint8_t* p = at(i, j);
  const auto byte = [](float part) {
    return static_cast<std::uint8_t>(std::clamp(part, 0.0F, 255.0F) + 0.5F);
  };
  p[0] = byte(colour.r), p[1] = byte(colour.g), p[2] = byte(colour.b), p[3] = byte(colour.a);
}

ColourImage on_paper(const ColourImage& image) {
  ColourImage out = image;
  for (std::size_t k = 0; k < out.rgba.size(); k += 4) {
    const int ink = out.rgba[k + 3];
    for (std::size_t c = 0; c < 3; ++c)
      out.rgba[k + c] =
          static_cast<std::uint8_t>((out.rgba[k + c] * ink + 255 * (255 - ink) + 127) / 255);
    out.rgba[k + 3] = 255;
  }
  return out;
}

Colour colour_between(const ColourImage& image, double x, double y) {
  return bilinear(image, x, y, {PictureWrap::Clamp, PictureWrap::Clamp});
}

Texture::Texture(ColourImage image) {
  levels_.push_back(std::move(image));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(halved(levels_.back()));
}

Colour Texture::at(double s, double t, double texels) const {
  if (levels_.empty() || !std::isfinite(s) || !std::isfinite(t)) return {};
  const double halvings = texels > 1.0 ? std::round(std::log2(texels)) : 0.0;
  const auto level =
      std::min(static_cast<std::size_t>(std::min(halvings, 64.0)), levels_.size() - 1);
  const ColourImage& image = levels_[level];
  // Far beyond the borders a repeating image is the same, and whole numbers stay exact.
  s = within_picture(s, wraps[0]);
  t = within_picture(t, wraps[1]);
  return bilinear(image, s * static_cast<double>(image.width) - 0.5,
                  t * static_cast<double>(image.height) - 0.5, wraps);
}

}  // namespace popcut
