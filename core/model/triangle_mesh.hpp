// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
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
[[nodiscard]] inline MeshBox box_of(const TriangleMesh& mesh) {
  MeshBox box;
  box.low.fill(std::numeric_limits<double>::infinity());
  box.high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < mesh.corners.size(); ++k) {
    const auto value = static_cast<double>(mesh.corners[k]);
    box.low[k % 3] = std::min(box.low[k % 3], value);
    box.high[k % 3] = std::max(box.high[k % 3], value);
  }
  return box;
}

}  // namespace popcut
