// SPDX-License-Identifier: MIT
#include "core/compare/depth_image.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/compare/raster.hpp"

namespace popcut::likeness {
namespace {

std::size_t count_of(int pixels) {
  return static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels);
}

}  // namespace

double Corner::clearance(const Vec3& p) const {
  // Square to the wall, toward the opening.
  const double ahead = std::sin(opening_rad) * p.x() - std::cos(opening_rad) * p.z();
  return std::min(ahead, p.z());
}

void draw(const Frame& frame, Triangles triangles, DepthImage& image) {
  image.pixels = frame.pixels;
  image.depth.assign(count_of(frame.pixels), kNothing);
  const auto width = static_cast<std::size_t>(frame.pixels);
  float* const depth = image.depth.data();
  Raster(frame).each_span(triangles, [&](std::size_t row, std::size_t first, std::size_t last,
                                         float at, float slope, float low, float high, int) {
    float* const line = depth + row * width;
    for (std::size_t x = first; x <= last; ++x) {
      const float here = at + slope * static_cast<float>(static_cast<int>(x - first));
      const float cut = here < low ? low : here > high ? high : here;
      line[x] = line[x] < cut ? cut : line[x];
    }
  });
}

void draw(const Frame& frame, const Corner& corner, DepthImage& image) {
  image.pixels = frame.pixels;
  image.depth.assign(count_of(frame.pixels), kNothing);
  const Vec3 ground(0, 0, 1);
  const Vec3 wall(std::sin(corner.opening_rad), 0, -std::cos(corner.opening_rad));
  const double at_ground = dot(ground, frame.view.toward), at_wall = dot(wall, frame.view.toward);
  constexpr double kGrazing = 1e-6;
  if (at_ground < kGrazing || at_wall < kGrazing) return;
  // Of a plane through the spine with the normal n: the depth at which centre + a right + b up +
  // t toward lies on it is -n . (centre + a right + b up) / n . toward. The nearer one is seen.
  const auto plane = [&](const Vec3& n, double facing) {
    return Vec3(-dot(n, frame.centre) / facing, -dot(n, frame.view.right) / facing,
                -dot(n, frame.view.up) / facing);
  };
  const Vec3 a = plane(ground, at_ground), b = plane(wall, at_wall);
  const double pitch = frame.pitch_mm(), first = 0.5 * pitch - 0.5 * frame.side_mm;
  std::size_t k = 0;
  for (int row = 0; row < frame.pixels; ++row) {
    const double y = first + pitch * row;
    for (int column = 0; column < frame.pixels; ++column) {
      const double x = first + pitch * column;
      image.depth[k++] =
          static_cast<float>(std::max(a[0] + a[1] * x + a[2] * y, b[0] + b[1] * x + b[2] * y));
    }
  }
}

void hide_behind(const DepthImage& backdrop, double touch_mm, DepthImage& image) {
  const auto touch = static_cast<float>(touch_mm);
  for (std::size_t p = 0; p < backdrop.depth.size(); ++p)
    if (!(image.depth[p] > backdrop.depth[p] + touch)) image.depth[p] = kNothing;
}

void find_contours(const DepthImage& image, float jump_mm, ContourPixels& out) {
  out.pixels.clear();
  const int size = image.pixels;
  const float* const d = image.depth.data();
  // Whether the depth falls from pixel `a` to its neighbour `b` in steps of `step`; `room` says
  // whether there is one pixel more on either side.
  const auto falls = [&](std::ptrdiff_t a, std::ptrdiff_t step, bool room_before, bool room_after) {
    const float here = d[a], next = d[a + step];
    if (!(here - next > jump_mm)) return false;  // also where nothing is here
    if (next == kNothing) return true;
    const float jump = here - next;
    if (room_before && d[a - step] != kNothing && d[a - step] - here > jump - jump_mm &&
        d[a - step] - here < jump + jump_mm)
      return false;
    if (room_after && d[a + 2 * step] != kNothing && next - d[a + 2 * step] > jump - jump_mm &&
        next - d[a + 2 * step] < jump + jump_mm)
      return false;
    return true;
  };
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(row) * size + column;
      if (d[k] == kNothing) continue;
      const bool left = column > 0, right = column + 1 < size, below = row > 0,
                 above = row + 1 < size;
      if ((left && falls(k, -1, right, column > 1)) ||
          (right && falls(k, 1, left, column + 2 < size)) ||
          (below && falls(k, -size, above, row > 1)) ||
          (above && falls(k, size, below, row + 2 < size)))
        out.pixels.push_back(static_cast<std::uint32_t>(k));
    }
}

double mean_distance(const ContourPixels& contours, const DistanceImage& distances, double most) {
  double sum = 0.0;
  for (const std::uint32_t pixel : contours.pixels)
    sum += std::min(most, static_cast<double>(distances[pixel]));
  return sum / static_cast<double>(contours.pixels.size());
}

void DistanceImage::measure(int pixels, const ContourPixels& contours) {
  constexpr float kFar = 1e12f;
  const auto size = static_cast<std::size_t>(pixels);
  empty_ = contours.pixels.empty();
  distance_.assign(size * size, kFar);
  if (empty_) return;
  for (const std::uint32_t pixel : contours.pixels) distance_[pixel] = 0.0f;
  line_.resize(size), border_.resize(size + 1), place_.resize(size);
  // Columns first: the way up and the way down, in whole pixels.
  for (std::size_t row = 1; row < size; ++row)
    for (std::size_t x = 0; x < size; ++x) {
      float& here = distance_[row * size + x];
      here = std::min(here, distance_[(row - 1) * size + x] + 1.0f);
    }
  for (std::size_t row = size - 1; row-- > 0;)
    for (std::size_t x = 0; x < size; ++x) {
      float& here = distance_[row * size + x];
      here = std::min(here, distance_[(row + 1) * size + x] + 1.0f);
    }
  // Rows: the lower envelope of parabolas.
  for (std::size_t row = 0; row < size; ++row) {
    float* const d = distance_.data() + row * size;
    int top = -1;
    for (int q = 0; q < pixels; ++q) {
      const float own = d[q];
      if (own >= 0.5f * kFar) continue;
      line_[static_cast<std::size_t>(q)] = own * own;
      const auto meets = [&](int p) {
        const float a = line_[static_cast<std::size_t>(p)], b = own * own;
        return (b - a + static_cast<float>(q * q - p * p)) / static_cast<float>(2 * (q - p));
      };
      float from = -std::numeric_limits<float>::infinity();
      while (top >= 0) {
        from = meets(place_[static_cast<std::size_t>(top)]);
        if (from > border_[static_cast<std::size_t>(top)]) break;
        --top, from = -std::numeric_limits<float>::infinity();
      }
      ++top;
      place_[static_cast<std::size_t>(top)] = q, border_[static_cast<std::size_t>(top)] = from;
    }
    if (top < 0) continue;
    int k = 0;
    for (int q = 0; q < pixels; ++q) {
      while (k < top && border_[static_cast<std::size_t>(k + 1)] < static_cast<float>(q)) ++k;
      const int p = place_[static_cast<std::size_t>(k)];
      const auto away = static_cast<float>(q - p);
      d[q] = std::sqrt(away * away + line_[static_cast<std::size_t>(p)]);
    }
  }
}

}  // namespace popcut::likeness
