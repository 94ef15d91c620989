// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// A box tree over triangles: the point of them that is nearest to any place in O(log n).
///
/// Each node has four children, whose boxes lie side by side, so that one look tells how far all
/// four are. The triangles are halved twice a node, each time by their middles along the longest
/// side of what holds these. Building is O(n log n).
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
  /// The triangle of the soup at a place of the tree.
  [[nodiscard]] std::size_t triangle_at(std::uint32_t place) const { return triangles_[place]; }

 private:
  static constexpr std::size_t kLeaf = 2, kChildren = 4;
  /// Boxes in floats, each a little larger than what it holds. A child is the number of a node, or
  /// of the first triangle of a leaf with `count` of them; 0 of them: there is no such child.
  struct Node {
    std::array<Eigen::Array4f, 3> low, high;
    std::array<std::uint32_t, kChildren> child{};
    std::array<std::uint8_t, kChildren> count{};
    std::array<bool, kChildren> is_leaf{};
  };
  struct Range {
    std::uint32_t from{}, to{};
  };
  class Builder;

  void look_at(std::uint32_t place, const Vec3& p, Nearest& best) const;
  [[nodiscard]] bool beyond(std::uint32_t place, const Vec3& p) const;

  std::vector<double> corners_;           ///< in the tree's order
  std::vector<std::uint32_t> triangles_;  ///< of the soup, in the tree's order
  std::vector<Node> nodes_;               ///< the root is the first
  float size_mm_{0};                      ///< the largest coordinate
};

}  // namespace popcut
