// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// A box tree over triangles: the point of them that is nearest to any place in O(log n).
///
/// The triangles are put in Morton order (Karras, Maximizing Parallelism in the Construction of
/// BVHs, 2012) and packed two a leaf; the boxes above them form a complete binary tree in one flat
/// array, node i over 2i and 2i + 1. Building is O(n).
class TriangleTree {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit TriangleTree(const TriangleSoup& soup);

  struct Nearest {
    double squared{std::numeric_limits<double>::infinity()};  ///< square of the distance, mm^2
    std::uint32_t place{kNone};  ///< of the triangle in the tree: a hint for a place near by
    Vec3 point;
  };
  /// The nearest point to `p`; `hint` is the place of a triangle that is probably near, or none.
  /// Without triangles the distance is infinite.
  [[nodiscard]] Nearest nearest(const Vec3& p, std::uint32_t hint = kNone) const;

  /// Whether some triangle has, in the plane of `p` across the spine (same v), a point farther from
  /// the wall and higher above the ground than `p`.
  [[nodiscard]] bool any_beyond(const Vec3& p) const;

  [[nodiscard]] std::size_t size() const { return corners_.size() / 9; }

 private:
  static constexpr std::size_t kLeaf = 2;
  struct Box {
    std::array<double, 3> low{}, high{};
  };
  [[nodiscard]] static double squared_to(const Box& box, const Vec3& p);
  void look_at(std::uint32_t place, const Vec3& p, Nearest& best) const;
  [[nodiscard]] bool beyond(std::uint32_t place, const Vec3& p) const;

  std::vector<double> corners_;  ///< in the tree's order
  std::vector<Box> boxes_;       ///< 2 x leaves of them; the root is 1
  std::size_t leaves_{0};
};

}  // namespace popcut
