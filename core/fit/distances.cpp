// SPDX-License-Identifier: MIT
#include "core/fit/distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace popcut {

double diagonal_of(const TriangleSoup& soup) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (std::size_t k = 0; k < soup.corners.size(); k += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], soup.corners[k + i]);
      high[i] = std::max(high[i], soup.corners[k + i]);
    }
  if (soup.corners.empty()) return 0.0;
  return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

std::vector<double> distances(const std::vector<Vec3>& points, const TriangleTree& to) {
  std::vector<double> out;
  out.reserve(points.size());
  std::uint32_t hint = TriangleTree::kNone;
  for (const Vec3& p : points) {
    const TriangleTree::Nearest near = to.nearest(p, hint);
    hint = near.place;
    out.push_back(std::sqrt(near.squared));
  }
  return out;
}

}  // namespace popcut
