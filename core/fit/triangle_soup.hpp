// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/vec.hpp"

namespace popcut {

/// Triangles without shared vertices, mm: nine numbers each, the corners (x, v, z) one after the
/// other. x is the distance from the wall, v runs along the spine, z is the height above the
/// ground.
struct TriangleSoup {
  std::vector<double> corners;

  [[nodiscard]] std::size_t size() const { return corners.size() / 9; }
  [[nodiscard]] Vec3 corner(std::size_t triangle, std::size_t k) const {
    return Vec3(corners.data() + 9 * triangle + 3 * k);
  }
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3* p : {&a, &b, &c}) corners.insert(corners.end(), p->data(), p->data() + 3);
  }
  /// The rectangle (or planar quadrilateral) a b c d as two triangles.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    add(a, b, c);
    add(a, c, d);
  }
};

}  // namespace popcut
