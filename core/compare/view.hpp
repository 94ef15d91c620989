// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "core/geometry/vec.hpp"

namespace popcut::likeness {

/// Triangles as flat numbers, mm: nine each, the corners (x, v, z) one after the other. x is the
/// distance from the wall along the ground, v runs along the spine, z is the height.
using Triangles = std::span<const float>;

/// A direction from which a scene is seen without perspective. `right`, `up` and `toward` are
/// orthonormal and right-handed; the depth of p is `toward . p`: the larger, the nearer.
struct View {
  Vec3 toward;  ///< from the scene to the eye
  Vec3 right, up;
};

/// The view from a direction, with z up as far as it can be. A zero vector is x.
[[nodiscard]] View view_from(const Vec3& toward);

/// Nine views of a card that is opened to `opening_rad`: the diagonal, halfway between ground and
/// wall, and eight around it on the border of a cone. The cone's half angle is 30 degrees, or two
/// thirds of half the opening where that is less, so that each view lies in front of the wall.
[[nodiscard]] std::vector<View> cone_views(double opening_rad = std::numbers::pi / 2);

/// Nine views of a card that lies open flat, whose front looks along x: 20, 40 and 60 degrees above
/// the page, each from in front and from 40 degrees to either side.
[[nodiscard]] std::vector<View> page_views();

/// `count` views square to the spine, evenly all around it, from the ground (x) to the height.
[[nodiscard]] std::vector<View> round_views(std::size_t count = 36);

/// A view from `turn_rad` about the spine, which stands upright, and from `rise_rad` above the
/// plane square to it.
[[nodiscard]] View risen_view(double turn_rad, double rise_rad);

/// The smallest box with its sides along the axes; empty (`low` above `high`) without triangles.
struct Box {
  Vec3 low, high;
  [[nodiscard]] bool empty() const { return !(low.x() <= high.x()); }
  [[nodiscard]] double diagonal() const { return empty() ? 0.0 : norm(high - low); }
  [[nodiscard]] Vec3 centre() const { return 0.5 * (low + high); }
};
[[nodiscard]] Box box_of(Triangles triangles);
/// The box around both.
[[nodiscard]] Box joined(const Box& a, const Box& b);

/// A square image of a view: `pixels` along each side, around `centre`. Pixel (column, row) counts
/// from the lower left; its middle is at `pitch_mm() (column + 0.5) - side_mm / 2` to the right of
/// the centre, and the same with rows upwards.
struct Frame {
  View view;
  Vec3 centre;
  double side_mm{};
  int pixels{};
  [[nodiscard]] double pitch_mm() const { return side_mm / pixels; }
};

inline constexpr int kLeastPixels = 16, kMostPixels = 4096;

}  // namespace popcut::likeness
