// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/deploy/pose_table.hpp"

namespace popcut {

/// How `body` is turned against its parent, or against the world if it is a root.
[[nodiscard]] Turn joint_turn(const PoseTable& table, std::size_t pose, std::size_t body);

/// Where the pivot of `body` lies in its parent: as an offset from the parent's own pivot, in axes
/// that turn with the parent. For a root: its place in the world at `pose`.
[[nodiscard]] Vec3 joint_place(const PoseTable& table, std::size_t pose, std::size_t body);

/// The poses that an animation needs as keys, first and last among them. Between keys each joint
/// turns by slerp, evenly in psi. Few keys, at most 60 degrees of psi apart, where that gives back
/// every pose of the table to 1e-9 rad and no root shifts (the hinges of panels parallel to wall
/// and ground turn evenly with psi, so there it is exact); else every pose of the table.
[[nodiscard]] std::vector<std::size_t> animation_keys(const PoseTable& table);

}  // namespace popcut
