// SPDX-License-Identifier: MIT
#include "core/design/target/triangle_mesh.hpp"

#include <algorithm>
#include <limits>

namespace popcut {

MeshBox box_of(const TriangleMesh& mesh) {
  MeshBox box;
  box.low.fill(std::numeric_limits<double>::infinity());
  box.high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < mesh.corners.size(); ++k) {
    const double value = static_cast<double>(mesh.corners[k]);
    box.low[k % 3] = std::min(box.low[k % 3], value);
    box.high[k % 3] = std::max(box.high[k % 3], value);
  }
  return box;
}

}  // namespace popcut
