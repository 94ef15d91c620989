// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace popcut {

/// Triangles without shared vertices: nine numbers each, x y z of the three corners.
struct TriangleMesh {
  std::vector<float> corners;

  [[nodiscard]] std::size_t size() const { return corners.size() / 9; }
};

inline constexpr std::size_t kMaxTriangles = 10'000'000;

/// Smallest and largest coordinates.
struct MeshBox {
  std::array<double, 3> low{}, high{};
};
[[nodiscard]] MeshBox box_of(const TriangleMesh& mesh);

}  // namespace popcut
