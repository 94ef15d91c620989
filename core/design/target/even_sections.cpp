// SPDX-License-Identifier: MIT
#include "core/design/target/even_sections.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace popcut {

std::vector<Section> even_sections(const TriangleMesh& mesh, const std::array<double, 3>& shift_mm,
                                   const EvenPlanes& planes) {
  std::vector<Section> out(static_cast<std::size_t>(planes.count));
  const MeshBox box = box_of(mesh);
  const double touch_mm =
      1e-6 * std::max({box.high[0] + shift_mm[0], box.high[2] + shift_mm[2], 0.0});
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    std::array<std::array<double, 3>, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[k][axis] = static_cast<double>(mesh.corners[9 * t + 3 * k + axis]) + shift_mm[axis];
    const auto [low, high] = std::minmax({p[0][1], p[1][1], p[2][1]});
    // The planes above `low` and at most at `high`: corners in a plane count as above it.
    const double last = planes.count - 1;
    const double begin = std::floor((low - planes.first_mm) / planes.step_mm);
    const double end = std::ceil((high - planes.first_mm) / planes.step_mm);
    for (double k = std::max(0.0, begin); k <= std::min(last, end); ++k) {
      const double s = planes.first_mm + k * planes.step_mm;
      std::array<SectionPoint, 2> ends;
      std::size_t found = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto &from = p[a], &to = p[(a + 1) % 3];
        if ((from[1] >= s) == (to[1] >= s)) continue;
        const double share = (s - from[1]) / (to[1] - from[1]);
        ends[found++] = {from[0] + share * (to[0] - from[0]), from[2] + share * (to[2] - from[2])};
      }
      if (found == 2) add_clipped(out[static_cast<std::size_t>(k)], ends[0], ends[1], touch_mm);
    }
  }
  return out;
}

}  // namespace popcut
