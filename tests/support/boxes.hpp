// SPDX-License-Identifier: MIT
// Plain solids for comparisons, as flat triangles.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "core/geometry/vec.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/random_numbers.hpp"

namespace popcut::testing {

[[nodiscard]] inline std::vector<float> box_between(const Vec3& low, const Vec3& high) {
  return box_mesh({low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}, false).corners;
}

[[nodiscard]] inline std::vector<float> shifted(std::vector<float> corners, const Vec3& by) {
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] =
        static_cast<float>(static_cast<double>(corners[k]) + by[static_cast<Eigen::Index>(k % 3)]);
  return corners;
}

inline void append(std::vector<float>& to, const std::vector<float>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Each triangle as four, in its own plane.
[[nodiscard]] inline std::vector<float> split(const std::vector<float>& corners) {
  std::vector<float> out;
  for (std::size_t k = 0; k + 8 < corners.size(); k += 9) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
      p[i] =
          Vec3(static_cast<double>(corners[k + 3 * i]), static_cast<double>(corners[k + 3 * i + 1]),
               static_cast<double>(corners[k + 3 * i + 2]));
    const Vec3 a = 0.5 * (p[0] + p[1]), b = 0.5 * (p[1] + p[2]), c = 0.5 * (p[2] + p[0]);
    for (const auto& t : {std::array{p[0], a, c}, std::array{a, p[1], b}, std::array{c, b, p[2]},
                          std::array{a, b, c}})
      for (const Vec3& q : t)
        for (int i = 0; i < 3; ++i) out.push_back(static_cast<float>(q[i]));
  }
  return out;
}

/// Boxes of random sizes at random places within 100 mm.
[[nodiscard]] inline std::vector<float> random_boxes(std::mt19937& random, int count) {
  using popcut::testing::uniform;
  std::vector<float> out;
  for (int k = 0; k < count; ++k) {
    const Vec3 low(uniform(random, 0, 70), uniform(random, 0, 70), uniform(random, 0, 70));
    const Vec3 size(uniform(random, 5, 30), uniform(random, 5, 30), uniform(random, 5, 30));
    append(out, box_between(low, low + size));
  }
  return out;
}

}  // namespace popcut::testing
