// SPDX-License-Identifier: MIT
#include "core/deploy/joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace popcut {
namespace {

std::vector<std::size_t> spread(std::size_t poses, std::size_t steps) {
  std::vector<std::size_t> keys;
  for (std::size_t i = 0; i <= steps; ++i) keys.push_back(i * (poses - 1) / steps);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

bool are_enough(const PoseTable& table, const std::vector<std::size_t>& keys) {
  constexpr double kWithinRad = 1e-9;
  for (std::size_t b = 0; b < table.bodies(); ++b) {
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      const double from = table.psi_rad[keys[i]], to = table.psi_rad[keys[i + 1]];
      const Turn first = joint_turn(table, keys[i], b), last = joint_turn(table, keys[i + 1], b);
      const Vec3 place = joint_place(table, keys[0], b);
      for (std::size_t k = keys[i]; k <= keys[i + 1]; ++k) {
        const Turn there = slerp(first, last, (table.psi_rad[k] - from) / (to - from));
        if (there.angularDistance(joint_turn(table, k, b)) > kWithinRad) return false;
        const double size = std::max(1.0, norm(place));
        if (table.parent[b] < 0 && norm(joint_place(table, k, b) - place) > kWithinRad * size)
          return false;
      }
    }
  }
  return true;
}

}  // namespace

Turn joint_turn(const PoseTable& table, std::size_t pose, std::size_t body) {
  const Turn& turn = table.at(pose, body).turn;
  const std::int32_t parent = table.parent[body];
  if (parent < 0) return turn;
  return table.at(pose, static_cast<std::size_t>(parent)).turn.conjugate() * turn;
}

Vec3 joint_place(const PoseTable& table, std::size_t pose, std::size_t body) {
  const std::int32_t parent = table.parent[body];
  if (parent < 0) return moved(table.at(pose, body), table.pivot[body]);
  return table.pivot[body] - table.pivot[static_cast<std::size_t>(parent)];
}

std::vector<std::size_t> animation_keys(const PoseTable& table) {
  const std::size_t poses = table.poses();
  if (poses < 3) return spread(poses, std::max<std::size_t>(poses, 2) - 1);
  const double span = std::abs(table.psi_rad.back() - table.psi_rad.front());
  constexpr double kStepRad = std::numbers::pi / 3;
  const auto steps = static_cast<std::size_t>(std::ceil(span / kStepRad - 1e-9));
  const auto few = spread(poses, std::clamp<std::size_t>(steps, 1, poses - 1));
  return are_enough(table, few) ? few : spread(poses, poses - 1);
}

}  // namespace popcut
