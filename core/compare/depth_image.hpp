// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "core/compare/view.hpp"

namespace popcut::likeness {

/// The depth of a pixel that shows nothing.
inline constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// Depths in mm, from the frame's centre toward the eye, row by row from below; `kNothing` where
/// nothing is.
struct DepthImage {
  int pixels{};
  std::vector<float> depth;
  [[nodiscard]] float at(int column, int row) const {
    return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels) +
                 static_cast<std::size_t>(column)];
  }
};

/// The corner that a card stands in: the ground z = 0, and the wall through the spine that rises at
/// `opening_rad` to it.
struct Corner {
  double opening_rad{std::numbers::pi / 2};
  /// How far a point is in front of the corner, mm: the lesser of its distances from ground and
  /// wall; negative behind one of them.
  [[nodiscard]] double clearance(const Vec3& p) const;
};

/// Draws triangles, the nearest one at each pixel, into an image that is emptied first. Corners
/// that are not finite draw nothing. O(triangles + covered pixels).
void draw(const Frame& frame, Triangles triangles, DepthImage& image);

/// Draws the corner, as far as the image reaches. Views from behind the wall or below the ground
/// show nothing of it.
void draw(const Frame& frame, const Corner& corner, DepthImage& image);

/// Empties the pixels that lie on what stands behind, or farther back.
/// @param backdrop  of the same frame; without pixels nothing stands behind
void hide_behind(const DepthImage& backdrop, double touch_mm, DepthImage& image);

/// Where depth jumps: `pixels` are the nearer sides, in order.
struct ContourPixels {
  std::vector<std::uint32_t> pixels;
};

/// Finds pixels beside which the depth falls by more than `jump_mm`, or to nothing. A slope is no
/// jump, however steep: what both sides lead one to expect is taken off.
void find_contours(const DepthImage& image, float jump_mm, ContourPixels& out);

/// The distance of each pixel from the nearest contour pixel, in pixels (Felzenszwalb and
/// Huttenlocher, Distance Transforms of Sampled Functions, 2012); infinite without any. O(pixels).
class DistanceImage {
 public:
  void measure(int pixels, const ContourPixels& contours);
  [[nodiscard]] float operator[](std::uint32_t pixel) const { return distance_[pixel]; }
  [[nodiscard]] bool is_empty() const { return empty_; }

 private:
  std::vector<float> distance_;  ///< squared on the way
  std::vector<float> line_, border_;
  std::vector<int> place_;
  bool empty_{true};
};

/// The mean distance at contour pixels from other contours, each `most` at most, in pixels.
/// @param contours  at least one
[[nodiscard]] double mean_distance(const ContourPixels& contours, const DistanceImage& distances,
                                   double most);

}  // namespace popcut::likeness
